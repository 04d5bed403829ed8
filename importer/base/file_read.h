// Files as bytes.
#pragma once

#include <filesystem>
#include <string>

#include "material/base/result.h"

namespace loden::importer {

// The whole of a regular file. Issues: kCannotOpen, of folders, pipes and devices too; kCannotRead.
Result<std::string> readFile(const std::filesystem::path& path);

// Whether a regular file, or a folder where that may be one, is there and readable, for libraries that do not
// say why they cannot open it, or wait at a pipe. Issues: kCannotOpen.
enum class Openable { kFile, kFileOrFolder };
Status checkOpens(const std::filesystem::path& path, Openable what);

}  // namespace loden::importer
