// Whole images to and from files.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "material/base/result.h"

namespace loden::importer {

enum class PixelType { kHalf, kFloat, kByte };  // kByte: 0..1 stored as 0..255

struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> pixels;  // row-major, channels interleaved; size width * height * channels
};

// Row 0 first. Encoded in memory and written by writeFileAtomically, so a file of that name is always
// complete. Not flushed: images are many, and what marks them as complete flushes them all.
Status writeImage(const std::filesystem::path& path, int width, int height, int channels, PixelType type,
                  std::span<const float> pixels);
Result<Image> readImage(const std::filesystem::path& path);

// Width and height of a PNG or JPEG that is in memory, read from its header; {0, 0} if it is neither.
glm::ivec2 imageExtents(std::span<const unsigned char> bytes);

}  // namespace loden::importer
