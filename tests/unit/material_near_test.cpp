// The near term: the local reflectance against closed forms, and what the light sees against traced rays.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "material/eval/evaluate.h"
#include "material/eval/near_term.h"
#include "tests/unit/hemisphere.h"
#include "tests/unit/material_fixtures.h"

namespace loden {
namespace {

using test::hemisphereIntegral;

glm::dvec3 upperDirection(std::mt19937& random, double least_z) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double z = least_z + (1 - least_z) * unit(random), phi = 2 * kPi * unit(random);
  const double sine = std::sqrt(1 - z * z);
  return {sine * std::cos(phi), sine * std::sin(phi), z};
}

// Bumps of a height field, which cast shadows on each other.
GeometryImage bumps(int side, double depth) {
  std::vector<glm::dvec3> positions;
  for (int t = 0; t < side * side; ++t) {
    const glm::dvec2 p((t % side + 0.5) / side, (t / side + 0.5) / side);
    positions.emplace_back(p, depth * (std::cos(4 * kPi * p.x) * std::cos(4 * kPi * p.y) - 1) / 2);
  }
  return encodeGeometryImage(side, positions, std::vector<uint16_t>(positions.size(), 1), true);
}

// The bumps and what finds shadows on them.
struct ShadedBumps {
  explicit ShadedBumps(double depth, VdimAtlasSize size)
      : image(bumps(64, depth)), atlas(buildVdimAtlas(image, size)), tracer(image) {}
  ShadedBumps(const ShadedBumps&) = delete;

  double visibility(Lookup lookup, glm::dvec2 p, const glm::dvec3& wi, double footprint) const {
    const auto point = surfaceAt<double>(image, p);
    return lookedUpVisibility(atlas, lookup, LocalSurface<double>{}, point.position, p, point.normal, wi,
                              footprint);
  }
  bool occluded(glm::dvec2 p, const glm::dvec3& wi) const {
    const auto point = surfaceAt<double>(image, p);
    return tracer.occluded(point.position + 2e-3 * point.normal, wi);
  }
  double cosine(glm::dvec2 p, const glm::dvec3& wi) const {
    return glm::dot(surfaceAt<double>(image, p).normal, wi);
  }

  const GeometryImage image;
  const VdimAtlas atlas;
  const GeometryTracer tracer;
};

// With indirect light and without.
struct IndirectPair {
  explicit IndirectPair(Material material) : with(std::move(material)), without(with) {
    without.surface->indirect = {};
  }
  Material with, without;
};

glm::dvec3 valueAt(const Evaluator& evaluator, glm::dvec2 p, const glm::dvec3& wi, const glm::dvec3& wo) {
  return evaluator.evaluate(evaluator.findHit(p, 0.0, wo, Lookup::kNone), wi, wo);
}

TEST(Near, LambertIsTheCosine) {
  NearPoint<double> point;
  point.diffuse = glm::dvec3(0.25, 0.5, 0.75);
  std::mt19937 random(1);
  for (int k = 0; k < 100; ++k) {
    const glm::dvec3 wi = upperDirection(random, 0.01), wo = upperDirection(random, 0.01);
    const glm::dvec3 value = evaluateNear(Lobe::kPhong, point, wi, wo);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], point.diffuse[c] * wi.z, 1e-12);
  }
}

TEST(Near, ShortenedNormalsGiveTheMeanOfTheirCosines) {
  // Two walls of a groove, both lit: the mean of N.L is the mean normal's.
  const glm::dvec3 left = glm::normalize(glm::dvec3(0.6, 0, 0.8)), right(-left.x, 0, left.z);
  NearPoint<double> point;
  point.mapped = 0.5 * (left + right);
  point.diffuse = glm::dvec3(1);
  const glm::dvec3 wi = glm::normalize(glm::dvec3(0.3, 0.4, 0.8));
  EXPECT_NEAR(evaluateNear(Lobe::kPhong, point, wi, glm::dvec3(0, 0, 1)).x,
              0.5 * (glm::dot(left, wi) + glm::dot(right, wi)), 1e-12);
}

// White metals and dielectrics of every roughness reflect no more than all the light, and dielectrics nearly
// all: what the lobe does not reflect, the diffuse part does.
TEST(Near, GgxKeepsTheLight) {
  for (const double roughness : {0.2, 0.4, 0.6, 0.8, 1.0})
    for (const bool metal : {false, true})
      for (const double theta : {0.0, 30.0, 60.0, 75.0}) {
        NearPoint<double> point;
        point.width = roughness * roughness;
        point.f0 = glm::dvec3(metal ? 1.0 : 0.04);
        point.diffuse = glm::dvec3(metal ? 0.0 : 1.0);
        const double angle = theta * kPi / 180;
        const glm::dvec3 wo(std::sin(angle), 0, std::cos(angle));
        const double albedo = hemisphereIntegral(
            [&](const glm::dvec3& wi) { return evaluateNear(Lobe::kGgx, point, wi, wo).x; }, 400);
        SCOPED_TRACE(testing::Message()
                     << "roughness " << roughness << (metal ? ", metal, " : ", dielectric, ") << theta
                     << " degrees: " << albedo);
        EXPECT_LE(albedo, 1.03);
        EXPECT_GE(albedo, metal ? 0.3 : 0.93) << "GGX without multiple scattering loses light, but no more";
      }
}

TEST(Near, APlaneCastsNoShadow) {
  const ShadedBumps plane(0, {12, 8});
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int k = 0; k < 2000; ++k) {
    const glm::dvec2 p(unit(random), unit(random));
    const glm::dvec3 wi = upperDirection(random, 0.02);
    EXPECT_NEAR(plane.visibility(Lookup::kFast, p, wi, std::exp2(unit(random) * 9) / 512), 1, 1e-6);
  }
}

TEST(Near, ShadowsAreThoseOfTracedRays) {
  const ShadedBumps bumps(0.15, {24, 20});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  int count = 0, shadowed = 0, wrong[2] = {0, 0};
  while (count < 4000) {
    const glm::dvec2 p(unit(random), unit(random));
    const glm::dvec3 wi = upperDirection(random, 0.1);
    if (bumps.cosine(p, wi) < 0.05) continue;
    ++count;
    const bool occluded = bumps.occluded(p, wi);
    shadowed += occluded;
    const Lookup lookups[] = {Lookup::kFast, Lookup::kDefault};
    for (int l = 0; l < 2; ++l) wrong[l] += (bumps.visibility(lookups[l], p, wi, 0.0) > 0.5) == occluded;
  }
  EXPECT_GT(shadowed, 250);
  EXPECT_LT(wrong[0], count * 3 / 100);
  EXPECT_LT(wrong[1], count * 2 / 100);
}

// The share of a footprint that the light reaches, from one ray, against that of traced rays all over it.
TEST(Near, AFootprintIsLitInPart) {
  const ShadedBumps bumps(0.15, {24, 20});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const double texels : {2.0, 4.0}) {
    const double footprint = texels / 64;
    double of_one_ray = 0, of_the_footprint = 0;
    int border = 0;
    while (border < 150) {
      const glm::dvec2 p(unit(random), unit(random));
      const glm::dvec3 wi = upperDirection(random, 0.3);
      double share = 0;
      constexpr int kSide = 6;
      for (int k = 0; k < kSide * kSide; ++k) {
        const glm::dvec2 within((k % kSide + 0.5) / kSide - 0.5, (k / kSide + 0.5) / kSide - 0.5);
        share += bumps.occluded(p + within * footprint, wi) ? 0.0 : 1.0 / (kSide * kSide);
      }
      if (share < 0.05 || share > 0.95 || bumps.cosine(p, wi) < 0.1) continue;
      ++border;
      of_one_ray += std::pow(bumps.visibility(Lookup::kDefault, p, wi, 0) - share, 2);
      of_the_footprint += std::pow(bumps.visibility(Lookup::kDefault, p, wi, footprint) - share, 2);
    }
    EXPECT_LT(of_the_footprint, 0.5 * of_one_ray) << texels << " texels";
  }
}

TEST(Near, FadesIntoTheBandsWithoutAStep) {
  Material material = test::nearMaterial();
  material.surface->visibility = Visibility::kNone;
  EXPECT_EQ(nearWeight(material, 0.5f), 1.0f);
  EXPECT_EQ(nearWeight(material, 2.5f), 0.0f);
  const Evaluator evaluator(material);
  const glm::dvec3 wi = glm::normalize(glm::dvec3(0.3, 0.1, 0.9)), wo(0, 0, 1);
  const auto value = [&](double lambda) {
    return evaluator.evaluate(evaluator.findHit(glm::dvec2(0.3, 0.8), lambda, wo, Lookup::kNone), wi, wo);
  };
  for (double lambda = -1; lambda < 4; lambda += 1e-3)
    EXPECT_LT(glm::length(value(lambda + 1e-3) - value(lambda)), 4e-3) << lambda;
}

// V by map is 1 - clamp(sum of products) of the texels at their centres, and multiplies what is lit.
TEST(Near, AShadowMapMultipliesTheReflectance) {
  const Material shaded = IndirectPair(test::splitSurfaceMaterial()).without;
  Material open = shaded;
  open.surface->visibility = Visibility::kNone;
  const Evaluator evaluator(shaded), without(open);
  const SurfaceMaps& maps = *shaded.surface;
  const int side = maps.shadow.width, across = maps.shadow_table.width;
  double least = 1, most = 0;
  for (int k = 0; k < side * side; ++k) {
    const glm::ivec2 texel(k % side, k / side), direction(1 + k % (across - 2), 1 + k / 7 % (across - 2));
    const glm::dvec2 p = (glm::dvec2(texel) + 0.5) / double(side);
    const glm::dvec3 wi = directionFromSquare(glm::dvec2(direction) / double(across - 1)), wo(0, 0, 1);
    double sum = 0;
    for (int layer = 0; layer < maps.shadow.depth; ++layer)
      sum += glm::dot(glm::dvec4(fetchTexel(maps.shadow, 0, texel.x, texel.y, layer)),
                      glm::dvec4(fetchTexel(maps.shadow_table, 0, direction.x, direction.y, layer)));
    const double visible = std::clamp(1 - sum, 0.0, 1.0);
    least = std::min(least, visible), most = std::max(most, visible);
    EXPECT_NEAR(mappedVisibility(maps, p, 0.0, wi), visible, 1e-9);
    const glm::dvec3 value = valueAt(evaluator, p, wi, wo), lit = valueAt(without, p, wi, wo);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], visible * lit[c], 1e-9);
  }
  EXPECT_LT(least, most - 0.2) << "the samples say little";
}

// C stands beside V A, and is what is seen where no light comes by itself.
TEST(Near, IndirectLightIsAddedToWhatTheLightReaches) {
  const IndirectPair pair(test::splitSurfaceMaterial());
  const Evaluator lit(pair.with), direct(pair.without);
  const SurfaceMaps& maps = *pair.with.surface;
  const int side = maps.indirect.width;
  std::mt19937 random(5);
  int dark = 0, added = 0;
  for (int k = 0; k < side * side; ++k) {
    const glm::ivec2 texel(k % side, k / side);
    const glm::dvec2 p = (glm::dvec2(texel) + 0.5) / double(side);
    const glm::dvec3 wi = upperDirection(random, 0.05), wo = upperDirection(random, 0.05);
    const glm::dvec3 root(fetchTexel(maps.indirect, 0, texel.x, texel.y, 0));
    const glm::dvec4 c(fetchTexel(maps.indirect, 0, texel.x, texel.y, 1));
    const double share = std::max(0.0, wi.z * glm::dot(c, glm::dvec4(1, wi.z, wi.x, wi.y)));
    const glm::dvec3 albedo = nearAlbedo(maps.lobe, nearPoint(maps, p, 0.0));
    const glm::dvec3 before = valueAt(direct, p, wi, wo), after = valueAt(lit, p, wi, wo);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(after[i], before[i] + albedo[i] * root[i] * root[i] * share, 1e-9);
    dark += before == glm::dvec3(0) && share > 0;
    added += share > 0;
  }
  EXPECT_GT(dark, 3);
  EXPECT_GT(added, side * side / 4);
}

// What the environment makes of C is the integral of what lights make of it.
TEST(Near, IndirectLightOfASkyIsThatOfItsLights) {
  Material with = test::splitSurfaceMaterial();
  for (int mip = 0; mip < with.surface->indirect.mips; ++mip) {
    const int side = with.surface->indirect.mipWidth(mip);
    for (int t = 0; t < side * side; ++t)
      storeTexel(with.surface->indirect, mip, t % side, t / side, 1, {0.6f, 0.3f, -0.4f, 0.4f});  // above 0
  }
  const IndirectPair pair(std::move(with));
  Evaluator lit(pair.with), direct(pair.without);
  lit.prepareEnvironment(), direct.prepareEnvironment();
  HemisphereLight light;
  light.c = {glm::vec3(0.9f, 1, 1.1f), glm::vec3(0.3f), glm::vec3(0.2f),
             glm::vec3(-0.1f),         glm::vec3(0.1f), glm::vec3(-0.2f)};
  const glm::dvec3 wo = glm::normalize(glm::dvec3(0.3, 0.2, 1));
  const auto hit = lit.findHit(glm::dvec2(0.4, 0.7), 0.0, wo, Lookup::kNone);
  const NearPoint<double> point = nearPoint(*pair.with.surface, hit.p, hit.lambda);
  const glm::dvec3 sum = hemisphereIntegral(
      [&](const glm::dvec3& w) {
        const double basis[] = {1, w.z, w.x, w.y, w.x * w.y, w.x * w.x - w.y * w.y};
        glm::dvec3 radiance(0);
        for (size_t k = 0; k < kEnvironmentBasis; ++k) radiance += basis[k] * glm::dvec3(light.c[k]);
        return radiance * indirectLight(*pair.with.surface, point, hit.p, hit.lambda, w);
      },
      64);
  const glm::dvec3 added =
      lit.evaluateEnvironment(hit, light, wo) - direct.evaluateEnvironment(hit, light, wo);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(added[c], sum[c], 1e-3 * sum[c]);
  EXPECT_GT(sum.x, 0.01);
}

TEST(Near, IsTheWholeOfAMaterialWithoutBands) {
  const Material surface = test::surfaceMaterial(), lod = test::lodMaterial();
  EXPECT_EQ(nearWeight(surface, 9.0f), 1.0f);
  EXPECT_EQ(nearWeight(lod, 0.0f), 0.0f);
  EXPECT_EQ(finestLevel(surface), 0.0f);
  EXPECT_EQ(finestLevel(test::nearMaterial()), -1.0f);
}

TEST(Near, PhongLobesReturnWhatTheirIntegralSays) {
  for (const double exponent : {1.0, 4.0, 15.0, 60.0, 250.0})
    for (const double cosine : {1.0, 0.8, 0.6, 0.4, 0.2, 0.05}) {
      NearPoint<double> point;
      point.strength = 1;
      point.width = exponent;
      const glm::dvec3 wo(std::sqrt(1 - cosine * cosine), 0, cosine);
      const double albedo = hemisphereIntegral(
          [&](const glm::dvec3& wi) { return evaluateNear(Lobe::kPhong, point, wi, wo).x; });
      EXPECT_NEAR(phongAlbedo(exponent, cosine), albedo, 0.075) << exponent << ", " << cosine;
    }
}

// The ambient part of light that is the same all around, on a plane that nothing hides, is the albedo.
TEST(Near, WhiteSkyGivesTheAlbedo) {
  Material material = test::surfaceMaterial();
  SurfaceMaps& maps = *material.surface;
  for (Texture* map : {&maps.normal, &maps.color, &maps.ambient})
    *map = Texture::make(map->format, map->shape, 1, 1, map->depth);
  storeTexel(maps.normal, 0, 0, 0, 0, {0, 0, 1, 0});
  storeTexel(maps.color, 0, 0, 0, 0, {1, 1, 1, 0});
  storeTexel(maps.ambient, 0, 0, 0, 0, {1, 2.0f / 3, 0, 0});
  Evaluator evaluator(material);
  evaluator.prepareEnvironment();
  HemisphereLight light;
  light.c[0] = glm::vec3(0.7f);
  const glm::vec3 wo = glm::normalize(glm::vec3(0.2f, 0.1f, 1.0f));
  const auto hit = evaluator.findHit(glm::vec2(0.5f), 0.0f, wo, Lookup::kNone);
  const glm::vec3 value = evaluator.evaluateEnvironment(hit, light, wo);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], 0.7f, 1e-5f);
}

}  // namespace
}  // namespace loden
