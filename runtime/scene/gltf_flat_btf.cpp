// The extension LODEN_materials_flat_btf on the document and on its materials.
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

Result<SceneAsset> readAsset(const Reader& reader, const tinygltf::Value& object, size_t index) {
  const std::string place = std::string("extensions.") + kExtension + "." + at("assets", index);
  const std::string uri = stringMember(object, "uri");
  const std::optional<int> view = indexMember(object, "bufferView");
  if (uri.empty() == !view.has_value())
    return reader.issue(issue_id::kAssetSource, place, "needs either uri or bufferView");
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
    return reader.issue(issue_id::kMaterialScale, place, "scale must be two finite numbers other than 0");
  return {};
}

Result<FlatBtfBinding> readBinding(const Reader& reader, const tinygltf::Value& object,
                                   const std::string& place) {
  FlatBtfBinding binding;
  const std::optional<int> asset = indexMember(object, "asset");
  if (!asset || size_t(*asset) >= reader.scene.assets.size())
    return reader.issue(issue_id::kMaterialAsset, place, "asset must be an index into the document's assets");
  binding.asset = *asset;
  binding.tex_coord = indexMember(object, "texCoord").value_or(0);
  const double rotation = numberMember(object, "rotation").value_or(0);
  if (binding.tex_coord > 15) return reader.issue(issue_id::kTexCoord, place, "texCoord must be 0 .. 15");
  if (!std::isfinite(rotation))
    return reader.issue(issue_id::kMaterialRotation, place, "rotation must be finite");
  binding.rotation = static_cast<float>(rotation);
  if (Status scale = readScale(reader, object, place, binding.scale); !scale) return scale.issue();
  return binding;
}

}  // namespace

Status readAssets(Reader& reader) {
  const tinygltf::Value* root = extension(reader.model.extensions);
  if (!root) return {};
  const std::string place = std::string("extensions.") + kExtension;
  if (!root->Has("assets") || !root->Get("assets").IsArray())
    return reader.issue(issue_id::kExtensionAssets, place, "needs an array \"assets\"");
  const tinygltf::Value& assets = root->Get("assets");
  for (size_t i = 0; i < assets.ArrayLen(); ++i) {
    auto asset = readAsset(reader, assets.Get(static_cast<int>(i)), i);
    if (!asset) return asset.issue();
    reader.scene.assets.push_back(*std::move(asset));
  }
  return {};
}

Status readFlatBtf(const Reader& reader, const tinygltf::Material& source, const std::string& place,
                   std::optional<FlatBtfBinding>& binding) {
  const tinygltf::Value* object = extension(source.extensions);
  if (!object) return {};
  auto read = readBinding(reader, *object, place + ".extensions." + kExtension);
  if (!read) return read.issue();
  binding = *read;
  return {};
}

}  // namespace loden::runtime::gltf
