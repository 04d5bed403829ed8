// Materials, and the extension LODEN_materials_flat_btf on the document and on its materials.
#include <cmath>

#include "material/system/asset_io.h"
#include "material/system/confined_path.h"
#include "runtime/scene/gltf_reader.h"

namespace loden::runtime::gltf {
namespace {

constexpr const char* kExtension = "LODEN_materials_flat_btf";

const tinygltf::Value* extension(const tinygltf::ExtensionMap& extensions) {
  const auto found = extensions.find(kExtension);
  return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

glm::vec3 colorOf(const std::vector<double>& values, const glm::vec3& fallback) {
  if (values.size() < 3) return fallback;
  const glm::vec3 color(values[0], values[1], values[2]);
  return std::isfinite(color.x + color.y + color.z) ? glm::max(color, glm::vec3(0)) : fallback;
}

Result<SceneAsset> readAsset(const Reader& reader, const tinygltf::Value& object, size_t index) {
  const std::string place = std::string("extensions.") + kExtension + "." + at("assets", index);
  const std::string uri = stringMember(object, "uri");
  const std::optional<int> view = indexMember(object, "bufferView");
  if (uri.empty() == !view.has_value())
    return reader.issue(issue_id::kGltfExtension, place, "needs either uri or bufferView");
  SceneAsset asset;
  if (view) {
    const Result<View> bytes = readView(reader, *view, place);
    if (!bytes) return bytes.issue();
    const auto* first = reinterpret_cast<const std::byte*>(bytes->data);
    asset.embedded.assign(first, first + bytes->size);
    asset.name = reader.file + ": " + place;
    return asset;
  }
  const auto path = confinedPath(reader.folder, uri, place);
  if (!path) return reader.issue(path.issue().id, place, path.issue().text);
  asset.path = *path;
  asset.name = path->string();
  return asset;
}

// A finite number of a two-element array; nothing if the member is absent, an Issue if it is something else.
Status readScale(const Reader& reader, const tinygltf::Value& object, const std::string& place,
                 glm::vec2& scale) {
  if (!object.Has("scale")) return {};
  const tinygltf::Value& value = object.Get("scale");
  const bool pair =
      value.IsArray() && value.ArrayLen() == 2 && value.Get(0).IsNumber() && value.Get(1).IsNumber();
  if (pair) scale = glm::vec2(value.Get(0).GetNumberAsDouble(), value.Get(1).GetNumberAsDouble());
  if (!pair || !std::isfinite(scale.x + scale.y) || scale.x == 0 || scale.y == 0)
    return reader.issue(issue_id::kGltfExtension, place, "scale must be two finite numbers other than 0");
  return {};
}

Result<FlatBtfBinding> readBinding(const Reader& reader, const tinygltf::Value& object,
                                   const std::string& place) {
  FlatBtfBinding binding;
  const std::optional<int> asset = indexMember(object, "asset");
  if (!asset || size_t(*asset) >= reader.scene.assets.size())
    return reader.issue(issue_id::kGltfExtension, place, "asset must be an index into the document's assets");
  binding.asset = *asset;
  binding.tex_coord = indexMember(object, "texCoord").value_or(0);
  const double rotation = numberMember(object, "rotation").value_or(0);
  if (binding.tex_coord > 15 || !std::isfinite(rotation))
    return reader.issue(issue_id::kGltfExtension, place, "texCoord must be 0 .. 15 and rotation finite");
  binding.rotation = static_cast<float>(rotation);
  if (Status scale = readScale(reader, object, place, binding.scale); !scale) return scale.issue();
  return binding;
}

Result<SceneMaterial> readMaterial(const Reader& reader, size_t index) {
  const tinygltf::Material& source = reader.model.materials[index];
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  SceneMaterial material;
  material.name = source.name;
  material.base_color = glm::vec4(colorOf(pbr.baseColorFactor, glm::vec3(1)), 1);
  material.metallic = glm::clamp(static_cast<float>(pbr.metallicFactor), 0.0f, 1.0f);
  material.roughness = glm::clamp(static_cast<float>(pbr.roughnessFactor), 0.0f, 1.0f);
  material.emissive = colorOf(source.emissiveFactor, glm::vec3(0));
  material.double_sided = source.doubleSided;
  if (const tinygltf::Value* object = extension(source.extensions)) {
    auto binding = readBinding(reader, *object, at("materials", index) + ".extensions." + kExtension);
    if (!binding) return binding.issue();
    material.flat_btf = *binding;
  }
  return material;
}

}  // namespace

std::optional<double> numberMember(const tinygltf::Value& object, const char* key) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return {};
  return object.Get(key).GetNumberAsDouble();
}

std::optional<int> indexMember(const tinygltf::Value& object, const char* key) {
  const std::optional<double> number = numberMember(object, key);
  if (!number || !(*number >= 0 && *number < 1e9) || *number != std::floor(*number)) return {};
  return static_cast<int>(*number);
}

std::string stringMember(const tinygltf::Value& object, const char* key) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsString()) return {};
  return object.Get(key).Get<std::string>();
}

Status readAssets(Reader& reader) {
  const tinygltf::Value* root = extension(reader.model.extensions);
  if (!root) return {};
  const std::string place = std::string("extensions.") + kExtension;
  if (!root->Has("assets") || !root->Get("assets").IsArray())
    return reader.issue(issue_id::kGltfExtension, place, "needs an array \"assets\"");
  const tinygltf::Value& assets = root->Get("assets");
  for (size_t i = 0; i < assets.ArrayLen(); ++i) {
    auto asset = readAsset(reader, assets.Get(static_cast<int>(i)), i);
    if (!asset) return asset.issue();
    reader.scene.assets.push_back(*std::move(asset));
  }
  return {};
}

Status readMaterials(Reader& reader) {
  for (size_t i = 0; i < reader.model.materials.size(); ++i) {
    auto material = readMaterial(reader, i);
    if (!material) return material.issue();
    reader.scene.materials.push_back(*std::move(material));
  }
  return {};
}

}  // namespace loden::runtime::gltf
