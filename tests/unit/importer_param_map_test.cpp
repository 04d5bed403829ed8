// Rasterizing over the parameter torus: points, whole cells, and what of them reaches a Flat-BTF.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "importer/bake/bake.h"
#include "importer/bake/bake_scene.h"
#include "importer/bake/surface_samples.h"
#include "importer/base/random.h"
#include "importer/tile/charts.h"
#include "importer_meshes.h"

namespace loden::importer {
namespace {

using testing::TemporaryFolder;
using Polygon = std::vector<glm::dvec2>;

// Of params alone; each triangle a chart.
Tile triangles(const Polygon& corners) {
  Tile tile;
  tile.params = corners;
  for (uint32_t v = 0; v + 2 < corners.size(); v += 3) {
    tile.triangles.push_back({v, v + 1, v + 2});
    tile.charts.push_back(uint16_t(v / 3 + 1));
  }
  return tile;
}

// Sutherland and Hodgman 1974: the part of a convex polygon in the square from `low`, 1 wide.
Polygon clipped(Polygon polygon, glm::dvec2 low) {
  for (int axis = 0; axis < 2; ++axis)
    for (const double sign : {1.0, -1.0}) {
      const double bound = sign > 0 ? low[axis] : low[axis] + 1;
      Polygon kept;
      for (size_t k = 0; k < polygon.size(); ++k) {
        const glm::dvec2 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
        const double da = sign * (a[axis] - bound), db = sign * (b[axis] - bound);
        if (da >= 0) kept.push_back(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) kept.push_back(a + (b - a) * (da / (da - db)));
      }
      polygon = kept;
    }
  return polygon;
}

double areaOf(const Polygon& polygon) {
  double twice = 0;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const glm::dvec2 a = polygon[k] - polygon[0], b = polygon[(k + 1) % polygon.size()] - polygon[0];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::abs(twice) / 2;
}

double distanceTo(const Polygon& polygon, glm::dvec2 point) {
  double least = 1e300;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const glm::dvec2 a = polygon[k], along = polygon[(k + 1) % polygon.size()] - a;
    const double length = glm::dot(along, along),
                 t = length > 0 ? std::clamp(glm::dot(point - a, along) / length, 0.0, 1.0) : 0;
    least = std::min(least, glm::distance(point, a + t * along));
  }
  return least;
}

glm::dvec2 pointOf(const Tile& tile, const ParamSample& at) {
  const glm::uvec3& v = tile.triangles[at.triangle];
  const glm::dvec2 b(at.b);
  return (1 - b.x - b.y) * tile.params[v.x] + b.x * tile.params[v.y] + b.y * tile.params[v.z];
}

// Big, small, thin, thinner than any spacing of samples, and several periods wide.
Polygon randomTriangle(uint64_t k) {
  const auto random = [&](uint64_t n) { return uniform(100 + n, k); };
  const glm::dvec2 a(3 * random(0) - 1, 3 * random(1) - 1);
  const double angle = 2 * kPi * random(2), length = std::pow(10, 2.5 * random(3) - 2),
               width = length * std::pow(10, -4 * random(4));
  const glm::dvec2 along(std::cos(angle), std::sin(angle)), across(-along.y, along.x);
  const glm::dvec2 b = a + length * along, c = a + length * random(5) * along + width * across;
  return random(6) < 0.5 ? Polygon{a, b, c} : Polygon{a, c, b};
}

TEST(CoverParams, CoversTheCellsThatATriangleOverlapsAndNoOther) {
  constexpr int n = 12;
  const glm::dvec2 position(0.53, 0.41);
  int by_area_only = 0, wrapped = 0;
  for (uint64_t k = 0; k < 400; ++k) {
    Polygon corners = randomTriangle(k);
    const Tile tile = triangles(corners);
    const auto points = locateParams(tile, n, position), cells = coverParams(tile, n, position);
    for (glm::dvec2& corner : corners) corner *= double(n);
    const glm::dvec2 low = glm::floor(glm::min(corners[0], glm::min(corners[1], corners[2])) / double(n));
    const glm::dvec2 high = glm::floor(glm::max(corners[0], glm::max(corners[1], corners[2])) / double(n));
    wrapped += low != high;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const ParamSample& at = cells[size_t(j * n + i)];
        double area = 0, distance = 1e300;
        for (double y = low.y; y <= high.y; ++y)
          for (double x = low.x; x <= high.x; ++x) {
            const glm::dvec2 cell = glm::dvec2(i, j) + glm::dvec2(x, y) * double(n);
            const Polygon part = clipped(corners, cell);
            if (part.empty()) continue;
            area = std::max(area, areaOf(part)),
            distance = std::min(distance, distanceTo(part, cell + position));
          }
        // Between: the clipping's rounding, and overlaps less than 1e-9 deep.
        if (area > 1e-8) {
          ASSERT_TRUE(at.covered()) << k << ": " << i << ' ' << j;
        }
        if (area < 1e-13) {
          ASSERT_FALSE(at.covered()) << k << ": " << i << ' ' << j;
        }
        if (!at.covered()) continue;
        ASSERT_TRUE(at.b.x >= -1e-6f && at.b.y >= -1e-6f && at.b.x + at.b.y <= 1 + 1e-6f);  // floats
        const ParamSample& point = points[size_t(j * n + i)];
        if (point.covered()) {
          ASSERT_TRUE(point.triangle == at.triangle && point.b == at.b);
          continue;
        }
        ++by_area_only;
        // In the cell, and no point of the triangle there is nearer.
        glm::dvec2 off = pointOf(tile, at) * double(n) - glm::dvec2(i, j) - position;
        off -= glm::round((off + position - 0.5) / double(n)) * double(n);
        const glm::dvec2 in_cell = off + position;
        const double slack =
            1e-5 * (1 + n * glm::distance(tile.params[0], tile.params[1]));  // weights are floats
        ASSERT_TRUE(in_cell.x > -slack && in_cell.y > -slack && in_cell.x < 1 + slack &&
                    in_cell.y < 1 + slack)
            << in_cell.x << ' ' << in_cell.y;
        ASSERT_NEAR(glm::length(off), distance, slack) << k;
      }
  }
  EXPECT_GT(by_area_only, 2000);
  EXPECT_GT(wrapped, 100);
}

TEST(CoverParams, FindsASliverBetweenTheSamples) {
  constexpr int n = 8;
  const double x = (3 + 0.8) / n, width = 1e-7;
  const Tile tile = triangles({{x, 0.1}, {x + width, 0.5}, {x, 0.9}});
  const auto points = locateParams(tile, n, glm::dvec2(0.5)), cells = coverParams(tile, n, glm::dvec2(0.5));
  EXPECT_TRUE(std::none_of(points.begin(), points.end(), [](const ParamSample& at) { return at.covered(); }));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) EXPECT_EQ(cells[size_t(j * n + i)].covered(), i == 3) << i << ' ' << j;
}

TEST(CoverParams, DoesNotCountWhatOnlyTouchesACell) {
  constexpr int n = 8;
  const glm::dvec2 low(2.0 / n, 3.0 / n), high(4.0 / n, 4.0 / n);
  const Tile tile = triangles({low, {high.x, low.y}, high, low, high, {low.x, high.y}});
  const auto cells = coverParams(tile, n, glm::dvec2(0.5));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      EXPECT_EQ(cells[size_t(j * n + i)].covered(), j == 3 && (i == 2 || i == 3)) << i << ' ' << j;
}

TEST(CoverParams, GivesACellThatTwoChartsTouchToTheNearer) {
  constexpr int n = 4;
  const auto left = [](double reach) { return Polygon{{0.1, 0.1}, {reach, 0.375}, {0.1, 0.65}}; };
  const auto right = [](double reach) { return Polygon{{0.65, 0.1}, {0.65, 0.65}, {reach, 0.375}}; };
  const auto winner = [&](Polygon first, const Polygon& second) {
    first.insert(first.end(), second.begin(), second.end());
    return coverParams(triangles(first), n, glm::dvec2(0.5))[size_t(1 * n + 1)]
        .triangle;  // of [0.25, 0.5]^2, its centre at 0.375
  };
  EXPECT_EQ(winner(left(0.35), right(0.42)), 0u);
  EXPECT_EQ(winner(right(0.42), left(0.35)), 1u);
  EXPECT_EQ(winner(left(0.31), right(0.42)), 1u);
  EXPECT_EQ(winner(right(0.42), left(0.31)), 0u);
  EXPECT_EQ(winner(left(0.38), right(0.376)),
            0u);  // both hold the centre, or not: the first that does counts
}

// The point is one of the surface, whatever its triangles.
TEST(CoverParams, DoesNotDependOnHowAChartIsTriangulated) {
  constexpr int n = 16;
  const glm::dvec2 a(0.11, 0.23), b(0.61, 0.31), c(0.74, 0.83), d(0.19, 0.69), m(0.4, 0.5);
  const Tile two = triangles({a, b, c, a, c, d}), four = triangles({a, b, m, b, c, m, c, d, m, d, a, m});
  const auto one = coverParams(two, n, glm::dvec2(0.5)), other = coverParams(four, n, glm::dvec2(0.5));
  for (size_t t = 0; t < one.size(); ++t) {
    ASSERT_EQ(one[t].covered(), other[t].covered());
    if (one[t].covered()) {
      ASSERT_LT(glm::distance(pointOf(two, one[t]), pointOf(four, other[t])), 1e-6);
    }  // weights are floats
  }
}

TEST(CoverParams, TrianglesWithoutAreaOverlapNothing) {
  for (const Polygon& corners :
       {Polygon(3, glm::dvec2(0.3)), Polygon{{0.125, 0.125}, {0.75, 0.75}, {0.25, 0.25}},
        Polygon{{0.5, 0}, {0.5, 0}, {0.5, 1}}})
    for (const ParamSample& at : coverParams(triangles(corners), 8, glm::dvec2(0.5)))
      EXPECT_FALSE(at.covered());
  // As near to that as it gets.
  for (const ParamSample& at :
       coverParams(triangles({{0.1, 0.1}, {0.9, 0.2}, {0.5, 0.15 + 1e-17}}), 8, glm::dvec2(0.5)))
    EXPECT_TRUE(std::isfinite(at.b.x) && std::isfinite(at.b.y));
}

TEST(CoverParams, IsLocateParamsWhereEverySampleIsCovered) {
  for (const char* name : {"isba", "sponge"}) {
    const Tile tile = *builtinTile(name, 24);
    const auto points = locateParams(tile, 32, glm::dvec2(0.5)),
               cells = coverParams(tile, 32, glm::dvec2(0.5));
    for (size_t t = 0; t < cells.size(); ++t) {
      ASSERT_TRUE(points[t].covered());
      ASSERT_TRUE(points[t].triangle == cells[t].triangle && points[t].b == cells[t].b) << t;
    }
  }
}

TEST(GutterOf, SeesAChartNarrowerThanItsCells) {
  const double x = (100 + 0.7) / 256;
  const Tile tile = triangles({{0.1, 0.2},
                               {0.2, 0.2},
                               {0.2, 0.8},
                               {x, 0.2},
                               {x + 1e-4, 0.2},
                               {x, 0.8},
                               {0.6, 0.2},
                               {0.7, 0.2},
                               {0.6, 0.8}});
  EXPECT_NEAR(gutterOf(tile), x - 0.2, 2.0 / 256);  // whole cells between cells that are touched
  EXPECT_LE(gutterOf(tile), x - 0.2);
}

TEST(GutterOf, IsWhatASquareBridgesAcrossCorners) {
  const auto corners = [](double gap) {
    const double a = 0.4, b = a + gap;
    return triangles({{0.1, 0.1}, {a, 0.1}, {a, a}, {b, b}, {0.9, b}, {0.9, 0.9}});
  };
  for (const double gap : {0.01, 0.1}) {
    EXPECT_LE(gutterOf(corners(gap)), gap);
    EXPECT_GT(gutterOf(corners(gap)), gap - 2.0 / 256);
  }
}

// Every texel that a yarn overlaps has samples; one at the nearest point where none lies under the texel's
// own.
TEST(SurfaceSamples, AreThereWhereverAYarnOverlapsATexel) {
  constexpr int n = 32;
  const Tile tile = *builtinTile("weave", 48);
  const TileTracer tracer(tile);
  BakeManifest manifest;
  manifest.flat_size = manifest.surface_size = n, manifest.supersample = 2,
  manifest.directions = concentricDirections(2);
  BakeCounters counters;
  const SurfaceSamples surface({tracer, manifest, counters});
  const TexelPoints points = locateTexels(tile, n, 2);
  const auto cells = coverParams(tile, n, glm::dvec2(0.5));
  int between = 0, empty = 0;
  for (size_t t = 0; t < size_t(n * n); ++t) {
    size_t located = 0;
    for (const auto& samples : points.located) located += samples[t].covered();
    const size_t count = surface.end(t) - surface.first(t);
    EXPECT_EQ(count, cells[t].covered() ? std::max(located, size_t(1)) : 0) << t;
    empty += count == 0, between += count > located;
    for (size_t s = surface.first(t); s < surface.end(t); ++s) {
      const glm::dvec2 expected = pointOf(tile, {surface[s].triangle, surface[s].b}) * double(n);
      EXPECT_LT(glm::distance(glm::dvec2(int(t) % n, int(t) / n) + surface[s].place, expected),
                1e-4);  // weights are floats
      for (int c = 0; c < 3; ++c)
        EXPECT_TRUE(std::isfinite(surface[s].origin[c]) && std::isfinite(surface[s].normal[c]));
      EXPECT_EQ(tile.charts[surface[s].triangle], surface.owners()[t]);
    }
  }
  EXPECT_GT(between, 20);
  EXPECT_GT(empty, 50);
}

// All texels of the geometry image that a yarn overlaps belong to it, so that patches reach its border.
TEST(Bake, TheGeometryImageIsOfTheChartThatOverlapsIt) {
  const Tile tile = *builtinTile("weave", 48);
  const TemporaryFolder folder;
  BakeOptions options;
  options.size = 32;
  options.geometry_size = 64;
  options.maps = {false, false, false, true};
  options.quiet = true;
  ASSERT_TRUE(bake(tile, "weave", folder.path(), options).ok());
  const BakedOutput output = *BakedOutput::open(folder.path());
  const auto geometry = *output.geometry();
  const auto cells = coverParams(tile, 64, glm::dvec2(0.5)), points = locateParams(tile, 64, glm::dvec2(0.5));
  int between = 0;
  for (size_t t = 0; t < geometry.size(); ++t) {
    for (int c = 0; c < 4; ++c) ASSERT_TRUE(std::isfinite(geometry[t][c]));
    if (!cells[t].covered()) continue;
    between += !points[t].covered();
    EXPECT_EQ(geometry[t].w, float(tile.charts[cells[t].triangle])) << t;
  }
  EXPECT_GT(between, 20);
  const BakedOutput::Surface surface = *output.surface();
  for (const glm::vec3& normal : surface.normal)
    ASSERT_TRUE(std::isfinite(normal.x) && std::isfinite(normal.y) && std::isfinite(normal.z));
}

TEST(ExtendParams, LooksThroughTrianglesWithoutArea) {
  // A cap on the right side of a square, its corners on one line.
  Tile tile = triangles({{0.2, 0.2}, {0.5, 0.2}, {0.5, 0.6}, {0.5, 0.2}, {0.5, 0.4}, {0.5, 0.6}});
  tile.charts = {1, 1};
  for (const ParamExtension& cell : extendParams(tile, 16, 2))
    if (cell.exists()) {
      EXPECT_EQ(cell.triangle, 0u);
    }
  EXPECT_EQ(extendParams(tile, 16, 2)[6 * 16 + 8].triangle, 0u);  // half a cell to the right of the cap
}

// Hills in four charts that stand obliquely in p, so that all seams are in view.
Tile quarters(int n) {
  Tile tile = testing::heightFieldTile(
      2 * n, [](glm::dvec2 p) { return 0.06 * std::cos(6 * kPi * p.x) * std::cos(6 * kPi * p.y) - 0.06; });
  const Tile whole = std::move(tile);
  tile = {};
  const double c = std::cos(0.35), s = std::sin(0.35);
  for (int chart = 0; chart < 4; ++chart) {
    const auto first = uint32_t(tile.positions.size()), row = uint32_t(n) + 1;
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const size_t v = size_t(chart / 2 * n + j) * size_t(2 * n + 1) + size_t(chart % 2 * n + i);
        const glm::dvec2 q = 0.3 * (glm::dvec2(i, j) / double(n) - 0.5);
        tile.positions.push_back(whole.positions[v]), tile.normals.push_back(whole.normals[v]);
        tile.params.push_back(glm::dvec2(chart % 2, chart / 2) * 0.5 + 0.25 +
                              glm::dvec2(c * q.x - s * q.y, s * q.x + c * q.y));
        tile.brdfs.push_back(
            {glm::vec3(0.5f + 0.4f * float(std::sin(10 * kPi * tile.positions.back().x))), 0, 1});
      }
    for (uint32_t j = 0; j < uint32_t(n); ++j)
      for (uint32_t i = 0; i < uint32_t(n); ++i) {
        const uint32_t a = first + j * row + i;
        tile.triangles.push_back({a, a + 1, a + row + 1});
        tile.triangles.push_back({a, a + row + 1, a + row});
      }
    tile.charts.insert(tile.charts.end(), size_t(2 * n * n), uint16_t(chart + 1));
  }
  return tile;
}

// BTF and Flat-BTF under 3 x 3 directions.
BakedOutput bakeSmall(const Tile& tile, int size, int per_side, const TemporaryFolder& folder) {
  BakeOptions options;
  options.size = size;
  options.supersample = per_side;
  options.directions = concentricDirections(3);
  options.maps = {true, true, false, false};
  options.quiet = true;
  const auto report = bake(tile, "small", folder.path(), options);
  EXPECT_TRUE(report.ok()) << (report.ok() ? "" : report.issue().text);
  return *BakedOutput::open(folder.path());
}

// Against the mean of the surface that the texel holds: the nearest point, and what push-pull has to offer.
TEST(Bake, ATexelThatASeamCutsIsCloserThanItsFillWouldBe) {
  constexpr int n = 32, per_side = 2, kFine = 16;
  const Tile tile = quarters(24);
  const TemporaryFolder folder;
  const BakedOutput output = bakeSmall(tile, n, per_side, folder);
  const TileTracer tracer(tile);
  const auto& directions = output.manifest().directions.samples;
  constexpr int kAbove = 4;  // the middle of 3 x 3
  const auto flat = *output.flatView(kAbove);
  const auto visible = *output.visibleView(kAbove);
  const TexelPoints points = locateTexels(tile, n, per_side);
  std::vector<std::vector<ParamSample>> fine;
  for (int k = 0; k < kFine * kFine; ++k)
    fine.push_back(locateParams(tile, n, (glm::dvec2(k % kFine, k / kFine) + 0.5) / double(kFine)));
  std::vector<float> weights(size_t(n * n));
  for (size_t t = 0; t < weights.size(); ++t) weights[t] = points.between[t].covered() ? 0 : visible[t];
  const HoleFill fill(FillMethod::kPushPull, n, weights, ownersOf(tile, n, points));
  double stored_error = 0, filled_error = 0;
  int seams = 0;
  for (size_t l = 0; l < directions.size(); ++l) {
    const std::vector<glm::vec3> stored(flat.begin() + long(l * n * n), flat.begin() + long((l + 1) * n * n));
    auto filled = stored;
    fill.apply(filled);
    for (size_t t = 0; t < size_t(n * n); ++t) {
      if (!points.between[t].covered()) continue;
      glm::dvec3 mean(0);
      int count = 0;
      for (const auto& samples : fine)
        if (samples[t].covered())
          mean += shadeHit(tracer, tracer.pointOn(samples[t].triangle, glm::dvec2(samples[t].b)),
                           directions[l], directions[kAbove], 0, 0),
              ++count;
      if (count == 0) continue;
      ++seams;
      mean /= count;
      stored_error += std::pow(stored[t].y - mean.y, 2), filled_error += std::pow(filled[t].y - mean.y, 2);
    }
  }
  EXPECT_GT(seams, 100);
  EXPECT_LT(stored_error, 0.25 * filled_error)  // half as far off; the nearest point is not the mean
      << std::sqrt(stored_error / seams) << " and " << std::sqrt(filled_error / seams);
}

// A black floor, and a white band over it that has an eighth of a texel in the flat map, between its samples.
TEST(Bake, AChartNarrowerThanASampleIsInTheFlatMap) {
  constexpr int n = 32;
  Tile tile;
  const auto add = [&](glm::dvec2 low, glm::dvec2 high, double z, glm::dvec2 p_low, glm::dvec2 p_high,
                       float albedo) {
    const auto first = uint32_t(tile.positions.size());
    for (int c = 0; c < 4; ++c) {
      const glm::dvec2 q(c % 2, c / 2);
      tile.positions.push_back({low + q * (high - low), z});
      tile.normals.push_back({0, 0, 1});
      tile.params.push_back(p_low + q * (p_high - p_low));
      tile.brdfs.push_back({glm::vec3(albedo), 0, 1});
    }
    tile.triangles.push_back({first, first + 1, first + 3});
    tile.triangles.push_back({first, first + 3, first + 2});
    tile.charts.insert(tile.charts.end(), 2, albedo > 0 ? 2 : 1);
  };
  add({0, 0}, {1, 1}, -0.1, {0.1, 0.1}, {0.5, 0.5}, 0);
  add({0.4, 0}, {0.6, 1}, 0, {24.4 / n, 4.0 / n}, {24.525 / n, 20.0 / n}, 1);
  const TemporaryFolder folder;
  const BakedOutput output = bakeSmall(tile, n, 2, folder);
  constexpr int kAbove = 4;  // the middle of 3 x 3
  const auto visible = *output.visibleView(kAbove);
  const auto flat = *output.flatView(kAbove);
  for (int j = 4; j < 20; ++j) {
    const auto t = size_t(j * n + 24);
    EXPECT_EQ(visible[t], 1) << j;
    EXPECT_NEAR(flat[size_t(kAbove) * n * n + t].y, 1, 0.01) << j;  // half floats; the light from above
  }
}

}  // namespace
}  // namespace loden::importer
