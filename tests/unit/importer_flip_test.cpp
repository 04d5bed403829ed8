// FLIP against values of the authors' own implementation (NVIDIA FLIP 1.6), and metrics against closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "importer/base/flip.h"
#include "importer/base/metrics.h"

namespace loden::importer {
namespace {

constexpr int kWidth = 64, kHeight = 48;

glm::vec3 patternAt(int x, int y) {
  constexpr float t = 6.2831853f;
  const float u = (static_cast<float>(x) + .5f) / kWidth, v = (static_cast<float>(y) + .5f) / kHeight;
  glm::vec3 f;
  for (int c = 0; c < 3; ++c) {
    const auto k = static_cast<float>(c);
    f[c] = 0.5f + 0.35f * std::sin(t * (3 * u + 0.7f * k)) * std::cos(t * 2 * v + k);
  }
  return f;
}

template <class Change>
std::vector<glm::vec3> image(const Change& change) {
  std::vector<glm::vec3> pixels;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) pixels.push_back(change(x, y));
  return pixels;
}

template <class Change>
void expectFlip(const Change& change, double mean, double max) {
  const FlipError error = flip(image(patternAt), image(change), kWidth, kHeight);
  EXPECT_NEAR(error.mean, mean, 1e-4);
  EXPECT_NEAR(error.max, max, 1e-4);
}

TEST(Flip, SameImage_IsZero) {
  expectFlip(patternAt, 0, 0);
}

TEST(Flip, Brighter_MatchesAuthors) {
  expectFlip([](int x, int y) { return glm::min(patternAt(x, y) * 1.1f, glm::vec3(1)); }, 0.192512, 0.230068);
}

TEST(Flip, Checker_MatchesAuthors) {
  const auto checker = [](int x, int y) { return patternAt(x, y) + ((x / 4 + y / 4) % 2 ? 0.08f : -0.08f); };
  expectFlip(checker, 0.128446, 0.341114);
}

TEST(Flip, Shifted_MatchesAuthors) {
  expectFlip([](int x, int y) { return patternAt(x + 1, y); }, 0.272767, 0.420648);
}

TEST(Metrics, ConstantOffset_HasClosedForm) {
  ErrorSums sums;
  for (int i = 0; i < 10; ++i) sums.add(glm::dvec3(0.5), glm::dvec3(0.6));
  EXPECT_NEAR(sums.y().mse, 0.01, 1e-12);
  EXPECT_NEAR(sums.y().rmse, 0.1, 1e-12);
  EXPECT_NEAR(sums.y().mae, 0.1, 1e-12);
  EXPECT_NEAR(sums.cb().rmse, 0, 1e-12);
  EXPECT_NEAR(sums.cr().rmse, 0, 1e-12);
  EXPECT_NEAR(sums.psnr(), 20, 1e-9);
}

TEST(Metrics, GrayLab_IsLightnessDifference) {
  ErrorSums sums;
  sums.add(glm::dvec3(1), glm::dvec3(0));
  EXPECT_NEAR(sums.labMean(), 100, 1e-6);
}

TEST(Metrics, Merging_EqualsAddingAtOnce) {
  ErrorSums one, a, b;
  for (int i = 0; i < 7; ++i) {
    const glm::dvec3 reference(0.1 * i, 0.2, 0.3), test(0.3, 0.1 * i, 0.2);
    one.add(reference, test);
    (i < 3 ? a : b).add(reference, test);
  }
  a.merge(b);
  EXPECT_EQ(a.count(), one.count());
  EXPECT_NEAR(a.y().mse, one.y().mse, 1e-15);
  EXPECT_NEAR(a.labMean(), one.labMean(), 1e-12);
  EXPECT_EQ(a.labMax(), one.labMax());
}

}  // namespace
}  // namespace loden::importer
