// Cooked near terms: closer than a band of many components, and the same at any number of threads.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "importer/bake/bake.h"
#include "importer/base/random.h"
#include "importer/cook/cook.h"
#include "importer/cook/level_choice.h"
#include "importer/fit/sampled_error.h"
#include "importer/fit/surface_light.h"
#include "material/asset/asset.h"
#include "material/eval/evaluate.h"

namespace loden::importer {
namespace {

class FitNear : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = (std::filesystem::temp_directory_path() / "loden_near_XXXXXX").string();
    ASSERT_NE(::mkdtemp(folder_.data()), nullptr);
    BakeOptions options;
    options.size = 16;
    options.geometry_size = 64;
    options.directions = concentricDirections(5);
    options.vdims = {};
    options.maps = {.btf = true, .flat = false, .vdim = false, .surface = true};
    options.quiet = true;
    const auto tile = builtinTile("button");
    ASSERT_TRUE(tile.ok());
    const auto report = bake(*tile, "builtin:button", folder_, options);
    ASSERT_TRUE(report.ok()) << report.issue().text;
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  static Material cooked(CookOptions options) {
    options.quiet = true;
    auto material = cook(*BakedOutput::open(folder_), options);
    EXPECT_TRUE(material.ok()) << (material.ok() ? "" : material.issue().text);
    return std::move(*material);
  }
  static double errorOf(const Material& material) {
    const auto source = bakedSource(*BakedOutput::open(folder_));
    const auto btf = loadHalved(**source, 4000, 0);
    const Evaluator evaluator(material);
    return sampledError(evaluator, btf->samples, (*source)->lights(), (*source)->views(), 2, 0)
        .channel[0]
        .rmse();
  }
  static std::string folder_;
};
std::string FitNear::folder_;

TEST_F(FitNear, IsCloserThanABandOfComponents) {
  const double near = errorOf(cooked({})), band = errorOf(cooked({.near = Near::kBand}));
  EXPECT_LT(near, 0.8 * band) << near << " and " << band;
}

TEST_F(FitNear, ShadowsArePartOfIt) {
  const Material with = cooked({.visibility = Visibility::kFast}),
                 without = cooked({.visibility = Visibility::kNone});
  EXPECT_LT(errorOf(with), 0.7 * errorOf(without));
  const auto chosen = cooked({});
  EXPECT_NE(chosen.surface->visibility, Visibility::kNone);
}

TEST_F(FitNear, AMapOfShadowsIsNearlyAsClose) {
  const Material map = cooked({.visibility = Visibility::kMap}),
                 lookup = cooked({.visibility = Visibility::kFast}),
                 without = cooked({.visibility = Visibility::kNone});
  EXPECT_LT(errorOf(map), 0.75 * errorOf(without));
  EXPECT_LT(errorOf(map), 1.5 * errorOf(lookup));
  const auto raw = [](const Material& m) { return int(nlohmann::json::parse(m.meta_json)["raw_bytes"]); };
  EXPECT_EQ(raw(map) - raw(lookup),
            int(map.surface->shadow.data.size() + map.surface->shadow_table.data.size()));
}

TEST_F(FitNear, DoesNotDependOnThreads) {
  for (const auto visibility : {std::optional<Visibility>(), std::optional(Visibility::kMap)}) {
    const auto one = serializeAsset(cooked({.visibility = visibility, .threads = 1})),
               three = serializeAsset(cooked({.visibility = visibility, .threads = 3}));
    ASSERT_TRUE(one.ok() && three.ok());
    EXPECT_TRUE(*one == *three);
  }
}

GeometryImage bumps(int side) {
  std::vector<glm::dvec3> positions;
  for (int t = 0; t < side * side; ++t) {
    const glm::dvec2 p = (glm::dvec2(t % side, t / side) + 0.5) / double(side);
    positions.emplace_back(p, 0.12 * (std::cos(2 * kPi * p.x) * std::cos(2 * kPi * p.y) - 1));
  }
  return encodeGeometryImage(side, positions, std::vector<uint16_t>(positions.size(), 1), true);
}

// Bumps that shade each other: the clamped sum of eight components leaves half of what a plain one does.
TEST(SurfaceLight, FitsTheEdgesOfShadows) {
  constexpr int kSide = 32;
  const GeometryImage image = bumps(kSide);
  const std::vector<glm::dvec3> directions = shadowDirections(9);
  const SurfaceLight light = surfaceLight(image, kSide, directions, 2, 0);
  const auto errorOf = [&](const Factors& f) {
    double squares = 0, all = 0;
    for (int t = 0; t < light.open.rows; ++t)
      for (int l = 0; l < light.open.cols; ++l) {
        double shadow = 0;
        for (int c = 0; c < f.components(); ++c) shadow += f.weights(t, c) * f.basis(l, c);
        const double lit = light.open(t, l) * (1 - std::clamp(shadow, 0.0, 1.0));
        squares += std::pow(lit - light.lit(t, l), 2);
        all += std::pow(light.open(t, l) - light.lit(t, l), 2);
      }
    return std::sqrt(squares / all);
  };
  Matrix shadow(light.open.rows, light.open.cols);
  for (size_t i = 0; i < shadow.data.size(); ++i)
    if (light.open.data[i] > 0) shadow.data[i] = 1 - light.lit.data[i] / light.open.data[i];
  const double fitted = errorOf(fitShadow(light, 8, 0)), plain = errorOf(leadingFactors(blocksOf(shadow), 8));
  EXPECT_LT(fitted, 0.5 * plain) << fitted << " and " << plain;
  EXPECT_LT(fitted, 0.2) << "of what no shadows at all leave";
}

// Directions of equal solid angle.
std::vector<glm::dvec3> equalDirections(int rows) {
  std::vector<glm::dvec3> directions;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < 2 * rows; ++column)
      directions.push_back(
          directionFromSpherical({std::acos((row + 0.5) / rows), kPi * (column + 0.5) / rows}));
  return directions;
}

// A white surface under a white sky reflects it everywhere, however deep, once all light has found its way
// out. Where the surface is deep, direct light alone would miss that by several times what is allowed.
TEST(SurfaceLight, WhiteSurfacesUnderAWhiteSkyAreWhite) {
  constexpr int kSide = 24, kBounces = 40;
  constexpr double kAllowed = 0.04;
  const GeometryImage image = bumps(kSide);
  const std::vector<glm::dvec3> directions = equalDirections(8);
  const Matrix lit = surfaceLight(image, kSide, directions, 2, 0).lit;
  const std::vector<glm::vec3> albedo(size_t(kSide * kSide), glm::vec3(1));
  const Matrix indirect = indirectLight(image, kSide, lit, directions, albedo, kBounces, 2, 0);
  double least = 1;
  for (int t = 0; t < kSide * kSide; ++t) {
    double sky = 0;
    for (int l = 0; l < lit.cols; ++l) sky += lit(t, l) * 2.0 / double(directions.size());
    least = std::min(least, sky);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(sky + indirect(t, 4 * c) + 2.0 / 3 * indirect(t, 4 * c + 1), 1, kAllowed) << t;
  }
  EXPECT_LT(least, 1 - 3 * kAllowed) << "too shallow to say something";
}

// One bounce, colour by colour, is what rays gather light by light.
TEST(SurfaceLight, IndirectLightIsThatOfRays) {
  constexpr int kSide = 24;
  const GeometryImage image = bumps(kSide);
  const GeometryTracer tracer(image);
  const std::vector<glm::dvec3> directions = equalDirections(6);
  const Matrix lit = surfaceLight(image, kSide, directions, 2, 0).lit;
  std::vector<glm::vec3> albedo;
  for (int t = 0; t < kSide * kSide; ++t)
    albedo.push_back(t % kSide < kSide / 2 ? glm::vec3(0.9f, 0.4f, 0.1f) : glm::vec3(0.2f, 0.4f, 0.8f));
  const Matrix indirect = indirectLight(image, kSide, lit, directions, albedo, 1, 2, 0);
  double squares[3] = {}, all[3] = {};
  for (int t = 5; t < kSide * kSide; t += 37) {
    const auto point = surfaceAt<double>(image, (glm::dvec2(t % kSide, t / kSide) + 0.5) / double(kSide));
    std::vector<glm::dvec3> gathered(directions.size(), glm::dvec3(0));
    constexpr int kRays = 24;
    for (int k = 0; k < kRays * kRays; ++k) {
      const auto hit =
          tracer.trace(point.position + 2e-3 * point.normal,
                       cosineDirection(point.normal, (k % kRays + 0.5) / kRays, (k / kRays + 0.5) / kRays));
      if (!hit) continue;
      const glm::dvec2 p = hit->p - glm::floor(hit->p);
      const glm::dvec3 color(albedo[size_t(int(p.y * kSide) * kSide + int(p.x * kSide))]);
      for (size_t l = 0; l < directions.size(); ++l) {
        const double cosine = glm::dot(hit->normal, directions[l]);
        if (cosine > 0 && !tracer.occluded(hit->position + 2e-3 * hit->normal, directions[l]))
          gathered[l] += color * (cosine / (kRays * kRays));
      }
    }
    for (size_t l = 0; l < directions.size(); ++l)
      for (int c = 0; c < 3; ++c) {
        const glm::dvec3& w = directions[l];
        const double value = w.z * (indirect(t, 4 * c) + indirect(t, 4 * c + 1) * w.z +
                                    indirect(t, 4 * c + 2) * w.x + indirect(t, 4 * c + 3) * w.y);
        squares[c] += std::pow(value - gathered[l][c], 2), all[c] += gathered[l][c] * gathered[l][c];
      }
  }
  for (int c = 0; c < 3; ++c) EXPECT_LT(std::sqrt(squares[c] / all[c]), 0.25);
}

// Without surface, or on a plane, all light arrives.
TEST(SurfaceLight, NothingShadesAPlane) {
  const std::vector<glm::dvec3> directions = shadowDirections(5);
  const SurfaceLight light = surfaceLight({}, 4, directions, 2, 0);
  for (int l = 0; l < light.open.cols; ++l)
    for (int t = 0; t < 16; ++t) {
      EXPECT_EQ(light.open(t, l), directions[size_t(l)].z);
      EXPECT_EQ(light.lit(t, l), light.open(t, l));
    }
  const Factors factors = fitShadow(light, 4, 0);
  for (const double w : factors.weights.data) EXPECT_TRUE(std::isfinite(w));
  for (const double e : factors.basis.data) EXPECT_NEAR(e, 0, 1e-9);
}

TEST(SurfaceLight, APlaneSendsItselfNothing) {
  std::vector<glm::dvec3> positions;
  for (int t = 0; t < 64; ++t) positions.emplace_back((t % 8 + 0.5) / 8, (t / 8 + 0.5) / 8, 0);
  const GeometryImage plane =
      encodeGeometryImage(8, positions, std::vector<uint16_t>(positions.size(), 1), true);
  const std::vector<glm::dvec3> directions = equalDirections(4);
  const Matrix lit = surfaceLight(plane, 8, directions, 2, 0).lit;
  const Matrix none =
      indirectLight(plane, 8, lit, directions, std::vector<glm::vec3>(64, glm::vec3(1)), 3, 2, 0);
  for (const double value : none.data) EXPECT_EQ(value, 0);
}

// The near term whose indirect light is `share` of what the material has.
Material withIndirect(Material material, float share) {
  Texture& map = material.surface->indirect;
  for (int mip = 0; mip < map.mips; ++mip)
    for (int t = 0; t < map.mipWidth(mip) * map.mipHeight(mip); ++t) {
      const int x = t % map.mipWidth(mip), y = t / map.mipWidth(mip);
      const glm::vec4 color = std::sqrt(share) * glm::vec4(fetchTexel(map, mip, x, y, 0));  // of square roots
      EXPECT_LE(std::max({color.x, color.y, color.z}), 1.0f) << "the format's range";
      storeTexel(map, mip, x, y, 0, color);
    }
  return material;
}

// Light that was reflected more than once is part of the near term, at its right strength. The bake's noise
// adds the same to every error, so that no error can be compared with a limit; which of several strengths is
// the closest does not depend on it.
TEST(CookNear, LightByWayOfTheTileIsPartOfIt) {
  std::string folder = (std::filesystem::temp_directory_path() / "loden_bounced_XXXXXX").string();
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  BakeOptions options;
  options.size = 16;
  options.geometry_size = 64;
  options.directions = concentricDirections(5);
  options.vdims = {};
  options.bounces = 2;
  options.supersample = 4;  // one path for each sample
  options.maps = {.btf = true, .flat = false, .vdim = false, .surface = true};
  options.quiet = true;
  ASSERT_TRUE(bake(*builtinTile("sponge"), "builtin:sponge", folder, options).ok());
  const auto baked = BakedOutput::open(folder);
  const auto cooked = [&](int threads, std::optional<Visibility> visibility = {}, Mode mode = Mode::kFused) {
    auto material = cook(*baked, {.mode = mode, .visibility = visibility, .threads = threads, .quiet = true});
    EXPECT_TRUE(material.ok());
    return std::move(*material);
  };
  const Material with = cooked(1);
  const auto meta = nlohmann::json::parse(with.meta_json);
  EXPECT_EQ(meta["near"]["indirect"], true);
  const auto source = bakedSource(*baked);
  const auto btf = loadHalved(**source, 4000, 0);
  const auto errorOf = [&](const Material& m) {
    return sampledError(Evaluator(m), btf->samples, (*source)->lights(), (*source)->views(), 2, 0)
        .channel[0]
        .rmse();
  };
  const double error = errorOf(with);
  for (const float other : {0.0f, 0.5f, 1.5f})
    EXPECT_LT(error, errorOf(withIndirect(with, other))) << other << " of it is closer";
  EXPECT_EQ(with.surface->indirect.mips, with.surface->ambient.mips);
  const auto one = serializeAsset(with), three = serializeAsset(cooked(3));
  ASSERT_TRUE(one.ok() && three.ok());
  EXPECT_TRUE(*one == *three);
  EXPECT_EQ(cooked(0, Visibility::kNone, Mode::kSurface).surface->indirect.width, 0) << "as published";
  EXPECT_GT(cooked(0, Visibility::kFast, Mode::kSurface).surface->indirect.width, 0);
  std::filesystem::remove_all(folder);
}

TEST_F(FitNear, SaysWhatItMeasured) {
  const Material material = cooked({});
  const auto meta = nlohmann::json::parse(material.meta_json);
  EXPECT_EQ(meta["near"]["lobe"], "phong");
  EXPECT_EQ(meta["near"]["side"], 32);
  EXPECT_FALSE(meta["near"].contains("indirect")) << "direct light alone was baked";
  EXPECT_EQ(material.surface->indirect.width, 0);
  EXPECT_EQ(meta["error"]["evaluations"], 4);
  EXPECT_LT(double(meta["error"]["y"]["rmse"]), double(meta["error_of_one_evaluation"]["y"]["rmse"]) * 1.05);
  EXPECT_NEAR(double(meta["error"]["y"]["rmse"]), errorOf(material), 0.2 * errorOf(material));
  EXPECT_GE(material.surface->fade_begin, 0.25f);
  EXPECT_LE(material.surface->fade_end, 3.0f);
}

// Where the bands stand alone, each level reads so many quads that the error is as promised, and no more.
TEST_F(FitNear, LevelsReadAsManyQuadsAsTheyNeed) {
  const Material material = cooked({});
  const auto levels = nlohmann::json::parse(material.meta_json)["levels"];
  ASSERT_EQ(levels.size(), size_t(material.lambda_max));
  const Band& band = material.bands.back();
  int fewest = band.quads();
  for (size_t i = 0; i < levels.size(); ++i) {
    const double lambda = levels[i]["level"];
    if (lambda < double(material.surface->fade_end)) continue;
    const auto rmse = levels[i]["quads_rmse_rgb"].get<std::vector<double>>();
    ASSERT_EQ(rmse.size(), size_t(band.quads()));
    size_t count = 1;
    while (count < rmse.size() && quadShare(band, int(count), lambda) > 0) ++count;
    EXPECT_EQ(quadShare(band, int(count) - 1, lambda), 1) << "whole at a level that needs it";
    EXPECT_LE(rmse[count - 1], std::max(kQuadFloor, (1 + kQuadLoss) * rmse.back()) + 1e-12) << lambda;
    fewest = std::min(fewest, int(count));
  }
  EXPECT_EQ(fewest, 1) << "the average of the whole tile has one component";
}

TEST_F(FitNear, GoalsChooseItsSizes) {
  const Material small = cooked({.max_bytes = 150000}), close = cooked({.target_rmse = 0.03});
  const auto bytes = [](const Material& m) {
    return double(nlohmann::json::parse(m.meta_json)["raw_bytes"]);
  };
  EXPECT_LE(bytes(small), 150000);
  EXPECT_LE(double(nlohmann::json::parse(close.meta_json)["error"]["y"]["rmse"]), 0.03);
}

}  // namespace
}  // namespace loden::importer
