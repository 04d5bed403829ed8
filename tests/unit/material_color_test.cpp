// Colour spaces: known answers and round trips.
#include <gtest/gtest.h>

#include <cmath>

#include "material/model/color.h"

namespace loden {
namespace {

TEST(Color, YccRoundTrips) {
  const glm::dvec3 rgb(0.7, -0.1, 1.6);
  EXPECT_LT(glm::length(rgbFromYcc(yccFromRgb(rgb)) - rgb), 1e-12);
  EXPECT_LT(glm::length(yccFromRgb(glm::dvec3(0.4)) - glm::dvec3(0.4, 0, 0)), 1e-15) << "grey has no chroma";
}

TEST(Color, SrgbRoundTrips) {
  for (int i = 0; i <= 255; ++i) {
    EXPECT_NEAR(srgbFromLinear(linearFromSrgb(i / 255.0)), i / 255.0, 1e-8);
  }
  EXPECT_NEAR(linearFromSrgb(0.5), 0.21404114048223255, 1e-15);
}

TEST(Color, LabOfWhiteGreyAndPrimaries) {
  EXPECT_LT(glm::length(labFromRgb(glm::dvec3(1)) - glm::dvec3(100, 0, 0)), 1e-12);
  EXPECT_NEAR(labFromRgb(glm::dvec3(0.18)).x, 49.4961, 1e-4);
  EXPECT_LT(glm::length(labFromRgb(glm::dvec3(0)) - glm::dvec3(0)), 1e-12);
  // Red of sRGB as colour tables print it, to their two digits.
  EXPECT_LT(glm::length(labFromRgb({1, 0, 0}) - glm::dvec3(53.24, 80.09, 67.20)), 0.02);
}

TEST(Color, LabIsContinuousBelowZero) {
  const double step = 1e-9;
  EXPECT_LT(glm::length(labFromRgb(glm::dvec3(-step)) - labFromRgb(glm::dvec3(step))), 1e-4);
}

}  // namespace
}  // namespace loden
