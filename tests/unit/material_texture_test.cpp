// Texels: codes, filters and half floats against plain formulas.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "material/model/texture.h"
#include "tests/unit/material_fixtures.h"

namespace loden {
namespace {

constexpr TexelFormat kAllFormats[] = {
    TexelFormat::kR8Unorm,     TexelFormat::kRG8Unorm,     TexelFormat::kRGBA8Unorm,
    TexelFormat::kRGBA8Snorm,  TexelFormat::kRG16Snorm,    TexelFormat::kRGBA16Unorm,
    TexelFormat::kRGBA16Snorm, TexelFormat::kRGBA16Sfloat, TexelFormat::kRGBA32Sfloat,
};

TEST(Texture, StoresWhatItFetches) {
  for (const TexelFormat format : kAllFormats) {
    SCOPED_TRACE(texelFormatName(format));
    const Texture noise = test::noiseTexture(format, TextureShape::kArray2D, 5, 3, 2, 3, 7);
    Texture copy = Texture::make(format, TextureShape::kArray2D, 5, 3, 2, 3);
    for (int mip = 0; mip < 3; ++mip) {
      for (int z = 0; z < 2; ++z) {
        for (int y = 0; y < noise.mipHeight(mip); ++y) {
          for (int x = 0; x < noise.mipWidth(mip); ++x) {
            storeTexel(copy, mip, x, y, z, fetchTexel(noise, mip, x, y, z));
          }
        }
      }
    }
    EXPECT_TRUE(copy.data == noise.data);
  }
}

TEST(Texture, MissingChannelsReadAsZeroAndAlphaAsOne) {
  for (const TexelFormat format : kAllFormats) {
    SCOPED_TRACE(texelFormatName(format));
    const Texture texture = Texture::make(format, TextureShape::kArray2D, 1, 1, 1);
    const float alpha = texelChannels(format) == 4 ? 0.0f : 1.0f;
    EXPECT_EQ(fetchTexel(texture, 0, 0, 0, 0), glm::vec4(0, 0, 0, alpha));
  }
}

TEST(Texture, RefusesNothingButClampsToTheFormat) {
  Texture texture = Texture::make(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, 1, 1, 1);
  storeTexel(texture, 0, 0, 0, 0, {-7, 7, std::numeric_limits<float>::quiet_NaN(), 0.5f});
  EXPECT_EQ(static_cast<int>(texture.data[0]), 0x81) << "-127; -128 is never stored";
  EXPECT_EQ(static_cast<int>(texture.data[1]), 0x7f);
  EXPECT_EQ(static_cast<int>(texture.data[2]), 0);
  EXPECT_EQ(static_cast<int>(texture.data[3]), 64);
  texture.data[0] = std::byte{0x80};
  EXPECT_EQ(fetchTexel(texture, 0, 0, 0, 0).x, -1) << "-128 reads as -1 all the same";
}

TEST(Texture, LaysMipsOutOneBehindTheOther) {
  const Texture texture = Texture::make(TexelFormat::kRG16Snorm, TextureShape::kArray2D, 8, 2, 3, 4);
  EXPECT_EQ(texture.mipBytes(0), 8u * 2 * 3 * 4);
  EXPECT_EQ(texture.mipBytes(3), 1u * 1 * 3 * 4);
  EXPECT_EQ(texture.mipOffset(3), (16u + 4 + 2) * 3 * 4);
  EXPECT_EQ(texture.data.size(), texture.mipOffset(3) + texture.mipBytes(3));
  EXPECT_EQ(fullMipCount(8, 2), 4);
  EXPECT_EQ(fullMipCount(1, 1), 1);
  EXPECT_EQ(fullMipCount(5, 9), 4);
}

TEST(Texture, BytesSaturateInsteadOfWrapping) {
  EXPECT_EQ(textureBytes(TexelFormat::kRGBA32Sfloat, 1ull << 32, 1ull << 32, 1, 1), ~0ull);
  EXPECT_EQ(textureBytes(TexelFormat::kRGBA32Sfloat, 16384, 16384, 16384, 1), 16ull << 42);
}

// The definition: blend of the four texels around uv * size - 1/2, indices modulo size.
glm::dvec4 bilinearByDefinition(const Texture& texture, int mip, int layer, glm::dvec2 uv) {
  const int width = texture.mipWidth(mip), height = texture.mipHeight(mip);
  const glm::dvec2 texel = uv * glm::dvec2(width, height) - 0.5;
  glm::dvec4 sum(0);
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      const double i = std::floor(texel.x) + dx, j = std::floor(texel.y) + dy;
      const double weight = (1 - std::abs(texel.x - i)) * (1 - std::abs(texel.y - j));
      const auto wrap = [](double index, int size) {
        return static_cast<int>(index - size * std::floor(index / size));
      };
      sum += weight * glm::dvec4(fetchTexel(texture, mip, wrap(i, width), wrap(j, height), layer));
    }
  }
  return sum;
}

TEST(Texture, FiltersBilinearlyWithRepeat) {
  for (const TexelFormat format : {TexelFormat::kRG16Snorm, TexelFormat::kRGBA16Sfloat}) {
    const Texture texture = test::noiseTexture(format, TextureShape::kArray2D, 7, 4, 3, 3, 11);
    for (int k = 0; k < 2000; ++k) {
      const glm::dvec2 uv(std::fmod(k * 0.7548776662, 5.0) - 2.5, std::fmod(k * 0.5698402910, 5.0) - 2.5);
      const int mip = k % 3, layer = k / 3 % 3;
      const glm::dvec4 expected = bilinearByDefinition(texture, mip, layer, uv);
      const glm::dvec4 in_double = sampleRepeat<double>(texture, mip, layer, uv);
      const glm::dvec4 in_float(sampleRepeat<float>(texture, mip, layer, glm::vec2(uv)));
      ASSERT_LT(glm::length(in_double - expected), 1e-12) << k;
      // Rounding uv to float moves the sample by up to 2e-7 * 7 texels, across a full contrast of 1 per
      // channel.
      ASSERT_LT(glm::length(in_float - expected), 1e-5) << k;
    }
  }
}

TEST(Texture, FiltersAtTheSeamAndFarAway) {
  const Texture texture = test::noiseTexture(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, 4, 4, 1, 1, 3);
  const glm::dvec4 seam = sampleRepeat<double>(texture, 0, 0, {0.0, 0.125});
  const glm::dvec4 expected =
      0.5 * (glm::dvec4(fetchTexel(texture, 0, 3, 0, 0)) + glm::dvec4(fetchTexel(texture, 0, 0, 0, 0)));
  EXPECT_LT(glm::length(seam - expected), 1e-12);
  // A tiny negative coordinate wraps to 1 exactly in float.
  EXPECT_LT(glm::length(glm::dvec4(sampleRepeat<float>(texture, 0, 0, {-1e-12f, 0.125f})) - expected), 1e-6);
  EXPECT_EQ(nearestRepeat<float>(texture, 0, 0, {-1e-12f, 0.125f}), fetchTexel(texture, 0, 3, 0, 0));
  EXPECT_EQ(sampleRepeat<float>(texture, 0, 0, {1e30f, 0.0f}),
            sampleRepeat<float>(texture, 0, 0, {0.0f, 0.0f}));
}

TEST(Texture, BlendsMipsAndClampsTheLevel) {
  const Texture texture = test::noiseTexture(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, 8, 8, 1, 4, 5);
  const glm::dvec2 uv(0.3, 0.6);
  const auto at = [&](double lod) { return sampleRepeatLod<double>(texture, lod, 0, uv); };
  const glm::dvec4 expected =
      glm::mix(sampleRepeat<double>(texture, 1, 0, uv), sampleRepeat<double>(texture, 2, 0, uv), 0.25);
  EXPECT_LT(glm::length(at(1.25) - expected), 1e-12);
  EXPECT_EQ(at(-3), at(0));
  EXPECT_EQ(at(9), sampleRepeat<double>(texture, 3, 0, uv));
}

TEST(Texture, FiltersVolumesTrilinearlyWithClamp) {
  const Texture volume = test::noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kVolume, 3, 4, 5, 1, 6);
  const auto fetch = [&](int x, int y, int z) { return glm::dvec4(fetchTexel(volume, 0, x, y, z)); };
  EXPECT_EQ(sampleVolume<double>(volume, {1.5, 2.5, 3.5}), fetch(1, 2, 3)) << "texel centres are at .5";
  EXPECT_EQ(sampleVolume<double>(volume, {-9, -9, -9}), fetch(0, 0, 0));
  EXPECT_EQ(sampleVolume<double>(volume, {9, 9, 9}), fetch(2, 3, 4));
  glm::dvec4 mean(0);
  for (int corner = 0; corner < 8; ++corner) {
    mean += fetch(corner & 1, corner >> 1 & 1, corner >> 2) / 8.0;
  }
  EXPECT_LT(glm::length(sampleVolume<double>(volume, {1, 1, 1}) - mean), 1e-12);
}

TEST(Half, RoundTripsEveryCode) {
  for (uint32_t code = 0; code < 65536; ++code) {
    const auto half = static_cast<uint16_t>(code);
    const float value = floatFromHalf(half);
    if (std::isnan(value)) {
      ASSERT_TRUE(std::isnan(floatFromHalf(halfFromFloat(value))));
    } else {
      ASSERT_EQ(halfFromFloat(value), half);
    }
  }
}

TEST(Half, RoundsToNearestEven) {
  for (uint32_t code = 0; code < 0x7bff; ++code) {
    const auto half = static_cast<uint16_t>(code);
    const float below = floatFromHalf(half), above = floatFromHalf(half + 1);
    const float middle = 0.5f * (below + above);
    const uint16_t even = code % 2 == 0 ? half : half + 1;
    ASSERT_EQ(halfFromFloat(middle), even);
    ASSERT_EQ(halfFromFloat(std::nextafter(middle, 0.0f)), half);
    ASSERT_EQ(halfFromFloat(std::nextafter(middle, 1e9f)), half + 1);
    ASSERT_EQ(halfFromFloat(-middle), even | 0x8000);
  }
  EXPECT_EQ(floatFromHalf(0x7bff), 65504.0f);
  EXPECT_EQ(halfFromFloat(65519.0f), 0x7bff);
  EXPECT_EQ(halfFromFloat(65520.0f), 0x7c00);
}

}  // namespace
}  // namespace loden
