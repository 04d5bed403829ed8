// Reads and writes assets by path.
#pragma once

#include <filesystem>
#include <memory>

#include "material/asset/asset.h"

namespace loden {

// The file as a source whose bytes are read on demand. Only a regular file is opened. Issues: kCannotOpen.
Result<std::unique_ptr<ByteSource>> openFileSource(const std::filesystem::path& path);

// The material in a file; see readAsset of material/asset/asset.h.
Result<Material> readAsset(const std::filesystem::path& path);

// Writes the asset to a file, which appears whole or not at all: it is written to a temporary file, flushed
// to disk and renamed, and the folder is flushed.
Status writeAsset(const Material& material, const std::filesystem::path& path);

}  // namespace loden
