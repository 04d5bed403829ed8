// Files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "material/base/result.h"

namespace loden {

// Writes to a temporary file in the same folder, fsync, rename over `path`, fsync of the folder. On failure
// (kCannotWrite) nothing is left behind and an existing file stays as it was.
Status writeFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace loden
