// Tiles of several pieces from files: their own charts, and the file's.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "importer/mesh/segment.h"
#include "importer/tile/charts.h"
#include "importer/tile/tile_tracer.h"
#include "importer_meshes.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

using testing::TemporaryFolder;

// OBJ text of a tile, with or without its parameters.
std::string objOf(const Tile& tile, bool uvs) {
  std::ostringstream text;
  text.precision(17);
  for (size_t v = 0; v < tile.positions.size(); ++v) {
    const glm::dvec3 p = tile.positions[v];
    text << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    if (uvs) text << "vt " << tile.params[v].x << ' ' << tile.params[v].y << '\n';
  }
  for (const glm::uvec3& t : tile.triangles) {
    text << 'f';
    for (int k = 0; k < 3; ++k) {
      text << ' ' << t[k] + 1;
      if (uvs) text << '/' << t[k] + 1;
    }
    text << '\n';
  }
  return text.str();
}

// A closed tube around a yarn along y, `radius` thick, and a plane below it.
Tile tubeOverPlane(double radius = 0.15, int around = 24, int along = 32) {
  Tile tile = testing::heightFieldTile(8, [&](glm::dvec2) { return -2.5 * radius; });
  const auto first = uint32_t(tile.positions.size());
  for (int j = 0; j <= along; ++j)
    for (int i = 0; i <= around; ++i) {
      const double angle = 2 * kPi * (i % around) / around;
      tile.positions.push_back(
          {0.5 + radius * std::sin(angle), double(j) / along, radius * std::cos(angle) - radius});
      tile.normals.push_back({std::sin(angle), 0, std::cos(angle)});
      tile.params.push_back({0, 0});
      tile.brdfs.push_back({});
    }
  for (uint32_t j = 0; j < uint32_t(along); ++j)
    for (uint32_t i = 0; i < uint32_t(around); ++i) {
      const uint32_t row = uint32_t(around) + 1, a = first + j * row + i;
      tile.triangles.push_back({a, a + 1, a + row + 1});
      tile.triangles.push_back({a, a + row + 1, a + row});
    }
  return tile;
}

void expectCharts(const Tile& tile, size_t pieces) {
  EXPECT_GE(std::set<uint16_t>(tile.charts.begin(), tile.charts.end()).size(), pieces);
  EXPECT_EQ(findCharts(tile), tile.charts);
  EXPECT_TRUE(isAtlas(tile.params, tile.triangles));
  EXPECT_GE(gutterOf(tile), 1.0 / 128 - 1.0 / 256);
  for (const glm::uvec3& t : tile.triangles)
    for (int k = 0; k < 3; ++k)
      ASSERT_LT(glm::distance(tile.positions[t[k]], tile.positions[t[(k + 1) % 3]]), 0.5);  // in one piece
}

TEST(TileCharts, SeparateOpenYarnsGetOneChartEach) {
  const TemporaryFolder folder;
  const Tile weave = *builtinTile("weave", 48);
  const auto tile = loadTile(folder.write("t.obj", objOf(weave, false)).string());
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  EXPECT_EQ(tile->triangles.size(), weave.triangles.size());
  expectCharts(*tile, 5);
  // The same surface: rays from above meet it at the same heights.
  const TileTracer ours(*tile), theirs(weave);
  int off = 0;
  const glm::dvec2 moved =
      glm::dvec2(tile->positions[tile->triangles[0].x]) - glm::dvec2(weave.positions[weave.triangles[0].x]);
  for (int k = 0; k < 1000; ++k) {
    const glm::dvec2 x(0.618034 * k, 0.754878 * k);
    const auto a = ours.intersectView(x + moved, {0, 0, 1}), b = theirs.intersectView(x, {0, 0, 1});
    ASSERT_TRUE(a && b);
    off += std::abs(a->position.z - b->position.z) > 1e-4;
  }
  EXPECT_LE(off, 5);  // silhouettes
}

TEST(TileCharts, AClosedTubeIsCutUntilItLiesFlat) {
  const TemporaryFolder folder;
  const auto tile = loadTile(folder.write("t.obj", objOf(tubeOverPlane(), false)).string());
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  expectCharts(*tile, 3);
}

TEST(TileCharts, KeepAnAtlasThatTheFileHas) {
  const TemporaryFolder folder;
  const Tile weave = *builtinTile("weave", 48);
  const auto tile = loadTile(folder.write("t.obj", objOf(weave, true)).string());
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  ASSERT_EQ(tile->triangles.size(), weave.triangles.size());
  for (size_t t = 0; t < weave.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      ASSERT_LT(glm::distance(tile->params[tile->triangles[t][k]], weave.params[weave.triangles[t][k]]),
                1e-12);
  EXPECT_EQ(tile->charts, weave.charts);
}

TEST(TileCharts, TurnAnAtlasWithVDownwards) {
  const TemporaryFolder folder;
  Tile weave = *builtinTile("weave", 24);
  for (glm::dvec2& p : weave.params) p.y = 1 - p.y;
  const auto tile = loadTile(folder.write("t.obj", objOf(weave, true)).string());
  ASSERT_TRUE(tile.ok()) << tile.issue().text;
  EXPECT_NEAR(tile->params[tile->triangles[5].x].y, 1 - weave.params[weave.triangles[5].x].y, 1e-12);
}

TEST(TileCharts, ReplaceTextureCoordinatesThatOverlap) {
  const TemporaryFolder folder;
  Tile weave = *builtinTile("weave", 24);
  for (glm::dvec2& p : weave.params) p = glm::fract(4.0 * p);
  const auto tile = loadTile(folder.write("t.obj", objOf(weave, true)).string());
  ASSERT_TRUE(tile.ok()) << tile.issue().text;
  expectCharts(*tile, 5);
}

TEST(IsAtlas, RefusesOverlapsAndTurnedTriangles) {
  const std::vector<glm::dvec2> params{{0, 0}, {0.5, 0}, {0, 0.5}, {0.1, 0.1}, {0.9, 0.1}, {0.1, 0.9}};
  EXPECT_TRUE(isAtlas(params, std::vector<glm::uvec3>{{0, 1, 2}}));
  EXPECT_FALSE(isAtlas(params, std::vector<glm::uvec3>{{0, 2, 1}}));
  EXPECT_FALSE(isAtlas(params, std::vector<glm::uvec3>{{0, 1, 2}, {3, 4, 5}}));
}

TEST(IsFlat, SeesABorderThatCrossesItself) {
  // A strip bent around until its end lies over its beginning.
  const auto strip = [](double turn) {
    std::vector<glm::dvec2> params;
    std::vector<glm::uvec3> triangles;
    for (uint32_t k = 0; k <= 40; ++k) {
      const double angle = turn * k / 40;
      for (const double radius : {1.0, 0.5})
        params.push_back(radius * glm::dvec2(std::sin(angle), std::cos(angle)));
      if (k < 40)
        triangles.push_back({2 * k, 2 * k + 1, 2 * k + 3}),
            triangles.push_back({2 * k, 2 * k + 3, 2 * k + 2});
    }
    for (glm::uvec3& t : triangles) std::swap(t.y, t.z);
    if (!isFlat(std::span(params).first(4), std::span(triangles).first(2)))
      for (glm::uvec3& t : triangles) std::swap(t.y, t.z);
    return isFlat(params, triangles);
  };
  EXPECT_TRUE(strip(5.5));
  EXPECT_FALSE(strip(7.0));
}

}  // namespace
}  // namespace loden::importer
