// Bakes of small tiles: light, periodicity, determinism, interruption, refusals.
#include "importer/bake/bake_scene.h"
#include "importer/base/random.h"
#include "importer/cook/cook.h"
#include "importer/cook/modes.h"
#include "importer/fit/lookup_error.h"
#include "importer/tile/tile_tracer.h"
#include "material/base/issues.h"
#include "material/model/vdim.h"
#include "tests/unit/small_bakes.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;
using namespace testing;  // NOLINT: small tiles and bakes

TEST(Bake, FlatWhiteLambertGivesTheCosine) {
  const TemporaryFolder folder;
  const BakedOutput output = baked(flatTile(), folder.path(), smallBake());
  const auto& directions = output.manifest().directions.samples;
  for (int view = 0; view < int(directions.size()); ++view) {
    const auto btf = *output.btfView(view), flat = *output.flatView(view);
    ASSERT_EQ(btf.size(), directions.size() * 64);
    for (size_t k = 0; k < btf.size(); ++k) {
      const double expected = directions[k / 64].z;
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(btf[k][c], expected, 1e-3);  // half floats near 1 are 5e-4 apart
        EXPECT_NEAR(flat[k][c], expected, 1e-3);
      }
    }
    const auto visible = *output.visibleView(view);
    for (const float v : visible) EXPECT_EQ(v, 1);
  }
  const auto vdim = *output.vdim(4, 5);
  for (const glm::vec2& v : vdim) EXPECT_LT(glm::length(v), 1e-5);
  const auto geometry = *output.geometry();
  for (const glm::vec4& g : geometry) EXPECT_LT(glm::length(g - glm::vec4(0, 0, 0, 1)), 1e-6);
}

TEST(Bake, FlatBtfAtItsVdimIsTheBtf) {
  // Shallow and smooth, so that nothing is hidden and both sample the same surface points.
  const Tile tile = testing::heightFieldTile(
      48, [](glm::dvec2 p) { return 0.02 * (std::sin(2 * kPi * p.x) + std::cos(2 * kPi * p.y)) - 0.04; });
  const TemporaryFolder folder;
  BakeOptions options = smallBake(32);
  options.vdims = {{2, 2}};
  const BakedOutput output = baked(tile, folder.path(), options);
  const auto btf = *output.btfView(4), flat = *output.flatView(4);  // the middle direction: straight down
  double difference = 0;
  for (size_t k = 0; k < btf.size(); ++k)
    difference = std::max(difference, double(glm::length(btf[k] - flat[k])));
  EXPECT_LT(difference, 0.02);
}

// Twice as many texels where patches between the usual ones would be off, and where they are two bytes each.
TEST(Bake, GeometryImagesOfSteepHeightFieldsAreFiner) {
  const auto sideOf = [](const Tile& tile, int geometry_size) {
    const TemporaryFolder folder;
    BakeOptions options = smallBake();
    options.maps = {.btf = false, .flat = false, .vdim = false, .surface = true};
    options.geometry_size = geometry_size;
    return baked(tile, folder.path(), options).manifest().geometry_size;
  };
  EXPECT_EQ(sideOf(testing::groovedTile(), 0), 128);
  EXPECT_EQ(sideOf(*builtinTile("sponge", 192), 0), 256);
  EXPECT_EQ(sideOf(*builtinTile("sponge", 192), 64), 64) << "as asked for";
  EXPECT_EQ(sideOf(*builtinTile("isba", 48), 0), 128) << "no height field";
}

// How far first hits are from those on the tile itself, in texels of 1/64 period.
struct HitError {
  double mean = 0;
  double over_1_texel = 0;  // share
};
template <class Hit>  // of p's position by (x, wo)
HitError hitError(const Tile& tile, const Hit& hit) {
  constexpr int kRays = 20000;
  const TileTracer tracer(tile);
  HitError error;
  for (uint64_t k = 0; k < kRays; ++k) {
    const uint64_t seed = mixSeed(0x417, k);
    const double z = 1 - uniform(seed, 0) * (1 - std::cos(kThetaMax));
    const glm::dvec3 wo = directionFromSpherical({std::acos(z), 2 * kPi * uniform(seed, 1)});
    const glm::dvec2 x(uniform(seed, 2), uniform(seed, 3));
    const auto truth = tracer.intersectView(x, wo);
    if (!truth) continue;
    const double texels = 64 * periodicDistance(hit(x, wo), glm::dvec2(truth->position));
    error.mean += texels / kRays, error.over_1_texel += (texels > 1) / double(kRays);
  }
  return error;
}

GeometryImage geometryImageOf(const Tile& tile) {
  const TemporaryFolder folder;
  BakeOptions options = smallBake();
  options.maps = {.btf = false, .flat = false, .vdim = false, .surface = true};
  options.geometry_size = 128;
  return *geometryOf(baked(tile, folder.path(), options), 0);
}

// Patches between points of a convex surface lie inside of it, and cut its edges off.
TEST(Bake, PatchesOfTheGeometryImageLieOnTheSurfaceInTheMean) {
  const Tile tile = *builtinTile("isba", 192);
  const GeometryImage image = geometryImageOf(tile);
  const GeometryTracer patches(image);
  const HitError error = hitError(tile, [&](const glm::dvec2& x, const glm::dvec3& wo) {
    const auto found = patches.traceView(x, wo);
    return found ? glm::dvec2(found->position) : x;
  });
  EXPECT_LT(error.mean, 0.06) << "texels on the surface have .09";
  EXPECT_LT(error.over_1_texel, 0.004) << "texels on the surface have .6 %";
}

// Many rays meet a chart near its silhouette, beyond which another one is.
TEST(Bake, LookupsFindTheChartsOfYarns) {
  const Tile tile = *builtinTile("weave", 192);
  const GeometryImage image = geometryImageOf(tile);
  const VdimAtlas atlas = buildVdimAtlas(image, {});
  for (const auto& [lookup, most] : {std::pair{Lookup::kDefault, 0.025}, {Lookup::kFast, 0.032}}) {
    const HitError error = hitError(tile, [&](const glm::dvec2& x, const glm::dvec3& wo) {
      return glm::dvec2(surfaceAt(image, vdimLookup({.atlas = &atlas}, lookup, x, wo).p).position);
    });
    EXPECT_LT(error.over_1_texel, most) << lookupName(lookup);
  }
}

TEST(Bake, ConcentricVdim_HoldsDepthsOfTheFirstHitOnTheRuntimesGrid) {
  const auto height = [](glm::dvec2 p) { return 0.1 * (std::cos(2 * kPi * p.x) - 1); };
  const Tile tile = testing::heightFieldTile(96, height);
  const TemporaryFolder folder;
  BakeOptions options = smallBake(8);
  options.vdims = {};
  options.concentric_vdims = {4};
  const BakedOutput output = baked(tile, folder.path(), options);
  EXPECT_EQ(output.manifest().concentric_vdims, std::vector<int>{4});
  const auto depths = *output.concentricVdim(4);
  ASSERT_EQ(depths.size(), size_t(16 * 64));
  for (size_t k = 0; k < depths.size(); ++k) {
    const glm::dvec3 wo = vdimViewFromSquare((glm::dvec2(k / 64 % 4, k / 64 / 4) + 0.5) / 4.0);
    const glm::dvec2 x = (glm::dvec2(k % 8, k % 64 / 8) + 0.5) / 8.0, slope = glm::dvec2(wo) / wo.z;
    const auto off = [&](double z) { return height(x + slope * z) - z; };  // below 0 above the surface
    // The bake looks .0022 of a texel beside the centre, and at facets of 1 / 96: depths differ by slope *
    // both.
    const double tolerance = 2e-3 * (1 + glm::length(slope));
    EXPECT_LT(std::abs(off(double(depths[k]))), tolerance);
    for (double z = 0; z > double(depths[k]) + tolerance; z -= 1e-3)
      EXPECT_LT(off(z), tolerance) << "something stands before the hit";
  }
}

// What the runtime builds when it loads an asset against what the bake stores, which traces the mesh itself.
TEST(Bake, AtlasRebuiltFromTheGeometryImageIsTheStoredConcentricVdim) {
  const Tile tile = *builtinTile("pulli", 96);
  const TemporaryFolder folder;
  BakeOptions options = smallBake(16);
  options.geometry_size = 256;
  options.maps = {.btf = false, .flat = false, .vdim = true, .surface = true};
  options.vdims = {}, options.concentric_vdims = {10};
  const BakedOutput output = baked(tile, folder.path(), options);
  const auto stored = *output.concentricVdim(10);
  const VdimAtlas atlas = buildVdimAtlas(*geometryOf(output, 0), {16, 10});
  const double range = double(atlas.geometry.range.z);
  ASSERT_EQ(stored.size(), atlas.depth.data.size());
  int apart = 0;
  double sum = 0;
  for (size_t k = 0; k < stored.size(); ++k) {
    const double codes =
        std::abs(255 * (1 + double(stored[k]) / range) - double(std::to_integer<int>(atlas.depth.data[k])));
    apart += codes > 3;
    sum += std::min(codes, 3.0);
  }
  EXPECT_LT(sum / double(stored.size()), 0.6)
      << "a quarter code of rounding, and .0022 of a texel beside the centre";
  EXPECT_LT(apart, 0.03 * double(stored.size()))
      << "rays that graze an edge of the mesh or of the image: .3 % upright, 3 % at 85 degrees";
}

// The BTF without any sharing: a shadow ray for every sample, view and light.
std::vector<glm::vec3> btfByRays(const Tile& tile, const BakeManifest& m, int view) {
  const TileTracer tracer(tile);
  const auto& directions = m.directions.samples;
  const size_t texels = size_t(m.size) * size_t(m.size);
  const int per_texel = m.supersample * m.supersample;
  std::vector<glm::vec3> values(directions.size() * texels);
  for (size_t t = 0; t < texels; ++t)
    for (int k = 0; k < per_texel; ++k) {
      const glm::dvec2 texel(double(t % size_t(m.size)), double(t / size_t(m.size)));
      const auto hit = tracer.intersectView((texel + samplePosition(k, m.supersample)) / double(m.size),
                                            directions[size_t(view)]);
      if (!hit) continue;
      for (size_t l = 0; l < directions.size(); ++l)
        values[l * texels + t] +=
            glm::vec3(shadeHit(tracer, *hit, directions[l], directions[size_t(view)], 0, 0)) /
            float(per_texel);
    }
  return values;
}

TEST(Bake, SharedShadowsAreThoseOfEveryRay) {
  BakeOptions options = smallBake(16);
  options.supersample = 4;
  options.maps = {.btf = true, .flat = false, .vdim = false, .surface = false};
  const TemporaryFolder folder;
  const Tile tile = *loadTile("builtin:button");
  const BakedOutput output = baked(tile, folder.path(), options);
  double square = 0;
  size_t count = 0, off = 0;
  for (const int view : {0, 4, 7}) {
    const auto shared = *output.btfView(view), exact = btfByRays(tile, output.manifest(), view);
    for (size_t k = 0; k < exact.size(); ++k, ++count) {
      const double difference = glm::length(shared[k] - exact[k]);
      square += difference * difference;
      off += difference > 2e-3;  // half floats near 1 are 5e-4 apart
    }
  }
  // Samples are 1/64 tile apart here, and a shadow narrower than that may fall between them.
  EXPECT_LT(double(off) / double(count), 0.02);
  EXPECT_LT(std::sqrt(square / double(count)), 0.004);
}

TEST(Bake, SameBytesAtAnyNumberOfThreads) {
  const TemporaryFolder one, three;
  BakeOptions options = smallBake();
  options.bounces = 1;
  options.threads = 1;
  (void)baked(groovedTile(), one.path(), options);
  options.threads = 3;
  (void)baked(groovedTile(), three.path(), options);
  EXPECT_EQ(contents(one.path()), contents(three.path()));
}

TEST(Bake, ShardsTogetherGiveTheSameBytes) {
  const TemporaryFolder whole, shared;
  (void)baked(groovedTile(), whole.path(), smallBake());
  for (const int shard : {2, 0, 1}) {
    EXPECT_FALSE(fs::exists(shared.path() / "bake.json"));
    BakeOptions options = smallBake();
    options.shard = shard, options.shards = 3;
    ASSERT_TRUE(bake(groovedTile(), "test", shared.path(), options).ok());
  }
  EXPECT_EQ(contents(whole.path()), contents(shared.path()));
}

TEST(Bake, ResumesWithTheSameBytes) {
  const TemporaryFolder whole, broken;
  (void)baked(groovedTile(), whole.path(), smallBake());
  BakeOptions options = smallBake();
  options.shards = 2;  // half of it: as if stopped
  ASSERT_TRUE(bake(groovedTile(), "test", broken.path(), options).ok());
  EXPECT_EQ(BakedOutput::open(broken.path()).issue().id, issue_id::kBakeIncomplete);
  options.shards = 1, options.resume = true;
  ASSERT_TRUE(bake(groovedTile(), "test", broken.path(), options).ok());
  EXPECT_EQ(contents(whole.path()), contents(broken.path()));
}

TEST(Bake, ResumeRefusesAnotherBakeAndAPlainRunReplacesIt) {
  const TemporaryFolder folder;
  (void)baked(groovedTile(), folder.path(), smallBake());
  BakeOptions options = smallBake(6);
  options.resume = true;
  EXPECT_EQ(bake(groovedTile(), "test", folder.path(), options).issue().id, issue_id::kExists);
  options.resume = false;
  EXPECT_EQ(baked(groovedTile(), folder.path(), options).manifest().size, 6);
}

TEST(Bake, RefusesATileWithHoles) {
  Tile tile = groovedTile();
  tile.triangles.resize(tile.triangles.size() / 2);
  const TemporaryFolder folder;
  const auto report = bake(tile, "test", folder.path(), smallBake());
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.issue().id, issue_id::kTileGeometry);
  EXPECT_TRUE(contents(folder.path()).empty());
}

// Small holes are few of a shard's rays, and none of a run's that has only maps of the surface left to make.
TEST(Bake, RefusesATileWithAHoleInEveryShardAndWhenResumed) {
  Tile tile = groovedTile();
  tile.triangles.resize(tile.triangles.size() - 4);  // of 2048
  const TemporaryFolder folder;
  for (int shard = 0; shard < 11; ++shard) {
    BakeOptions options = smallBake();
    options.shard = shard, options.shards = 11, options.resume = true;
    const auto report = bake(tile, "test", folder.path(), options);
    ASSERT_FALSE(report.ok()) << shard;
    EXPECT_EQ(report.issue().id, issue_id::kTileGeometry);
    EXPECT_NE(report.issue().text.find("x = ("), std::string::npos) << report.issue().text;
  }
  EXPECT_TRUE(contents(folder.path()).empty());
}

TEST(Bake, RefusesOptionsOutOfRange) {
  const TemporaryFolder folder;
  const auto id = [&](const std::function<void(BakeOptions&)>& change) {
    BakeOptions options = smallBake();
    change(options);
    const auto report = bake(flatTile(), "test", folder.path(), options);
    return report.ok() ? 0 : report.issue().id;
  };
  EXPECT_EQ(id([](auto& o) { o.size = 0; }), issue_id::kOption);
  EXPECT_EQ(id([](auto& o) { o.size = 100000; }), issue_id::kOption);
  EXPECT_EQ(id([](auto& o) { o.supersample = 0; }), issue_id::kOption);
  EXPECT_EQ(id([](auto& o) { o.bounces = -1; }), issue_id::kOption);
  EXPECT_EQ(id([](auto& o) { o.shard = 3, o.shards = 3; }), issue_id::kOption);
  EXPECT_EQ(id([](auto& o) { o.vdims = {{1, 4}}; }), issue_id::kOption);
  EXPECT_EQ(id([](auto& o) { o.concentric_vdims = {0}; }), issue_id::kOption);
}

TEST(Bake, SaysWhereItCannotWrite) {
  const TemporaryFolder folder;
  const auto file = folder.write("file", "");
  EXPECT_EQ(bake(flatTile(), "test", file / "out", smallBake()).issue().id, issue_id::kCannotWrite);
}

TEST(BakedOutput, RefusesWhatIsIncompleteOrDamaged) {
  const TemporaryFolder folder;
  EXPECT_EQ(BakedOutput::open(folder.path()).issue().id, issue_id::kBakeIncomplete);
  BakeOptions options = smallBake();
  options.maps = {true, false, false, false};
  const BakedOutput output = baked(flatTile(), folder.path(), options);
  EXPECT_EQ(output.flatView(0).issue().id, issue_id::kBakeIncomplete);
  EXPECT_EQ(output.surface().issue().id, issue_id::kBakeIncomplete);
  fs::remove(folder.path() / "btf" / "view_0000.exr");
  EXPECT_EQ(output.btfView(0).issue().id, issue_id::kCannotOpen);
  fs::resize_file(folder.path() / "btf" / "view_0001.exr", 400);
  EXPECT_FALSE(output.btfView(1).ok());
  folder.write("bake.json", "{\"schema\": \"loden/bake/1\"}");
  EXPECT_EQ(BakedOutput::open(folder.path()).issue().id, issue_id::kBakeManifest);
}

class EveryBuiltinTile : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, EveryBuiltinTile, ::testing::ValuesIn(builtinTileNames()),
                         [](const auto& tile) { return tile.param; });

TEST_P(EveryBuiltinTile, IsBakedWithoutARefusalAndSaysWhatItsPeriodIs) {
  const TemporaryFolder folder;
  BakeOptions options;
  options.size = 16;
  options.supersample = 1;
  options.directions = concentricDirections(2);
  options.vdims = {{4, 8}};
  options.period = 0.03;
  options.quiet = true;
  const Tile tile = *builtinTile(GetParam(), 96);
  const auto report = bake(tile, GetParam(), folder.path(), options);
  ASSERT_TRUE(report.ok()) << report.issue().where << ": " << report.issue().text;
  EXPECT_EQ(report->misses, 0u);
  const auto baked = BakedOutput::open(folder.path());
  ASSERT_TRUE(baked.ok()) << baked.issue().text;
  EXPECT_EQ(baked->manifest().aspect, tile.aspect);
  EXPECT_EQ(baked->manifest().period, 0.03);
  CookOptions cooking;
  cooking.mode = Mode::kSurface;
  cooking.quiet = true;
  const auto material = cook(*baked, cooking);
  ASSERT_TRUE(material.ok()) << material.issue().text;
  EXPECT_EQ(material->aspect, float(tile.aspect));
  EXPECT_EQ(material->geometry.aspect, float(tile.aspect));
  EXPECT_EQ(material->period, 0.03f);
}

}  // namespace
}  // namespace loden::importer
