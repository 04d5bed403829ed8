// Lookups of rays that are bent in the tile: on a cylinder, and where texture coordinates are stretched.

#include <gtest/gtest.h>

#include <optional>

#include "tests/unit/waves.h"

namespace loden {
namespace {

using namespace test;  // NOLINT: waves are what all of this file is about

// The wave tile bent around a cylinder, of which the world's straight rays are followed in small steps.
class WaveCylinder : public testing::Test {
 protected:
  // Tile periods; the axis is across the waves, so that rays leave along valleys.
  static constexpr double kHeight = 0.3, kCurvature = 0.25, kRadius = 1 / kCurvature;
  static constexpr double kTexel = 1.0 / 64;
  const GeometryImage image_ = waveImage(128, kHeight, 0);
  const VdimAtlas atlas_ = buildVdimAtlas(image_, {});
  const LocalSurface<double> surface_{glm::dmat2(0, 0, 0, kCurvature), glm::dmat2(1)};

  // Of a point, seen from the point of the surface that is looked at: x along the cylinder, y around it, z
  // over it.
  static glm::dvec3 unbent(const glm::dvec3& p) {
    return {p.x, kRadius * std::atan2(p.y, kRadius + p.z), std::hypot(p.y, kRadius + p.z) - kRadius};
  }
  static double below(glm::dvec2 x, const glm::dvec3& p) {  // how far a point is below the wave
    const glm::dvec3 q = unbent(p);
    return wavePoint({x.x + q.x, x.y + q.y}, kHeight, 0).z - q.z;
  }
  // The first point of the ray below the wave; none: it has left.
  static std::optional<glm::dvec2> firstHit(const View& view) {
    for (double along = 0; along > -4; along -= 0.001) {
      const glm::dvec3 point = view.wo * along;
      if (below(view.x, point) >= 0) return view.x + glm::dvec2(unbent(point));
      if (unbent(point).z > 0.01) return std::nullopt;
    }
    return std::nullopt;
  }
  struct Counts {
    int seen = 0, straight_off = 0, bent_off = 0, lost = 0, by = 0, by_found = 0;
  };
  Counts count(int samples, double theta_min_degrees) const {
    Counts n;
    for (const View& view : randomViews(samples, 85)) {
      if (view.wo.z > std::cos(theta_min_degrees * kPi / 180)) continue;
      const auto truth = firstHit(view);
      const auto bent = vdimLookup({.atlas = &atlas_}, Lookup::kDefault, view.x, view.wo, surface_);
      if (!truth) {
        n.by += 1, n.by_found += !bent.missed;
        continue;
      }
      const auto straight = vdimLookup({.atlas = &atlas_}, Lookup::kDefault, view.x, view.wo);
      const auto off = [&](const VdimHit<double>& found) {
        return glm::distance(glm::dvec2(found.position), *truth) > kTexel;
      };
      n.seen += 1, n.lost += bent.missed, n.straight_off += off(straight), n.bent_off += off(bent);
    }
    return n;
  }
};

// What the lookup finds lies on the bent tile, on the straight ray of the world, and nothing is before it.
TEST_F(WaveCylinder, LookupFollowsTheRay) {
  const Counts n = count(4000, 0);
  ASSERT_GT(n.by, 50);
  // Of rays that turn in the lower half of the relief the lookup never says that they go by.
  EXPECT_LT(n.by_found, n.by / 3) << "of " << n.by << " rays that go by";
  EXPECT_LT(n.lost, n.seen / 200) << "of " << n.seen << " rays that meet the tile";
  // A texel of 64 off: the second-order model of the bend, and what the search loses on a plane already.
  EXPECT_LT(n.bent_off, n.seen / 20) << "of " << n.seen;
  EXPECT_LT(n.bent_off * 5, n.straight_off)
      << "of " << n.seen << "; bent " << n.bent_off << ", straight " << n.straight_off;
}

// There a ray runs over a tile or more, and no straight ray from where it comes in is near all of it.
TEST_F(WaveCylinder, LookupFollowsGrazingRays) {
  const Counts n = count(20000, 75);
  ASSERT_GT(n.seen, 1000);
  EXPECT_LT(n.bent_off, n.seen / 10) << "of " << n.seen;
  EXPECT_LT(n.bent_off * 3, n.straight_off)
      << "of " << n.seen << "; bent " << n.bent_off << ", straight " << n.straight_off;
  // Rays that come close to the surface without meeting it are told apart by the search's own tolerances.
  EXPECT_LT(n.lost, n.seen / 200) << "of " << n.seen << " rays that meet the tile";
  EXPECT_LT(n.by_found, n.by / 20) << "of " << n.by << " rays that go by";
}

// Around the cylinder along a valley .3 deep a ray at 80 degrees turns at .06 and leaves; along a crest it
// stops at once, across the waves at a flank.
TEST_F(WaveCylinder, LookupTellsRaysThatGoByFromRaysThatMeetTheTile) {
  for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault})
    for (const double theta : {80.0, 82.5, 85.0}) {
      const double sine = std::sin(theta * kPi / 180), cosine = std::cos(theta * kPi / 180);
      for (const double side : {-1.0, 1.0}) {
        const glm::dvec3 around(0, side * sine, cosine);
        EXPECT_TRUE(vdimLookup({.atlas = &atlas_}, lookup, {0.25, 0.4}, around, surface_).missed) << theta;
        const auto crest = vdimLookup({.atlas = &atlas_}, lookup, {0.5, 0.4}, around, surface_);
        EXPECT_TRUE(crest.converged) << theta;
        EXPECT_NEAR(crest.position.y, 0.4, kTexel) << theta;
      }
      // Bent most where it goes half along, half across.
      const View oblique{{0.2, 0.4}, {sine * std::sqrt(0.5), sine * std::sqrt(0.5), cosine}};
      const auto truth = firstHit(oblique);
      ASSERT_TRUE(truth);
      const auto found = vdimLookup({.atlas = &atlas_}, lookup, oblique.x, oblique.wo, surface_);
      EXPECT_TRUE(found.converged) << theta;
      EXPECT_LT(glm::distance(glm::dvec2(found.position), *truth), kTexel) << theta;
    }
}

// Seeds are read where the straight rays that stand for the bent one would come in, far from x.
TEST_F(WaveCylinder, LookupRepeatsWithTheTile) {
  for (const View& view : randomViews(500, 85)) {
    const glm::dvec2 x = glm::round(view.x * 1024.0) / 1024.0;  // so that sums are exact
    const auto near = vdimLookup({.atlas = &atlas_}, Lookup::kDefault, x, view.wo, surface_);
    const auto far =
        vdimLookup({.atlas = &atlas_}, Lookup::kDefault, x + glm::dvec2(64, -32), view.wo, surface_);
    EXPECT_EQ(near.missed, far.missed);
    EXPECT_EQ(near.height, far.height);
    EXPECT_TRUE(std::isfinite(near.position.x) && std::isfinite(near.position.y) &&
                std::isfinite(near.position.z));
  }
}

// Stretched texture coordinates: twice as many periods per length along x move the hit twice as far.
TEST(VdimLookup, FollowsStretchedCoordinates) {
  const GeometryImage image = waveImage(64, 0.1, 0);
  const VdimAtlas atlas = buildVdimAtlas(image, {});
  const LocalSurface<double> stretched{glm::dmat2(0), glm::dmat2(2, 0, 0, 1)};
  for (const View& view : randomViews(200, 60)) {
    const auto found = vdimLookup({.atlas = &atlas}, Lookup::kDefault, view.x, view.wo, stretched);
    if (!found.converged) continue;
    const glm::dvec2 slope(view.wo.x / view.wo.z, view.wo.y / view.wo.z);
    EXPECT_NEAR(found.offset.x, 2 * slope.x * found.position.z, 1e-9);
    EXPECT_NEAR(found.offset.y, slope.y * found.position.z, 1e-9);
    EXPECT_NEAR(found.position.z, surfaceAt(image, found.p).position.z, 1e-3);
  }
}

}  // namespace
}  // namespace loden
