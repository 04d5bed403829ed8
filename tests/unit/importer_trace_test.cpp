// Rays through a tile, and the light that a hit reflects.
#include <gtest/gtest.h>

#include "importer/bake/light_sum.h"
#include "importer/base/random.h"
#include "importer/tile/mesh_material.h"
#include "importer/tile/tile_tracer.h"
#include "tests/unit/importer_meshes.h"

namespace loden::importer {
namespace {

using testing::groovedTile;

TEST(TileTracer, FindsTheHeightFieldFromAnyPeriodAndAngle) {
  const auto height = [](glm::dvec2 p) {
    return 0.1 * (std::cos(2 * kPi * p.x) * std::cos(2 * kPi * p.y) - 1);
  };
  const Tile tile = testing::heightFieldTile(96, height);
  const TileTracer tracer(tile);
  for (int k = 0; k < 500; ++k) {
    const glm::dvec2 x(20 * uniform(1, 2 * k) - 10, 20 * uniform(1, 2 * k + 1) - 10);
    const glm::dvec3 wo = directionFromSpherical({89.5 * kPi / 180 * uniform(2, k), 2 * kPi * uniform(3, k)});
    const auto hit = tracer.intersectView(x, wo);
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->position.z, height(hit->p), 2e-4);  // facets of a 96 x 96 grid
    EXPECT_LT(glm::distance(hit->p, glm::dvec2(hit->position)), 1e-9);
    const glm::dvec3 on_ray = glm::dvec3(x, 0) - wo * hit->t;
    EXPECT_LT(glm::distance(on_ray, hit->position), 2e-5 / wo.z);  // float rays
    const auto shifted = tracer.intersectView(x + glm::dvec2(3, -2), wo);
    ASSERT_TRUE(shifted.has_value());
    EXPECT_LT(glm::distance(shifted->p - glm::dvec2(3, -2), hit->p), 1e-4);
  }
}

TEST(TileTracer, StreamsOfViewRaysAgreeWithSingleOnes) {
  const TileTracer tracer(groovedTile());
  std::vector<glm::dvec2> x;
  for (int k = 0; k < 301; ++k) x.emplace_back(20 * uniform(6, 2 * k) - 10, 20 * uniform(6, 2 * k + 1) - 10);
  std::vector<std::optional<TileHit>> hits(x.size());
  for (const double theta : {0.0, 0.7, 1.4, 1.567}) {  // the last leaves the scene's box
    const glm::dvec3 wo = directionFromSpherical({theta, 0.3});
    tracer.intersectViews(x, wo, hits);
    for (size_t k = 0; k < x.size(); ++k) {
      const auto single = tracer.intersectView(x[k], wo);
      ASSERT_TRUE(hits[k] && single) << theta << ' ' << k;
      EXPECT_LT(glm::distance(hits[k]->position, single->position), 1e-7)
          << theta;  // either triangle beside an edge
      EXPECT_NEAR(hits[k]->t, single->t, 1e-7 / wo.z);
    }
  }
  const glm::dvec3 from_below(0.6, 0, -0.8);  // its rays go up and away from the tile
  tracer.intersectViews(x, from_below, hits);
  for (size_t k = 0; k < x.size(); ++k)
    EXPECT_EQ(hits[k].has_value(), tracer.intersectView(x[k], from_below).has_value()) << k;
}

TEST(TileTracer, StreamsOfShadowRaysAgreeWithSingleOnes) {
  const TileTracer tracer(groovedTile());
  std::vector<glm::vec3> origins;
  std::vector<uint8_t> wanted;
  for (int k = 0; k < 301; ++k) {
    const TileHit hit =
        tracer.pointOn(uint32_t(uniform(5, k) * double(tracer.tile().triangles.size())), {0.3, 0.3});
    origins.push_back(glm::vec3(hit.ray_origin) + glm::vec3(float(k % 7) - 3, 0, 0));
    wanted.push_back(k % 5 != 0);
  }
  std::vector<uint8_t> blocked(origins.size());
  size_t shadowed = 0;
  for (const double theta : {0.0, 0.7, 1.4, 1.55}) {
    const glm::vec3 direction(directionFromSpherical({theta, 0.3}));
    tracer.occluded(origins, wanted, direction, blocked);
    for (size_t k = 0; k < origins.size(); ++k) {
      const bool expected = !wanted[k] || tracer.occluded(glm::dvec3(origins[k]), glm::dvec3(direction));
      EXPECT_EQ(bool(blocked[k]), expected) << theta << ' ' << k;
      shadowed += wanted[k] && blocked[k];
    }
  }
  EXPECT_GT(shadowed, 100u);
}

TEST(ShadeHit, WhiteFurnaceReturnsAllLightWithEnoughBounces) {
  const TileTracer tracer(groovedTile(0.25));
  constexpr int kPaths = 20000;
  double direct = 0, all = 0;
  for (int k = 0; k < kPaths; ++k) {
    const auto hit = tracer.intersectView({uniform(11, k), uniform(12, k)}, glm::dvec3(0, 0, 1));
    ASSERT_TRUE(hit.has_value());
    const double z = uniform(13, k), phi = 2 * kPi * uniform(14, k);  // uniform in solid angle
    const glm::dvec3 wi(std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z);
    direct += 2 * shadeHit(tracer, *hit, wi, {0, 0, 1}, 0, uint64_t(k)).x / kPaths;
    all += 2 * shadeHit(tracer, *hit, wi, {0, 0, 1}, 30, uint64_t(k)).x / kPaths;
  }
  EXPECT_LT(direct, 0.9);
  EXPECT_NEAR(all, 1, 0.02);  // standard error of 20,000 paths is .006
}

TEST(LightSum, AllLightsAtOnceAgreeWithOneByOne) {
  const DirectionSet set = bonn81Directions();
  LightTable lights(set);
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.3, -0.2, 0.9));
  const uint64_t lit[2] = {0xF0A5FF0012345678ull, 0x1F0FF};  // whole groups, empty groups, single lights
  for (const LocalBrdf& brdf : {LocalBrdf{glm::vec3(0.1f, 0.5f, 0.2f), 0.7f, 45},
                                brdfFromMetallicRoughness({0.9f, 0.6f, 0.1f}, 0.4f, 0.5f)})
    for (const glm::dvec3& wo : set.samples) {
      lights.setView(glm::vec3(wo));
      LightSum sum(lights);
      for (int twice = 0; twice < 2; ++twice) sum.add(glm::vec3(normal), glm::vec3(wo), brdf, lit);
      for (size_t l = 0; l < lights.size(); ++l) {
        const double cosine =
            lit[l / 64] >> (l % 64) & 1 ? std::max(0.0, glm::dot(normal, set.samples[l])) : 0;
        const glm::dvec3 expected = 2 * cosine * reflectance(brdf, normal, set.samples[l], wo);
        EXPECT_LT(glm::length(glm::dvec3(sum[l]) - expected),
                  1e-4 + 1e-4 * glm::length(expected));  // float against double
      }
    }
}

TEST(LocalBrdf, FastPowerIsClose) {
  for (int k = 1; k <= 2000; ++k)
    for (const float n : {1.0f, 7.3f, 60.0f, 500.0f}) {
      const float x = float(k) / 2000, expected = std::pow(x, n);
      EXPECT_NEAR(fastPower(x, n), expected, 1e-30f + expected * (n * 2e-7f + 4e-6f));
    }
}

}  // namespace
}  // namespace loden::importer
