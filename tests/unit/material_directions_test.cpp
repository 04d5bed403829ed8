// Directions against closed form, for every index; maps against their inverses.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "material/model/directions.h"

namespace loden {
namespace {

void expectDirection(const glm::dvec3& w, double theta_degrees, double phi_degrees, int index) {
  const double theta = theta_degrees * kPi / 180, phi = phi_degrees * kPi / 180;
  EXPECT_NEAR(w.x, std::sin(theta) * std::cos(phi), 1e-12) << "index " << index;
  EXPECT_NEAR(w.y, std::sin(theta) * std::sin(phi), 1e-12) << "index " << index;
  EXPECT_NEAR(w.z, std::cos(theta), 1e-12) << "index " << index;
}

TEST(Directions, Bonn81AgreesWithClosedFormAtEveryIndex) {
  const DirectionSet set = bonn81Directions();
  ASSERT_EQ(set.size(), 81);
  const double theta[] = {0, 15, 30, 45, 60, 75}, step[] = {360, 60, 30, 20, 18, 15};
  int index = 0;
  for (int ring = 0; ring < 6; ++ring)
    for (double phi = 0; phi < 359.999; phi += step[ring], ++index)
      expectDirection(set.samples[index], theta[ring], phi, index);
  EXPECT_EQ(index, 81);
}

TEST(Directions, Ubo151AgreesWithClosedFormAtEveryIndex) {
  const DirectionSet set = ubo151Directions();
  ASSERT_EQ(set.size(), 151);
  const double theta[] = {0, 11, 23.5, 30, 37.5, 45, 52.5, 60, 67.5, 75};
  const int count[] = {1, 6, 12, 12, 12, 18, 18, 24, 24, 24};
  const double first[] = {0, 15, 0, 15, 0, 0, 7.5, 0, 7.5, 0};
  int index = 0;
  for (int ring = 0; ring < 10; ++ring)
    for (int k = 0; k < count[ring]; ++k, ++index)
      expectDirection(set.samples[index], theta[ring], first[ring] + 360.0 * k / count[ring], index);
  EXPECT_EQ(index, 151);
}

TEST(Directions, ConcentricCellsCoverEqualSolidAngles) {
  // Every cell's centre is nearest to itself, and the mean of z over equal-area cells is (1 + cos(85)) / 2.
  const DirectionSet set = concentricDirections(60);
  double sum = 0;
  for (int k = 0; k < set.size(); ++k) {
    EXPECT_EQ(nearestDirection(set, set.samples[k]), k);
    EXPECT_NEAR(glm::length(set.samples[k]), 1, 1e-12);
    sum += set.samples[k].z;
  }
  EXPECT_NEAR(sum / set.size(), (1 + std::cos(85 * kPi / 180)) / 2,
              2e-3);  // the midpoint rule on 60 x 60 cells
}

TEST(Directions, NamesRoundTripAndNonsenseIsRefused) {
  for (const char* name : {"bonn81", "ubo151", "5x5", "15x15"}) {
    const auto set = directionsByName(name);
    ASSERT_TRUE(set) << name;
    EXPECT_EQ(directionsName(*set), name);
  }
  for (const char* name :
       {"", "bonn", "5", "5x", "x5", "5x6", "0x0", "-3x-3", "17x17", "5x5 ", "99999999999x1"})
    EXPECT_FALSE(directionsByName(name)) << name;
}

TEST(Directions, SphericalCoordinatesRoundTrip) {
  for (double theta = 0; theta < 1.55; theta += 0.11)
    for (double phi = 0; phi < 6.28; phi += 0.37) {
      const Spherical s = sphericalFromDirection(directionFromSpherical({theta, phi}));
      EXPECT_NEAR(s.theta, theta, 1e-12);
      if (theta > 0) {
        EXPECT_NEAR(s.phi, phi, 1e-12);
      }
    }
}

TEST(Directions, NearestImageNamesEverySampleAtItsOwnPlace) {
  for (const DirectionSet& set : {bonn81Directions(), ubo151Directions()}) {
    const auto image = nearestDirectionLookup(set, kNearestLookupSide);
    std::set<int> found;
    for (int k = 0; k < set.size(); ++k) {
      const auto texel = [](double c) { return static_cast<int>((c * 0.5 + 0.5) * kNearestLookupSide); };
      const int at = image[texel(set.samples[k].y) * kNearestLookupSide + texel(set.samples[k].x)];
      EXPECT_EQ(at, k);
      found.insert(at);
    }
    EXPECT_EQ(static_cast<int>(found.size()), set.size());
  }
}

TEST(Directions, DiskAndSquareAreInverse) {
  for (double v = 0.01; v < 1; v += 0.07)
    for (double u = 0.01; u < 1; u += 0.07) {
      const glm::dvec2 disk = diskFromSquare(glm::dvec2(u, v));
      EXPECT_LE(glm::length(disk), 1 + 1e-12);
      const glm::dvec2 back = squareFromDisk(disk);
      EXPECT_NEAR(back.x, u, 1e-12);
      EXPECT_NEAR(back.y, v, 1e-12);
    }
}

}  // namespace
}  // namespace loden
