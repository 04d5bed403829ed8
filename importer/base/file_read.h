// Files as bytes.
#pragma once

#include <filesystem>
#include <string>

#include "material/base/result.h"

namespace loden::importer {

// The whole file, a pipe included. Issues: kCannotOpen; kCannotRead, of folders too.
Result<std::string> readFile(const std::filesystem::path& path);

// Whether a file, or a folder where that may be one, is there and readable, for libraries that do not say why
// they cannot open it. Issues: kCannotOpen.
enum class Openable { kFile, kFileOrFolder };
Status checkOpens(const std::filesystem::path& path, Openable what);

}  // namespace loden::importer
