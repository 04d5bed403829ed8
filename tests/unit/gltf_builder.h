// Makes small glTF scenes for tests, of accessors, textures, materials and nodes, in a temporary folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runtime/scene/gltf_scene.h"

namespace loden::test {

using Json = nlohmann::json;

// Collects a scene. A test may add to `json`, beside what the builder puts there. The destructor removes the
// folder.
class GltfBuilder {
 public:
  GltfBuilder();
  ~GltfBuilder();
  GltfBuilder(const GltfBuilder&) = delete;
  GltfBuilder& operator=(const GltfBuilder&) = delete;

  Json json;
  std::string bytes;  // content of the first buffer
  Json more_buffers = Json::array();

  // Adds a buffer view of these bytes, and returns its index.
  int view(const std::string& content);
  // Add an accessor, and return its index. `type` is glTF's, such as "VEC3". Numbers are stored without gaps.
  int floats(const std::vector<float>& values, const std::string& type);
  int bytesOf(const std::vector<uint8_t>& values, const std::string& type, bool normalized);
  int shorts(const std::vector<uint16_t>& values, const std::string& type);
  int accessor(int view, int component_type, size_t count, const std::string& type);

  // Adds a texture, as a PNG, and returns its index. Codes are in rows from the top. `sampler` is glTF's, or
  // null.
  int texture(glm::ivec2 size, const std::vector<glm::u8vec4>& codes, const Json& sampler = {});
  int material(const Json& material);
  // Adds a mesh of one primitive, and returns its index.
  int mesh(const Json& primitive);
  // The same for a square of side 2 in the plane z = 0, seen from +z, with texture coordinates from 0 at the
  // top left to 1. squareAttributes() are its attributes; `attributes` are further ones.
  int square(int material, const Json& attributes = Json::object());
  Json squareAttributes();
  int node(const Json& node);  // adds a root node of the scene

  // Writes the scene and loads it.
  Result<runtime::Scene> load();
  std::filesystem::path write();
  std::filesystem::path folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

// glTF's JSON of a material that shows its texture unlit.
Json unlit(int texture);

}  // namespace loden::test
