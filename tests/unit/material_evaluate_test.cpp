// The equation's terms against plain formulas.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "material/eval/evaluate.h"
#include "tests/unit/material_fixtures.h"

namespace loden {
namespace {

TEST(Window, IsLbtfsWeight) {
  // w_k = min(max(1 - lambda + k, 0), 1), LBTF eq. 7.
  for (int k = 0; k < 5; ++k) {
    Window window;
    window.out_begin = static_cast<float>(k);
    window.out_end = static_cast<float>(k + 1);
    for (double lambda = 0; lambda < 6; lambda += 0.13)
      EXPECT_NEAR(windowWeight(window, lambda), std::min(std::max(1 - lambda + k, 0.0), 1.0), 1e-12);
  }
}

TEST(Window, CrossFadeSumsToOne) {
  Window fine, coarse;
  fine.out_begin = 1, fine.out_end = 2;
  coarse.in_begin = 1, coarse.in_end = 2;
  for (double lambda = 0; lambda < 6; lambda += 0.07)
    EXPECT_NEAR(windowWeight(fine, lambda) + windowWeight(coarse, lambda), 1, 1e-12);
}

TEST(Mean, IsPhong) {
  const PhongMean mean{0.1f, 0.5f, 0.3f, 20, 0.02f, -0.03f, MeanChroma::kConstant};
  const glm::dvec3 wi = directionFromSpherical({0.5, 1}), wo = directionFromSpherical({0.8, 2});
  const double cosine = glm::normalize(wi + wo).z;
  const glm::dvec3 value = evaluateMean(mean, wi, wo);
  EXPECT_NEAR(value.x, 0.1 + 0.5 * std::cos(0.5) + 0.3 * std::pow(cosine, 20), 1e-7);
  EXPECT_NEAR(value.y, 0.02, 1e-7);
  EXPECT_NEAR(value.z, -0.03, 1e-7);
}

TEST(Mean, RatioChromaFollowsY) {
  const PhongMean mean{0, 1, 0, 1, 0.2f, -0.1f, MeanChroma::kRatio};
  const glm::dvec3 up(0, 0, 1);
  const glm::dvec3 value = evaluateMean(mean, directionFromSpherical({1.0, 0}), up);
  EXPECT_NEAR(value.y, 0.2 * value.x, 1e-7);
  EXPECT_NEAR(value.z, -0.1 * value.x, 1e-7);
}

TEST(Evaluator, FloatAndDoubleAgree) {
  for (const Material& material : {test::lodMaterial(), test::fusedMaterial(), test::surfaceMaterial()}) {
    const Evaluator evaluator(material);
    for (int k = 0; k < 400; ++k) {
      const glm::dvec2 x(0.137 * k - 3, 0.0713 * k);
      const double lambda = 0.011 * k;
      const glm::dvec3 wi = directionFromSpherical({0.0037 * k, 0.31 * k}),
                       wo = directionFromSpherical({0.9, 0.17 * k});
      const auto a = evaluator.evaluate(evaluator.findHit(x, lambda, wo, Lookup::kNone), wi, wo);
      const auto b = evaluator.evaluate(
          evaluator.findHit(glm::vec2(x), static_cast<float>(lambda), glm::vec3(wo), Lookup::kNone),
          glm::vec3(wi), glm::vec3(wo));
      // Noise of the fixtures reaches 1 per texel, so coordinates' rounding (1e-6) times the texel density
      // shows.
      EXPECT_NEAR(a.x, b.x, 2e-3) << "sample " << k;
      EXPECT_NEAR(a.y, b.y, 2e-3) << "sample " << k;
      EXPECT_NEAR(a.z, b.z, 2e-3) << "sample " << k;
    }
  }
}

TEST(Evaluator, IsContinuousInLambda) {
  // No step above 1/255 of white for a change of 0.01, where the bands' own values are of the order of 1.
  const Material material = test::fusedMaterial();
  const Evaluator evaluator(material);
  const glm::dvec3 wi = directionFromSpherical({0.4, 1}), wo = directionFromSpherical({0.6, 3});
  glm::dvec3 last(0);
  for (double lambda = 0; lambda < material.lambda_max + 2; lambda += 1e-4) {
    const auto value =
        evaluator.evaluate(evaluator.findHit(glm::dvec2(0.3, 0.7), lambda, wo, Lookup::kNone), wi, wo);
    if (lambda > 0) {
      EXPECT_LT(glm::length(value - last), 1e-2) << "lambda " << lambda;
    }
    last = value;
  }
}

TEST(Evaluator, AQuadFadesInAndOutWithinItsLevels) {
  Material whole = test::splitFusedMaterial();
  whole.mean.ka = 4;  // far from black
  Band& band = whole.bands.back();
  band.quad_levels.assign(3, {});
  Material first = whole, fading = whole;
  first.bands.back().quad_scale[1] = first.bands.back().quad_scale[2] = glm::vec4(0);
  fading.bands.back().quad_levels = {{}, {2.25f, 4}, {2.25f, 4}};
  const Evaluator of_whole(whole), of_first(first), of_fading(fading);
  const glm::dvec3 wi = directionFromSpherical({0.4, 1.7}), wo = directionFromSpherical({0.6, 0.2});
  for (const double lambda : {2.0, 2.25, 2.5, 3.0, 3.125, 3.5, 3.75, 4.0, 5.0}) {
    const auto valueOf = [&](const Evaluator& evaluator) {
      return evaluator.evaluate(evaluator.findHit(glm::dvec2(0.31, 0.77), lambda, wo), wi, wo);
    };
    const double share = std::clamp(std::min(lambda - 2.25, 4 - lambda), 0.0, 1.0);
    const glm::dvec3 blend = glm::mix(valueOf(of_first), valueOf(of_whole), share),
                     value = valueOf(of_fading);
    EXPECT_GT(glm::distance(valueOf(of_first), valueOf(of_whole)), 1e-4) << lambda;
    EXPECT_LT(glm::distance(value, blend), 1e-12) << lambda;
  }
}

TEST(Evaluator, DirectionsBelowTheHorizonAreBlack) {
  const Material material = test::fusedMaterial();
  const Evaluator evaluator(material);
  const glm::dvec3 up(0, 0, 1), down = glm::normalize(glm::dvec3(1, 0, -0.2));
  const auto hit = evaluator.findHit(glm::dvec2(0.5), 0.0, up);
  EXPECT_EQ(glm::length(evaluator.evaluate(hit, down, up)), 0);
  EXPECT_EQ(glm::length(evaluator.evaluate(hit, up, down)), 0);
}

TEST(Evaluator, LightFadesToZeroAtTheHorizon) {
  const Material material = test::fusedMaterial();
  const Evaluator evaluator(material);
  const glm::dvec3 up(0, 0, 1);
  const auto hit = evaluator.findHit(glm::dvec2(0.2, 0.4), 3.0, up);
  const auto at = [&](double theta) {
    return evaluator.evaluate(hit, directionFromSpherical({theta, 1}), up);
  };
  const double theta_max = material.theta_max;
  for (double theta = theta_max; theta < kPi / 2; theta += 0.02)
    EXPECT_NEAR(glm::length(at(theta)), glm::length(at(theta_max)) * std::cos(theta) / std::cos(theta_max),
                1e-6);
}

// Fits undershoot black; light is not negative.
TEST(Evaluator, UndershootIsBlack) {
  Material m;
  m.mode = Mode::kLod;
  m.mean = {-0.2f, 0.5f, 0, 1, 0, 0, MeanChroma::kConstant};
  const Evaluator evaluator(m);
  const glm::dvec3 low = directionFromSpherical({1.4, 0}), up(0, 0, 1);  // N.L = .17
  EXPECT_EQ(evaluator.evaluate(evaluator.findHit(glm::dvec2(0), 0.0, up), low, up), glm::dvec3(0));
  EXPECT_NEAR(evaluator.evaluate(evaluator.findHit(glm::dvec2(0), 0.0, up), up, up).x, 0.3, 1e-6);
}

TEST(Evaluator, ParallaxFadesWithTheTexelsThatItCrosses) {
  Material material = test::fusedMaterial();
  material.geometry.identity_parameterization = true;
  material.geometry.range.z = 0.1f;
  material.side = 32;
  // 0.1 periods deep, slope 1: 3.2 texels at lambda 0, half a texel at log2(6.4), a quarter one level later.
  const glm::dvec3 wo = directionFromSpherical({kPi / 4, 1});
  EXPECT_DOUBLE_EQ(parallaxFade(material, std::log2(6.4) - 0.01, wo), 1);
  EXPECT_NEAR(parallaxFade(material, std::log2(6.4) + std::log2(4.0 / 3), wo), 0.5, 1e-6);
  EXPECT_NEAR(parallaxFade(material, std::log2(6.4) + 1, wo), 0, 1e-6);
  EXPECT_EQ(parallaxFade(material, 0.0, glm::dvec3(0, 0, 1)), 0);
  material.geometry.identity_parameterization = false;
  EXPECT_EQ(parallaxFade(material, 9.0, wo), 1) << "p is not x without parallax";
}

TEST(Evaluator, FadedParallaxEndsAtX) {
  Material material = test::fusedMaterial();
  material.geometry.identity_parameterization = true;
  const Evaluator evaluator(material);
  const glm::dvec3 wo = directionFromSpherical({1.0, 1});
  const glm::dvec2 x(0.3, 0.6);
  const auto far = evaluator.findHit(x, 12.0, wo, Lookup::kDefault, Parallax::kFaded);
  EXPECT_EQ(far.p, x);
  EXPECT_EQ(far.depth, 0);
  EXPECT_EQ(far.fetches, 0);
}

TEST(Evaluator, CosineThatValuesLeaveOut_IsMultiplied) {
  Material with = test::lodMaterial(), without = with;
  without.cosine_included = false;
  const glm::dvec3 wi = directionFromSpherical({1.0, 2}), wo = directionFromSpherical({0.3, 1});
  const auto valueOf = [&](const Material& material) {
    const Evaluator evaluator(material);
    return evaluator.evaluate(evaluator.findHit(glm::dvec2(0.3, 0.6), 0.0, wo, Lookup::kNone), wi, wo);
  };
  const glm::dvec3 value = valueOf(without), expected = valueOf(with) * std::cos(1.0);
  ASSERT_GT(glm::length(expected), 0);
  EXPECT_LT(glm::length(value - expected), 1e-12);
}

}  // namespace
}  // namespace loden
