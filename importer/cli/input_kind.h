// What a path on the command line is: verbs that take several kinds of input share this.
#pragma once

#include <filesystem>

namespace loden::importer {

enum class InputKind { kMissing, kBakedOutput, kAsset, kGltf, kPicture, kUnknown };

// A folder with bake.json, or by extension: .loden; .gltf, .glb; .exr, .png, .jpg, .jpeg, .hdr, .tif, .tiff,
// .webp.
InputKind inputKind(const std::filesystem::path& path);

}  // namespace loden::importer
