// Writes pictures to files.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <span>

#include "material/base/result.h"

namespace loden::runtime {

// Writes sRGB RGBA8 codes, [height][width] with the first row at the top, as a PNG file. The file appears
// whole or not at all. Issues: kCannotWrite, kMemory.
Status writePng(const std::filesystem::path& path, std::span<const glm::u8vec4> pixels, glm::ivec2 size);

}  // namespace loden::runtime
