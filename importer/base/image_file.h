// Whole images to and from files. OpenImageIO behind it, named nowhere else in the bake.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "material/base/result.h"

namespace loden::importer {

enum class PixelType { kHalf, kFloat, kByte };  // kByte: 0..1 stored as 0..255

struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> pixels;  // row-major, channels interleaved; size width * height * channels
};

// Row 0 first. Written beside the target and renamed, so a file of that name is always complete.
Status writeImage(const std::filesystem::path& path, int width, int height, int channels, PixelType type,
                  std::span<const float> pixels);
Result<Image> readImage(const std::filesystem::path& path);

}  // namespace loden::importer
