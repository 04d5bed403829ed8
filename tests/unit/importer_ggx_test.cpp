// The GGX lobe: furnace, reciprocity, energy, and through a whole bake.
#include <gtest/gtest.h>

#include "importer/bake/bake.h"
#include "importer/base/random.h"
#include "importer/tile/local_brdf.h"
#include "importer/tile/mesh_material.h"
#include "importer_meshes.h"

namespace loden::importer {
namespace {

using testing::TemporaryFolder;

const glm::dvec3 kUp(0, 0, 1);
const glm::vec3 kWhite(1);

glm::dvec3 viewAt(double cosine) {
  return {std::sqrt(1 - cosine * cosine), 0, cosine};
}

// Integral over the upper hemisphere of body(wi), midpoints of n x 2n cells, finer towards the horizon and
// around the mirror direction of a view in the xz plane.
double integral(const std::function<double(const glm::dvec3&)>& body, int n = 350) {
  double sum = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double theta = kPi / 2 * (j + 0.5) / n, s = (i + 0.5) / n;
      const double phi = kPi + kPi * s * s * s,
                   density = 3 * kPi * s * s;  // half of the hemisphere, by symmetry
      sum += 2 * body({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)}) *
             std::sin(theta) * density * (kPi / 2) / (double(n) * n);
    }
  return sum;
}

double albedo(const LocalBrdf& brdf, const glm::dvec3& wo) {
  return integral([&](const glm::dvec3& wi) { return reflectance(brdf, kUp, wi, wo).x * wi.z / kPi; });
}

// Heitz 2014, 5.3: without shadowing the lobe reflects exactly what the microfacets show.
TEST(Ggx, PassesTheWeakWhiteFurnace) {
  for (const double alpha : {0.1, 0.3, 0.7, 1.0})
    for (const double cosine : {0.95, 0.6, 0.3}) {
      const glm::dvec3 wo = viewAt(cosine);
      const double lambda = (std::sqrt(1 + alpha * alpha * (1 / (cosine * cosine) - 1)) - 1) / 2;
      // Over all half vectors that the view can see: also those whose mirror direction lies below the
      // horizon.
      const double share = integral([&](const glm::dvec3& h) {
        const double d = alpha * alpha / (kPi * std::pow(h.z * h.z * (alpha * alpha - 1) + 1, 2));
        return d * std::max(0.0, glm::dot(wo, h)) / (1 + lambda) / wo.z;
      });
      EXPECT_NEAR(share, 1, 2e-3) << alpha << ' ' << cosine;
      // And ggxLobe is that D over the correlated Smith denominator.
      const glm::dvec3 wi = viewAt(0.8), half = glm::normalize(wi + wo);
      const double lambda_i = (std::sqrt(1 + alpha * alpha * (1 / (0.8 * 0.8) - 1)) - 1) / 2;
      const double d = alpha * alpha / std::pow(half.z * half.z * (alpha * alpha - 1) + 1, 2);
      EXPECT_NEAR(ggxLobe(alpha, wi.z, wo.z, half.z), d / (1 + lambda + lambda_i) / (4 * wi.z * wo.z),
                  1e-9 * d);
    }
}

TEST(Ggx, WhiteDielectricReflectsAllLightAtEveryAngle) {
  for (const float roughness : {0.35f, 0.6f, 1.0f})
    for (const double cosine : {0.98, 0.7, 0.4, 0.15})
      EXPECT_NEAR(albedo(brdfFromMetallicRoughness(kWhite, 0, roughness), viewAt(cosine)), 1, 0.015)
          << roughness << ' ' << cosine;
}

TEST(Ggx, NeverReflectsMoreThanAll) {
  for (const float metallic : {0.0f, 0.5f, 1.0f})
    for (const float roughness : {0.3f, 0.5f, 0.8f, 1.0f})
      for (const double cosine : {0.9, 0.5, 0.2, 0.1}) {
        const double a = albedo(brdfFromMetallicRoughness(kWhite, metallic, roughness), viewAt(cosine));
        EXPECT_LT(a, 1.015) << metallic << ' ' << roughness << ' ' << cosine;  // the sum's own error
      }
}

// At alpha 1 the distribution is uniform and the integral of c / (mu + c) is left.
TEST(Ggx, RoughestMirrorHasTheKnownAlbedo) {
  for (const double mu : {0.9, 0.5, 0.2})
    EXPECT_NEAR(albedo(brdfFromMetallicRoughness(kWhite, 1, 1), viewAt(mu)), 1 - mu * std::log((1 + mu) / mu),
                1e-3);
}

TEST(Ggx, IsReciprocal) {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.2, 0.1, 1));
  for (int k = 0; k < 500; ++k) {
    const LocalBrdf brdf = brdfFromMetallicRoughness({float(uniform(1, k)), float(uniform(2, k)), 0.5f},
                                                     float(uniform(3, k)), float(uniform(4, k)));
    const glm::dvec3 a = cosineDirection(normal, uniform(5, k), uniform(6, k)),
                     b = cosineDirection(normal, uniform(7, k), uniform(8, k));
    const glm::dvec3 ab = reflectance(brdf, normal, a, b), ba = reflectance(brdf, normal, b, a);
    EXPECT_LT(glm::length(ab - ba), 1e-9 * (1 + glm::length(ab)));
    EXPECT_TRUE(std::isfinite(ab.x) && ab.x >= 0);
  }
}

TEST(Ggx, MirrorPeakIsWhereItBelongs) {
  const LocalBrdf metal = brdfFromMetallicRoughness({1, 0.8f, 0.3f}, 1, 0.3f);
  const glm::dvec3 wo = viewAt(0.8), mirror(-wo.x, 0, wo.z);
  const glm::dvec3 peak = reflectance(metal, kUp, mirror, wo),
                   beside = reflectance(metal, kUp, viewAt(0.3), wo);
  EXPECT_GT(peak.x, 20 * beside.x);
  EXPECT_NEAR(peak.y / peak.x, 0.8, 0.01);  // a metal's highlight has its colour
  EXPECT_EQ(metal.diffuse, glm::vec3(0));
}

TEST(Ggx, BakesWhatItTraces) {
  const LocalBrdf brdf = brdfFromMetallicRoughness({0.8f, 0.5f, 0.2f}, 0.5f, 0.6f);
  const TemporaryFolder folder;
  BakeOptions options;
  options.size = 4;
  options.geometry_size = 4;
  options.directions = concentricDirections(4);
  options.maps.vdim = options.maps.surface = false;
  options.quiet = true;
  ASSERT_TRUE(bake(testing::flatTile(brdf), "test", folder.path(), options).ok());
  const auto output = *BakedOutput::open(folder.path());
  const auto& directions = output.manifest().directions.samples;
  for (int view = 0; view < int(directions.size()); ++view) {
    const auto btf = *output.btfView(view), flat = *output.flatView(view);
    for (size_t k = 0; k < btf.size(); ++k) {
      const glm::dvec3 wi = directions[k / 16],
                       expected = reflectance(brdf, kUp, wi, directions[size_t(view)]) * wi.z;
      for (const auto* image : {&btf, &flat})
        EXPECT_LT(glm::length(glm::dvec3((*image)[k]) - expected),
                  1e-3 * (1 + glm::length(expected)));  // half floats
    }
  }
}

}  // namespace
}  // namespace loden::importer
