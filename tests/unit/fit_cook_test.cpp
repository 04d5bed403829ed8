// The cooked modes on small synthetic BTFs.

#include <gtest/gtest.h>

#include <cmath>

#include "importer/btf/packed_lod.h"
#include "importer/cook/meta.h"
#include "importer/cook/modes.h"
#include "importer/fit/band_fit.h"
#include "importer/fit/flat_fit.h"
#include "importer/fit/measure.h"
#include "importer/fit/ratio_fit.h"
#include "material/eval/evaluate.h"
#include "material/model/color.h"
#include "tests/unit/fit_synthetic.h"

namespace loden::importer {
namespace {

double wave(glm::dvec2 p) {
  return 0.5 + 0.2 * std::sin(2 * kPi * p.x) + 0.15 * std::cos(2 * kPi * (p.x + 2 * p.y));
}

// A Lambertian picture under the surface, seen with parallax: rank 1 in the flat domain, of high rank on the
// plane.
glm::dvec2 parallax(glm::dvec2 x, const glm::dvec3& wo) {
  return x - 0.08 * glm::dvec2(wo) / wo.z;
}
SyntheticSource parallaxSource(int side) {
  return {side, bonn81Directions(), [](glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3& wo) {
            return glm::dvec3(0.9, 0.7, 0.4) * wave(parallax(x, wo)) * wi.z;
          }};
}

TEST(CookLod, SeedHasThePublishedLayout) {
  const SyntheticSource source = parallaxSource(16);
  CookOptions options;
  options.mode = Mode::kLod;
  options.preset = Preset::kSeed;
  options.levels = 3;
  const auto m = cookLod(source, options);
  ASSERT_TRUE(m.ok()) << m.issue().text;
  ASSERT_EQ(m->bands.size(), 3u);
  size_t tables = 0, weights = 0;
  for (const Band& band : m->bands) {
    EXPECT_EQ(band.layout, TableLayout::kNearest);
    EXPECT_EQ(band.filter, WeightFilter::kNearest);
    EXPECT_EQ(band.y_quads, 2);
    EXPECT_EQ(band.chroma_quads, 1);
    tables += band.table.data.size();
    weights += band.weights.data.size();
  }
  EXPECT_EQ(tables, 48u * 81 * 81 * 3);            // 48 p q (lambda_max + 1)
  EXPECT_EQ(weights, 64u * 16 * 16);               // 64 r^2
  for (double lambda : {0.0, 0.3, 1.0, 1.5, 2.0})  // w_k = clamp(1 - lambda + k, 0, 1)
    for (int k = 0; k < 2; ++k)
      EXPECT_NEAR(windowWeight(m->bands[size_t(k)].window, lambda), std::clamp(1 - lambda + k, 0.0, 1.0),
                  1e-12);
  EXPECT_EQ(windowWeight(m->bands[2].window, 2.0), 1);
}

// Ma et al. 2005, sections 3.3 and 3.4: from the two packed textures alone, as their shader reads them at
// level 0.
double lumaFromPacked(const PackedLod& packed, const PhongMean& mean, const SyntheticSource& source,
                      int levels, glm::ivec2 texel, int l, int v) {
  const int lights = source.lights().size(), views = source.views().size();
  double y = evaluateMean(mean, source.lights().samples[size_t(l)], source.views().samples[size_t(v)]).x;
  glm::ivec2 corner(0);
  for (int level = 0, side = packed.weights.width / 2; level < levels; ++level, side /= 2, texel /= 2) {
    for (int quad = 0; quad < 2; ++quad)
      y += double(glm::dot(packed.weights.at(corner.x + quad * side + texel.x, corner.y + texel.y),
                           packed.eigen.at(quad * lights + l, level * views + v)));
    corner += side;
  }
  return y;
}

TEST(CookLod, PacksAsPublished) {
  const SyntheticSource source = parallaxSource(16);
  CookOptions options;
  options.mode = Mode::kLod;
  options.preset = Preset::kSeed;
  const auto m = cookLod(source, options);
  ASSERT_TRUE(m.ok()) << m.issue().text;
  const auto packed = packLod(*m);
  ASSERT_TRUE(packed.ok()) << packed.issue().text;
  EXPECT_EQ(packed->eigen.width, 3 * 81);
  EXPECT_EQ(packed->eigen.height, 5 * 81);
  EXPECT_EQ(packed->weights.width, 2 * 16);
  EXPECT_EQ(packed->weights.height, 2 * 16);
  const Evaluator evaluator(*m);
  for (const glm::ivec4 at : {glm::ivec4(0, 0, 0, 0), glm::ivec4(3, 9, 17, 60), glm::ivec4(15, 6, 80, 33)}) {
    const glm::dvec2 x = (glm::dvec2(at.x, at.y) + 0.5) / 16.0;
    const glm::dvec3 wi = source.lights().samples[size_t(at.z)], wo = source.views().samples[size_t(at.w)];
    const double y = yccFromRgb(evaluator.evaluate(evaluator.findHit(x, 0.0, wo), wi, wo)).x;
    EXPECT_NEAR(lumaFromPacked(*packed, m->mean, source, 5, {at.x, at.y}, at.z, at.w), y,
                1e-6);  // 32-bit floats
  }
  options.preset = Preset::kGame;
  EXPECT_FALSE(packLod(*cookLod(source, options)).ok());
}

TEST(CookLod, TakesComponentsLiterally) {
  CookOptions options;
  options.mode = Mode::kLod;
  options.preset = Preset::kSeed;
  EXPECT_EQ(cookLod(parallaxSource(16), options)->bands[0].chroma_quads, 1) << "the preset's 8,2,2";
  options.y_components = 4;
  const auto m = cookLod(parallaxSource(16), options);
  ASSERT_TRUE(m.ok());
  EXPECT_EQ(m->bands[0].y_quads, 1);
  EXPECT_EQ(m->bands[0].chroma_quads, 0);
}

TEST(CookLod, RefusesLevelsThatDoNotDivide) {
  CookOptions options;
  options.preset = Preset::kSeed;
  options.levels = 6;
  EXPECT_FALSE(cookLod(parallaxSource(16), options).ok());
}

TEST(CookLod, RefusesValuesThatAreNotFinite) {
  const SyntheticSource source(4, bonn81Directions(),
                               [](glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3&) {
                                 return glm::dvec3(x.x > 0.8 && x.y > 0.8 && wi.z == 1 ? NAN : 0.5);
                               });
  const auto m = cookLod(source, {});
  ASSERT_FALSE(m.ok());
  EXPECT_NE(m.issue().text.find("light 0, texel (3, 3)"), std::string::npos) << m.issue().text;
}

// The algebra of measureError is what the evaluator computes.
TEST(Measure, AgreesWithTheEvaluator) {
  const SyntheticSource source = parallaxSource(4);
  for (Preset preset : {Preset::kSeed, Preset::kGame, Preset::kReference}) {
    CookOptions options;
    options.preset = preset;
    options.levels = preset == Preset::kSeed ? 2 : 0;
    const auto m = cookLod(source, options);
    ASSERT_TRUE(m.ok());
    const auto btf = loadYcc(source, 0);
    const DirectionSet& set = source.lights();
    const BtfError error = measureError(*m, *btf, set, set, {}, 0);
    const Evaluator evaluator(*m);
    double squares = 0;
    for (int v = 0; v < 81; ++v)
      for (int l = 0; l < 81; ++l)
        for (int t = 0; t < 16; ++t) {
          const glm::dvec2 x = glm::dvec2(t % 4 + 0.5, t / 4 + 0.5) / 4.0;
          const glm::dvec3 wi = set.samples[size_t(l)], wo = set.samples[size_t(v)];
          const glm::dvec3 value = evaluator.evaluate(evaluator.findHit(x, 0.0, wo), wi, wo);
          const glm::dvec3 truth = glm::dvec3(0.9, 0.7, 0.4) * wave(parallax(x, wo)) * wi.z;
          const double d = glm::dot(value - truth, glm::dvec3(0.299, 0.587, 0.114));
          squares += d * d;
        }
    const double rmse = std::sqrt(squares / (81.0 * 81 * 16));
    EXPECT_NEAR(error.channel[0].rmse(), rmse, 2e-5 + 1e-3 * rmse);
  }
}

TEST(FlatFit, OneComponentGivesBackAPictureUnderParallax) {
  const SyntheticSource source = parallaxSource(16);
  const auto btf = loadYcc(source, 0);
  const Indirection a = makeIndirection(16, 32, source.views(), parallax, 0);
  FlatFitOptions options;
  options.components = 1;
  options.smoothness = 1e-7;
  options.cg_steps = 30;
  const FlatFit fit = fitFlat(channelBlocks(*btf, 0), a, options);
  EXPECT_LT(fit.rmse, 2e-3);  // bilinear reading of a sine over 32 texels
  // On the reference plane the same data needs many components.
  const Factors plane = leadingFactors(channelBlocks(*btf, 0), 1, 0);
  double energy = 0, kept = 0;
  Matrix block;
  for (int v = 0; v < 81; ++v) {
    btf->read(0, v, block);
    for (double value : block.data) energy += value * value;
  }
  for (double w : plane.weights.data) kept += w * w;
  EXPECT_GT(std::sqrt((energy - kept) / (256.0 * 6561)), 0.02);

  const PhongMean none;
  const Matrix mean(6561, 3);
  const auto ratios = fitRatios(*btf, wholeLuma(*btf, fit.factors, mean, a), none, a, 0);
  const glm::dvec3 ycc = yccFromRgb(glm::dvec3(0.9, 0.7, 0.4));
  for (const glm::dvec2& r : ratios) {
    EXPECT_NEAR(r.x, ycc.y / ycc.x, 2e-3);
    EXPECT_NEAR(r.y, ycc.z / ycc.x, 2e-3);
  }
}

TEST(FlatFit, TexelsThatNoViewSeesStayFinite) {
  const SyntheticSource source = parallaxSource(8);
  const auto btf = loadYcc(source, 0);
  const auto halfSeen = [](glm::dvec2 x, const glm::dvec3&) { return glm::dvec2(x.x * 0.5, x.y); };
  const Indirection a = makeIndirection(8, 8, source.views(), halfSeen, 0);
  FlatFitOptions options;
  options.components = 4;
  const FlatFit fit = fitFlat(channelBlocks(*btf, 0), a, options);
  for (double w : fit.factors.weights.data) ASSERT_TRUE(std::isfinite(w));
  for (double e : fit.factors.basis.data) ASSERT_TRUE(std::isfinite(e));
}

// What is kept of a BTF is what the whole of it has.
TEST(HalvedBtf, HoldsTheWholeAtHalfTheSideAndSamplesOfIt) {
  for (const int side : {1, 5, 8}) {
    const SyntheticSource source = parallaxSource(side);
    const auto whole = loadYcc(source, 0);
    const auto kept = loadHalved(source, 1000, 0);
    ASSERT_TRUE(whole.ok() && kept.ok());
    EXPECT_EQ(kept->side, side);
    const YccBtf half = side > 1 ? downsample(*whole, BoxFilter::k2x2, 0) : *whole;
    ASSERT_EQ(kept->half.side(), half.side());
    Matrix expected, value;
    for (int v = 0; v < 81; ++v)
      for (int channel = 0; channel < 3; ++channel) {
        half.read(channel, v, expected), kept->half.read(channel, v, value);
        EXPECT_EQ(value.data, expected.data) << "view " << v << ", channel " << channel;
      }
    EXPECT_EQ(kept->samples.size(), 81u * 12u);
    for (const BtfSample& sample : kept->samples)
      for (int channel = 0; channel < 3; ++channel) {
        whole->read(channel, sample.view, value);
        EXPECT_EQ(sample.ycc[channel], value(sample.texel.y * side + sample.texel.x, sample.light));
      }
  }
}

TEST(Downsample, OddSidesKeepMeanAndPosition) {
  for (const int side : {3, 5, 25}) {
    Matrix ramp(side * side, 1);
    for (int t = 0; t < side * side; ++t) ramp(t, 0) = (t % side + 0.5) / side + 10 * (t / side + 0.5) / side;
    const int half = side / 2;
    const Matrix coarse = downsample(ramp, side, BoxFilter::k2x2);
    double mean = 0;
    for (const double value : coarse.data) mean += value / double(coarse.rows);
    EXPECT_NEAR(mean, 5.5, 1e-12);
    // A box around the coarse texel's centre reads a ramp there, but for the steps of the fine texels.
    for (int t = 0; t < coarse.rows; ++t)
      EXPECT_NEAR(coarse(t, 0), (t % half + 0.5) / half + 10 * (t / half + 0.5) / half, 11 * 0.25 / side)
          << side;
  }
}

TEST(MeanFirst, KeepsTheAverageExactThroughMips) {
  const SyntheticSource source = parallaxSource(8);
  const auto m = cookLod(source, {});
  ASSERT_TRUE(m.ok());
  const Evaluator evaluator(*m);
  const glm::dvec3 wi = source.lights().samples[30], wo = source.views().samples[50];
  glm::dvec3 mean(0);
  for (int t = 0; t < 64; ++t)
    mean += glm::dvec3(0.9, 0.7, 0.4) * wave(parallax(glm::dvec2(t % 8 + 0.5, t / 8 + 0.5) / 8.0, wo)) *
            wi.z / 64.0;
  const glm::dvec3 value = evaluator.evaluate(evaluator.findHit(glm::dvec2(0.3), 10.0, wo), wi, wo);
  EXPECT_NEAR(value.x, mean.x, 0.002);  // 8-bit tables
  EXPECT_NEAR(value.y, mean.y, 0.002);
}

}  // namespace
}  // namespace loden::importer
