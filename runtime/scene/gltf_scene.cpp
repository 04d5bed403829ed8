#include "runtime/scene/gltf_scene.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <span>

#include "material/base/gltf_extensions.h"
#include "material/base/json_depth.h"
#include "material/base/memory_issue.h"
#include "material/base/one_line.h"
#include "material/system/confined_path.h"
#include "runtime/scene/gltf_guard.h"
#include "runtime/scene/gltf_reader.h"
#include "runtime/scene/gltf_rewrite.h"

namespace loden::runtime {
namespace {

// tinygltf's access to files, confined to one folder.
struct ConfinedFiles {
  std::filesystem::path folder;
  std::optional<Issue> refused;  // the first URI that led outside

  static Result<std::filesystem::path> find(const std::string& name, void* user_data) {
    auto* self = static_cast<ConfinedFiles*>(user_data);
    // tinygltf decodes data URIs of the media types that glTF knows, and takes others for files.
    Result<std::filesystem::path> path =
        name.starts_with("data:")
            ? Issue{issue_id::kMediaType, Severity::kError, "glTF",
                    "a data URI is of another media type than glTF knows: " + name.substr(0, 40)}
            : confinedPath(self->folder, name, "glTF");
    if (!path && !self->refused) self->refused = path.issue();
    return path;
  }
  static bool exists(const std::string& name, void* self) {
    const auto path = find(name, self);
    std::error_code error;
    return path && std::filesystem::is_regular_file(*path, error);
  }
  static std::string expand(const std::string& name, void*) { return name; }
  static bool readWhole(std::vector<unsigned char>* out, std::string* message, const std::string& name,
                        void* self) {
    const auto path = find(name, self);
    auto bytes = path ? readRegularFile(*path) : Result<std::vector<std::byte>>(path.issue());
    if (!bytes) {
      if (message) *message += bytes.issue().where + ": " + bytes.issue().text;
      return false;
    }
    const auto* first = reinterpret_cast<const unsigned char*>(bytes->data());
    out->assign(first, first + bytes->size());
    return true;
  }
  static bool refuseWrite(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  }

  tinygltf::FsCallbacks callbacks() { return {&exists, &expand, &readWhole, &refuseWrite, this}; }
};

// Keeps the bytes of an image for later. What lies in a buffer view is read there, after checks that tinygltf
// does not make.
bool keepImage(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes,
               int size, void*) {
  if (image->bufferView < 0 && size > 0) image->image.assign(bytes, bytes + size);
  return true;
}

Status checkRequired(const tinygltf::Model& model, const std::string& file) {
  for (const std::string& name : model.extensionsRequired)
    if (!isDrawnGltfExtension(name))
      return Issue{issue_id::kGltfRequired, Severity::kError, file + ": extensionsRequired",
                   "needs " + name.substr(0, 100) + ", which is not supported: export without it"};
  return {};
}

// What a viewer of the file would show and this one does not, each by its name.
void noteUndrawn(gltf::Reader& reader) {
  for (const std::string& name : reader.model.extensionsUsed)
    if (!isDrawnGltfExtension(name))
      reader.note(issue_id::kGltfExtension, "extensionsUsed", name.substr(0, 100) + " is not drawn");
}

Result<tinygltf::Model> parse(std::span<const std::byte> bytes, const std::filesystem::path& folder,
                              const std::string& file) {
  tinygltf::TinyGLTF loader;
  ConfinedFiles files{folder, {}};
  loader.SetFsCallbacks(files.callbacks());
  loader.SetImageLoader(&keepImage, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const auto size = static_cast<unsigned>(bytes.size());
  const bool binary = bytes.size() >= 4 && std::equal(data, data + 4, "glTF");
  // With an empty base folder tinygltf hands on the URI as it stands in the file.
  const bool ok = binary ? loader.LoadBinaryFromMemory(&model, &error, &warning, data, size, "")
                         : loader.LoadASCIIFromString(&model, &error, &warning,
                                                      reinterpret_cast<const char*>(data), size, "");
  if (!ok && files.refused)
    return Issue{files.refused->id, Severity::kError, file + ": " + files.refused->where,
                 files.refused->text};
  // It hands on what() of what it catches.
  if (!ok && error.find(std::bad_alloc().what()) != std::string::npos) throw std::bad_alloc();
  if (!ok) return Issue{issue_id::kGltfParse, Severity::kError, file, oneLine(error)};
  return model;
}

Result<Scene> convert(const tinygltf::Model& model, const std::filesystem::path& path,
                      const SceneOptions& options) {
  gltf::Reader reader{model, path.parent_path(), path.string()};
  reader.scene.name = path.stem().string();
  noteUndrawn(reader);
  if (Status status = gltf::readVariants(reader, options.variant); !status) return status.issue();
  for (auto* part : {&gltf::readCompressedViews, &gltf::readAssets, &gltf::readMaterials, &gltf::readMeshes,
                     &gltf::readNodes, &gltf::readSkins, &gltf::readAnimations})
    if (Status status = part(reader); !status) return status.issue();
  return std::move(reader.scene);
}

Result<Scene> load(const std::filesystem::path& path, const SceneOptions& options) {
  const std::string file = path.string();
  const auto bytes = readRegularFile(path);
  if (!bytes) return bytes.issue();
  const auto json = gltfJson(*bytes, file);
  if (!json) return json.issue();
  if (Status depth = checkJsonDepth(*json, file); !depth) return depth.issue();
  const std::vector<std::byte> changed = withoutFallbackBuffers(*bytes, *json);
  const auto model = parse(changed.empty() ? *bytes : changed, path.parent_path(), file);
  if (!model) return model.issue();
  if (Status required = checkRequired(*model, file); !required) return required.issue();
  return convert(*model, path, options);
}

}  // namespace

Result<Scene> loadGltfScene(const std::filesystem::path& path, const SceneOptions& options) {
  return withMemoryIssue(path.native(), "this scene", [&]() -> Result<Scene> {
    try {
      return load(path, options);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {  // tinygltf and its JSON parser throw on some malformed input
      return Issue{issue_id::kGltfParse, Severity::kError, path.string(), oneLine(error.what())};
    }
  });
}

}  // namespace loden::runtime
