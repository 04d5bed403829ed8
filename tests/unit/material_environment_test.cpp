// Light from all around against integrals done the slow way.

#include <gtest/gtest.h>

#include <cmath>

#include "material/eval/evaluate.h"
#include "material/model/environment.h"
#include "tests/unit/hemisphere.h"
#include "tests/unit/material_fixtures.h"
#include "tests/unit/panoramas.h"

namespace loden {
namespace {

using test::hemisphereIntegral;
using test::panoramaOf;

EnvironmentLight somePolynomial() {
  EnvironmentLight light;
  light.constant = {1, 0.8f, 0.6f};
  light.linear = {glm::vec3(0.3f, -0.2f, 0.4f), glm::vec3(0.1f, 0.2f, 0.5f), glm::vec3(-0.4f, 0.1f, 0.2f)};
  for (int c = 0; c < 3; ++c) {
    glm::mat3& m = light.quadratic[c];
    m[0][0] = 0.2f, m[1][1] = -0.3f + 0.1f * c, m[2][2] = 0.1f;
    m[0][1] = m[1][0] = 0.15f, m[0][2] = m[2][0] = -0.2f, m[1][2] = m[2][1] = 0.1f * c;
  }
  return light;
}

glm::vec3 reducedRadiance(const HemisphereLight& light, const glm::vec3& w) {
  const float h[] = {1, w.z, w.x, w.y, w.x * w.y, w.x * w.x - w.y * w.y};
  glm::vec3 sum(0);
  for (int k = 0; k < kEnvironmentBasis; ++k) sum += light.c[k] * h[k];
  return sum;
}

TEST(Panorama, DirectionsAndPixelsAreInverse) {
  const Panorama panorama = panoramaOf(16, [](const glm::dvec3& w) { return glm::vec3(w); });
  for (int row = 0; row < 16; ++row)
    for (int column = 0; column < 32; ++column) {
      const glm::dvec3 w = panoramaDirection(panorama, column + 0.5, row + 0.5);
      EXPECT_EQ(panoramaPixel(panorama, w), glm::vec3(w));
    }
  EXPECT_NEAR(panoramaDirection(panorama, 16, 8).x, 1, 1e-12) << "the middle is +x";
  EXPECT_NEAR(panoramaDirection(panorama, 8, 8).y, 1, 1e-12) << "left of it is +y";
}

TEST(Environment, ProjectionKeepsAQuadraticPolynomial) {
  const EnvironmentLight truth = somePolynomial();
  // Shifted up, so that no pixel is negative; wide and low, so that no sun is taken out.
  const auto at = [&](const glm::dvec3& w) { return radianceFrom(truth, glm::vec3(w)) + 0.5f; };
  const Environment found = projectPanorama(panoramaOf(128, at), 2);
  EXPECT_TRUE(found.suns.empty());
  for (int k = 0; k < 50; ++k) {
    const glm::dvec3 w = directionFromSpherical({0.06 * k, 2.4 * k});
    // Midpoint rule on 128 rows: (pi / 128)^2 / 24 of the second derivative.
    EXPECT_LT(glm::length(radianceFrom(found.light, glm::vec3(w)) - at(w)), 1e-3f);
  }
}

TEST(Environment, TakesOutASun) {
  const glm::dvec3 sun = directionFromSpherical({0.7, 2.0});
  const auto at = [&](const glm::dvec3& w) {
    return glm::vec3(glm::dot(w, sun) > std::cos(0.1) ? 50.0f : 0.2f);
  };
  const Environment found = projectPanorama(panoramaOf(512, at), 3);
  ASSERT_EQ(found.suns.size(), 1u);
  EXPECT_GT(glm::dot(glm::dvec3(found.suns[0].direction), sun), std::cos(0.01));
  // Solid angle of the disk times what stands above twice the median.
  const double solid_angle = 2 * kPi * (1 - std::cos(0.1));
  EXPECT_NEAR(found.suns[0].irradiance.x, (50 - 0.4) * solid_angle / kPi, 0.02 * 50 * solid_angle / kPi);
}

TEST(Environment, CountsBrokenPixelsAsBlack) {
  Panorama panorama = panoramaOf(32, [](const glm::dvec3&) { return glm::vec3(1); });
  panorama.pixels[5] = glm::vec3(NAN);
  panorama.pixels[700].x = -INFINITY;
  const Environment found = projectPanorama(panorama, 1);
  EXPECT_NEAR(found.light.constant.y, 1, 1e-2);
}

TEST(Environment, ReductionToTheHemisphereKeepsIrradiance) {
  const EnvironmentLight light = somePolynomial();
  const glm::vec3 n = glm::normalize(glm::vec3(0.3f, -0.5f, 0.7f));
  const glm::vec3 t = glm::normalize(glm::cross(n, glm::vec3(0, 1, 0)));
  const glm::mat3 frame(t, glm::cross(n, t), n);
  const HemisphereLight reduced = hemisphereLight(light, frame);
  const auto exact = hemisphereIntegral(
      [&](const glm::dvec3& w) { return glm::dvec3(radianceFrom(light, frame * glm::vec3(w))) * w.z; });
  const auto got = hemisphereIntegral(
      [&](const glm::dvec3& w) { return glm::dvec3(reducedRadiance(reduced, glm::vec3(w))) * w.z; });
  EXPECT_LT(glm::length(exact - got), 1e-4);
}

TEST(Environment, RotationMovesTheLight) {
  const EnvironmentLight light = somePolynomial();
  const glm::mat3 y_up_from_z_up(glm::vec3(1, 0, 0), glm::vec3(0, 0, -1), glm::vec3(0, 1, 0));
  const EnvironmentLight moved = rotated(light, y_up_from_z_up);
  const glm::vec3 w = glm::normalize(glm::vec3(0.3f, 0.5f, -0.2f));
  EXPECT_LT(glm::length(radianceFrom(moved, y_up_from_z_up * w) - radianceFrom(light, w)), 1e-5f);
}

TEST(Environment, SkyGivesItsIrradiance) {
  const EnvironmentLight light = skyLight(glm::vec3(2), glm::vec3(0.5f), {0, 0, 1});
  const auto up = hemisphereIntegral(
      [&](const glm::dvec3& w) { return glm::dvec3(radianceFrom(light, glm::vec3(w))) * w.z; });
  const auto down = hemisphereIntegral(
      [&](const glm::dvec3& w) { return glm::dvec3(radianceFrom(light, glm::vec3(w.x, w.y, -w.z))) * w.z; });
  EXPECT_NEAR(up.x * kPi, 2, 1e-4);
  EXPECT_NEAR(down.x * kPi, 0.5, 1e-4);
}

// The integral of evaluate() under the reduced light is what evaluateEnvironment returns: tables, mean, ratio
// chroma, the fade at the horizon and assets without the cosine.
TEST(Environment, EvaluatorIntegratesItself) {
  for (const bool cosine : {true, false})
    for (Material material : {test::fusedMaterial(), test::lodMaterial()}) {
      material.cosine_included = cosine;
      Evaluator evaluator(material);
      evaluator.prepareEnvironment();
      const HemisphereLight light = hemisphereLight(somePolynomial(), glm::mat3(1));
      // At a row and a column of the grid both readings agree.
      const double step = double(material.theta_max) / (environmentGrid(material.bands[0], 1).thetas - 1);
      for (const Spherical view : {Spherical{step, 0}, Spherical{2 * step, 0}}) {
        const glm::dvec3 wo = directionFromSpherical(view);
        const auto hit = evaluator.findHit(glm::dvec2(0.37, 0.81), 0.5, wo, Lookup::kNone);
        const glm::dvec3 truth = hemisphereIntegral([&](const glm::dvec3& wi) {
          return evaluator.evaluate(hit, wi, wo) * glm::dvec3(reducedRadiance(light, glm::vec3(wi)));
        });
        const glm::dvec3 got = evaluator.evaluateEnvironment(hit, light, wo);
        // Fixtures are noise from light to light; nearest tables are read at a grid of lights instead.
        const double tolerance = material.mode == Mode::kLod ? 0.05 : 0.01;
        EXPECT_LT(glm::length(truth - got), tolerance * std::max(1.0, glm::length(truth)))
            << modeName(material.mode) << ": " << got.x << " " << got.y << " " << got.z << ", expected "
            << truth.x << " " << truth.y << " " << truth.z;
      }
    }
}

}  // namespace
}  // namespace loden
