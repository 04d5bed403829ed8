#include "runtime/scene/image_mips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "material/model/color.h"

namespace loden::runtime {
namespace {

// The codes of one channel as numbers from 0 to 1, and back.
struct Coding {
  std::array<float, 256> value{};
  std::array<uint8_t, 65536> code{};  // of the number index / 65535
};

Coding makeCoding(bool srgb) {
  Coding coding;
  for (size_t i = 0; i < coding.value.size(); ++i)
    coding.value[i] = float(srgb ? linearFromSrgb(double(i) / 255) : double(i) / 255);
  for (size_t i = 0; i < coding.code.size(); ++i) {
    const double value = double(i) / 65535;
    coding.code[i] = uint8_t(std::lround(255 * (srgb ? srgbFromLinear(value) : value)));
  }
  return coding;
}

const Coding& codingOf(bool srgb) {
  static const Coding linear = makeCoding(false), encoded = makeCoding(true);
  return srgb ? encoded : linear;
}

// The texels of one axis that a texel of the next mip covers, from `first` on, and their shares.
struct Taps {
  int first = 0, count = 1;
  std::array<float, 3> share{1, 0, 0};
};

Taps tapsOf(int texel, int size) {
  if (size == 1) return {};
  if (size % 2 == 0) return {2 * texel, 2, {0.5f, 0.5f, 0}};
  const auto half = float(size / 2), whole = float(size);
  return {2 * texel, 3, {(half - float(texel)) / whole, half / whole, float(texel + 1) / whole}};
}

void addRow(const std::byte* texels, float share, const Coding& color, const Coding& alpha,
            std::vector<glm::vec4>& row) {
  for (glm::vec4& sum : row) {
    for (int c = 0; c < 3; ++c) sum[c] += share * color.value[size_t(texels[c])];
    sum.a += share * alpha.value[size_t(texels[3])];
    texels += 4;
  }
}

uint8_t codeOf(const Coding& coding, float value) {
  return coding.code[size_t(std::clamp(value, 0.0f, 1.0f) * 65535.0f + 0.5f)];
}

void makeMip(Texture& mips, int mip, const Coding& color, const Coding& alpha) {
  const int width = mips.mipWidth(mip - 1), height = mips.mipHeight(mip - 1);
  const std::byte* from = mips.data.data() + mips.mipOffset(mip - 1);
  std::byte* to = mips.data.data() + mips.mipOffset(mip);
  std::vector<glm::vec4> row(static_cast<size_t>(width));
  for (int y = 0; y < mips.mipHeight(mip); ++y) {
    std::fill(row.begin(), row.end(), glm::vec4(0));
    const Taps down = tapsOf(y, height);
    for (int k = 0; k < down.count; ++k)
      addRow(from + size_t(down.first + k) * size_t(width) * 4, down.share[size_t(k)], color, alpha, row);
    for (int x = 0; x < mips.mipWidth(mip); ++x) {
      const Taps across = tapsOf(x, width);
      glm::vec4 mean(0);
      for (int k = 0; k < across.count; ++k) mean += across.share[size_t(k)] * row[size_t(across.first + k)];
      for (int c = 0; c < 3; ++c) *to++ = std::byte(codeOf(color, mean[c]));
      *to++ = std::byte(codeOf(alpha, mean.a));
    }
  }
}

}  // namespace

Texture imageMips(const SceneImage& image, bool srgb) {
  const glm::ivec2 size = image.size;
  Texture mips = Texture::make(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, size.x, size.y, 1,
                               fullMipCount(size.x, size.y));
  std::memcpy(mips.data.data(), image.pixels.data(), image.pixels.size() * sizeof image.pixels[0]);
  for (int mip = 1; mip < mips.mips; ++mip) makeMip(mips, mip, codingOf(srgb), codingOf(false));
  return mips;
}

}  // namespace loden::runtime
