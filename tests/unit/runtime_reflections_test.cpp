// Image based lighting's tables against what they stand for.
#include <gtest/gtest.h>

#include "runtime/scene/reflections.h"

namespace loden::runtime {
namespace {

// Radiance that grows along a direction: a lobe around n shows .5 + .5 c dot(n, direction), c the lobe's mean
// cosine, the same for all directions.
TEST(Reflections, BlurredLevelsKeepTheirDirections) {
  Panorama panorama{512, 256, {}};
  for (int row = 0; row < panorama.height; ++row)
    for (int column = 0; column < panorama.width; ++column)
      panorama.pixels.push_back(0.5f + 0.5f * glm::vec3(panoramaDirection(panorama, column, row)));
  const ReflectionMap map = makeReflectionMap(panorama, glm::mat3(1));
  ASSERT_EQ(map.levels.size(), size_t(ReflectionMap::kLevels) + 1);
  float last = 1.1f;
  for (int level = 0; level < ReflectionMap::kLevels; ++level) {
    const int side = ReflectionMap::kSide >> level;
    ASSERT_EQ(map.levels[size_t(level)].size(), size_t(6) * size_t(side) * size_t(side));
    float cosine = 0;
    for (int face = 0; face < 6; ++face) {
      const size_t middle =
          (size_t(face) * size_t(side) + size_t(side) / 2) * size_t(side) + size_t(side) / 2;
      const glm::vec3 n = cubeDirection(face, glm::vec2(float(side / 2) + 0.5f) / float(side));
      const glm::vec3 seen = 2.0f * map.levels[size_t(level)][middle] - 1.0f;
      if (face == 0) cosine = glm::dot(seen, n);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(seen[c], cosine * n[c], 0.03f) << level << " " << face << " " << c;
    }
    EXPECT_LT(cosine, last) << "rougher is more blurred";
    last = cosine;
  }
  EXPECT_NEAR(last, 2 / 3.0f, 0.1f) << "a lobe of roughness 1, seen head-on, is nearly a cosine";
  const int side = ReflectionMap::kSide >> ReflectionMap::kLevels;
  const std::vector<glm::vec3>& diffuse = map.levels.back();
  for (size_t i = 0; i < diffuse.size(); ++i) {
    const int row = int(i) / side % side, column = int(i) % side;
    const glm::vec3 n = cubeDirection(int(i) / (side * side), (glm::vec2(column, row) + 0.5f) / float(side));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(diffuse[i][c], 0.5f + n[c] / 3, 0.01f) << i;
  }
}

TEST(Reflections, TableAgreesWithKnownReflectances) {
  constexpr int kSide = 16;
  const std::vector<glm::vec4> table = makeReflectanceTable(kSide);
  const auto at = [&](int roughness, int cosine) {
    return table[size_t(roughness) * kSide + size_t(cosine)];
  };
  EXPECT_NEAR(at(0, kSide - 1).x, 1, 0.01f) << "a mirror head-on reflects f0";
  EXPECT_NEAR(at(0, kSide - 1).y, 0, 0.01f);
  for (int roughness = 0; roughness < kSide; ++roughness)
    for (int cosine = 1; cosine < kSide; ++cosine) {
      const glm::vec4 value = at(roughness, cosine);
      EXPECT_GT(value.x + value.y, 0.3f);
      EXPECT_LT(value.x + value.y, 1.02f) << "no more than all light";
      EXPECT_LE(value.z, 1.0f);
    }
  EXPECT_LT(at(2, 8).w, 0.1f) << "sharp lobes lie around the mirror direction";
  EXPECT_GT(at(kSide - 1, 2).w, 0.4f) << "rough ones do not at grazing angles";
}

TEST(Reflections, NeutralStudioIsGreyAndOfOrdinaryBrightness) {
  const Panorama studio = neutralPanorama();
  glm::vec3 least(1e9f);
  for (const glm::vec3& pixel : studio.pixels) {
    EXPECT_EQ(pixel.r, pixel.g);
    least = glm::min(least, pixel);
  }
  EXPECT_GT(least.r, 0.1f) << "no side of an object is black";
  const EnvironmentLight light = projectPanorama(studio, 0).light;
  float sum = 0;  // irradiance on a surface that faces up, over pi
  constexpr int kRings = 40;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kRings; ++j) {
      const float z = std::sqrt((float(i) + 0.5f) / kRings), phi = 6.2831853f * (float(j) + 0.5f) / kRings;
      const float r = std::sqrt(1 - z * z);
      sum += radianceFrom(light, {r * std::cos(phi), r * std::sin(phi), z}).r / (kRings * kRings);
    }
  EXPECT_NEAR(sum, 1, 0.25f);
}

}  // namespace
}  // namespace loden::runtime
