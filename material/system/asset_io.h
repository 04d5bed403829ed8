// Assets by path.
#pragma once

#include <filesystem>
#include <memory>

#include "material/asset/asset.h"

namespace loden {

// The file's bytes by range, read on demand. Only a regular file is opened. Issues: kCannotOpen.
Result<std::unique_ptr<ByteSource>> openFileSource(const std::filesystem::path& path);

// parseAsset of a file.
Result<Material> readAsset(const std::filesystem::path& path);

// serializeAsset to a temporary file, fsync, rename, fsync of the folder.
Status writeAsset(const Material& material, const std::filesystem::path& path);

}  // namespace loden
