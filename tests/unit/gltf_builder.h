// Small glTF scenes for tests: accessors of numbers, pictures, materials and nodes, written to a folder.
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

// What a test adds to `json` stands beside what the builder makes. The folder goes with the builder.
class GltfBuilder {
 public:
  GltfBuilder();
  ~GltfBuilder();
  GltfBuilder(const GltfBuilder&) = delete;
  GltfBuilder& operator=(const GltfBuilder&) = delete;

  Json json;
  std::string bytes;  // of the first buffer
  Json more_buffers = Json::array();

  // Index of a buffer view of these bytes.
  int view(const std::string& content);
  // Index of an accessor; `type` as in the file, such as "VEC3". Numbers are stored one after the other.
  int floats(const std::vector<float>& values, const std::string& type);
  int bytesOf(const std::vector<uint8_t>& values, const std::string& type, bool normalized);
  int shorts(const std::vector<uint16_t>& values, const std::string& type);
  int accessor(int view, int component_type, size_t count, const std::string& type);

  // Index of a texture of a PNG; codes by rows from the top. `sampler` as in the file, or null.
  int texture(glm::ivec2 size, const std::vector<glm::u8vec4>& codes, const Json& sampler = {});
  int material(const Json& material);
  // Index of a mesh of the primitive. The others: of a square of side 2 in the plane z = 0, seen from +z,
  // with texture coordinates from 0 at the top left to 1; more attributes stand beside its own.
  int mesh(const Json& primitive);
  int square(int material, const Json& attributes = Json::object());
  Json squareAttributes();
  int node(const Json& node);  // of the scene

  // Writes all and loads it.
  Result<runtime::Scene> load();
  std::filesystem::path write();
  std::filesystem::path folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

// A material that shows its texture as it is.
Json unlit(int texture);

}  // namespace loden::test
