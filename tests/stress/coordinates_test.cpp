// Coordinates and levels at the edges of what they can be. Footprints are the shaders' alone:
// edges_gl_test.cpp.

#include <gtest/gtest.h>

#include <random>

#include "material/eval/evaluate.h"
#include "tests/stress/stress.h"
#include "tests/stress/stress_materials.h"

namespace loden::stress {
namespace {

const glm::dvec3 kLight = glm::normalize(glm::dvec3(0.3, -0.2, 0.8)),
                 kView = glm::normalize(glm::dvec3(-0.4, 0.1, 0.7));

std::vector<float> levelsOf(const Material& m) {
  std::vector<float> borders{0, 1, 2, m.lambda_min, m.lambda_max, finestLevel(m)};
  for (const Band& band : m.bands) {
    borders.insert(borders.end(),
                   {band.window.in_begin, band.window.in_end, band.window.out_begin, band.window.out_end,
                    band.lambda_first, band.lambda_first + float(band.weights.mips - 1)});
  }
  if (m.surface) borders.insert(borders.end(), {m.surface->fade_begin, m.surface->fade_end});
  return edgeLevels(borders);
}

TEST(StressCoordinates, EveryCoordinateAtEveryLevelIsFinite) {
  int64_t values = 0, broken = 0;
  for (const Material& material : edgeMaterials()) {
    Evaluator evaluator(material);
    evaluator.prepareQuality();
    std::vector<float> xs = edgeCoordinates(material.side);
    for (const float bad : {NAN, INFINITY, -INFINITY}) xs.push_back(bad);
    const std::vector<float> levels = levelsOf(material);
    const auto step = static_cast<size_t>(amount(5, 1));
    for (const Lookup lookup : kLookups)
      for (size_t i = 0; i < xs.size(); ++i)
        for (size_t k = i % step; k < levels.size(); k += step) {
          const glm::vec2 x(xs[i], xs[(7 * i + k) % xs.size()]);
          const auto f = evaluator.findHit(x, levels[k], glm::vec3(kView), lookup, Parallax::kFaded,
                                           LocalSurface<float>::flat(material.geometry.aspect));
          const auto d = evaluator.findHit(glm::dvec2(x), double(levels[k]), kView, lookup);
          values += 2;
          broken += !blackOrLight(evaluator.evaluate(f, glm::vec3(kLight), glm::vec3(kView)));
          broken += !blackOrLight(evaluator.evaluate(d, kLight, kView));
        }
  }
  record("values at edge coordinates and levels, including coordinates and levels that are not finite",
         double(values), "all tried");
  record("values at edge coordinates and levels that are not finite, or negative", double(broken), "0");
  EXPECT_EQ(broken, 0);
}

// Floats of any size, on and beside the borders of texels, against the definition in double.
TEST(StressCoordinates, ValuesAreRightOnAndBesideTheBordersOfTexels) {
  double most[3] = {0, 0, 0};
  int64_t count = 0;
  for (const int side : {4, 8, 32}) {
    const Material material = smoothMaterial(side);
    const Evaluator evaluator(material);
    const std::vector<float> xs = edgeCoordinates(side);
    for (size_t i = 0; i < xs.size(); ++i)
      for (const double lambda : {0.0, 0.5, 1.0, double(below(1.0f)), 1.3}) {
        const glm::vec2 x(xs[i], xs[(5 * i + 3) % xs.size()]);
        const glm::dvec3 expected = smoothValue(side, glm::dvec2(x), lambda, kLight, kView);
        const auto f = evaluator.findHit(x, float(lambda), glm::vec3(kView), Lookup::kNone);
        const auto d = evaluator.findHit(glm::dvec2(x), lambda, kView, Lookup::kNone);
        ++count;
        most[0] = std::max(
            most[0],
            largestOf(glm::dvec3(evaluator.evaluate(f, glm::vec3(kLight), glm::vec3(kView))) - expected));
        most[1] = std::max(most[1], largestOf(evaluator.evaluate(d, kLight, kView) - expected));
      }
  }
  record("values on and beside borders of texels, up to 1e30 periods away", double(count), "");
  record("values on and beside borders of texels: float against the definition in double, largest difference",
         most[0], "<= 2e-6");
  record(
      "values on and beside borders of texels: double, with tables in floats, against the definition, "
      "largest difference",
      most[1], "<= 1e-7");
  // Weights up to .9 / c and tables up to 1, twelve of them at .1, 1.77 of chroma: floats of both are off by
  // 6e-8 of themselves.
  EXPECT_LE(most[1], 1e-7);
  // A float's place between texels is off by side ulps, 32 * 6e-8, times slopes of the weights of .5 a texel.
  EXPECT_LE(most[0], 2e-6);
}

// x and x + n hold the same fraction where both are floats; then values are the same bit by bit, and what is
// read at p moves by whole periods.
TEST(StressCoordinates, WholePeriodsDoNotMatter) {
  int64_t count = 0, different = 0;
  double worst_float = 0, worst_double = 0;
  for (const Material& material : edgeMaterials()) {
    const Evaluator evaluator(material);
    std::mt19937 random(3);
    for (int k = 0; k < 400; ++k) {
      const glm::vec2 x(float(random() % 64) / 64, float(random() % 64) / 64);
      const auto here = evaluator.findHit(x, 0.25f, glm::vec3(kView), Lookup::kNone);
      const auto found = evaluator.findHit(x, 0.25f, glm::vec3(kView));
      const auto found_double = evaluator.findHit(glm::dvec2(x), 0.25, kView);
      for (const float n : {1.0f, -1.0f, 1e3f, -1e3f, 1e5f, -1e5f}) {
        const glm::vec2 there = x + glm::vec2(n, -n);
        const auto moved = evaluator.findHit(there, 0.25f, glm::vec3(kView), Lookup::kNone);
        ++count;
        different += evaluator.evaluate(here, glm::vec3(kLight), glm::vec3(kView)) !=
                     evaluator.evaluate(moved, glm::vec3(kLight), glm::vec3(kView));
        const auto f = evaluator.findHit(there, 0.25f, glm::vec3(kView));
        const auto d = evaluator.findHit(glm::dvec2(there), 0.25, kView);
        const auto whole = [&](const glm::dvec2& a, const glm::dvec2& b) {
          const glm::dvec2 off = a - b;
          return glm::length(off - glm::floor(off + 0.5));
        };
        worst_float = std::max(worst_float,
                               whole(glm::dvec2(f.p), glm::dvec2(found.p)) / ulpOf(std::abs(double(n)) + 1));
        worst_double = std::max(worst_double, whole(d.p, found_double.p));
      }
    }
  }
  record("values moved by up to 1e5 periods that differ in a bit, of " + std::to_string(count),
         double(different), "0");
  record("p of lookups moved by up to 1e5 periods, in float: largest change, in ulp of the coordinate",
         worst_float, "<= 4");
  record("p of lookups moved by up to 1e5 periods, in double: largest change, tile periods", worst_double,
         "<= 1e-9");
  EXPECT_EQ(different, 0);
  EXPECT_LE(worst_float, 4);
  EXPECT_LE(worst_double, 1e-9);
}

// --- levels ---

// The definition of a window, by cases.
double windowByCases(const Window& w, double lambda) {
  if (!(lambda > double(w.in_begin)) || !(lambda < double(w.out_end))) return 0;
  double weight = 1;
  if (lambda < double(w.in_end))
    weight *= (lambda - double(w.in_begin)) / (double(w.in_end) - double(w.in_begin));
  if (lambda > double(w.out_begin))
    weight *= (double(w.out_end) - lambda) / (double(w.out_end) - double(w.out_begin));
  return weight;
}

TEST(StressLevels, WindowsAreRightOnAndBesideTheirBorders) {
  double worst = 0, jump = 0;
  int64_t count = 0;
  for (const Window& w :
       {Window{}, Window{-2, -1, 1, 2}, Window{1, 2, 1e4f, 2e4f}, Window{0.1f, 0.3f, 0.3f, 0.7f},
        Window{1, 1.001f, 1.001f, 1.002f}, Window{-2, -1, 0.5f, above(0.5f)}}) {
    for (const float lambda : edgeLevels({w.in_begin, w.in_end, w.out_begin, w.out_end, 0, 1})) {
      const double f = double(windowWeight(w, lambda)), d = windowWeight(w, double(lambda));
      ++count;
      if (std::isnan(lambda)) continue;  // never reaches a window: the finest level stands for it
      // The difference of two floats is rounded to its own ulp, and so is the quotient.
      worst = std::max({worst, std::abs(f - windowByCases(w, double(lambda))),
                        std::abs(d - windowByCases(w, double(lambda)))});
      EXPECT_TRUE(f >= 0 && f <= 1) << lambda;
      const float next = above(lambda);
      if (!std::isfinite(lambda) || !std::isfinite(next)) continue;
      const double steep =
          1 / std::min(double(w.in_end) - double(w.in_begin), double(w.out_end) - double(w.out_begin));
      jump = std::max(jump, (std::abs(double(windowWeight(w, next)) - f) - 2.4e-7) /
                                (steep * (double(next) - double(lambda))));
    }
  }
  record("window weights on and beside borders, largest error", worst, "<= 2.4e-7");
  record("largest change of a weight over one ulp of lambda, as a share of the window's slope", jump, "<= 1");
  EXPECT_LE(worst, 2.4e-7);
  EXPECT_LE(jump, 1);
}

TEST(StressLevels, WhatIsNoLevelShowsTheFinestAndWhatIsBeyondShowsTheLast) {
  int64_t count = 0;
  for (const Material& material : edgeMaterials()) {
    const Evaluator evaluator(material);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int k = 0; k < 50; ++k) {
      const glm::vec2 x(uniform(random), uniform(random));
      const auto valueAt = [&](float lambda) {
        return evaluator.evaluate(evaluator.findHit(x, lambda, glm::vec3(kView)), glm::vec3(kLight),
                                  glm::vec3(kView));
      };
      const glm::vec3 finest = valueAt(finestLevel(material));
      for (const float lambda : {-INFINITY, -1e30f, NAN, -NAN}) {
        EXPECT_EQ(valueAt(lambda), finest) << material.name << ' ' << lambda;
        ++count;
      }
      // As published, beyond the last level the last level stays.
      const glm::vec3 last = valueAt(20);
      for (const float lambda : {INFINITY, 1e30f, 3e4f, 1e4f})
        EXPECT_EQ(valueAt(lambda), last) << material.name << ' ' << lambda;
      if (material.name != "smooth") continue;
      const glm::dvec3 defined = smoothValue(material.side, glm::dvec2(x), INFINITY, kLight, kView);
      EXPECT_LE(largestOf(glm::dvec3(last) - defined), 1e-6);
    }
  }
  record("values at -inf, -1e30 and NaN that are those of the finest level", double(count), "all tried");
}

// No level has a step: windows, mips, hand-overs and the fade of the near term, in steps of an ulp at borders
// and of 1e-3 between.
TEST(StressLevels, ValuesHaveNoStepOverLambda) {
  double steepest = 0, at_borders = 0;
  for (const Material& material : edgeMaterials()) {
    if (material.bands.empty() || material.bands[0].filter == WeightFilter::kNearest) continue;
    Material unshadowed = material;
    if (unshadowed.surface) unshadowed.surface->visibility = Visibility::kNone;
    const Evaluator evaluator(unshadowed);
    const glm::dvec2 x(0.3, 0.8);
    const auto valueAt = [&](double lambda) {
      return evaluator.evaluate(evaluator.findHit(x, lambda, kView, Lookup::kNone), kLight, kView);
    };
    for (double lambda = -2; lambda < 6; lambda += 1e-3)
      steepest = std::max(steepest, largestOf(valueAt(lambda + 1e-3) - valueAt(lambda)) / 1e-3);
    for (const float border : levelsOf(material)) {
      if (!std::isfinite(border) || std::abs(border) > 8) continue;
      const auto single = [&](float lambda) {
        return evaluator.evaluate(evaluator.findHit(glm::vec2(x), lambda, glm::vec3(kView), Lookup::kNone),
                                  glm::vec3(kLight), glm::vec3(kView));
      };
      at_borders = std::max(at_borders, largestOf(single(above(border)) - single(border)));
    }
  }
  // A mip or a window replaces a value by another, both from 0 to 1.5, within one level; and both together.
  record("steepest change of a value per level, over 8 levels", steepest, "<= 3");
  record("largest change over one ulp of lambda at borders of windows and mips", at_borders, "<= 1e-5");
  EXPECT_LE(steepest, 3);
  EXPECT_LE(at_borders, 1e-5);
}

}  // namespace
}  // namespace loden::stress
