// Writes files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "material/base/result.h"

namespace loden {

// When a file reaches the disk: before the call returns (kNow), or when the system writes it (kLater, for one
// of many files after which flushFileSystem is called).
enum class Flush { kNow, kLater };

// Writes to a temporary file in the same folder, flushes it and renames it to `path`. On failure
// (kCannotWrite) nothing is left behind and an existing file stays as it was. The temporary file of a process
// that was killed is removed when the same path is written again. A path at which something stands that is no
// regular file, such as a folder, a pipe or a device, is refused.
Status writeFileAtomically(const std::filesystem::path& path, std::span<const std::byte> bytes,
                           Flush flush = Flush::kNow);

// Writes everything that the file system of this folder still has in memory to the disk. Issues:
// kCannotWrite.
Status flushFileSystem(const std::filesystem::path& folder);

}  // namespace loden
