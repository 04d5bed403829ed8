// What no renderer may get wrong: energy, reciprocity, Lambert, GGX, light from all around.

#include <gtest/gtest.h>

#include <atomic>

#include "importer/bake/bake.h"
#include "importer/base/parallel.h"
#include "importer/base/random.h"
#include "importer/cook/cook.h"
#include "importer/tile/local_brdf.h"
#include "importer/tile/mesh_material.h"
#include "importer/tile/tile_tracer.h"
#include "material/eval/evaluate.h"
#include "material/eval/near_term.h"
#include "tests/stress/stress.h"
#include "tests/stress/stress_materials.h"
#include "tests/unit/importer_meshes.h"

namespace loden::stress {
namespace {

using namespace importer;

// Mean and standard error of body(k) for k in [0, count).
struct Estimate {
  double mean = 0, error = 0;
};
Estimate estimate(int64_t count, const std::function<double(uint64_t)>& body) {
  constexpr int64_t kBatch = 1000;
  const int64_t batches = std::max<int64_t>(count / kBatch, 2);
  std::vector<double> means(size_t(batches), 0.0);
  parallelFor(size_t(batches), 0, [&](size_t batch) {
    const FlushDenormals flush;
    for (int64_t k = 0; k < kBatch; ++k) means[batch] += body(batch * kBatch + uint64_t(k)) / kBatch;
  });
  Estimate e;
  double squares = 0;
  for (const double m : means) e.mean += m / double(batches);
  for (const double m : means) squares += (m - e.mean) * (m - e.mean);
  e.error = std::sqrt(squares / double(batches - 1) / double(batches));
  return e;
}

glm::dvec3 uniformLight(uint64_t seed, double least = 0) {
  const double z = least + (1 - least) * uniform(seed, 1), phi = 2 * kPi * uniform(seed, 2),
               sine = std::sqrt(1 - z * z);
  return {sine * std::cos(phi), sine * std::sin(phi), z};
}

glm::dvec3 viewAt(double degrees, double phi = 0.4) {
  return directionFromSpherical({degrees * kPi / 180, phi});
}

// Green of what leaves the tile towards wo at a random x, under light from wi.
double valueAt(const TileTracer& tracer, const glm::dvec3& wi, const glm::dvec3& wo, int bounces,
               uint64_t seed) {
  const auto hit = tracer.intersectView({uniform(seed, 3), uniform(seed, 4)}, wo);
  return hit ? shadeHit(tracer, *hit, wi, wo, bounces, mixSeed(seed, 5)).y : 0;
}

// Radiance towards wo under a sky of radiance 1: lights are uniform over the hemisphere.
Estimate underWhiteSky(const TileTracer& tracer, const glm::dvec3& wo, int bounces, int64_t samples) {
  return estimate(samples, [&](uint64_t k) {
    const uint64_t seed = mixSeed(77, k);
    return 2 * valueAt(tracer, uniformLight(seed), wo, bounces, seed);
  });
}

Tile bumps(double depth, const LocalBrdf& brdf) {
  return importer::testing::heightFieldTile(
      64, [depth](glm::dvec2 p) { return bumpHeight(p, depth); }, brdf);
}

LocalBrdf lambert(float albedo) {
  return {glm::vec3(albedo), 0, 1};
}

TEST(StressPhysics, WhiteTilesVanishInAWhiteSky) {
  const int64_t samples = amount(200'000, 1'000'000);
  const auto furnace = [&](const std::string& what, const Tile& tile) {
    const TileTracer tracer(tile);
    double worst = 0, noise = 0;
    for (const double theta : {0.0, 40.0, 70.0}) {
      const Estimate e = underWhiteSky(tracer, viewAt(theta), 100, samples);
      worst = std::max(worst, std::abs(e.mean - 1)), noise = std::max(noise, e.error);
    }
    record("white sky, 100 bounces, " + what + ": largest deviation from 1, noise " + shortNumber(noise),
           worst, "<= .01 + 3 noise");
    EXPECT_LE(worst, 0.01 + 3 * noise) << what;
  };
  furnace("white Lambert plane", importer::testing::flatTile());
  furnace("white Lambert bumps, .1 deep", bumps(0.1, lambert(1)));
  furnace("white Lambert bumps, .3 deep", bumps(0.3, lambert(1)));
  furnace("white dielectric bumps, roughness .6",
          bumps(0.1, brdfFromMetallicRoughness(glm::vec3(1), 0, 0.6f)));
  // Half as fine a mesh loses 1 % where shading normals and facets disagree.
  Tile isba = *builtinTile("isba", 192);
  for (LocalBrdf& brdf : isba.brdfs) brdf = lambert(1);
  furnace("isba, an overhanging tile, in white Lambert", isba);
}

TEST(StressPhysics, NoTileReflectsMoreThanAllLight) {
  double most = -1;
  std::string which;
  for (const std::string& name : builtinTileNames()) {
    const auto tile = builtinTile(name, 64);
    ASSERT_TRUE(tile.ok());
    const TileTracer tracer(*tile);
    for (const double theta : {0.0, 60.0, 80.0}) {
      const Estimate e = underWhiteSky(tracer, viewAt(theta), 30, amount(6'000, 50'000));
      if (e.mean - 3 * e.error > most) most = e.mean - 3 * e.error, which = name;
    }
  }
  record("builtin tiles under a white sky, 30 bounces: the most light, less 3 noise (" + which + ")", most,
         "<= 1");
  EXPECT_LE(most, 1);
}

// Averaged over the tile, light and sight may be exchanged, with any number of bounces.
TEST(StressPhysics, TilesAreReciprocalWithinNoise) {
  const glm::dvec3 directions[] = {viewAt(10, 1), viewAt(35, 4), viewAt(60, 2), viewAt(75, 5.5)};
  double worst = 0, largest = 0;
  int pairs = 0;
  for (const auto& tile :
       {bumps(0.2, lambert(0.8f)), bumps(0.1, brdfFromMetallicRoughness(glm::vec3(0.8f), 0.3f, 0.5f))}) {
    const TileTracer tracer(tile);
    for (const int bounces : {0, 6})
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < a; ++b) {
          const auto towards = [&](const glm::dvec3& wi, const glm::dvec3& wo, uint64_t salt) {
            return estimate(amount(40'000, 200'000), [&, salt](uint64_t k) {
              return valueAt(tracer, wi, wo, bounces, mixSeed(salt, k)) / wi.z;
            });
          };
          const Estimate ab = towards(directions[a], directions[b], uint64_t(pairs)),
                         ba = towards(directions[b], directions[a], uint64_t(1000 + pairs));
          const double noise = std::hypot(ab.error, ba.error);
          // Shading normals are interpolated, with which Lambert's law is not quite reciprocal: .5 %.
          const double difference = std::max(std::abs(ab.mean - ba.mean) - 0.005 * ab.mean, 0.0);
          worst = std::max(worst, difference / noise);
          largest = std::max(largest, std::abs(ab.mean - ba.mean) / ab.mean);
          ++pairs;
        }
  }
  const std::string what =
      "reciprocity of tile averages, " + std::to_string(pairs) + " pairs, 0 and 6 bounces: ";
  record(what + "largest difference beyond .5 %, in standard errors", worst, "<= 4");
  record(what + "largest relative difference, noise included", largest, "<= .03");
  EXPECT_LE(worst, 4);
  EXPECT_LE(largest, 0.03);
}

TEST(StressPhysics, LambertIsTheCosine) {
  // Traced.
  double traced = 0;
  const TileTracer tracer(importer::testing::flatTile(lambert(0.7f)));
  for (uint64_t k = 0; k < 20000; ++k) {
    const glm::dvec3 wi = uniformLight(mixSeed(1, k)), wo = uniformLight(mixSeed(2, k), 1e-3);
    const auto hit = tracer.intersectView({uniform(3, k), uniform(4, k)}, wo);
    ASSERT_TRUE(hit);
    traced = std::max(traced, std::abs(shadeHit(tracer, *hit, wi, wo, 0, 0).y - double(0.7f) * wi.z));
  }
  record("Lambert, traced: largest difference to albedo times cosine", traced, "<= 1e-6");
  EXPECT_LE(traced, 1e-6);
  // Stored, looked up and evaluated, in floats, on planes at and below the reference surface.
  double evaluated = 0;
  for (const double depth : {0.0, 0.2}) {
    const Material material = planeMaterial(depth);
    const Evaluator evaluator(material);
    for (const Lookup lookup : {Lookup::kNone, Lookup::kFast, Lookup::kDefault})
      for (uint64_t k = 0; k < 20000; ++k) {
        const glm::vec3 wi(uniformLight(mixSeed(5, k))), wo(uniformLight(mixSeed(6, k)));
        const auto hit = evaluator.findHit(glm::vec2(uniform(7, k), uniform(8, k)), 0.0f, wo, lookup);
        evaluated = std::max(evaluated, largestOf(evaluator.evaluate(hit, wi, wo) - wi.z));
      }
  }
  record("Lambert, stored and evaluated in floats: largest difference to the cosine", evaluated, "<= 1e-6");
  EXPECT_LE(evaluated, 1e-6);
}

// --- a whole road: baked and cooked ---

BakedOutput bake(const Tile& tile, const importer::testing::TemporaryFolder& folder) {
  BakeOptions options;
  options.size = 32;
  options.geometry_size = 64;
  options.directions = bonn81Directions();
  options.supersample = 1;
  options.quiet = true;
  const auto report = importer::bake(tile, "test", folder.path(), options);
  EXPECT_TRUE(report.ok()) << (report.ok() ? "" : report.issue().text);
  auto baked = BakedOutput::open(folder.path());
  EXPECT_TRUE(baked.ok()) << (baked.ok() ? "" : baked.issue().text);
  return std::move(*baked);
}

Material cook(const BakedOutput& baked, Mode mode) {
  CookOptions options;
  options.mode = mode;
  options.quiet = true;
  auto material = importer::cook(baked, options);
  EXPECT_TRUE(material.ok()) << (material.ok() ? "" : material.issue().text);
  return std::move(*material);
}

TEST(StressPhysics, LambertSurvivesBakeAndCook) {
  const importer::testing::TemporaryFolder folder;
  const BakedOutput baked = bake(importer::testing::flatTile(), folder);
  for (const Mode mode : {Mode::kSurface, Mode::kFused}) {
    const Material material = cook(baked, mode);
    const Evaluator evaluator(material);
    double worst = 0, coarse = 0;
    for (uint64_t k = 0; k < 5000; ++k) {
      const glm::vec3 wi(uniformLight(mixSeed(5, k))), wo(uniformLight(mixSeed(6, k)));
      const glm::vec2 x(uniform(7, k), uniform(8, k));
      const auto at = [&](float lambda) {
        return largestOf(evaluator.evaluate(evaluator.findHit(x, lambda, wo), wi, wo) - wi.z);
      };
      worst = std::max(worst, at(finestLevel(material)));
      coarse = std::max(coarse, at(4));
    }
    const std::string name = modeName(mode), what = "white Lambert plane baked and cooked as " + name;
    record(what + ", near: largest difference to the cosine", worst, "<= 1e-6");
    EXPECT_LE(worst, 1e-6) << name;
    // Far away the mean and tables of 8 bits over 25 x 6 directions stand for it.
    record(what + ", at lambda 4: largest difference to the cosine", coarse,
           mode == Mode::kSurface ? "<= 1e-6" : "<= .01");
    EXPECT_LE(coarse, mode == Mode::kSurface ? 1e-6 : 0.01) << name;
  }
}

TEST(StressPhysics, LightFromAllAroundIsThatOfManyLights) {
  const importer::testing::TemporaryFolder folder;
  const BakedOutput baked = bake(bumps(0.12, lambert(0.8f)), folder);
  EnvironmentLight white, tilted;
  white.constant = glm::vec3(1);
  tilted.constant = {1, 0.8f, 0.6f};
  tilted.linear = {glm::vec3(0.4f, -0.2f, 0.3f), glm::vec3(0.1f, 0.3f, 0.2f), glm::vec3(-0.3f, 0.1f, 0.2f)};
  for (const Mode mode : {Mode::kSurface, Mode::kFused, Mode::kLod}) {
    Material material = cook(baked, mode);
    if (material.surface && material.surface->visibility == Visibility::kNone)
      material.surface->visibility = Visibility::kDefault;
    Evaluator evaluator(material);
    evaluator.prepareEnvironment();
    for (const auto& [sky_name, sky] : {std::pair{"white sky", &white}, {"sky with a gradient", &tilted}})
      for (const float lambda : {0.0f, 4.0f}) {
        if (mode == Mode::kSurface && lambda > 0) continue;
        const HemisphereLight light = hemisphereLight(*sky, glm::mat3(1));
        constexpr int kRows = 24;
        double off = 0, sum = 0, worst = 0;
        const int points = static_cast<int>(amount(40, 400));
        for (int k = 0; k < points; ++k) {
          const glm::vec3 wo(uniformLight(mixSeed(11, uint64_t(k)), 0.3));
          const auto hit =
              evaluator.findHit(glm::vec2(uniform(12, uint64_t(k)), uniform(13, uint64_t(k))), lambda, wo);
          glm::dvec3 many(0);
          for (int j = 0; j < kRows; ++j)
            for (int i = 0; i < 2 * kRows; ++i) {
              const glm::vec3 wi(
                  directionFromSpherical({std::acos((j + 0.5) / kRows), kPi * (i + 0.5) / kRows}));
              many += glm::dvec3(evaluator.evaluate(hit, wi, wo) * radianceFrom(*sky, wi)) /
                      double(kRows * kRows);
            }
          const glm::dvec3 at_once(evaluator.evaluateEnvironment(hit, light, wo));
          off += std::abs(at_once.y - many.y), sum += many.y;
          worst = std::max(worst, std::abs(at_once.y - many.y));
        }
        const std::string what = "light from all around at once against 1,152 lights, " +
                                 std::string(modeName(mode)) + ", lambda " + shortNumber(lambda) + ", " +
                                 sky_name;
        record(what + ": mean difference, of the mean value", off / sum, "<= .02");
        record(what + ": largest difference, of the mean value", worst / (sum / points), "<= .1");
        EXPECT_LE(off / sum, 0.02) << what;
        EXPECT_LE(worst / (sum / points), 0.1) << what;
      }
  }
}

// --- GGX ---

// pi f_r cos of a GGX lobe alone: Walter et al. 2007 (distribution), Heitz 2014 (height-correlated masking
// and shadowing by Lambda), Schlick 1994, in long double and with 1 - (N.H)^2 from the cross product.
double ggxByDefinition(double alpha, double f0, const glm::dvec3& wi, const glm::dvec3& wo) {
  const glm::dvec3 sum = wi + wo, half = sum / glm::length(sum);
  const long double a2 = (long double)alpha * alpha,
                    sine2 = (long double)half.x * half.x + (long double)half.y * half.y;
  const long double d = a2 * half.z * half.z + sine2;  // over cos^4 of tan^2: (cos^2 (a^2 + tan^2))
  const long double distribution = a2 / ((long double)kPi * d * d);
  const auto lambda = [a2](long double z) { return (std::sqrt(1 + a2 * (1 / (z * z) - 1)) - 1) / 2; };
  const long double masking = 1 / (1 + lambda(wi.z) + lambda(wo.z));
  const long double fresnel = f0 + (1 - f0) * std::pow(1 - (long double)glm::dot(wi, half), 5);
  return double(kPi * fresnel * distribution * masking / (4 * wo.z));
}

TEST(StressPhysics, GgxIsItsClosedForm) {
  double in_double = 0, in_float[2] = {0, 0}, traced = 0;
  Histogram ulps;
  const int64_t count = amount(100'000, 2'000'000);
  for (int64_t k = 0; k < count; ++k) {
    const uint64_t seed = mixSeed(21, uint64_t(k));
    const float alpha = float(std::exp(std::log(0.002) * uniform(seed, 1)));  // .002 to 1
    const glm::dvec3 wo = uniformLight(mixSeed(seed, 2), 0.0201);
    // Half of the lights near the mirror direction, where the lobe is.
    glm::dvec3 wi = uniformLight(mixSeed(seed, 3), 1e-4);
    if (k % 2 == 0) {
      const double tangent = double(alpha) * std::sqrt(uniform(seed, 4) / (1 - uniform(seed, 4))),
                   phi = 6.3 * uniform(seed, 5);
      const glm::dvec3 half = glm::normalize(glm::dvec3(tangent * std::cos(phi), tangent * std::sin(phi), 1));
      wi = 2 * glm::dot(wo, half) * half - wo;
      if (wi.z < 1e-4) continue;
    }
    const float f0 = float(uniform(seed, 6));
    NearPoint<double> d;
    d.width = double(alpha), d.f0 = glm::dvec3(f0);
    const double expected = ggxByDefinition(double(alpha), double(f0), wi, wo);
    in_double = std::max(in_double, std::abs(evaluateNear(Lobe::kGgx, d, wi, wo).y / expected - 1));
    NearPoint<float> f;
    f.width = alpha, f.f0 = glm::vec3(f0);
    // Of the same floats, made unit again in double.
    const glm::vec3 fi(wi), fo(wo);
    const double of_floats = ggxByDefinition(double(alpha), double(f0), glm::normalize(glm::dvec3(fi)),
                                             glm::normalize(glm::dvec3(fo)));
    const double error = std::abs(double(evaluateNear(Lobe::kGgx, f, fi, fo).y) / of_floats - 1);
    double& worst = in_float[alpha >= 0.03f ? 0 : 1];
    worst = std::max(worst, error);
    ulps.add(error / 1.19e-7);
    if (alpha >= 0.03f) {
      LocalBrdf brdf{glm::vec3(0), 0, 1};
      brdf.alpha = alpha, brdf.f0 = glm::vec3(f0);
      const double value = reflectance(brdf, {0, 0, 1}, wi, wo).y * wi.z;
      traced = std::max(traced, std::abs(value / expected - 1));
    }
  }
  record("GGX of the near term, double: largest relative error", in_double, "<= 1e-9");
  record("GGX of traced tiles, double, alpha from .03 on: largest relative error", traced, "<= 1e-9");
  record("GGX of the near term, float, alpha from .03 on: largest relative error", in_float[0], "<= .002");
  record("GGX of the near term, float, alpha .002 to .03: largest relative error", in_float[1], "<= .1");
  recordText("GGX of the near term, float, all: relative errors in 2^-23", ulps.text(), "");
  EXPECT_LE(in_double, 1e-9);
  EXPECT_LE(traced, 1e-9);
  EXPECT_LE(in_float[0], 0.002);
  EXPECT_LE(in_float[1], 0.1);
}

// Albedo of the near term's reflectance: lights by half vectors of the lobe and by the cosine, one of both
// each time, weighted by the mean of their densities (Veach and Guibas 1995).
TEST(StressPhysics, TheNearTermReflectsNoMoreThanAllLight) {
  double most_metal = 0, most_dielectric = 0, least_dielectric = 1;
  for (const double alpha : {0.002, 0.01, 0.03, 0.1, 0.25, 0.5, 1.0})
    for (const double theta : {0.0, 30.0, 60.0, 75.0, 85.0})
      for (const bool metal : {false, true}) {
        NearPoint<double> point;
        point.width = alpha;
        point.f0 = glm::dvec3(metal ? 1.0 : 0.04), point.diffuse = glm::dvec3(metal ? 0.0 : 1.0);
        const glm::dvec3 wo = viewAt(theta);
        const Estimate e = estimate(amount(20'000, 100'000), [&](uint64_t k) {
          const uint64_t seed = mixSeed(41, k);
          const double u = uniform(seed, 1), phi = 2 * kPi * uniform(seed, 2);
          glm::dvec3 wi;
          if (k % 2 == 0) {
            wi = {std::sqrt(u) * std::cos(phi), std::sqrt(u) * std::sin(phi), std::sqrt(1 - u)};
          } else {
            const double tangent = alpha * std::sqrt(u / (1 - u));
            const glm::dvec3 half =
                glm::normalize(glm::dvec3(tangent * std::cos(phi), tangent * std::sin(phi), 1));
            wi = 2 * glm::dot(wo, half) * half - wo;
          }
          if (wi.z <= 0) return 0.0;
          const glm::dvec3 half = glm::normalize(wi + wo);
          const double a2 = alpha * alpha, d = a2 * half.z * half.z + half.x * half.x + half.y * half.y;
          const double density =
              0.5 * wi.z / kPi + 0.5 * a2 / (kPi * d * d) * half.z / (4 * glm::dot(wo, half));
          return evaluateNear(Lobe::kGgx, point, wi, wo).y / kPi / density;
        });
        if (metal)
          most_metal = std::max(most_metal, e.mean - 3 * e.error);
        else
          most_dielectric = std::max(most_dielectric, e.mean - 3 * e.error),
          least_dielectric = std::min(least_dielectric, e.mean + 3 * e.error);
      }
  // A dielectric's diffuse part goes by Lazarov's fit of the lobe's albedo, which is up to .06 too low from
  // 75 degrees on: the excess is known and bounded here, 1 would be right.
  record("near term, white metals, all roughnesses and views to 85 degrees: the most light", most_metal,
         "<= 1");
  record("near term, white dielectrics: the most light", most_dielectric, "<= 1.07 (1 would be right)");
  record("near term, white dielectrics: the least light", least_dielectric, ">= .9");
  EXPECT_LE(most_metal, 1.0);
  EXPECT_LE(most_dielectric, 1.07);
  EXPECT_GE(least_dielectric, 0.9);
}

}  // namespace
}  // namespace loden::stress
