// The fused mode end to end on a picture that lies under the reference plane: identity parameterization, z =
// -0.08.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "importer/cook/goal.h"
#include "importer/cook/meta.h"
#include "importer/cook/modes.h"
#include "importer/fit/coarse_fit.h"
#include "importer/fit/grid_table.h"
#include "importer/fit/reduction.h"
#include "material/base/issues.h"
#include "material/eval/evaluate.h"
#include "material/model/leading_part.h"
#include "tests/unit/fit_synthetic.h"

namespace loden::importer {
namespace {

constexpr double kDepth = 0.08;
constexpr int kSide = 16;

double wave(glm::dvec2 p) {
  return 0.5 + 0.2 * std::sin(2 * kPi * p.x) + 0.15 * std::cos(2 * kPi * (p.x + 2 * p.y));
}

SyntheticSource sunkenPicture() {
  return {kSide, bonn81Directions(), [](glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3& wo) {
            return glm::dvec3(0.9, 0.7, 0.4) * wave(x - kDepth * glm::dvec2(wo) / wo.z) * wi.z;
          }};
}

GeometryImage sunkenPlane(int side) {
  std::vector<glm::dvec3> positions;
  for (int t = 0; t < side * side; ++t)
    positions.emplace_back((t % side + 0.5) / side, (t / side + 0.5) / side, -kDepth);
  return encodeGeometryImage(side, positions, std::vector<uint16_t>(positions.size(), 1), true);
}

FusedPlan smallPlan() {
  FusedPlan plan;
  plan.y_components = 4;
  plan.flat_scale = 2;
  return plan;
}

// The coarse band may take fewer columns than the plan allows.
FusedPlan asFitted(FusedPlan plan, const Material& material) {
  plan.coarse_phis = tableGrid(material.bands.back(), material.theta_max).phis;
  return plan;
}

TEST(Fused, BeatsThePlaneOnParallax) {
  const SyntheticSource source = sunkenPicture();
  const auto btf = loadYcc(source, 0);
  const FusedFit fused = fitFusedBands(source, *btf, sunkenPlane(32), smallPlan(), 0);
  CookOptions options;
  options.y_components = 4;
  const auto lod = fitLod(source, *btf, options);
  const double plane = measureError(*lod, *btf, source.lights(), source.views(), {}, 0).channel[0].rmse();
  EXPECT_LT(fused.error.channel[0].rmse(), 0.01);
  EXPECT_GT(plane, 4 * fused.error.channel[0].rmse());
  EXPECT_EQ(rawFileBytes(fused.material), fusedBytes(asFitted(smallPlan(), fused.material), kSide, 32));
}

TEST(Fused, SameBytesAtAnyThreadCount) {
  const SyntheticSource source = sunkenPicture();
  const auto btf = loadYcc(source, 0);
  const FusedFit one = fitFusedBands(source, *btf, sunkenPlane(32), smallPlan(), 1);
  const FusedFit three = fitFusedBands(source, *btf, sunkenPlane(32), smallPlan(), 3);
  for (size_t b = 0; b < one.material.bands.size(); ++b) {
    EXPECT_EQ(one.material.bands[b].weights.data, three.material.bands[b].weights.data);
    EXPECT_EQ(one.material.bands[b].table.data, three.material.bands[b].table.data);
  }
  EXPECT_EQ(one.error.channel[0].mse, three.error.channel[0].mse);
}

// Three faint patterns that a quarter of the tile does not average away, and eight strong ones that it does;
// each seen under its own directions.
SyntheticSource patterns() {
  return {2 * kSide, bonn81Directions(), [](glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3& wo) {
            double sum = 0.5;
            for (int k = 0; k < 11; ++k) {
              const bool faint = k < 3;
              const int across = faint ? (k + 1) & 1 : (k - 2) % 3 * 4,
                        up = faint ? (k + 1) >> 1 : (k - 2) / 3 * 4;
              sum += (faint ? 0.01 : 0.1) * std::sin(2 * kPi * (across * x.x + up * x.y)) *
                     std::cos((k + 1) * wi.x + (k % 5) * wo.y);
            }
            return glm::dvec3(sum);
          }};
}

// What far pixels show stands in the first quad: of what the levels of at most four texels along a side hold,
// each of its components has more than any of the others.
TEST(Fused, CoarseLevelsNeedTheFirstQuad) {
  const SyntheticSource source = patterns();
  const auto btf = loadYcc(source, 0);
  const YccBtf half = downsample(*btf, BoxFilter::k2x2, 0);
  CoarseFitOptions options;
  options.y_components = 12;
  options.grid = gridFor(source.lights(), 6, 11);
  const Matrix nothing(source.views().size() * source.lights().size(), 3);
  const Factors y = fitCoarse(half, source.lights(), source.views(), nothing, options).y;
  std::vector<double> squares(11);
  Matrix level = y.weights;
  for (int side = half.side() / 2; side > 1; side /= 2) {
    level = downsample(level, 2 * side, BoxFilter::k2x2);
    if (side > 4) continue;
    // Twice as much for each level, and of a mean.
    const double weight = std::pow(double(half.side()) / side, 3);
    for (int c = 0; c < 11; ++c)
      for (const double value : level.col(c + 1)) squares[size_t(c)] += weight * value * value;
  }
  EXPECT_GT(squares[2], 0);
  for (size_t later = 3; later < 11; ++later) EXPECT_LE(squares[later], squares[2]) << later;
}

// Yellow highlights on blue cloth, each with its own pattern; `yellow` is the colour of the highlights.
SyntheticSource shinyCloth(const glm::dvec3& yellow) {
  return {kSide, bonn81Directions(), [yellow](glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3& wo) {
            const double shine = std::pow(glm::normalize(wi + wo).z, 12);
            return wi.z * (glm::dvec3(0.1, 0.15, 0.4) * wave(x) + yellow * shine * (1.2 - wave(x)));
          }};
}

FusedFit nearFit(const SyntheticSource& source, std::optional<int> coarse_chroma) {
  BakedSurface surface;
  surface.side = kSide;
  surface.maps.normal.assign(kSide * kSide, glm::vec3(0, 0, 1));
  surface.maps.diffuse.assign(kSide * kSide, glm::vec3(0.3f));
  surface.maps.specular.assign(kSide * kSide, glm::vec2(0, 1));
  FusedPlan plan;
  plan.surface_side = kSide;
  plan.visibility = Visibility::kNone;
  plan.coarse_y = coarse_chroma ? 12 - 2 * *coarse_chroma : 12;
  plan.coarse_chroma = coarse_chroma;
  return fitFusedNear(source, *loadHalved(source, 1000, 0), surface, sunkenPlane(16), plan, 0);
}

// One ratio of chroma to luma per texel cannot give cloth and highlights of different colours. Quads hold
// chroma in place of luma where that is closer, at the same bytes, and none where all is of one colour.
TEST(Fused, QuadsHoldChromaWhereOneRatioDoesNotDo) {
  const SyntheticSource two_colors = shinyCloth({0.6, 0.4, 0.1}), one_color = shinyCloth({0.2, 0.3, 0.8});
  const FusedFit chosen = nearFit(two_colors, {}), ratios = nearFit(two_colors, 0);
  const Band& band = chosen.material.bands.back();
  EXPECT_GT(band.chroma_quads, 0);
  EXPECT_EQ(band.quads(), 3);
  EXPECT_EQ(rawFileBytes(chosen.material), rawFileBytes(ratios.material));
  for (size_t level = 0; level + 1 < chosen.levels.size(); ++level)
    EXPECT_LT(chosen.levels[level].bands_mse(), 0.2 * ratios.levels[level].bands_mse()) << level + 1;
  const FusedFit plain = nearFit(one_color, {});
  EXPECT_EQ(plain.material.bands.back().chroma_quads, 0);
  EXPECT_EQ(plain.material.bands.back().weights.data,
            nearFit(one_color, 0).material.bands.back().weights.data);
}

// A plan may name the components of chroma; the leading part has none.
TEST(Fused, PlansMayNameChroma) {
  const FusedFit fit = nearFit(shinyCloth({0.6, 0.4, 0.1}), 4);
  const Band& band = fit.material.bands.back();
  EXPECT_EQ(band.y_quads, 1);
  EXPECT_EQ(band.chroma_quads, 2);
  EXPECT_TRUE(fit.chroma.empty());
  EXPECT_EQ(leadOf(band).chroma_quads, 0);
}

// No step above one 8-bit code of white for a lambda change of 0.01; and the far end is the exact average.
TEST(Fused, ContinuousInLambdaDownToTheAverage) {
  const SyntheticSource source = sunkenPicture();
  const auto btf = loadYcc(source, 0);
  const FusedFit fit = fitFusedBands(source, *btf, sunkenPlane(32), smallPlan(), 0);
  const Evaluator evaluator(fit.material);
  for (const int pair : {0, 1234, 4321, 6000}) {
    const glm::dvec3 wi = source.lights().samples[size_t(pair % 81)],
                     wo = source.views().samples[size_t(pair / 81)];
    const glm::dvec2 x(0.23, 0.71);
    glm::dvec3 last = evaluator.evaluate(evaluator.findHit(x, 0.0, wo), wi, wo);
    for (int i = 1; i <= 600; ++i) {
      const glm::dvec3 value = evaluator.evaluate(evaluator.findHit(x, 0.01 * i, wo), wi, wo);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], last[c], 1.0 / 255) << "lambda " << 0.01 * i;
      last = value;
    }
    double average = 0;
    for (int t = 0; t < kSide * kSide; ++t)
      average +=
          wave(glm::dvec2(t % kSide + 0.5, t / kSide + 0.5) / double(kSide) - kDepth * glm::dvec2(wo) / wo.z);
    EXPECT_NEAR(last.x, 0.9 * wi.z * average / (kSide * kSide), 0.0018);  // 55 dB
  }
}

TEST(AtlasChoice, AShallowTileGetsASmallAtlas) {
  std::vector<glm::dvec3> steep, shallow;
  for (int t = 0; t < 64 * 64; ++t) {
    const glm::dvec2 p((t % 64 + 0.5) / 64, (t / 64 + 0.5) / 64);
    const double wave = 0.5 + 0.25 * std::sin(4 * kPi * p.x) + 0.25 * std::sin(6 * kPi * p.y);
    steep.emplace_back(p, -0.4 * wave), shallow.emplace_back(p, -0.01 * wave);
  }
  const std::vector<uint16_t> charts(steep.size(), 1);
  const AtlasChoice deep = chooseAtlas(encodeGeometryImage(64, steep, charts, true), 64, 0),
                    flat = chooseAtlas(encodeGeometryImage(64, shallow, charts, true), 64, 0);
  EXPECT_LE(vdimDepthBytes(flat.size), kMostAtlasBytes / 8);
  EXPECT_GT(vdimDepthBytes(deep.size), kMostAtlasBytes / 2);
}

// What a finer image of heights takes on the GPU is less for the depths.
TEST(AtlasChoice, FinerHeightsTakeBytesOfTheDepths) {
  const auto bytes = [](int side, bool heights) {
    GeometryImage image;
    image.texels = Texture::make(TexelFormat::kRGBA16Unorm, TextureShape::kArray2D, side, side, 1, 1);
    image.identity_parameterization = heights;
    return mostAtlasBytes(image);
  };
  EXPECT_EQ(bytes(64, true), kMostAtlasBytes);
  EXPECT_EQ(bytes(128, true), kMostAtlasBytes);
  EXPECT_EQ(bytes(256, true), kMostAtlasBytes - 2 * (256 * 256 - 128 * 128));
  EXPECT_EQ(bytes(1024, true), kMostAtlasBytes / 2);
  EXPECT_EQ(bytes(256, false), kMostAtlasBytes);
}

// The lookup of the fit is that of the asset: the split of texels and directions that errs least on this
// geometry, and the asset says so.
TEST(Fused, AssetNamesTheAtlasThatItWasFittedThrough) {
  const SyntheticSource source = sunkenPicture();
  const auto btf = loadYcc(source, 0);
  std::vector<glm::dvec3> ridges;
  for (int t = 0; t < 32 * 32; ++t) {
    const glm::dvec2 p((t % 32 + 0.5) / 32, (t / 32 + 0.5) / 32);
    ridges.emplace_back(p, -0.15 - 0.15 * std::sin(6 * kPi * p.x));
  }
  const GeometryImage geometry =
      encodeGeometryImage(32, ridges, std::vector<uint16_t>(ridges.size(), 1), true);
  FusedPlan plan = smallPlan();
  plan.coarse_y = 0;
  const FusedFit fit = fitFusedBands(source, *btf, geometry, plan, 0);
  ASSERT_GT(fit.atlases.size(), atlasCandidates().size());  // and smaller ones
  const LookupProbe probe(geometry, kSide, 0);
  const auto badness = [&](VdimAtlasSize size) {
    const LookupError e = probe.measure(buildVdimAtlas(geometry, size), Lookup::kDefault);
    return e.mean_texels * e.over_1_texel;
  };
  for (const VdimAtlasSize size : atlasCandidates()) {
    EXPECT_LE(badness(fit.material.atlas), 1.1 * badness(size))
        << size.texels << " texels, " << size.directions << " directions";
    EXPECT_LE(vdimDepthBytes(size), kMostAtlasBytes);
  }
  EXPECT_GT(badness(fit.material.atlas), 0);
  const std::string meta = cookMeta(fit.material, "test", "game", &fit.error, {}, fit.atlases);
  EXPECT_NE(meta.find("\"atlas_texels\":" + std::to_string(fit.material.atlas.texels) + ","),
            std::string::npos)
      << meta;

  plan.atlas = VdimAtlasSize{12, 6};
  const FusedFit named = fitFusedBands(source, *btf, geometry, plan, 0);
  EXPECT_EQ(named.material.atlas, *plan.atlas);
  EXPECT_TRUE(named.atlases.empty());
  EXPECT_EQ(residentBytes(fit.material) - residentBytes(named.material),
            vdimDepthBytes(fit.material.atlas) + vdimDepthBytes(kFirstVdimAtlas) - vdimDepthBytes({12, 6}));
}

TEST(Fused, LevelsKeepTheFinest) {
  const SyntheticSource source = sunkenPicture();
  const auto btf = loadYcc(source, 0);
  FusedPlan plan = smallPlan();
  const FusedFit all = fitFusedBands(source, *btf, sunkenPlane(32), plan, 0);
  plan.levels = 3;
  const FusedFit three = fitFusedBands(source, *btf, sunkenPlane(32), plan, 0);
  ASSERT_EQ(three.material.bands.size(), 2u);
  EXPECT_EQ(three.material.lambda_max, 2.5f) << "the coarse band is read half a level finer";
  EXPECT_EQ(rawFileBytes(three.material), fusedBytes(asFitted(plan, three.material), kSide, 32));
  EXPECT_LT(rawFileBytes(three.material), rawFileBytes(all.material));
  plan.levels = 1;
  const FusedFit one = fitFusedBands(source, *btf, sunkenPlane(32), plan, 0);
  ASSERT_EQ(one.material.bands.size(), 1u);
  EXPECT_EQ(rawFileBytes(one.material), fusedBytes(plan, kSide, 32));
  EXPECT_EQ(one.error.channel[0].mse, all.error.channel[0].mse);  // at lambda 0 nothing is missing
  // Up to the last level kept the values are those of all levels; beyond it, that level's.
  const Evaluator whole(all.material), kept(three.material), alone(one.material);
  const glm::dvec3 wi = source.lights().samples[30], wo = source.views().samples[50];
  const auto at = [&](const Evaluator& e, double lambda) {
    return e.evaluate(e.findHit(glm::dvec2(0.23, 0.71), lambda, wo), wi, wo).x;
  };
  for (const double lambda : {0.0, 1.0, 1.5, 2.0, 2.5})
    EXPECT_EQ(at(kept, lambda), at(whole, lambda)) << lambda;
  EXPECT_EQ(at(kept, 4.0), at(kept, 2.5));
  EXPECT_EQ(at(alone, 3.0), at(alone, 0.0));
  EXPECT_NE(at(whole, 3.0), at(whole, 0.0));
}

TEST(Fused, SixteenBitsRoundLess) {
  const SyntheticSource source = sunkenPicture();
  const auto btf = loadYcc(source, 0);
  FusedPlan plan = smallPlan();
  plan.phis = 25;  // tables solved directly: nothing but rounding differs
  const FusedFit eight = fitFusedBands(source, *btf, sunkenPlane(32), plan, 0);
  plan.storage = Storage::kSnorm16;
  const FusedFit sixteen = fitFusedBands(source, *btf, sunkenPlane(32), plan, 0);
  EXPECT_EQ(rawFileBytes(sixteen.material), fusedBytes(asFitted(plan, sixteen.material), kSide, 32));
  EXPECT_LT(sixteen.error.channel[0].mse, eight.error.channel[0].mse);
}

// A highlight as white as the light over a coloured picture: chroma is no multiple of luma.
TEST(Fused, ChromaComponentsCatchWhiteHighlights) {
  const SyntheticSource source(
      kSide, bonn81Directions(), [](glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3& wo) {
        const double lobe = std::pow(glm::normalize(wi + wo).z, 20);
        return glm::dvec3(0.9, 0.4, 0.1) * wave(x - kDepth * glm::dvec2(wo) / wo.z) * wi.z +
               glm::dvec3(0.5 * lobe);
      });
  const auto btf = loadYcc(source, 0);
  FusedPlan plan = smallPlan();
  const FusedFit ratio = fitFusedBands(source, *btf, sunkenPlane(32), plan, 0);
  plan.chroma_components = 2;
  const FusedFit both = fitFusedBands(source, *btf, sunkenPlane(32), plan, 0);
  EXPECT_EQ(rawFileBytes(both.material), fusedBytes(asFitted(plan, both.material), kSide, 32));
  for (const int c : {1, 2}) EXPECT_LT(both.error.channel[c].rmse(), 0.5 * ratio.error.channel[c].rmse());
}

// A table made on 17 columns is exact there and on no other number.
TEST(AverageGrid, TakesTheColumnsThatGiveTheAverage) {
  const DirectionSet set = bonn81Directions();
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const int columns : {16, 17, 18}) {
    const DirectionGrid grid = gridFor(set, 6, columns);
    Matrix table(gridDof(grid) * gridDof(grid), 1), means(81 * 81, 3);
    for (double& value : table.data) value = uniform(random);
    const Matrix at_samples = mapTables(table, gridSampling(grid, set), gridSampling(grid, set));
    std::copy(at_samples.data.begin(), at_samples.data.end(), means.data.begin());
    EXPECT_EQ(averageGrid(means, Matrix(81 * 81, 3), set, set, 18).phis, columns);
  }
}

// An error that falls with components and with the finer structures, and least with storage.
Result<double> pretended(const FusedPlan& plan) {
  return 0.3 / (4 + plan.y_components) + 0.005 / plan.flat_scale + 0.001 * (25 - plan.phis) / 12.0 +
         (plan.storage == Storage::kSnorm8 ? 1e-4 : 0);
}

TEST(Goal, LeastErrorStaysWithinTheBytes) {
  const auto choice = choosePlan({600000, 0}, 64, 128, pretended);
  ASSERT_TRUE(choice.ok());
  EXPECT_LE(fusedBytes(choice->plan, 64, choice->plan.geometry_side), 600000u);
  for (const TradePoint& p : choice->measured) {
    EXPECT_LE(p.bytes, 600000u);
    EXPECT_GE(p.rmse_y, *pretended(choice->plan));
  }
}

TEST(Goal, TargetIsMetByTheCheapestMeasured) {
  const auto choice = choosePlan({0, 0.02}, 64, 128, pretended);
  ASSERT_TRUE(choice.ok());
  EXPECT_LE(*pretended(choice->plan), 0.02);
  const uint64_t bytes = fusedBytes(choice->plan, 64, choice->plan.geometry_side);
  for (const TradePoint& p : choice->measured) EXPECT_TRUE(p.rmse_y > 0.02 || p.bytes >= bytes) << p.bytes;
}

TEST(Goal, SixteenBitsComeLast) {
  const auto sixteen = [](const Choice& choice) {
    return std::count_if(choice.measured.begin(), choice.measured.end(),
                         [](const TradePoint& p) { return p.plan.storage == Storage::kSnorm16; });
  };
  // Where bytes are short they go into components; where there are enough for everything, into storage.
  const auto tight = choosePlan({600000, 0}, 64, 128, pretended),
             ample = choosePlan({1 << 30, 0}, 64, 128, pretended);
  ASSERT_TRUE(tight.ok() && ample.ok());
  EXPECT_EQ(sixteen(*tight), 0);
  EXPECT_EQ(sixteen(*ample), 1);
  EXPECT_EQ(ample->plan.storage, Storage::kSnorm16);
  // A target that only 16 bits reach; and one that 8 bits reach.
  const double lavish = *pretended(ample->plan);
  const auto hard = choosePlan({0, lavish + 5e-5}, 64, 128, pretended),
             easy = choosePlan({0, lavish + 2e-4}, 64, 128, pretended);
  ASSERT_TRUE(hard.ok() && easy.ok());
  EXPECT_EQ(hard->plan.storage, Storage::kSnorm16);
  EXPECT_EQ(easy->plan.storage, Storage::kSnorm8);
  EXPECT_EQ(sixteen(*easy), 0);
}

TEST(Goal, HoldsWithTheLevelsAskedFor) {
  for (const int levels : {0, 1, 3}) {
    const auto choice = choosePlan({300000, 0, levels}, 64, 128, pretended);
    ASSERT_TRUE(choice.ok());
    EXPECT_EQ(choice->plan.levels, levels);
    EXPECT_LE(fusedBytes(choice->plan, 64, choice->plan.geometry_side), 300000u);
  }
  // Without the coarse band there is room for a better plan.
  EXPECT_LT(*pretended(choosePlan({300000, 0, 1}, 64, 128, pretended)->plan),
            *pretended(choosePlan({300000, 0, 0}, 64, 128, pretended)->plan));
}

TEST(Goal, SaysWhatCannotBeMet) {
  const auto bytes = choosePlan({1000, 0}, 64, 128, pretended);
  ASSERT_FALSE(bytes.ok());
  EXPECT_EQ(bytes.issue().id, issue_id::kGoal);
  const auto error = choosePlan({0, 1e-5}, 64, 128, pretended);
  ASSERT_FALSE(error.ok());
  EXPECT_EQ(error.issue().id, issue_id::kGoal);
}

TEST(Goal, ParetoFrontFallsInError) {
  const std::vector<TradePoint> front =
      paretoFront({{{}, 300, 0.1}, {{}, 100, 0.5}, {{}, 200, 0.6}, {{}, 300, 0.05}, {{}, 400, 0.05}});
  ASSERT_EQ(front.size(), 2u);
  EXPECT_EQ(front[0].bytes, 100u);
  EXPECT_EQ(front[1].bytes, 300u);
  EXPECT_EQ(front[1].rmse_y, 0.05);
}

}  // namespace
}  // namespace loden::importer
