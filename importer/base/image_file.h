// Reads and writes whole images.
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

// Writes an image, row 0 first. It is encoded in memory and written by writeFileAtomically, so that a file of
// that name is always complete. It is not flushed to disk: a bake writes many images, and flushes them all
// before it marks them as complete.
Status writeImage(const std::filesystem::path& path, int width, int height, int channels, PixelType type,
                  std::span<const float> pixels);
Result<Image> readImage(const std::filesystem::path& path);

// Width and height of a PNG or JPEG in memory, read from its header; {0, 0} if it is neither.
glm::ivec2 imageExtents(std::span<const unsigned char> bytes);

}  // namespace loden::importer
