// Frames as a film, where ffmpeg is installed.
#pragma once

#include <filesystem>

#include "material/base/result.h"

namespace loden::walk {

// Makes `film` of frame_0000.png, frame_0001.png ... in `folder`; false, and nothing more, where there is no
// ffmpeg. kCannotWrite if it fails.
Result<bool> encodeFilm(const std::filesystem::path& folder, const std::filesystem::path& film,
                        int frames_per_second);

}  // namespace loden::walk
