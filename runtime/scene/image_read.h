// Reads panoramas from files.
#pragma once

#include <filesystem>

#include "material/base/result.h"
#include "material/model/environment.h"

namespace loden::runtime {

// The lat-long panorama in a Radiance file (.hdr), which is untrusted input. Issues: those of openFileSource;
// kLimit if it is larger than 16384 x 8192 pixels; kOption if it is not such a file.
Result<Panorama> readPanorama(const std::filesystem::path& path);

}  // namespace loden::runtime
