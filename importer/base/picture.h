// Pictures for comparison and ray tracing: linear RGBA in memory; PNG, JPEG, EXR, HDR and others on disk.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

#include "material/base/result.h"
#include "material/system/atomic_file.h"

namespace loden::importer {

// A picture, row 0 at the top. Linear RGB, white = 1; alpha is coverage, and colour is premultiplied by it.
struct Picture {
  int width = 0, height = 0;
  std::vector<glm::vec4> pixels;  // width * height, x fastest
  glm::vec4& at(int x, int y) { return pixels[size_t(y) * width + x]; }
  const glm::vec4& at(int x, int y) const { return pixels[size_t(y) * width + x]; }
};

// The picture in a file. Integer formats are decoded from sRGB, float formats are taken as linear. Missing
// alpha reads as 1.
Result<Picture> readPicture(const std::filesystem::path& path);

// Checks, before long work, that writePicture knows the extension. Issues: kOption if not.
Status checkPictureName(const std::filesystem::path& path);

// Writes a picture in the format of the extension: .exr float RGBA linear; .png and .jpg 8 bit sRGB, clamped,
// without alpha; .hdr RGBE. It is encoded in memory and written by writeFileAtomically.
Status writePicture(const Picture& picture, const std::filesystem::path& path, Flush flush = Flush::kNow);

// The bytes of a width x height 8-bit RGB image as PNG (level 9) or JPEG (quality 100, no chroma
// subsampling).
enum class PictureCodec { kPng, kJpeg };
Result<std::vector<unsigned char>> encodeRgb8(const std::vector<unsigned char>& rgb, int width, int height,
                                              PictureCodec codec);

}  // namespace loden::importer
