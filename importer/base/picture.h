// Pictures for comparison and ray tracing: linear RGBA in memory; PNG, JPEG, EXR, HDR and others on disk.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

#include "material/base/result.h"
#include "material/system/atomic_file.h"

namespace loden::importer {

// Row 0 is the top. Linear RGB, white = 1; alpha is coverage, colour is premultiplied by it.
struct Picture {
  int width = 0, height = 0;
  std::vector<glm::vec4> pixels;  // width * height, x fastest
  glm::vec4& at(int x, int y) { return pixels[size_t(y) * width + x]; }
  const glm::vec4& at(int x, int y) const { return pixels[size_t(y) * width + x]; }
};

// Integer formats are decoded from sRGB, float formats are taken as linear. Missing alpha reads as 1.
Result<Picture> readPicture(const std::filesystem::path& path);

// kOption unless writePicture knows the extension: to be asked before long work.
Status checkPictureName(const std::filesystem::path& path);

// By the extension: .exr float RGBA linear; .png and .jpg 8 bit sRGB, clamped, without alpha; .hdr RGBE.
// Encoded in memory and written by writeFileAtomically.
Status writePicture(const Picture& picture, const std::filesystem::path& path, Flush flush = Flush::kNow);

// Bytes of a width x height 8-bit RGB image as PNG (level 9) or JPEG (quality 100, no chroma subsampling).
enum class PictureCodec { kPng, kJpeg };
Result<std::vector<unsigned char>> encodeRgb8(const std::vector<unsigned char>& rgb, int width, int height,
                                              PictureCodec codec);

}  // namespace loden::importer
