// Paths of files that an untrusted document names by URI, confined to the document's own folder.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "material/base/result.h"

namespace loden {

// The path that a relative URI names, percent-encoding decoded, without ".." that leads out of the folder.
// Issues: kGltfPath for schemes, absolute paths, broken escapes, backslashes and zero bytes. `where` names
// the URI in messages.
Result<std::filesystem::path> relativePathOfUri(std::string_view uri, const std::string& where);

// The file that the URI names inside `folder`, with links followed. Issues: kGltfPath as for
// relativePathOfUri, and if the file lies outside the folder.
Result<std::filesystem::path> confinedPath(const std::filesystem::path& folder, std::string_view uri,
                                           const std::string& where);

}  // namespace loden
