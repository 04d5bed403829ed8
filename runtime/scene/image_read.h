// Panoramas from files.
#pragma once

#include <filesystem>

#include "material/base/result.h"
#include "material/model/environment.h"

namespace loden::runtime {

// A lat-long panorama from a Radiance file (.hdr), which is untrusted input. Issues of openFileSource; kLimit
// beyond 16384 x 8192 pixels; kOption if it is no such file.
Result<Panorama> readPanorama(const std::filesystem::path& path);

}  // namespace loden::runtime
