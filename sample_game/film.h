// Encodes frames as a film by the program ffmpeg, if that is installed.
#pragma once

#include <filesystem>

#include "material/base/result.h"

namespace loden::walk {

// Encodes frame_0000.png, frame_0001.png ... in `folder` as the file `film`. Returns false, and does nothing,
// if ffmpeg is not installed. The issue is kCannotWrite if ffmpeg fails.
Result<bool> encodeFilm(const std::filesystem::path& folder, const std::filesystem::path& film,
                        int frames_per_second);

}  // namespace loden::walk
