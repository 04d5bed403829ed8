// Tiles of several charts: packing, gutters, who owns a texel, filling, and the weave.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "importer/bake/bake.h"
#include "importer/bake/push_pull.h"
#include "importer/base/random.h"
#include "importer/cook/modes.h"
#include "importer/tile/charts.h"
#include "importer/tile/tile_tracer.h"
#include "importer_meshes.h"

namespace loden::importer {
namespace {

using testing::TemporaryFolder;

// `count` separate rectangles of the given parameter sizes, two triangles each.
Tile rectangles(const std::vector<glm::dvec2>& sizes) {
  Tile tile;
  for (size_t k = 0; k < sizes.size(); ++k) {
    const auto first = uint32_t(tile.positions.size());
    for (int c = 0; c < 4; ++c) {
      const glm::dvec2 q = glm::dvec2(c % 2, c / 2) * sizes[k];
      tile.positions.push_back({q, -double(k)});
      tile.normals.push_back({0, 0, 1});
      tile.params.push_back(q);
      tile.brdfs.push_back({});
    }
    tile.triangles.push_back({first, first + 1, first + 3});
    tile.triangles.push_back({first, first + 3, first + 2});
    tile.charts.insert(tile.charts.end(), 2, uint16_t(k + 1));
  }
  return tile;
}

TEST(PackCharts, KeepsAGutterBetweenAnyTwoAndTheirProportions) {
  Tile tile = rectangles({{1, 2}, {0.5, 0.5}, {3, 1}, {0.2, 1.5}, {1, 1}});
  const double gutter = packCharts(tile);
  EXPECT_EQ(gutter, 1.0 / 16);
  EXPECT_GE(gutterOf(tile), gutter - 1.0 / 256);  // counted in cells
  const auto area = [&](size_t t) {
    const glm::dvec2 a = tile.params[tile.triangles[t].x], b = tile.params[tile.triangles[t].y] - a,
                     c = tile.params[tile.triangles[t].z] - a;
    return b.x * c.y - b.y * c.x;
  };
  EXPECT_GT(area(0), 0);
  EXPECT_NEAR(area(4) / area(0), 1.5, 1e-9);
  EXPECT_NEAR(area(6) / area(0), 0.15, 1e-9);
  for (const glm::dvec2& p : tile.params) EXPECT_TRUE(p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1);
}

TEST(PackCharts, TakesASmallerGutterForManyCharts) {
  Tile tile = rectangles(std::vector<glm::dvec2>(60, {1, 1}));
  const double gutter = packCharts(tile);
  EXPECT_LT(gutter, 1.0 / 16);
  EXPECT_GE(gutterOf(tile), gutter - 1.0 / 256);
}

TEST(ChartOwners, AreTheNearestAcrossThePeriod) {
  constexpr int n = 16;
  std::vector<uint16_t> labels(n * n, 0);
  for (int j = 0; j < n; ++j) labels[size_t(j * n + 1)] = 7, labels[size_t(j * n + 9)] = 3;
  const auto owners = chartOwners(n, labels);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int to7 = std::min(std::abs(i - 1), n - std::abs(i - 1)),
                to3 = std::abs(i - 9) < n / 2 ? std::abs(i - 9) : n - std::abs(i - 9);
      EXPECT_EQ(owners[size_t(j * n + i)], to7 < to3 ? 7 : 3) << i;
    }
}

TEST(ChartOwners, HalvedAreTheMajority) {
  const std::vector<uint16_t> owners{1, 1, 2, 3, 1, 2, 3, 3, 4, 4, 5, 6, 5, 5, 7, 8};
  const auto halved = halvedOwners(4, owners);
  EXPECT_EQ(halved, (std::vector<uint16_t>{1, 3, 4, 5}));
  EXPECT_EQ(childrenOf(4, owners, halved, 0, 0), 0b0111u);
  EXPECT_EQ(childrenOf(4, owners, halved, 1, 0), 0b1110u);
  EXPECT_EQ(childrenOf(4, {}, {}, 1, 0), 15u);
}

class Fill : public ::testing::TestWithParam<FillMethod> {};
INSTANTIATE_TEST_SUITE_P(Methods, Fill, ::testing::Values(FillMethod::kPushPull, FillMethod::kHarmonic),
                         [](const auto& method) {
                           return method.param == FillMethod::kPushPull ? "PushPull" : "Harmonic";
                         });

TEST_P(Fill, TakesEachChartsColourIntoItsOwnGutterOnly) {
  constexpr int n = 32;
  std::vector<uint16_t> labels(n * n, 0);
  std::vector<float> weights(n * n, 0);
  std::vector<glm::vec3> texels(n * n, glm::vec3(-9));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto t = size_t(j * n + i);
      labels[t] = i < 10 ? 1 : i >= 14 && i < 28 ? 2 : 0;
      if (labels[t] == 0 || (i + j) % 3 == 0) continue;  // holes too
      weights[t] = 1, texels[t] = labels[t] == 1 ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    }
  const auto owners = chartOwners(n, labels);
  HoleFill(GetParam(), n, weights, owners).apply(texels);
  for (size_t t = 0; t < texels.size(); ++t) {
    const glm::vec3 expected = owners[t] == 1 ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    ASSERT_LT(glm::distance(texels[t], expected), 1e-5) << t;
  }
}

TEST_P(Fill, GivesAChartWithoutAnyDefinedTexelTheMeanOfAll) {
  std::vector<glm::vec3> texels{glm::vec3(1), glm::vec3(3), glm::vec3(-9), glm::vec3(-9)};
  HoleFill(GetParam(), 2, std::vector<float>{1, 1, 0, 0}, std::vector<uint16_t>{1, 1, 2, 2}).apply(texels);
  EXPECT_EQ(texels, (std::vector<glm::vec3>{glm::vec3(1), glm::vec3(3), glm::vec3(2), glm::vec3(2)}));
}

// How far a linear ramp with a hole comes back from a straight line. Ramp and hole lie inside a chart of
// their own, because a ramp does not repeat.
double rampError(FillMethod method) {
  constexpr int n = 32;
  std::vector<float> weights(n * n, 1);
  std::vector<uint16_t> owners(n * n, 1);
  std::vector<glm::vec3> texels(n * n);
  const auto ramp = [](int i, int j) { return glm::vec3(float(i), float(j), float(2 * i - 3 * j)) / 32.0f; };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto t = size_t(j * n + i);
      const bool hole = i > 6 && i < 21 && j > 8 && j < 26;
      texels[t] = hole ? glm::vec3(-9) : ramp(i, j), weights[t] = hole ? 0 : 1;
    }
  HoleFill(method, n, weights, owners).apply(texels);
  double worst = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      worst = std::max(worst, double(glm::distance(texels[size_t(j * n + i)], ramp(i, j))));
  return worst;
}

TEST(HarmonicFill, ContinuesALinearRampAcrossAHoleAndPushPullDoesNot) {
  EXPECT_LT(rampError(FillMethod::kHarmonic), 1e-5);  // float storage
  EXPECT_GT(rampError(FillMethod::kPushPull), 0.02);
}

TEST(HoleFill, WithOneChartIsPlainPushPull) {
  constexpr int n = 21;
  std::vector<float> weights(n * n);
  std::vector<glm::vec3> a(n * n);
  for (size_t t = 0; t < a.size(); ++t)
    weights[t] = uniform(3, t) < 0.4 ? 1.0f : 0.0f, a[t] = glm::vec3(float(uniform(4, t)));
  auto b = a;
  PushPull(n, weights).apply(a);
  HoleFill(FillMethod::kPushPull, n, weights, {}).apply(b);
  EXPECT_EQ(a, b);
}

TEST(Weave, HasSeparateYarnsThatPassOverAndUnder) {
  const Tile tile = *builtinTile("weave", 96);
  EXPECT_EQ(findCharts(tile), tile.charts);
  EXPECT_EQ(*std::max_element(tile.charts.begin(), tile.charts.end()),
            5);  // two warps, two wefts, the lining
  EXPECT_GE(gutterOf(tile), 1.0 / 16 - 1.0 / 256);
  // Straight down, through everything: a yarn left behind does not come back, so none cuts into another.
  const TileTracer tracer(tile);
  int crossings = 0;
  for (int k = 0; k < 4000; ++k) {
    glm::dvec3 from(uniform(1, k), uniform(2, k), 0.01);
    std::vector<uint16_t> charts;
    while (const auto hit = tracer.intersect(from, {0, 0, -1})) {
      const uint16_t chart = tile.charts[hit->triangle];
      if (charts.empty() || charts.back() != chart) charts.push_back(chart);
      from.z = hit->position.z - 1e-4;
    }
    ASSERT_FALSE(charts.empty());
    EXPECT_EQ(charts.back(), 5);
    EXPECT_EQ(std::set<uint16_t>(charts.begin(), charts.end()).size(), charts.size()) << k;
    crossings += charts.size() == 3;
  }
  EXPECT_GT(crossings, 2000);  // most of the tile is covered twice
}

TEST(Weave, GetsMapsThatLeaveGutters_AndIsRefusedWithAllThatIsTooSmall) {
  const TemporaryFolder folder;
  BakeOptions options;
  options.size = 16;
  options.directions = concentricDirections(2);
  options.quiet = true;
  options.maps = {false, false, false, true};
  const auto chosen = bake(*builtinTile("weave", 24), "weave", folder.path(), options);
  ASSERT_TRUE(chosen.ok()) << chosen.issue().text;
  const BakeManifest& m = chosen->manifest;
  EXPECT_EQ(m.size, 16);
  EXPECT_GT(m.flat_size, 16);
  EXPECT_GE(m.geometry_size, m.flat_size);
  options.flat_size = options.geometry_size = 16;
  const auto report = bake(*builtinTile("weave", 24), "weave", folder.path(), options);
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.issue().where, "flat_size, geometry_size");
  const std::string least = std::to_string(m.flat_size);
  EXPECT_NE(report.issue().text.find("at least " + least + " texels"), std::string::npos)
      << report.issue().text;
}

// Where a yarn is cut, a filter over the surface maps reads the yarn's own normals, as they would go on.
TEST(Weave, NormalsGoOnBeyondTheCut) {
  const Tile tile = *builtinTile("weave", 96);
  const TemporaryFolder folder;
  BakeOptions options;
  options.size = 64;
  options.maps = {false, false, false, true};
  options.quiet = true;
  ASSERT_TRUE(bake(tile, "weave", folder.path(), options).ok());
  const auto surface = *BakedOutput::open(folder.path())->surface();
  const auto filtered = [&](glm::dvec2 p) {
    const glm::dvec2 at = p * 64.0 - 0.5, base = glm::floor(at), f = at - base;
    const auto texel = [&](int i, int j) {
      return glm::dvec3(
          surface.normal[size_t((int(base.y) + j + 64) % 64 * 64 + (int(base.x) + i + 64) % 64)]);
    };
    return glm::normalize(
        glm::mix(glm::mix(texel(0, 0), texel(1, 0), f.x), glm::mix(texel(0, 1), texel(1, 1), f.x), f.y));
  };
  // Mean error in degrees over the upper half of one row of the first yarn; 33 vertices to a row.
  const auto error = [&](size_t row) {
    double sum = 0;
    for (size_t v = 33 * row + 8; v <= 33 * row + 24; ++v)
      sum += glm::degrees(std::acos(std::min(1.0, glm::dot(filtered(tile.params[v]), tile.normals[v])))) / 17;
    return sum;
  };
  double inside = 0;
  for (size_t row = 8; row < 88; ++row) inside += error(row) / 80;
  EXPECT_LT(error(0), 1.3 * inside);
  EXPECT_LT(error(96), 1.3 * inside);
}

TEST(Weave, BakesIntoAGeometryImageWhosePatchesKeepToOneChart) {
  const Tile tile = *builtinTile("weave", 96);
  const TemporaryFolder folder;
  BakeOptions options;
  options.size = 32;
  options.directions = concentricDirections(2);
  options.vdims = {{2, 2}};
  options.supersample = 1;
  options.quiet = true;
  const auto report = bake(tile, "weave", folder.path(), options);
  ASSERT_TRUE(report.ok()) << report.issue().text;
  EXPECT_EQ(report->misses, 0u);
  const GeometryImage image = *geometryOf(*BakedOutput::open(folder.path()), 0);
  // A patch never spans a gutter: its corners lie close together in space.
  int patches = 0;
  for (int j = 0; j < image.side(); ++j)
    for (int i = 0; i < image.side(); ++i) {
      const auto patch = fetchPatch<double>(image, i, j);
      if (patch.chart == 0) continue;
      ++patches;
      EXPECT_LT(glm::distance(patch.p00, patch.p11), 0.15);  // the lining has 1/8 period between texels
    }
  EXPECT_GT(patches, image.side() * image.side() / 3);
  // Where the mesh is met, the image is: charts reach their borders, seams do not open. The image's own
  // facets make the difference.
  const TileTracer tracer(tile);
  const GeometryTracer image_tracer(image);
  int missed = 0, off = 0;
  for (int k = 0; k < 4000; ++k) {
    const glm::dvec2 x(uniform(5, k), uniform(6, k));
    const glm::dvec3 wo = directionFromSpherical({1.2 * uniform(7, k), 2 * kPi * uniform(8, k)});
    const auto truth = tracer.intersectView(x, wo);
    const auto hit = image_tracer.traceView(x, wo);
    ASSERT_TRUE(truth.has_value());
    missed += !hit;
    if (hit) off += glm::distance(hit->position, truth->position) > 0.03;
  }
  EXPECT_EQ(missed, 0);
  EXPECT_LT(off, 120);  // 3 %: silhouettes of yarns, a texel of the image wide
}

}  // namespace
}  // namespace loden::importer
