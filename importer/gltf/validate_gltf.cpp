// What `loden validate` says about a scene. Numbers as in material/base/issues.h.
#include <algorithm>
#include <cmath>
#include <set>

#include "importer/base/file_read.h"
#include "importer/gltf/gltf_accessor.h"
#include "importer/gltf/gltf_document.h"
#include "importer/gltf/gltf_resource.h"
#include "importer/gltf/pack.h"
#include "importer/gltf/validate.h"
#include "material/base/gltf_extensions.h"
#include "material/base/issues.h"
#include "material/base/memory_issue.h"
#include "material/system/confined_path.h"

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

class SceneCheck {
 public:
  SceneCheck(const fs::path& path, const GltfDocument& document)
      : path_(path), file_(path.string()), json_(document.json), buffers_(document, path_) {}

  std::vector<Issue> run() {
    issues_ = wrongTypes(json_, path_.string());
    checkRequired();
    checkBuffers();
    checkImages();
    checkBufferViews();
    checkAccessors();
    checkAssets();
    checkMaterials();
    checkDeclared();
    append(checkSceneGraph(json_, buffers_, file_));
    return std::move(issues_);
  }

 private:
  void add(int id, const std::string& place, const std::string& text, Severity severity = Severity::kError) {
    issues_.push_back({id, severity, path_.string() + ": " + place, text});
  }

  void append(const std::vector<Issue>& issues) {
    issues_.insert(issues_.end(), issues.begin(), issues.end());
  }

  static std::string at(const char* list, size_t i) {
    return std::string(list) + "[" + std::to_string(i) + "]";
  }

  void checkRequired() {
    for (size_t i = 0; i < arraySize(json_, "extensionsRequired"); ++i) {
      const Json& name = json_["extensionsRequired"][i];
      if (!name.is_string() || !isDrawnGltfExtension(name.get<std::string>()))
        add(issue_id::kGltfRequired, at("extensionsRequired", i), name.dump() + " is not known to Loden");
    }
  }

  // The element's uri; null if it has none. One that is no text is said by wrongTypes.
  static const std::string* uriOf(const Json& item) {
    if (!item.is_object()) return nullptr;
    const auto uri = item.find("uri");
    return uri != item.end() && uri->is_string() ? uri->get_ptr<const std::string*>() : nullptr;
  }

  Result<GltfResource> openUri(const std::string& uri, const std::string& place) const {
    return GltfResource::open(uri, path_.parent_path(), path_.string() + ": " + place);
  }

  // Every buffer has the bytes that it declares.
  void checkBuffers() {
    for (size_t i = 0; i < arraySize(json_, "buffers"); ++i) {
      const auto& buffer = buffers_.at(i);
      const int64_t declared = integerMember(json_["buffers"][i], "byteLength");
      checkMediaType(i);
      if (!buffer)
        issues_.push_back(buffer.issue());
      else if (declared < 1)
        add(issue_id::kBufferLength, at("buffers", i), "has no byteLength");
      else if (buffer->size() < static_cast<uint64_t>(declared))
        add(issue_id::kBufferShort, at("buffers", i),
            "has " + std::to_string(buffer->size()) + " bytes of the " + std::to_string(declared) +
                " that it declares");
    }
  }

  // Of a buffer in the document itself: glTF knows two.
  void checkMediaType(size_t i) {
    const std::string* uri = uriOf(json_["buffers"][i]);
    if (uri && isDataUri(*uri) && !uri->starts_with("data:application/octet-stream;") &&
        !uri->starts_with("data:application/gltf-buffer;"))
      add(issue_id::kMediaType, at("buffers", i) + ".uri",
          "is of another media type than application/octet-stream and application/gltf-buffer");
  }

  void checkImages() {
    for (size_t i = 0; i < arraySize(json_, "images"); ++i)
      if (const std::string* uri = uriOf(json_["images"][i]))
        if (const auto image = openUri(*uri, at("images", i) + ".uri"); !image)
          issues_.push_back(image.issue());
  }

  // All sums in 64 bit; members are at most 2^53 in valid JSON, so that nothing overflows.
  void checkBufferViews() {
    for (size_t i = 0; i < arraySize(json_, "bufferViews"); ++i) {
      const Json& view = json_["bufferViews"][i];
      const int64_t buffer = integerMember(view, "buffer"), length = integerMember(view, "byteLength");
      const int64_t offset =
          view.is_object() && view.contains("byteOffset") ? integerMember(view, "byteOffset") : 0;
      if (buffer < 0 || static_cast<size_t>(buffer) >= arraySize(json_, "buffers")) {
        add(issue_id::kViewBuffer, at("bufferViews", i), "names no existing buffer");
        continue;
      }
      const int64_t size = integerMember(json_["buffers"][buffer], "byteLength");
      if (size < 1) continue;  // said by checkBuffers
      if (offset < 0 || length < 1 || length > size || offset > size - length)
        add(issue_id::kViewRange, at("bufferViews", i), "does not lie inside its buffer");
    }
  }

  void checkAccessors() {
    for (size_t i = 0; i < arraySize(json_, "accessors"); ++i) {
      const Json& accessor = json_["accessors"][i];
      const auto shape = accessorShape(accessor);
      if (!shape) {
        if (const auto fault = shapeFault(accessor)) add(fault->id, at("accessors", i), fault->text);
        continue;
      }
      if (accessor.contains("bufferView")) {
        const int64_t offset = accessor.contains("byteOffset") ? integerMember(accessor, "byteOffset") : 0;
        const auto fault = viewFault(json_, integerMember(accessor, "bufferView"), offset, shape->count,
                                     shape->elementBytes());
        if (fault && fault->id != issue_id::kViewBuffer)  // which checkBufferViews has said
          add(fault->id, at("accessors", i), fault->text);
        if (fault) continue;
      }
      if (accessor.contains("sparse"))
        if (const auto fault = visitAccessor(json_, buffers_, i, [](uint64_t, int, double) {}))
          add(fault->id, at("accessors", i) + ".sparse", fault->text);
    }
  }

  const Json& rootAssets() const {
    static const Json none = Json::array();
    if (!json_.contains("extensions") || !json_["extensions"].is_object()) return none;
    const auto& extensions = json_["extensions"];
    const auto root = extensions.find(kExtensionName);
    if (root == extensions.end() || arraySize(*root, "assets") == 0) return none;
    return (*root)["assets"];
  }

  bool hasRootExtension() const {
    return json_.contains("extensions") && json_["extensions"].is_object() &&
           json_["extensions"].contains(kExtensionName) && json_["extensions"][kExtensionName].is_object();
  }

  void checkAssets() {
    const Json& assets = rootAssets();
    if (hasRootExtension() && !json_["extensions"][kExtensionName].contains("assets"))
      add(issue_id::kExtensionAssets, std::string("extensions.") + kExtensionName,
          "needs an array \"assets\"");
    for (size_t i = 0; i < assets.size(); ++i) {
      const std::string place = "extensions." + std::string(kExtensionName) + "." + at("assets", i);
      const Json& asset = assets[i];
      const bool by_uri = asset.is_object() && asset.contains("uri") && asset["uri"].is_string();
      const bool by_view = asset.is_object() && asset.contains("bufferView");
      if (by_uri == by_view)
        add(issue_id::kAssetSource, place, "needs either a uri or a bufferView");
      else if (by_uri)
        checkFile(asset["uri"].get<std::string>(), place);
      else
        checkEmbedded(asset, place);
    }
  }

  void checkFile(const std::string& uri, const std::string& place) {
    const auto relative =
        relativePathOfUri(uri, path_.string() + ": " + place);  // an asset's uri is never data
    const auto file = relative ? openUri(uri, place) : Result<GltfResource>(relative.issue());
    if (!file)
      issues_.push_back(file.issue());
    else if (const fs::path path = path_.parent_path() / *relative; checked_.insert(path.string()).second)
      checkBytes(*file, 0, file->size(), path.string());
  }

  void checkEmbedded(const Json& asset, const std::string& place) {
    if (!asset.contains("mimeType") || asset["mimeType"] != kAssetMimeType)
      add(issue_id::kAssetMediaType, place, std::string("mimeType must be ") + kAssetMimeType);
    const int64_t view = integerMember(asset, "bufferView");
    if (view < 0 || static_cast<size_t>(view) >= arraySize(json_, "bufferViews")) {
      add(issue_id::kAssetView, place, "names no existing bufferView");
      return;
    }
    const Json& buffer_view = json_["bufferViews"][view];
    const int64_t index = integerMember(buffer_view, "buffer");
    if (index < 0 || static_cast<size_t>(index) >= arraySize(json_, "buffers"))
      return;  // said by checkBufferViews
    const auto& buffer = buffers_.at(static_cast<size_t>(index));
    if (!buffer) return;  // said by checkBuffers
    if (!checked_.insert("bufferView " + std::to_string(view)).second) return;
    const int64_t offset = std::max<int64_t>(0, integerMember(buffer_view, "byteOffset"));
    const int64_t length = integerMember(buffer_view, "byteLength"),
                  size = static_cast<int64_t>(buffer->size());
    if (length < 1 || length > size || offset > size - length)
      return;  // said by checkBufferViews or checkBuffers
    checkBytes(*buffer, static_cast<uint64_t>(offset), static_cast<uint64_t>(length),
               path_.string() + ": " + place);
  }

  void checkBytes(const GltfResource& resource, uint64_t offset, uint64_t length, const std::string& name) {
    const auto bytes = resource.read(offset, length);
    if (!bytes) {
      issues_.push_back(bytes.issue());
      return;
    }
    append(validateAssetBytes(std::as_bytes(std::span(*bytes)), name));
  }

  // Two numbers that single precision holds as finite ones other than 0.
  static bool isScale(const Json& value) {
    return value.is_array() && value.size() == 2 &&
           std::all_of(value.begin(), value.end(), [](const Json& v) {
             const float number = v.is_number() ? static_cast<float>(v.get<double>()) : 0.0f;
             return std::isfinite(number) && number != 0;
           });
  }

  void checkMaterials() {
    for (size_t m = 0; m < arraySize(json_, "materials"); ++m) {
      const Json& material = json_["materials"][m];
      if (!material.is_object() || !material.contains("extensions") || !material["extensions"].is_object() ||
          !material["extensions"].contains(kExtensionName))
        continue;
      ++uses_;
      const Json& extension = material["extensions"][kExtensionName];
      const std::string place = at("materials", m) + "." + kExtensionName;
      const int64_t asset = integerMember(extension, "asset");
      if (asset < 0 || static_cast<size_t>(asset) >= rootAssets().size())
        add(issue_id::kMaterialAsset, place + ".asset", "names no asset of the root extension");
      if (!extension.is_object()) continue;
      if (extension.contains("scale") && !isScale(extension["scale"]))
        add(issue_id::kMaterialScale, place + ".scale", "must be two finite numbers other than 0");
      if (extension.contains("rotation") && !extension["rotation"].is_number())
        add(issue_id::kMaterialRotation, place + ".rotation", "must be a number, radians");
      checkTexCoord(extension, static_cast<int64_t>(m), place);
    }
  }

  void checkTexCoord(const Json& extension, int64_t material, const std::string& place) {
    const int64_t set = extension.contains("texCoord") ? integerMember(extension, "texCoord") : 0;
    if (set < 0 || set > 15) {
      add(issue_id::kTexCoord, place + ".texCoord", "must be an integer from 0 to 15");
      return;
    }
    const std::string attribute = "TEXCOORD_" + std::to_string(set);
    for (const std::string& primitive : primitivesWithout(json_, material, attribute))
      add(issue_id::kTexCoordMissing, primitive, "has no " + attribute + ", which its material asks for");
  }

  void checkDeclared() {
    if (uses_ == 0 && !hasRootExtension()) {
      add(issue_id::kUnused, "materials", std::string("none uses ") + kExtensionName, Severity::kNote);
      return;
    }
    bool declared = false;
    for (size_t i = 0; i < arraySize(json_, "extensionsUsed"); ++i)
      declared |= json_["extensionsUsed"][i] == kExtensionName;
    if (!declared)
      add(issue_id::kUndeclared, "extensionsUsed", std::string("does not list ") + kExtensionName);
  }

  const fs::path& path_;
  const std::string file_;
  const Json& json_;
  GltfBuffers buffers_;
  std::set<std::string> checked_;  // assets, each by its file or buffer view: many may refer to one
  std::vector<Issue> issues_;
  int uses_ = 0;
};

}  // namespace

Result<std::vector<Issue>> validateGltf(const fs::path& path) {
  return withMemoryIssue(path.native(), "this scene", [&]() -> Result<std::vector<Issue>> {
    const auto bytes = readFile(path);
    if (!bytes) return bytes.issue();
    const auto document = parseGltf(*bytes, path.string());
    if (!document) return std::vector<Issue>{document.issue()};
    return SceneCheck(path, *document).run();
  });
}

}  // namespace loden::importer
