// Writes a scene of shapes: NAME.gltf and NAME.bin.
#pragma once

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "sample_game/gallery/shapes.h"

namespace gallery {

using Json = nlohmann::ordered_json;

inline Json vec(glm::vec3 v) {
  return {v.x, v.y, v.z};
}

// A glTF document and its one buffer, which write() writes.
class SceneWriter {
 public:
  // `name` is the scene's name, and that of the files.
  explicit SceneWriter(const std::string& name) : name_(name) {
    json_["asset"] = {{"version", "2.0"}, {"generator", "Loden"}};
    json_["extensionsUsed"] = {"KHR_lights_punctual"};
    json_["scene"] = 0;
    json_["scenes"] = {{{"name", name}, {"nodes", Json::array()}}};
  }

  int addMaterial(const std::string& name, glm::vec3 color, float roughness, bool double_sided) {
    Json material{{"name", name},
                  {"pbrMetallicRoughness",
                   {{"baseColorFactor", {color.x, color.y, color.z, 1.0f}},
                    {"metallicFactor", 0},
                    {"roughnessFactor", roughness}}}};
    if (double_sided) material["doubleSided"] = true;
    return append("materials", material);
  }

  int addMesh(const std::string& name, const Shape& shape, int material) {
    glm::vec3 low(1e9f), high(-1e9f);
    for (const glm::vec3& p : shape.positions) low = glm::min(low, p), high = glm::max(high, p);
    const int positions = addAccessor(shape.positions, 5126, "VEC3", 34962);
    json_["accessors"][positions]["min"] = vec(low);
    json_["accessors"][positions]["max"] = vec(high);
    const int uvs = addAccessor(shape.uvs, 5126, "VEC2", 34962);
    std::vector<uint16_t> indices;
    for (const auto& q : shape.quads) indices.insert(indices.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
    Json mesh{{"name", name},
              {"primitives",
               {{{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
                 {"indices", addAccessor(indices, 5123, "SCALAR", 34963)},
                 {"material", material}}}}};
    if (shape.is_cage) mesh["extras"]["loden_subdivision"] = {{"levels", 3}, {"quads", true}};
    return append("meshes", mesh);
  }

  void addNode(Json node) {
    const int index =
        append("nodes", std::move(node));  // made first: adding a member to json_ moves the others
    json_["scenes"][0]["nodes"].push_back(index);
  }
  void addLight(Json light, glm::vec3 position, Json rotation = {}) {
    Json& lights = json_["extensions"]["KHR_lights_punctual"]["lights"];
    Json node{{"name", light["name"]}, {"translation", vec(position)}};
    if (!rotation.is_null()) node["rotation"] = rotation;
    node["extensions"]["KHR_lights_punctual"]["light"] = lights.size();
    lights.push_back(std::move(light));
    addNode(std::move(node));
  }
  int addCamera(const Json& camera) { return append("cameras", camera); }

  bool write(const std::filesystem::path& folder) {
    json_["buffers"] = {{{"uri", name_ + ".bin"}, {"byteLength", buffer_.size()}}};
    std::ofstream binary(folder / (name_ + ".bin"), std::ios::binary);
    binary.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    std::ofstream text(folder / (name_ + ".gltf"), std::ios::binary);
    text << json_.dump(1, '\t') << '\n';
    binary.close();
    text.close();
    return binary && text;
  }

 private:
  int append(const char* array, Json value) {
    json_[array].push_back(std::move(value));
    return static_cast<int>(json_[array].size()) - 1;
  }

  template <class T>
  int addAccessor(const std::vector<T>& values, int component, const char* type, int target) {
    const size_t offset = buffer_.size(), bytes = values.size() * sizeof(T);
    buffer_.resize((offset + bytes + 3) / 4 * 4);
    std::memcpy(buffer_.data() + offset, values.data(), bytes);
    const int view = append(
        "bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}, {"target", target}});
    return append(
        "accessors",
        {{"bufferView", view}, {"componentType", component}, {"count", values.size()}, {"type", type}});
  }

  std::string name_;
  Json json_;
  std::vector<char> buffer_;
};

}  // namespace gallery
