// Tiles: the builtin ones, those from files, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "importer/mesh/parameterize.h"
#include "importer/mesh/weld.h"
#include "importer/tile/tile_tracer.h"
#include "importer_meshes.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

using testing::gltfTile;
using testing::objGrid;
using testing::TemporaryFolder;

const auto kFlat = [](glm::dvec2 q) { return glm::dvec3(2.0 * q, 1); };
const auto kSame = [](glm::dvec2 q) { return q; };

int refusal(const std::filesystem::path& path, const TileOptions& options = {}) {
  const auto tile = loadTile(path.string(), options);
  return tile.ok() ? 0 : tile.issue().id;
}

glm::dvec3 faceNormal(const Tile& tile, const glm::uvec3& t) {
  return glm::cross(tile.positions[t.y] - tile.positions[t.x], tile.positions[t.z] - tile.positions[t.x]);
}

class BuiltinTile : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, BuiltinTile, ::testing::ValuesIn(builtinTileNames()),
                         [](const auto& tile) { return tile.param; });

// Those that are one deformed grid over the whole parameter domain.
class GridTile : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, GridTile, ::testing::Values("button", "isba", "pulli", "sponge"),
                         [](const auto& tile) { return tile.param; });

TEST_P(BuiltinTile, HasItsTopAtZeroAndStaysPlausible) {
  const Tile tile = *loadTile("builtin:" + GetParam());
  double top = -1, bottom = 0;
  for (const glm::dvec3& p : tile.positions) top = std::max(top, p.z), bottom = std::min(bottom, p.z);
  EXPECT_EQ(top, 0);
  EXPECT_LT(bottom, -0.05);
  EXPECT_GT(bottom, -0.5);
  for (const LocalBrdf& brdf : tile.brdfs) {
    EXPECT_GE(glm::min(brdf.diffuse.x, glm::min(brdf.diffuse.y, brdf.diffuse.z)), 0);
    EXPECT_LE(glm::max(brdf.diffuse.x, glm::max(brdf.diffuse.y, brdf.diffuse.z)), 1);
    EXPECT_GE(brdf.specular, 0);
    EXPECT_GE(brdf.exponent, 1);
  }
}

TEST_P(GridTile, RepeatsExactly) {
  constexpr int n = 40;
  const Tile tile = *builtinTile(GetParam(), n);
  for (int k = 0; k <= n; ++k) {
    const size_t left = size_t(k * (n + 1)), right = left + n, bottom = size_t(k),
                 top = size_t(n * (n + 1) + k);
    EXPECT_EQ(tile.positions[left] + glm::dvec3(1, 0, 0), tile.positions[right]);
    EXPECT_EQ(tile.positions[bottom] + glm::dvec3(0, 1, 0), tile.positions[top]);
    EXPECT_EQ(tile.normals[left], tile.normals[right]);
    EXPECT_EQ(tile.normals[bottom], tile.normals[top]);
    EXPECT_EQ(tile.brdfs[left].diffuse, tile.brdfs[right].diffuse);
  }
}

TEST_P(BuiltinTile, OverhangsWhereItShould) {
  const Tile tile = *builtinTile(GetParam());
  const bool overhangs = std::any_of(tile.triangles.begin(), tile.triangles.end(),
                                     [&](const glm::uvec3& t) { return faceNormal(tile, t).z < -1e-9; });
  const bool height_field = GetParam() == "pulli" || GetParam() == "sponge" || GetParam() == "bricks";
  EXPECT_EQ(overhangs, !height_field && GetParam() != "leather");  // whose holes have upright walls
  EXPECT_EQ(tile.identity_parameterization, height_field);
  EXPECT_EQ(tile.aspect != 1,
            GetParam() == "stockinette" || GetParam() == "shingles" || GetParam() == "bricks");
  if (!height_field) return;
  for (size_t v = 0; v < tile.positions.size(); ++v) ASSERT_EQ(glm::dvec2(tile.positions[v]), tile.params[v]);
}

TEST_P(GridTile, KeepsAreaRoughlyWhereItOverhangs) {
  const Tile tile = *builtinTile(GetParam());
  if (tile.identity_parameterization) GTEST_SKIP() << "height fields have p = xy";
  double sum = 0, squares = 0;  // of the area per parameter area; all triangles have the same parameter area
  for (const glm::uvec3& t : tile.triangles) {
    const double area = glm::length(faceNormal(tile, t));
    sum += area, squares += area * area;
  }
  const double mean = sum / double(tile.triangles.size()),
               variance = squares / double(tile.triangles.size()) - mean * mean;
  EXPECT_LT(std::sqrt(variance) / mean, 0.40);  // a plain grid over the button has more than 1.5
}

TEST(Tile, RefusesUnknownBuiltin) {
  const auto tile = loadTile("builtin:tweed");
  ASSERT_FALSE(tile.ok());
  EXPECT_EQ(tile.issue().id, issue_id::kOption);
  EXPECT_NE(tile.issue().text.find("pulli"), std::string::npos);
}

TEST(Tile, RefusesSubdivisionOfABuiltin) {
  EXPECT_EQ(refusal("builtin:pulli", {1}), issue_id::kOption);
}

TEST(TileObj, ComesBackWithPeriodOneAndTopAtZero) {
  const TemporaryFolder folder;
  const auto path = folder.write("t.obj", objGrid(4, kFlat, kSame));
  const auto tile = loadTile(path.string());
  ASSERT_TRUE(tile.ok()) << tile.issue().text;
  EXPECT_EQ(tile->triangles.size(), 32u);
  EXPECT_TRUE(tile->identity_parameterization);
  for (size_t v = 0; v < tile->positions.size(); ++v) EXPECT_EQ(tile->positions[v].z, 0);
}

TEST(TileObj, TurnsFlippedAndSwappedTextureCoordinates) {
  const TemporaryFolder folder;
  const auto wave = [](glm::dvec2 q) { return glm::dvec3(3.0 * q, 0.3 * std::sin(2 * kPi * q.x)); };
  const std::function<glm::dvec2(glm::dvec2)> variants[] = {
      [](glm::dvec2 q) { return glm::dvec2(q.x, 1 - q.y); },
      [](glm::dvec2 q) { return glm::dvec2(1 - q.x, q.y); },
      [](glm::dvec2 q) { return glm::dvec2(q.y, q.x); },
      [](glm::dvec2 q) { return glm::dvec2(1 - q.y, 1 - q.x); }};
  for (const auto& uv : variants) {
    const auto tile = loadTile(folder.write("t.obj", objGrid(16, wave, uv)).string());
    ASSERT_TRUE(tile.ok()) << tile.issue().text;
    EXPECT_TRUE(tile->identity_parameterization);
  }
}

TEST(TileObj, ReadsMaterialsBesideIt) {
  const TemporaryFolder folder;
  folder.write("m.mtl", "newmtl a\nKd 0.1 0.2 0.3\nKs 1 1 1\nNs 8\n");
  const auto path = folder.write("t.obj", "mtllib m.mtl\nusemtl a\n" + objGrid(2, kFlat, kSame));
  const auto tile = loadTile(path.string());
  ASSERT_TRUE(tile.ok()) << tile.issue().text;
  EXPECT_EQ(tile->brdfs[0].diffuse, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_FLOAT_EQ(tile->brdfs[0].specular, 2);  // (8 + 8) / 8
}

// A wave along a direction of its own, of a surface of period 3 in x and 1.5 in y. Texture coordinates or
// not, as it stands or turned by a quarter.
TEST(TileObj, PeriodMayBeARectangle) {
  const TemporaryFolder folder;
  const auto wave = [](glm::dvec2 q) {
    return glm::dvec3(3 * q.x, 1.5 * q.y, 0.15 * std::sin(2 * kPi * (q.x + q.y)));
  };
  const auto turned = [&](glm::dvec2 q) {
    const glm::dvec3 p = wave(q);
    return glm::dvec3(-p.y, p.x, p.z);
  };
  for (const bool with_uvs : {true, false})
    for (const bool quarter : {false, true}) {
      SCOPED_TRACE(with_uvs);
      const auto tile = loadTile(
          folder
              .write("t.obj", objGrid(24, quarter ? std::function<glm::dvec3(glm::dvec2)>(turned) : wave,
                                      with_uvs ? std::function<glm::dvec2(glm::dvec2)>(kSame) : nullptr))
              .string());
      ASSERT_TRUE(tile.ok()) << tile.issue().text;
      EXPECT_NEAR(tile->aspect, quarter ? 2 : 0.5, 1e-12);
      double bottom = 0;
      for (size_t v = 0; v < tile->positions.size(); ++v) {
        bottom = std::min(bottom, tile->positions[v].z);
        // z = .15 sin(2 pi (x / 3 + y / 1.5)): the slopes stand as 1 to 2.
        const glm::dvec3 n = tile->normals[v];
        const double along_x = quarter ? n.y : n.x, along_y = quarter ? -n.x : n.y;
        EXPECT_NEAR(along_y, 2 * along_x, 0.02);
        EXPECT_NEAR(std::hypot(n.x, n.y, n.z), 1, 1e-9);
      }
      EXPECT_NEAR(bottom, -0.3 / std::sqrt(4.5), 1e-9);  // tile lengths: the root of the period's area
    }
}

// The same surface as a tile of period 1 x 1/2, and as one of 1 x 1 that holds it twice.
TEST(TileTracer, RectangularPeriodIsTheSameSurfaceAsASquareOfTwo) {
  const TemporaryFolder folder;
  const auto bumps = [](double x, double y) {
    return 0.08 * std::sin(2 * kPi * x) * std::sin(2 * kPi * 2 * y) + 0.04 * std::cos(2 * kPi * (x - 2 * y));
  };
  const auto half = loadTile(
      folder
          .write(
              "half.obj",
              objGrid(
                  48, [&](glm::dvec2 q) { return glm::dvec3(q.x, 0.5 * q.y, bumps(q.x, 0.5 * q.y)); }, kSame))
          .string());
  const auto whole = loadTile(
      folder
          .write("whole.obj", objGrid(
                                  96, [&](glm::dvec2 q) { return glm::dvec3(q, bumps(q.x, q.y)); }, kSame))
          .string());
  ASSERT_TRUE(half.ok() && whole.ok());
  const TileTracer a(*half), b(*whole);
  const double length = std::sqrt(0.5);  // a tile length of the half, in those of the whole
  for (int k = 0; k < 400; ++k) {
    const glm::dvec2 x(std::fmod(0.37 * k, 1.0), std::fmod(0.59 * k, 1.0));
    const glm::dvec3 wo = directionFromSpherical({1.3 * std::fmod(0.71 * k, 1.0), 0.9 * k}),
                     wi = directionFromSpherical({1.4 * std::fmod(0.43 * k, 1.0), 2.3 * k});
    const auto hit = a.intersectView({x.x, 2 * x.y}, wo), twin = b.intersectView(x, wo);
    ASSERT_TRUE(hit && twin);
    // The meshes are the same along y, and finer by two in one of x: facets differ.
    EXPECT_NEAR(hit->t * length, twin->t, 2e-2);
    if (std::abs(hit->t * length - twin->t) > 2e-3) continue;  // at a silhouette
    EXPECT_LT(glm::distance(hit->position * glm::dvec3(1, 0.5, length), twin->position), 5e-3);
    EXPECT_LT(glm::distance(hit->normal, twin->normal), 2e-2);
    EXPECT_LT(glm::distance(hit->geometric_normal, twin->geometric_normal), 0.2);
    if (glm::dot(hit->normal, wi) > 0.2) {
      EXPECT_EQ(a.occluded(hit->ray_origin, wi), b.occluded(twin->ray_origin, wi)) << k;
    }
  }
}

// A closed block of 1.2 x 0.5 x 0.2 beside the origin, as OBJ.
std::string blockObj() {
  std::ostringstream text;
  for (int k = 0; k < 8; ++k)
    text << "v " << (k & 1 ? 1.5 : 0.3) << ' ' << (k & 2 ? 0.7 : 0.2) << ' ' << (k & 4 ? 0.0 : -0.2) << '\n';
  for (const char* face : {"5 6 8 7", "1 3 4 2", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"})
    text << "f " << face << '\n';
  return text.str();
}

TEST(TileObj, ClosedPiecesTakeTheirPeriodAndAGroundFromOptions) {
  const TemporaryFolder folder;
  const std::string path = folder.write("block.obj", blockObj()).string();
  const auto without = loadTile(path);
  ASSERT_FALSE(without.ok());
  EXPECT_NE(without.issue().text.find("--mesh-period"), std::string::npos) << without.issue().text;
  TileOptions options;
  options.mesh_period = {2, 1};
  const auto alone = loadTile(path, options);
  ASSERT_TRUE(alone.ok()) << alone.issue().text;
  EXPECT_EQ(alone->aspect, 0.5);
  EXPECT_EQ(alone->triangles.size(), 12u);
  options.ground = 0.1;
  const auto tile = loadTile(path, options);
  ASSERT_TRUE(tile.ok()) << tile.issue().text;
  const double length = std::sqrt(2.0);  // a tile length, in the file's units
  const TileTracer tracer(*tile);
  for (int k = 0; k < 200; ++k) {
    const glm::dvec2 x(std::fmod(0.0037 + 0.37 * k, 1.0), std::fmod(0.0041 + 0.59 * k, 1.0));  // off edges
    const auto hit = tracer.intersectView(x, {0, 0, 1});
    ASSERT_TRUE(hit) << k;
    const glm::dvec2 at = x * glm::dvec2(2, 1);
    const bool on_block = at.x > 0.3 && at.x < 1.5 && at.y > 0.2 && at.y < 0.7;
    EXPECT_NEAR(hit->position.z * length, on_block ? 0 : -0.3, 1e-6) << k;
    EXPECT_NEAR(hit->geometric_normal.z, 1, 1e-6);
  }
  EXPECT_EQ(refusal("builtin:pulli", options), issue_id::kOption);
}

TEST(TileObj, RefusesWhatIsNoTile) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal(folder.path() / "missing.obj"), issue_id::kCannotOpen);
  EXPECT_EQ(refusal(folder.write("t.stl", "solid")), issue_id::kOption);
  EXPECT_EQ(refusal(folder.write("t.obj", "v 0 0 0\n")), issue_id::kTileGeometry);
  EXPECT_EQ(refusal(folder.write("t.obj", "v 0 0 0\nf 1 2 3\n")), issue_id::kTileGeometry);
  EXPECT_EQ(refusal(folder.write("t.obj", "v 0 0 0\nf 1 1\n")), issue_id::kTileGeometry);
  EXPECT_EQ(refusal(folder.write("t.obj", objGrid(2, kFlat, kSame) + "f 1/-10 2/2 3/3\n")),
            issue_id::kTileGeometry);  // of nine
  EXPECT_EQ(refusal(folder.write("t.obj", "mtllib ../m.mtl\n")), issue_id::kGltfPath);
  EXPECT_EQ(
      refusal(folder.write("t.obj", objGrid(
                                        4, [](glm::dvec2 q) { return glm::dvec3(q, q.x * q.y); }, nullptr))),
      issue_id::kTileUv);
  // Borders that do not match, a rotated parameterization, a period that is a strip, the wrong side up.
  EXPECT_EQ(refusal(folder.write("t.obj", objGrid(
                                              4, [](glm::dvec2 q) { return glm::dvec3(q, q.x * q.y); },
                                              [](glm::dvec2 q) { return 0.9 * q; }))),
            issue_id::kTileUv);
  EXPECT_EQ(refusal(folder.write(
                "t.obj",
                objGrid(
                    4, [](glm::dvec2 q) { return glm::dvec3(q.x + 0.3 * q.y, q.y - 0.3 * q.x, 0); }, kSame))),
            issue_id::kTileUv);
  EXPECT_EQ(
      refusal(folder.write("t.obj", objGrid(
                                        4, [](glm::dvec2 q) { return glm::dvec3(q.x, 9 * q.y, 0); }, kSame))),
      issue_id::kTileGeometry);
  EXPECT_EQ(
      refusal(folder.write("t.obj", objGrid(
                                        4, [](glm::dvec2 q) { return glm::dvec3(1 - q.x, q.y, 0); }, kSame))),
      issue_id::kTileGeometry);
}

TEST(TileObj, GetsAParameterizationIfItHasNone) {
  const TemporaryFolder folder;
  // An overhanging wave on a grid of period 3, its borders cut along a curve.
  const auto wave = [](glm::dvec2 q) {
    const double angle = 4 * kPi * q.x;
    return 3.0 * glm::dvec3(q.x + 0.06 * std::sin(2 * angle) + 0.05 * std::sin(2 * kPi * q.y), q.y,
                            0.1 * std::cos(angle));
  };
  const auto tile = loadTile(folder.write("t.obj", objGrid(48, wave, nullptr)).string());
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  EXPECT_FALSE(tile->identity_parameterization);
  const auto quality = measureParameterization(tile->positions, tile->params, tile->triangles);
  EXPECT_EQ(quality.flipped, 0);
  EXPECT_LT(quality.area_cv, 0.1);
  const auto same = weldVertices(tile->positions, {1, 1, 0}, 1e-6);
  for (size_t v = 0; v < same.size(); ++v) {  // P(p + n) = P(p) + n
    const glm::dvec2 n(tile->positions[v] - tile->positions[same[v]]);
    EXPECT_LT(glm::distance(tile->params[v] - tile->params[same[v]], n), 1e-6);
  }
}

TEST(TileObj, IsTheSameTileWhereverItsMeshStands) {
  const TemporaryFolder folder;
  const auto tileAt = [&](double away) {
    const auto waves = [away](glm::dvec2 q) {
      return glm::dvec3(q + away, 0.05 * std::sin(2 * kPi * q.x) * std::cos(2 * kPi * q.y));
    };
    return *loadTile(folder.write("t.obj", objGrid(12, waves, nullptr)).string());
  };
  const Tile here = tileAt(0), there = tileAt(1e6);
  ASSERT_EQ(here.positions.size(), there.positions.size());
  for (size_t v = 0; v < here.positions.size(); ++v) {
    EXPECT_LT(glm::distance(here.positions[v], there.positions[v]), 1e-8);  // of doubles around 1e6
    EXPECT_LT(glm::distance(here.params[v], there.params[v]), 1e-6);
  }
}

TEST(TileObj, RefusesTextureCoordinatesThatFold) {
  const TemporaryFolder folder;
  const auto folded = [](glm::dvec2 q) {
    return glm::distance(q, glm::dvec2(0.5)) < 0.1 ? q + glm::dvec2(0.3, 0) : q;
  };
  const auto tile = loadTile(folder.write("t.obj", objGrid(8, kFlat, folded)).string());
  ASSERT_FALSE(tile.ok());
  EXPECT_EQ(tile.issue().id, issue_id::kTileUv);
  EXPECT_NE(tile.issue().where.find("triangle "), std::string::npos) << tile.issue().where;
  // Upright walls have no area in p, and lie over nobody.
  const auto stairs = [](glm::dvec2 q) {
    return glm::dvec3(std::floor(4 * q.x + 0.5) / 4, q.y, 0.1 * std::cos(2 * kPi * q.x));
  };
  const auto above = [&](glm::dvec2 q) { return glm::dvec2(stairs(q)); };
  EXPECT_EQ(refusal(folder.write("s.obj", objGrid(8, stairs, above))), 0);
}

TEST(TileObj, RefusesNormalsThatPointDown) {
  const TemporaryFolder folder;
  const auto text = [](const char* normal) {
    return std::string("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn ") + normal +
           "\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";
  };
  EXPECT_EQ(refusal(folder.write("t.obj", text("0 0 1"))), 0);
  EXPECT_EQ(refusal(folder.write("t.obj", text("0 0 -1"))), issue_id::kTileGeometry);
}

TEST(TileObj, DropsDegenerateAndDuplicateTriangles) {
  const TemporaryFolder folder;
  const auto path =
      folder.write("t.obj", objGrid(4, kFlat, kSame) + "f 1/1 2/2 7/7\nf 1/1 1/1 2/2\nf 1/1 2/2 3/3\n");
  const auto tile = loadTile(path.string());
  ASSERT_TRUE(tile.ok()) << tile.issue().text;
  EXPECT_EQ(tile->triangles.size(), 32u);
  ASSERT_EQ(tile->warnings.size(), 1u);
  EXPECT_NE(tile->warnings[0].where.find("triangle 32"), std::string::npos) << tile->warnings[0].where;
  EXPECT_NE(tile->warnings[0].text.find("repaired: 3 "), std::string::npos) << tile->warnings[0].text;
}

class Parameterization : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, Parameterization, ::testing::Values("button", "isba", "pulli", "sponge"),
                         [](const auto& tile) { return tile.param; });

TEST_P(Parameterization, IsBijectiveAndEven) {
  const Tile tile = *builtinTile(GetParam(), 64);
  const auto made = parameterizeTorus(tile.positions, tile.triangles, "test");
  ASSERT_TRUE(made.ok()) << made.issue().text;
  EXPECT_EQ(made->quality.flipped, 0);
  EXPECT_LT(made->quality.area_cv, 0.15);
  EXPECT_GT(made->quality.area_p5, 0.75);
  EXPECT_LT(made->quality.area_p95, 1.3);
}

// They would stretch the box that rays are traced in.
TEST(TileObj, DropsVerticesOfNoTriangle) {
  const TemporaryFolder folder;
  const std::string grid = objGrid(6, kFlat, kSame);
  const auto expected = loadTile(folder.write("grid.obj", grid).string());
  const auto tile = loadTile(folder.write("more.obj", grid + "v 40 1 7\nv 1 1 -300\n").string());
  ASSERT_TRUE(expected.ok() && tile.ok());
  EXPECT_EQ(tile->positions, expected->positions);
  EXPECT_EQ(tile->triangles, expected->triangles);
  EXPECT_EQ(tile->normals.size(), tile->positions.size());
  EXPECT_EQ(tile->params, expected->params);
}

TEST(ParameterizeTorus, RefusesWhatIsNoTorus) {
  const Tile tile = *builtinTile("sponge", 16);
  const auto refusalOf = [&](const std::function<void(std::vector<glm::uvec3>&)>& change) {
    auto triangles = tile.triangles;
    change(triangles);
    const auto made = parameterizeTorus(tile.positions, triangles, "test");
    return made.ok() ? std::string() : made.issue().where + ": " + made.issue().text;
  };
  EXPECT_EQ(refusalOf([](auto&) {}), "");
  EXPECT_NE(refusalOf([](auto& t) { t.pop_back(); }).find("open"), std::string::npos);
  EXPECT_NE(refusalOf([](auto& t) { t.push_back(t[7]); }).find("triangle 512"), std::string::npos);
  EXPECT_NE(refusalOf([](auto& t) { std::swap(t[5].x, t[5].y); }).find("opposite"), std::string::npos);
  EXPECT_NE(refusalOf([](auto& t) { t[3].y = t[3].x; }).find("triangle 3"), std::string::npos);
}

TEST(TileObj, NamesCountAndFirstOfNonFiniteVertices) {
  const TemporaryFolder folder;
  const std::string text = objGrid(4, kFlat, kSame) + "v nan 0 0\nv 0 0 inf\nf 26/1 27/1 26/1\n";
  const auto tile = loadTile(folder.write("t.obj", text).string());
  ASSERT_FALSE(tile.ok());
  EXPECT_EQ(tile.issue().id, issue_id::kTileNonFinite);
  const auto first = std::to_string(
      1 + std::count(text.begin(), text.begin() + static_cast<ptrdiff_t>(text.find("v nan")), '\n'));
  EXPECT_NE(tile.issue().where.find("line " + first), std::string::npos) << tile.issue().where;
  EXPECT_EQ(tile.issue().text.rfind("2 of", 0), 0u) << tile.issue().text;
}

TEST(TileObj, SubdividedCageHasNoSeamAndUnitNormals) {
  const TemporaryFolder folder;
  const auto bumpy = [](glm::dvec2 q) {
    return glm::dvec3(
        q, 0.1 * std::cos(2 * kPi * q.x) * std::cos(2 * kPi * q.y) + 0.05 * std::sin(2 * kPi * q.y));
  };
  const auto tile = loadTile(folder.write("t.obj", objGrid(4, bumpy, kSame)).string(), {3});
  ASSERT_TRUE(tile.ok()) << tile.issue().text;
  EXPECT_EQ(tile->triangles.size(), 4u * 4 * 64 * 2);
  const auto same = weldVertices(tile->positions, {1, 1, 0}, 1e-6);
  size_t joined = 0;
  for (size_t v = 0; v < same.size(); ++v) {
    EXPECT_NEAR(glm::length(tile->normals[v]), 1, 1e-12);
    EXPECT_LT(glm::distance(tile->normals[v], tile->normals[same[v]]),
              1e-5);  // OpenSubdiv's weights are float
    joined += same[v] != v;
  }
  EXPECT_EQ(joined, 32u + 32u + 1u);  // two sides of the border
}

TEST(TileObj, FlatCageStaysFlatAndUniformWhenSubdivided) {
  const TemporaryFolder folder;
  const auto tile = loadTile(folder.write("t.obj", objGrid(3, kFlat, kSame)).string(), {2});
  ASSERT_TRUE(tile.ok()) << tile.issue().text;
  EXPECT_TRUE(tile->identity_parameterization);
  for (const glm::dvec3& p : tile->positions) EXPECT_NEAR(p.z, 0, 1e-6);
}

TEST(TileGltf, ReadsTransformedGeometryAndMaterial) {
  const TemporaryFolder folder;
  auto json = gltfTile();
  json["nodes"][0]["translation"] = {5, 1, 3};
  const auto tile = loadTile(folder.write("t.gltf", json.dump()).string());
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  EXPECT_EQ(tile->triangles.size(), 2u);
  EXPECT_TRUE(tile->identity_parameterization);
  EXPECT_EQ(tile->brdfs[0].diffuse, glm::vec3(0.5f, 0.25f, 0.125f));
  EXPECT_FLOAT_EQ(tile->brdfs[0].alpha, 0.25f);
  EXPECT_EQ(tile->brdfs[0].f0, glm::vec3(0.04f));
  EXPECT_NEAR(tile->normals[0].z, 1, 1e-12);
}

TEST(TileGltf, NodesOfAnyScaleKeepAuthoredNormals) {
  const TemporaryFolder folder;
  constexpr float kNormals[] = {0.6f, 0.8f, 0, 0.6f, 0.8f, 0, 0.6f, 0.8f, 0, 0.6f, 0.8f, 0};  // y is up
  auto json = gltfTile();
  json["buffers"].push_back(
      {{"byteLength", sizeof kNormals},
       {"uri", "data:application/octet-stream;base64," +
                   base64({reinterpret_cast<const char*>(kNormals), sizeof kNormals})}});
  json["bufferViews"].push_back({{"buffer", 1}, {"byteLength", sizeof kNormals}});
  json["accessors"].push_back({{"bufferView", 3}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
  json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 3;
  for (const double scale : {1e-4, 1.0, 25.0, 1e4}) {
    json["nodes"][0]["scale"] = {scale, scale, scale};
    const auto tile = loadTile(folder.write("t.gltf", json.dump()).string());
    ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
    for (const glm::dvec3& normal : tile->normals)
      EXPECT_LT(glm::distance(normal, {0.6, 0, 0.8}), 1e-7) << scale;
  }
  json["nodes"][0]["scale"] = {2, 0, 2};  // flattened: what has an upright part stands upright
  const auto tile = loadTile(folder.write("t.gltf", json.dump()).string());
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  for (const glm::dvec3& normal : tile->normals) EXPECT_LT(glm::distance(normal, {0, 0, 1}), 1e-7);
}

TEST(TileGltf, ReadsQuantizedMeshes) {
  const TemporaryFolder folder;
  constexpr int8_t kNormals[] = {76, 102, 0, 0, 76, 102, 0, 0,
                                 76, 102, 0, 0, 76, 102, 0, 0};  // y is up; in steps of four bytes
  constexpr int16_t kPositions[] = {-32768, 0, 32767,  0, 32767,  0, 32767,  0,
                                    32767,  0, -32767, 0, -32767, 0, -32767, 0};
  auto json = gltfTile();
  json["extensionsUsed"] = json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const auto add = [&](const void* data, size_t bytes, int stride, int type, const char* attribute) {
    const auto view = json["bufferViews"].size();
    json["buffers"].push_back(
        {{"byteLength", bytes},
         {"uri", "data:application/octet-stream;base64," + base64({static_cast<const char*>(data), bytes})}});
    json["bufferViews"].push_back(
        {{"buffer", json["buffers"].size() - 1}, {"byteLength", bytes}, {"byteStride", stride}});
    json["meshes"][0]["primitives"][0]["attributes"][attribute] = json["accessors"].size();
    json["accessors"].push_back({{"bufferView", view},
                                 {"componentType", type},
                                 {"normalized", true},
                                 {"count", 4},
                                 {"type", "VEC3"}});
  };
  add(kNormals, sizeof kNormals, 4, 5120, "NORMAL");
  add(kPositions, sizeof kPositions, 8, 5122, "POSITION");
  json["nodes"][0]["scale"] = {0.5, 0.5, 0.5}, json["nodes"][0]["translation"] = {0.5, 0, 0.5};
  const auto tile = loadTile(folder.write("t.gltf", json.dump()).string());
  ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
  EXPECT_TRUE(tile->identity_parameterization);
  for (const glm::dvec3& normal : tile->normals)
    EXPECT_LT(glm::distance(normal, glm::normalize(glm::dvec3(76, 0, 102))), 1e-7);
}

TEST(TileObj, NormalsMayHaveAnyLength) {
  const TemporaryFolder folder;
  const auto path = folder.write("t.obj",
                                 "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn "
                                 ".006 0 .008\nf 1/1/1 2/2/1 3/3/1 4/4/1\n");
  const auto tile = loadTile(path.string());
  ASSERT_TRUE(tile.ok()) << tile.issue().text;
  for (const glm::dvec3& normal : tile->normals) EXPECT_LT(glm::distance(normal, {0.6, 0, 0.8}), 1e-12);
}

TEST(TileGltf, MirroredNodesKeepTheirFront) {
  const TemporaryFolder folder;
  for (const auto& scale : {std::array{-1, 1, 1}, std::array{1, 1, -1}, std::array{-1, 1, -1}}) {
    auto json = gltfTile();
    json["nodes"][0]["scale"] = scale;
    const auto tile = loadTile(folder.write("t.gltf", json.dump()).string());
    ASSERT_TRUE(tile.ok()) << tile.issue().where << ": " << tile.issue().text;
    EXPECT_NEAR(tile->normals[0].z, 1, 1e-12);
  }
  auto json = gltfTile();
  json["nodes"][0]["scale"] = {1, -1, 1};  // its front below
  EXPECT_EQ(refusal(folder.write("t.gltf", json.dump())), issue_id::kTileGeometry);
}

TEST(TileGltf, ReadsBinaryFilesLikeText) {
  const TemporaryFolder folder;
  GltfDocument document;
  document.json = gltfTile();
  document.binary = true;
  EXPECT_EQ(refusal(folder.write("t.glb", serializeGltf(document))), 0);
}

TEST(TileGltf, RefusesDamageAndEscape) {
  const TemporaryFolder folder;
  const auto changed = [&](const std::function<void(nlohmann::ordered_json&)>& change) {
    auto json = gltfTile();
    change(json);
    return refusal(folder.write("t.gltf", json.dump()));
  };
  EXPECT_EQ(changed([](auto& j) { j["extensionsRequired"] = {"EXT_unknown"}; }), issue_id::kGltfRequired);
  EXPECT_EQ(changed([](auto& j) { j["buffers"][0]["uri"] = "../t.bin"; }), issue_id::kGltfParse);
  EXPECT_EQ(changed([](auto& j) { j["accessors"][0]["count"] = 1000000; }), issue_id::kGltfAccessor);
  EXPECT_EQ(changed([](auto& j) { j["accessors"][0]["byteOffset"] = 40; }), issue_id::kGltfAccessor);
  EXPECT_EQ(changed([](auto& j) { j["bufferViews"][0]["byteLength"] = 100000; }), issue_id::kGltfAccessor);
  EXPECT_EQ(changed([](auto& j) { j["accessors"][0]["type"] = "VEC2"; }), issue_id::kGltfAccessor);
  EXPECT_EQ(changed([](auto& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9; }),
            issue_id::kGltfAccessor);
  EXPECT_EQ(changed([](auto& j) { j["nodes"][0]["children"] = {0}; }), issue_id::kGltfNode);
  EXPECT_EQ(changed([](auto& j) { j["nodes"][0]["mesh"] = 7; }), issue_id::kGltfNode);
  EXPECT_EQ(changed([](auto& j) {
              for (int k = 1; k <= 40; ++k)
                j["nodes"][size_t(k - 1)]["children"] = {k, k},
                                      j["nodes"].push_back(nlohmann::ordered_json::object());
            }),
            issue_id::kGltfNode);  // 2^40 paths
  EXPECT_EQ(changed([](auto& j) { j["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0"); }),
            issue_id::kTileUv);
  EXPECT_EQ(changed([](auto& j) { j["meshes"][0]["primitives"][0]["mode"] = 5; }), issue_id::kTileGeometry);
  const std::string nested =
      R"({"asset":{"version":"2.0"},"extras":)" + std::string(20000, '[') + std::string(20000, ']') + "}";
  EXPECT_EQ(refusal(folder.write("t.gltf", nested)), issue_id::kGltfDepth);
  EXPECT_EQ(refusal(folder.write("t.gltf", "{")), issue_id::kGltfParse);
}

TEST(Weld, JoinsAcrossThePeriodAndAcrossCells) {
  const std::vector<glm::dvec3> points{{0, 0, 0}, {1, 2, 0}, {1e-7, -1e-7, 1e-7}, {0.5, 0.5, 0}, {0, 0, 1}};
  const auto same = weldVertices(points, {1, 1, 0}, 1e-6);
  EXPECT_EQ(same, (std::vector<uint32_t>{0, 0, 0, 3, 4}));
}

}  // namespace
}  // namespace loden::importer
