// Bakes of small tiles: light, periodicity, determinism, interruption, refusals.
#include <gtest/gtest.h>

#include <map>

#include "importer/bake/bake.h"
#include "importer/bake/bake_scene.h"
#include "importer/bake/light_sum.h"
#include "importer/bake/linear_texels.h"
#include "importer/bake/push_pull.h"
#include "importer/base/random.h"
#include "importer/cook/cook.h"
#include "importer/cook/modes.h"
#include "importer/tile/mesh_material.h"
#include "importer/tile/tile_tracer.h"
#include "importer_meshes.h"
#include "material/base/issues.h"
#include "material/model/vdim.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;
using testing::flatTile;
using testing::groovedTile;
using testing::TemporaryFolder;

BakeOptions smallBake(int size = 8) {
  BakeOptions options;
  options.size = size;
  options.geometry_size = 16;
  options.directions = concentricDirections(3);
  options.vdims = {{4, 5}};
  options.quiet = true;
  return options;
}

// Relative name to bytes of every file.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ostringstream bytes;
    bytes << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    files[fs::relative(entry.path(), folder).string()] = bytes.str();
  }
  return files;
}

BakedOutput baked(const Tile& tile, const fs::path& folder, const BakeOptions& options) {
  const auto report = bake(tile, tile.name, folder, options);
  EXPECT_TRUE(report.ok()) << report.issue().text;
  auto output = BakedOutput::open(folder);
  EXPECT_TRUE(output.ok()) << output.issue().text;
  return *output;
}

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

TEST(Bake, HarmonicFillChangesOnlyWhatAViewDoesNotSee) {
  const TemporaryFolder a, b;
  BakeOptions options = smallBake(16);
  const BakedOutput plain = baked(groovedTile(), a.path(), options);
  options.fill = FillMethod::kHarmonic;
  const BakedOutput harmonic = baked(groovedTile(), b.path(), options);
  EXPECT_EQ(plain.manifest().fill, FillMethod::kPushPull);
  EXPECT_EQ(harmonic.manifest().fill, FillMethod::kHarmonic);
  size_t filled = 0, changed = 0;
  for (int view = 0; view < plain.manifest().directions.size(); ++view) {
    const auto visible = *plain.visibleView(view);
    EXPECT_EQ(visible, *harmonic.visibleView(view));  // the mask of what is defined stays beside the maps
    const auto p = *plain.flatView(view), h = *harmonic.flatView(view);
    for (size_t k = 0; k < p.size(); ++k) {
      const bool defined = visible[k % visible.size()] > 0;
      EXPECT_TRUE(!defined || p[k] == h[k]);
      filled += !defined, changed += p[k] != h[k];
    }
  }
  EXPECT_GT(filled, 100u);
  EXPECT_GT(changed, filled / 4);
}

// The view nearest to `view` that sees a texel; -1 if none does.
int nearestView(const BakedOutput& output, int view, size_t texel) {
  const auto& directions = output.manifest().directions.samples;
  int nearest = -1;
  for (int other = 0; other < int(directions.size()); ++other)
    if ((*output.visibleView(other))[texel] > 0 &&
        (nearest < 0 || glm::dot(directions[other], directions[view]) >
                            glm::dot(directions[nearest], directions[view]) + 1e-12))
      nearest = other;
  return nearest;
}

TEST(Bake, NearestViewFillCopiesHiddenTexelsFromTheNearestViewThatSeesThem) {
  const TemporaryFolder a, b;
  BakeOptions options = smallBake();
  const BakedOutput plain = baked(groovedTile(), a.path(), options);
  options.fill = FillMethod::kNearestView;
  const BakedOutput filled = baked(groovedTile(), b.path(), options);
  EXPECT_EQ(filled.manifest().fill, FillMethod::kNearestView);
  size_t hidden = 0;
  for (int view = 0; view < plain.manifest().directions.size(); ++view) {
    const auto visible = *plain.visibleView(view);
    const auto p = *plain.flatView(view), f = *filled.flatView(view);
    for (size_t t = 0; t < visible.size(); ++t) {
      const int source = nearestView(plain, view, t);
      const auto expected = source < 0 || visible[t] > 0 ? p : *plain.flatView(source);
      hidden += visible[t] == 0;
      for (size_t k = t; k < p.size(); k += visible.size()) ASSERT_EQ(f[k], expected[k]) << view << ' ' << t;
    }
  }
  EXPECT_GT(hidden, 20u);
}

TEST(Bake, NearestViewFillGivesTheSameBytesInShardsAndAgain) {
  const TemporaryFolder whole, shared;
  BakeOptions options = smallBake();
  options.fill = FillMethod::kNearestView;
  (void)baked(groovedTile(), whole.path(), options);
  options.shards = 2;
  for (const int shard : {1, 0, 0}) {  // the last run fills a second time what is filled
    options.shard = shard, options.resume = true;
    ASSERT_TRUE(bake(groovedTile(), "test", shared.path(), options).ok());
  }
  EXPECT_EQ(contents(whole.path()), contents(shared.path()));
}

TEST(Bake, LinearTexelsChangeOnlyTheFlatMaps) {
  const TemporaryFolder a, b, c;
  BakeOptions options = smallBake();
  (void)baked(groovedTile(), a.path(), options);
  options.texels = TexelMethod::kLinear;
  options.threads = 1;
  EXPECT_EQ(baked(groovedTile(), b.path(), options).manifest().texels, TexelMethod::kLinear);
  options.threads = 3;
  (void)baked(groovedTile(), c.path(), options);
  EXPECT_EQ(contents(b.path()), contents(c.path()));
  const auto mean = contents(a.path()), linear = contents(b.path());
  for (const auto& [name, bytes] : mean)
    EXPECT_EQ(bytes != linear.at(name), name.starts_with("flat/") || name == "bake.json") << name;
}

// Where black and white samples disagree, the fit stays closer to the black ones than their mean does.
TEST(LinearTexels, ErrOnTheBrightSide) {
  constexpr int n = 6, per_side = 2;
  LinearTexels linear(n, per_side, 1);
  for (int t = 0; t < n * n; ++t)
    for (int k = 0; k < per_side * per_side; ++k)
      for (const glm::vec3& value : {glm::vec3(0), glm::vec3(1)})
        linear.add({t % n, t / n}, samplePosition(k, per_side), std::span(&value, 1));
  std::vector<glm::vec3> texels(n * n, glm::vec3(0.5f));
  linear.fit(0, texels);
  for (const glm::vec3& texel : texels) {
    EXPECT_LT(texel.y, 0.3f);
    EXPECT_GT(texel.y, 0.1f) << "bright samples count too";
  }
}

// A map that its own filter has read: the fit gives it back, and does not touch what has no samples around
// it.
TEST(LinearTexels, RecoverAMapFromItsFilteredSamples) {
  constexpr int n = 12, per_side = 4;
  std::vector<glm::vec3> map;
  for (int t = 0; t < n * n; ++t) map.emplace_back(uniform(31, t), uniform(32, t), 0.5f);
  LinearTexels linear(n, per_side, 1);
  std::vector<glm::vec3> texels(n * n, glm::vec3(0.5f));
  const auto seen = [](int i, int j) { return i < 8 && j < 8; };
  double mean_error = 0, fitted_error = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (!seen(i, j)) continue;
      glm::vec3& mean = texels[size_t(j * n + i)] = glm::vec3(0);
      for (int k = 0; k < per_side * per_side; ++k) {
        const glm::dvec2 at = glm::dvec2(i, j) + samplePosition(k, per_side) - 0.5, cell = glm::floor(at),
                         f = at - cell;
        const auto read = [&](int x, int y) {
          return map[size_t((int(cell.y) + y + n) % n * n + (int(cell.x) + x + n) % n)];
        };
        const glm::vec3 value = glm::mix(glm::mix(read(0, 0), read(1, 0), float(f.x)),
                                         glm::mix(read(0, 1), read(1, 1), float(f.x)), float(f.y));
        linear.add({i, j}, samplePosition(k, per_side), std::span(&value, 1));
        mean += value / float(per_side * per_side);
      }
    }
  const auto means = texels;
  linear.fit(0, texels);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const size_t t = size_t(j * n + i);
      if (i > 8 && j > 8 && i < n - 1 && j < n - 1) {
        EXPECT_EQ(texels[t], means[t]);
      }
      if (i < 1 || j < 1 || i > 6 || j > 6) continue;  // the border hangs on the first guess
      mean_error = std::max(mean_error, double(glm::distance(means[t], map[t])));
      fitted_error = std::max(fitted_error, double(glm::distance(texels[t], map[t])));
    }
  EXPECT_GT(mean_error, 0.3);
  EXPECT_LT(fitted_error, 0.1);  // 12 steps and the weight of the first guess
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

TEST(TileTracer, FindsTheHeightFieldFromAnyPeriodAndAngle) {
  const auto height = [](glm::dvec2 p) {
    return 0.1 * (std::cos(2 * kPi * p.x) * std::cos(2 * kPi * p.y) - 1);
  };
  const Tile tile = testing::heightFieldTile(96, height);
  const TileTracer tracer(tile);
  for (int k = 0; k < 500; ++k) {
    const glm::dvec2 x(20 * uniform(1, 2 * k) - 10, 20 * uniform(1, 2 * k + 1) - 10);
    const glm::dvec3 wo = directionFromSpherical({89.5 * kPi / 180 * uniform(2, k), 2 * kPi * uniform(3, k)});
    const auto hit = tracer.intersectView(x, wo);
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->position.z, height(hit->p), 2e-4);  // facets of a 96 x 96 grid
    EXPECT_LT(glm::distance(hit->p, glm::dvec2(hit->position)), 1e-9);
    const glm::dvec3 on_ray = glm::dvec3(x, 0) - wo * hit->t;
    EXPECT_LT(glm::distance(on_ray, hit->position), 2e-5 / wo.z);  // float rays
    const auto shifted = tracer.intersectView(x + glm::dvec2(3, -2), wo);
    ASSERT_TRUE(shifted.has_value());
    EXPECT_LT(glm::distance(shifted->p - glm::dvec2(3, -2), hit->p), 1e-4);
  }
}

TEST(TileTracer, StreamsOfViewRaysAgreeWithSingleOnes) {
  const TileTracer tracer(groovedTile());
  std::vector<glm::dvec2> x;
  for (int k = 0; k < 301; ++k) x.emplace_back(20 * uniform(6, 2 * k) - 10, 20 * uniform(6, 2 * k + 1) - 10);
  std::vector<std::optional<TileHit>> hits(x.size());
  for (const double theta : {0.0, 0.7, 1.4, 1.567}) {  // the last leaves the scene's box
    const glm::dvec3 wo = directionFromSpherical({theta, 0.3});
    tracer.intersectViews(x, wo, hits);
    for (size_t k = 0; k < x.size(); ++k) {
      const auto single = tracer.intersectView(x[k], wo);
      ASSERT_TRUE(hits[k] && single) << theta << ' ' << k;
      EXPECT_LT(glm::distance(hits[k]->position, single->position), 1e-7)
          << theta;  // either triangle beside an edge
      EXPECT_NEAR(hits[k]->t, single->t, 1e-7 / wo.z);
    }
  }
  const glm::dvec3 from_below(0.6, 0, -0.8);  // its rays go up and away from the tile
  tracer.intersectViews(x, from_below, hits);
  for (size_t k = 0; k < x.size(); ++k)
    EXPECT_EQ(hits[k].has_value(), tracer.intersectView(x[k], from_below).has_value()) << k;
}

TEST(TileTracer, StreamsOfShadowRaysAgreeWithSingleOnes) {
  const TileTracer tracer(groovedTile());
  std::vector<glm::vec3> origins;
  std::vector<uint8_t> wanted;
  for (int k = 0; k < 301; ++k) {
    const TileHit hit =
        tracer.pointOn(uint32_t(uniform(5, k) * double(tracer.tile().triangles.size())), {0.3, 0.3});
    origins.push_back(glm::vec3(hit.ray_origin) + glm::vec3(float(k % 7) - 3, 0, 0));
    wanted.push_back(k % 5 != 0);
  }
  std::vector<uint8_t> blocked(origins.size());
  size_t shadowed = 0;
  for (const double theta : {0.0, 0.7, 1.4, 1.55}) {
    const glm::vec3 direction(directionFromSpherical({theta, 0.3}));
    tracer.occluded(origins, wanted, direction, blocked);
    for (size_t k = 0; k < origins.size(); ++k) {
      const bool expected = !wanted[k] || tracer.occluded(glm::dvec3(origins[k]), glm::dvec3(direction));
      EXPECT_EQ(bool(blocked[k]), expected) << theta << ' ' << k;
      shadowed += wanted[k] && blocked[k];
    }
  }
  EXPECT_GT(shadowed, 100u);
}

TEST(ShadeHit, WhiteFurnaceReturnsAllLightWithEnoughBounces) {
  const TileTracer tracer(groovedTile(0.25));
  constexpr int kPaths = 20000;
  double direct = 0, all = 0;
  for (int k = 0; k < kPaths; ++k) {
    const auto hit = tracer.intersectView({uniform(11, k), uniform(12, k)}, glm::dvec3(0, 0, 1));
    ASSERT_TRUE(hit.has_value());
    const double z = uniform(13, k), phi = 2 * kPi * uniform(14, k);  // uniform in solid angle
    const glm::dvec3 wi(std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z);
    direct += 2 * shadeHit(tracer, *hit, wi, {0, 0, 1}, 0, uint64_t(k)).x / kPaths;
    all += 2 * shadeHit(tracer, *hit, wi, {0, 0, 1}, 30, uint64_t(k)).x / kPaths;
  }
  EXPECT_LT(direct, 0.9);
  EXPECT_NEAR(all, 1, 0.02);  // standard error of 20,000 paths is .006
}

TEST(LightSum, AllLightsAtOnceAgreeWithOneByOne) {
  const DirectionSet set = bonn81Directions();
  LightTable lights(set);
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.3, -0.2, 0.9));
  const uint64_t lit[2] = {0xF0A5FF0012345678ull, 0x1F0FF};  // whole groups, empty groups, single lights
  for (const LocalBrdf& brdf : {LocalBrdf{glm::vec3(0.1f, 0.5f, 0.2f), 0.7f, 45},
                                brdfFromMetallicRoughness({0.9f, 0.6f, 0.1f}, 0.4f, 0.5f)})
    for (const glm::dvec3& wo : set.samples) {
      lights.setView(glm::vec3(wo));
      LightSum sum(lights);
      for (int twice = 0; twice < 2; ++twice) sum.add(glm::vec3(normal), glm::vec3(wo), brdf, lit);
      for (size_t l = 0; l < lights.size(); ++l) {
        const double cosine =
            lit[l / 64] >> (l % 64) & 1 ? std::max(0.0, glm::dot(normal, set.samples[l])) : 0;
        const glm::dvec3 expected = 2 * cosine * reflectance(brdf, normal, set.samples[l], wo);
        EXPECT_LT(glm::length(glm::dvec3(sum[l]) - expected),
                  1e-4 + 1e-4 * glm::length(expected));  // float against double
      }
    }
}

TEST(LocalBrdf, FastPowerIsClose) {
  for (int k = 1; k <= 2000; ++k)
    for (const float n : {1.0f, 7.3f, 60.0f, 500.0f}) {
      const float x = float(k) / 2000, expected = std::pow(x, n);
      EXPECT_NEAR(fastPower(x, n), expected, 1e-30f + expected * (n * 2e-7f + 4e-6f));
    }
}

TEST(PushPull, KeepsWhatIsDefinedAndFillsTheRestFromAround) {
  for (const int side : {1, 2, 7, 16, 33}) {
    const size_t texels = size_t(side * side);
    std::vector<float> weight(texels);
    std::vector<glm::vec3> values(texels, glm::vec3(-99));
    for (size_t t = 0; t < texels; t += 5) weight[t] = 0.25f, values[t] = glm::vec3(float(t % 3), 2, 1);
    const auto before = values;
    PushPull(side, weight).apply(values);
    for (size_t t = 0; t < texels; ++t) {
      EXPECT_TRUE(weight[t] == 0 || values[t] == before[t]);
      EXPECT_GE(values[t].x, 0);
      EXPECT_LE(values[t].x, 2);
      EXPECT_NEAR(values[t].y, 2, 1e-5);
    }
  }
}

TEST(PushPull, LeavesAnEmptyImageAlone) {
  std::vector<glm::vec3> values(9, glm::vec3(3));
  PushPull(3, std::vector<float>(9, 0)).apply(values);
  EXPECT_EQ(values, std::vector<glm::vec3>(9, glm::vec3(3)));
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
