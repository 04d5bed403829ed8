// The kind of input that a path on the command line names; used by verbs that accept several kinds.
#pragma once

#include <filesystem>

namespace loden::importer {

enum class InputKind { kMissing, kBakedOutput, kAsset, kGltf, kPicture, kUnknown };

// The kind of input at a path: kBakedOutput is a folder with bake.json, the others are known by their
// extensions: .loden; .gltf, .glb; .exr, .png, .jpg, .jpeg, .hdr, .tif, .tiff, .webp.
InputKind inputKind(const std::filesystem::path& path);

}  // namespace loden::importer
