#include "importer/cli/input_kind.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace loden::importer {

InputKind inputKind(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return InputKind::kMissing;
  if (std::filesystem::is_directory(path, error))
    return std::filesystem::exists(path / "bake.json", error) ? InputKind::kBakedOutput : InputKind::kUnknown;
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (extension == ".loden") return InputKind::kAsset;
  if (extension == ".gltf" || extension == ".glb") return InputKind::kGltf;
  for (const char* picture : {".exr", ".png", ".jpg", ".jpeg", ".hdr", ".tif", ".tiff", ".webp"})
    if (extension == picture) return InputKind::kPicture;
  return InputKind::kUnknown;
}

}  // namespace loden::importer
