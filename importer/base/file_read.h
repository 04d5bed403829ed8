// Reads files as bytes.
#pragma once

#include <filesystem>
#include <string>

#include "material/base/result.h"

namespace loden::importer {

// The bytes of a whole regular file. Issues: kCannotOpen, also for folders, pipes and devices; kCannotRead.
Result<std::string> readFile(const std::filesystem::path& path);

// Checks that a regular file, or a folder if `what` allows one, is there and readable. It is for libraries
// that do not say why they cannot open a file, or that would wait at a pipe. Issues: kCannotOpen.
enum class Openable { kFile, kFileOrFolder };
Status checkOpens(const std::filesystem::path& path, Openable what);

}  // namespace loden::importer
