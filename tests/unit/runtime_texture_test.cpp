// Mips of images, the parts that they are streamed in, and how finely a mesh shows them.
#include <gtest/gtest.h>

#include <cmath>

#include "material/model/color.h"
#include "runtime/scene/camera.h"
#include "runtime/scene/image_mips.h"
#include "runtime/stream/image_parts.h"
#include "tests/unit/textured_square.h"

namespace loden::test {
namespace {

using namespace runtime;

int codeAt(const Texture& mips, int mip, int x, int y, int channel) {
  return int(mips.data[mips.mipOffset(mip) + size_t(4 * (y * mips.mipWidth(mip) + x) + channel)]);
}

TEST(ImageMips, AreMeansOfTheCodesThatAreNotSrgb) {
  const SceneImage image{
      "checker", {2, 2}, {{0, 10, 255, 0}, {255, 20, 255, 4}, {255, 30, 255, 8}, {0, 41, 255, 12}}};
  const Texture mips = imageMips(image, false);
  ASSERT_EQ(mips.mips, 2);
  EXPECT_EQ(codeAt(mips, 0, 1, 0, 1), 20);
  EXPECT_EQ(codeAt(mips, 1, 0, 0, 0), 128);  // of 127.5
  EXPECT_EQ(codeAt(mips, 1, 0, 0, 1), 25);   // of 25.25
  EXPECT_EQ(codeAt(mips, 1, 0, 0, 2), 255);
  EXPECT_EQ(codeAt(mips, 1, 0, 0, 3), 6);
}

TEST(ImageMips, AreMeansOfTheLightThatSrgbCodesStandFor) {
  const SceneImage image{"checker", {2, 1}, {{0, 90, 255, 0}, {255, 90, 255, 100}}};
  const Texture mips = imageMips(image, true);
  EXPECT_EQ(codeAt(mips, 1, 0, 0, 0), std::lround(255 * srgbFromLinear(0.5)));
  EXPECT_EQ(codeAt(mips, 1, 0, 0, 1), 90);
  EXPECT_EQ(codeAt(mips, 1, 0, 0, 2), 255);
  EXPECT_EQ(codeAt(mips, 1, 0, 0, 3), 50) << "alpha is no colour";
}

// Every texel of the image has the same share in the coarsest mip, whatever the size.
TEST(ImageMips, CountEveryTexelOfOddSizesAlike) {
  for (const glm::ivec2 size : {glm::ivec2(5, 3), glm::ivec2(7, 1), glm::ivec2(1, 11), glm::ivec2(6, 9)}) {
    const int texels = size.x * size.y;
    for (int white = 0; white < texels; ++white) {
      SceneImage image{"one white", size, std::vector<glm::u8vec4>(size_t(texels), glm::u8vec4(0))};
      image.pixels[size_t(white)] = glm::u8vec4(255);
      const Texture mips = imageMips(image, false);
      EXPECT_EQ(mips.mips, fullMipCount(size.x, size.y));
      // Each mip is rounded to half a code.
      EXPECT_NEAR(codeAt(mips, mips.mips - 1, 0, 0, 0), 255.0 / texels, 0.5 * mips.mips)
          << size.x << " x " << size.y;
    }
  }
}

TEST(ImageParts, AreTheTailAndThenMipByMip) {
  const Texture mips = Texture::make(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, 300, 128, 1, 9);
  const std::vector<PartPlan> parts = planImageParts(mips, true, 4096);
  ASSERT_EQ(parts.size(), 4u);  // from 37 x 16, 75 x 32, 150 x 64 and 300 x 128 texels on
  uint64_t chain = 0;
  for (int mip = 8; mip >= 3; --mip) chain += mips.mipBytes(mip);
  EXPECT_EQ(parts[0].desc.bytes, chain);
  EXPECT_EQ(parts[0].desc.lambda_end, 8);  // without it the coarsest mip is shown
  EXPECT_FALSE(parts[0].desc.takes_over);
  for (int k = 1; k < 4; ++k) {
    const PartPlan& part = parts[size_t(k)];
    EXPECT_EQ(part.first_mip, 3 - k);
    EXPECT_EQ(part.mips, 9 - part.first_mip);
    EXPECT_EQ(part.desc.bytes, chain += mips.mipBytes(part.first_mip));
    EXPECT_EQ(part.desc.lambda_end, part.first_mip + 1);  // the last level at which it is blended in
    EXPECT_TRUE(part.desc.takes_over);
  }
  EXPECT_EQ(planImageParts(mips, true, 150).size(), 3u) << "the driver takes no more";
  for (const PartPlan& part : planImageParts(mips, false, 4096))
    EXPECT_EQ(part.desc.bytes, mips.mipBytes(part.first_mip));
}

TEST(ImageParts, OfTheSmallestImageAreOne) {
  const Texture mips = Texture::make(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, 1, 1, 1, 1);
  const std::vector<PartPlan> parts = planImageParts(mips, true, 4096);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].desc.bytes, 4u);
  EXPECT_GT(parts[0].desc.lambda_end, 0);
}

TEST(TexelDensity, CountsTexelsPerMetre) {
  const Mesh mesh = texturedSquare(2);
  TextureUse use;
  EXPECT_NEAR(texelDensity(mesh, use, {512, 512}), 256, 1e-2);
  // The finer axis counts with half of its texels where the other has fewer: pixels may be turned.
  EXPECT_NEAR(texelDensity(mesh, use, {512, 128}), 128, 1e-2);
  EXPECT_NEAR(texelDensity(mesh, use, {512, 500}), 250, 1e-2);
}

TEST(TexelDensity, FollowsTheTransformAndTheSetOfCoordinates) {
  Mesh mesh = texturedSquare(2);
  TextureUse use;
  const float c = 3 * std::cos(0.4f), s = 3 * std::sin(0.4f);
  use.image_u = {c, s, 7};
  use.image_v = {-s, c, -2};
  EXPECT_NEAR(texelDensity(mesh, use, {512, 512}), 3 * 256, 0.1);
  mesh.uv_sets[2] = mesh.uv_sets[0];
  for (glm::vec2& uv : mesh.uv_sets[2]) uv *= 0.5f;
  use.tex_coord = 2;
  EXPECT_NEAR(texelDensity(mesh, use, {512, 512}), 1.5 * 256, 0.1);
}

// Such a mesh shows one texel of the image itself, as palettes want.
TEST(TexelDensity, IsZeroWhereCoordinatesStandStill) {
  Mesh mesh = texturedSquare(2);
  TextureUse use;
  use.tex_coord = 1;
  EXPECT_EQ(texelDensity(mesh, use, {512, 512}), 0) << "no coordinates";
  mesh.uv_sets[1].assign(mesh.vertices.size(), {0.3f, 0.3f});
  EXPECT_EQ(texelDensity(mesh, use, {512, 512}), 0);
}

TEST(MostStretch, IsThatOfTheLongestAxis) {
  EXPECT_FLOAT_EQ(mostStretch(glm::mat3(1)), 1);
  const float c = std::cos(0.7f), s = std::sin(0.7f);
  const glm::mat3 turned(glm::vec3(c, s, 0), glm::vec3(-s, c, 0), glm::vec3(0, 0, 1));
  const glm::mat3 scaled(glm::vec3(2, 0, 0), glm::vec3(0, 0.1f, 0), glm::vec3(0, 0, 5));
  EXPECT_NEAR(mostStretch(turned * scaled), 5, 1e-5);
  const glm::mat3 sheared(glm::vec3(1, 0, 0), glm::vec3(3, 1, 0), glm::vec3(0, 0, 1));
  EXPECT_GE(mostStretch(sheared), 3.3027f);  // its largest singular value
  EXPECT_LT(mostStretch(sheared), 4);
}

}  // namespace
}  // namespace loden::test
