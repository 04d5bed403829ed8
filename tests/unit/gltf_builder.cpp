#include "tests/unit/gltf_builder.h"

#include <unistd.h>

#include <fstream>

#include "runtime/scene/image_write.h"

namespace loden::test {
namespace {

namespace fs = std::filesystem;

template <class T>
std::string rawBytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

size_t componentsOf(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "MAT4") return 16;
  return size_t(type.back() - '0');
}

int lastIndex(const Json& array) {
  return int(array.size()) - 1;
}

}  // namespace

GltfBuilder::GltfBuilder() {
  std::string name = (fs::temp_directory_path() / "loden_scene_XXXXXX").string();
  folder_ = ::mkdtemp(name.data());
  json = {{"asset", {{"version", "2.0"}}}, {"scenes", {{{"nodes", Json::array()}}}}};
}

GltfBuilder::~GltfBuilder() {
  std::error_code error;
  fs::remove_all(folder_, error);
}

int GltfBuilder::view(const std::string& content) {
  bytes.resize((bytes.size() + 3) / 4 * 4);
  json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", content.size()}});
  bytes += content;
  return lastIndex(json["bufferViews"]);
}

int GltfBuilder::accessor(int view, int component_type, size_t count, const std::string& type) {
  json["accessors"].push_back(
      {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
  return lastIndex(json["accessors"]);
}

int GltfBuilder::floats(const std::vector<float>& values, const std::string& type) {
  return accessor(view(rawBytes(values)), 5126, values.size() / componentsOf(type), type);
}

int GltfBuilder::bytesOf(const std::vector<uint8_t>& values, const std::string& type, bool normalized) {
  const int index = accessor(view(rawBytes(values)), 5121, values.size() / componentsOf(type), type);
  json["accessors"][size_t(index)]["normalized"] = normalized;
  return index;
}

int GltfBuilder::shorts(const std::vector<uint16_t>& values, const std::string& type) {
  return accessor(view(rawBytes(values)), 5123, values.size() / componentsOf(type), type);
}

int GltfBuilder::texture(glm::ivec2 size, const std::vector<glm::u8vec4>& codes, const Json& sampler) {
  const std::string name = "image" + std::to_string(json["images"].size()) + ".png";
  if (!runtime::writePng(folder_ / name, codes, size).ok()) std::abort();
  json["images"].push_back({{"uri", name}});
  Json texture{{"source", lastIndex(json["images"])}};
  if (!sampler.is_null()) {
    json["samplers"].push_back(sampler);
    texture["sampler"] = lastIndex(json["samplers"]);
  }
  json["textures"].push_back(texture);
  return lastIndex(json["textures"]);
}

int GltfBuilder::material(const Json& material) {
  json["materials"].push_back(material);
  return lastIndex(json["materials"]);
}

int GltfBuilder::mesh(const Json& primitive) {
  json["meshes"].push_back({{"primitives", {primitive}}});
  return lastIndex(json["meshes"]);
}

Json GltfBuilder::squareAttributes() {
  return {{"POSITION", floats({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, "VEC3")},
          {"NORMAL", floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")},
          {"TEXCOORD_0", floats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2")}};
}

int GltfBuilder::square(int material, const Json& attributes) {
  Json all = squareAttributes();
  all.update(attributes);
  return mesh(
      {{"attributes", all}, {"indices", shorts({0, 1, 2, 0, 2, 3}, "SCALAR")}, {"material", material}});
}

int GltfBuilder::node(const Json& node) {
  json["nodes"].push_back(node);
  json["scenes"][0]["nodes"].push_back(lastIndex(json["nodes"]));
  return lastIndex(json["nodes"]);
}

fs::path GltfBuilder::write() {
  std::ofstream(folder_ / "scene.bin", std::ios::binary) << bytes;
  Json whole = json;
  if (!bytes.empty()) whole["buffers"] = {{{"uri", "scene.bin"}, {"byteLength", bytes.size()}}};
  for (const Json& buffer : more_buffers) whole["buffers"].push_back(buffer);
  std::ofstream(folder_ / "scene.gltf") << whole;
  return folder_ / "scene.gltf";
}

Result<runtime::Scene> GltfBuilder::load() {
  return runtime::loadGltfScene(write());
}

Json unlit(int texture) {
  return {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}},
          {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
}

}  // namespace loden::test
