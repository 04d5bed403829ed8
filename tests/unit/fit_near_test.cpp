// Cooked near terms: closer than a band of many components, and the same at any number of threads.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "importer/bake/bake.h"
#include "importer/cook/cook.h"
#include "importer/fit/sampled_error.h"
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
    const auto btf = loadYcc(**source, 0);
    const Evaluator evaluator(material);
    return sampledError(evaluator, *btf, (*source)->lights(), (*source)->views(), 2, 4000, 0)
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

TEST_F(FitNear, DoesNotDependOnThreads) {
  const auto one = serializeAsset(cooked({.threads = 1})), three = serializeAsset(cooked({.threads = 3}));
  ASSERT_TRUE(one.ok() && three.ok());
  EXPECT_TRUE(*one == *three);
}

TEST_F(FitNear, SaysWhatItMeasured) {
  const Material material = cooked({});
  const auto meta = nlohmann::json::parse(material.meta_json);
  EXPECT_EQ(meta["near"]["lobe"], "phong");
  EXPECT_EQ(meta["near"]["side"], 32);
  EXPECT_EQ(meta["error"]["evaluations"], 4);
  EXPECT_LT(double(meta["error"]["y"]["rmse"]), double(meta["error_of_one_evaluation"]["y"]["rmse"]) * 1.05);
  EXPECT_NEAR(double(meta["error"]["y"]["rmse"]), errorOf(material), 0.2 * errorOf(material));
  EXPECT_GE(material.surface->fade_begin, 0.25f);
  EXPECT_LE(material.surface->fade_end, 3.0f);
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
