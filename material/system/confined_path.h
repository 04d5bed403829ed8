// Files that an untrusted document names by uri: only those in its own folder.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "material/base/result.h"

namespace loden {

// A relative uri, percent-encoding decoded, as a path without ".." that leave. kGltfPath for schemes,
// absolute paths, broken escapes, backslashes and zero bytes. `where` names the uri in messages.
Result<std::filesystem::path> relativePathOfUri(std::string_view uri, const std::string& where);

// The file that the uri names inside `folder`, links followed; kGltfPath also if it would lie outside.
Result<std::filesystem::path> confinedPath(const std::filesystem::path& folder, std::string_view uri,
                                           const std::string& where);

}  // namespace loden
