// Pictures to files.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <span>

#include "material/base/result.h"

namespace loden::runtime {

// RGBA8 codes, sRGB, [height][width], first row at the top. The file appears whole or not at all.
// kCannotWrite, kMemory.
Status writePng(const std::filesystem::path& path, std::span<const glm::u8vec4> pixels, glm::ivec2 size);

}  // namespace loden::runtime
