// builtin:rings, shingles, leather and bricks: metal, sharp overhangs, deep holes, pictures.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "importer/base/periodic_noise.h"
#include "importer/tile/mesh_material.h"
#include "importer/tile/tile_parts.h"
#include "material/model/directions.h"

namespace loden::importer {
namespace {

constexpr double kTwoPi = 2 * kPi;

// --- rings ------------------------------------------------------------------------------------------------

// Rings of brass lie tilted on a napped cloth.
void addRing(SheetTile& tile, int number, int resolution) {
  constexpr double kMajor = 0.155, kMinor = 0.03;
  constexpr int kPieces = 2;
  const glm::dvec2 centre((number % 2 + 0.5) / 2 + (number / 2) * 0.25, (number / 2 + 0.5) / 2);
  const double lean = 0.16 + 0.10 * latticeRandom(number, 3, 121),
               towards = kTwoPi * latticeRandom(number, 3, 122);
  const auto axis = [=](double t) {
    const double angle = kTwoPi * t;
    const glm::dvec2 on(kMajor * std::cos(angle), kMajor * std::sin(angle));
    return glm::dvec3(centre + on, lean * (on.x * std::cos(towards) + on.y * std::sin(towards)));
  };
  for (int piece = 0; piece < kPieces; ++piece) {
    Sheet sheet;
    sheet.position = [=](glm::dvec2 uv) {
      return tubePoint(axis, (piece + uv.x) / kPieces, -kTwoPi * (uv.y - 0.5), kMinor);
    };
    sheet.brdf = [](glm::dvec2, const glm::dvec3&) {
      return brdfFromMetallicRoughness({0.91f, 0.72f, 0.36f}, 1, 0.3f);
    };
    sheet.cells = {std::max(16, resolution / 4), std::max(10, resolution / 8)};
    sheet.density = 1.3;
    tile.add(sheet);
  }
}

void addNap(SheetTile& tile, double depth, int resolution) {
  Sheet sheet;
  sheet.position = [depth](glm::dvec2 uv) {
    const glm::dvec2 p = uv - glm::floor(uv);
    return glm::dvec3(uv, -depth + 0.006 * periodicFractal(p, {24, 24}, 2, 131));
  };
  sheet.brdf = [](glm::dvec2 uv, const glm::dvec3&) {
    const double shade = 1 + 0.18 * periodicFractal(uv - glm::floor(uv), {32, 32}, 2, 133);
    LocalBrdf b;
    b.diffuse = glm::vec3(glm::clamp(glm::dvec3(0.06, 0.10, 0.20) * shade, 0.0, 1.0));
    b.specular = 0.02f, b.exponent = 6;
    return b;
  };
  sheet.cells = glm::ivec2(std::max(16, resolution / 2));
  tile.add(sheet);
}

// --- shingles ---------------------------------------------------------------------------------------------

constexpr int kRows = 2, kShingles = 3;  // of a period
constexpr double kShinglesAspect = 0.5, kExposure = kShinglesAspect / kRows, kThickness = 0.045;

// A shingle's section: over the top, down over the edge, and back on its underside.
struct ProfilePoint {
  double along, below;  // of the top's plane, of the top
};
// t in [0, 1] over `points`, which are that many.
template <size_t N>
ProfilePoint profileAt(const std::array<ProfilePoint, N>& points, double t) {
  const double at = std::clamp(t, 0.0, 1.0) * double(N - 1);
  const auto k = std::min(static_cast<size_t>(at), N - 2);
  const double f = at - double(k);
  return {glm::mix(points[k].along, points[k + 1].along, f),
          glm::mix(points[k].below, points[k + 1].below, f)};
}

void addShingle(SheetTile& tile, int row, int column, int resolution) {
  const double random = latticeRandom(column, row, 141), half = 0.5 / kShingles * (0.965 + 0.02 * random);
  const double centre = (column + 0.5 + (row % 2) * 0.5) / kShingles;
  const double edge = kExposure * row + 0.02 * (latticeRandom(column, row, 142) - 0.5);
  constexpr double kLength = 2.15 * kExposure, kSlope = 1.12 * kThickness / kExposure, kUnder = 0.06;
  const std::array<ProfilePoint, 5> across{
      {{-half, kThickness}, {-half, 0}, {0, 0}, {half, 0}, {half, kThickness}}};
  const std::array<ProfilePoint, 5> along{
      {{kUnder, kThickness}, {0, kThickness}, {0, 0}, {kLength / 2, 0}, {kLength, 0}}};
  Sheet sheet;
  sheet.position = [=](glm::dvec2 uv) {
    const ProfilePoint x = profileAt(across, uv.x), y = profileAt(along, uv.y);
    const double grain = 0.004 * periodicNoise({3 * centre + x.along, 0.3 * y.along}, {90, 20}, 143);
    const bool top = x.below == 0 && y.below == 0;
    return glm::dvec3(centre + x.along, edge + y.along,
                      -kSlope * (edge - kExposure * row + y.along) - std::max(x.below, y.below) +
                          (top ? grain * 0.5 : 0.0));
  };
  sheet.brdf = [=](glm::dvec2 uv, const glm::dvec3& at) {
    const double grain = periodicNoise({at.x + 0.31 * column, 0.2 * uv.y}, {70, 8}, 145);
    const double weather = 0.75 + 0.35 * random + 0.15 * grain;
    LocalBrdf b;
    b.diffuse = glm::vec3(glm::clamp(glm::dvec3(0.42, 0.31, 0.22) * weather, 0.0, 1.0));
    b.specular = 0.03f, b.exponent = 10;
    return b;
  };
  const int quarter = std::max(3, resolution / 20);
  sheet.cells = glm::ivec2(4 * quarter, 4 * quarter);
  sheet.creases[0] = {0.25, 0.75}, sheet.creases[1] = {0.25, 0.5};
  tile.add(sheet);
}

// --- leather ----------------------------------------------------------------------------------------------

constexpr int kHoles = 3;  // per side

// Around a hole's middle: the smooth skin from the border of its cell to the rim, the wall, and the floor.
TorusSurface leatherSurface() {
  constexpr double kRim = 0.062, kFloor = 0.056, kDepth = 0.24, kRound = 0.012;
  // Parameter radii of rim and floor: the wall has its share of the domain.
  constexpr double kRimParam = 0.128, kFloorParam = 0.045;
  const auto position = [](glm::dvec2 p) {
    const glm::dvec2 middle = (glm::floor(p * double(kHoles)) + 0.5) / double(kHoles), offset = p - middle;
    const double r = glm::length(offset);
    const double border =
        r * 0.5 / kHoles / std::max({std::abs(offset.x), std::abs(offset.y), 1e-9});  // of the cell
    double radius = r, z = 0;
    if (r >= kRimParam) {
      const double out = (r - kRimParam) / (border - kRimParam);
      radius = glm::mix(kRim, border, out);
      const double edge = std::max(0.0, 1 - (radius - kRim) / kRound);
      z = -0.5 * kRound * edge * edge;
    } else if (r >= kFloorParam) {
      const double down = (kRimParam - r) / (kRimParam - kFloorParam);
      radius = glm::mix(kRim, kFloor, down);
      z = -0.5 * kRound - (kDepth - 0.5 * kRound) * down;
    } else {
      radius = kFloor * r / kFloorParam;
      z = -kDepth;
    }
    const glm::dvec2 at = middle + (r > 1e-9 ? offset * (radius / r) : glm::dvec2(0));
    if (r >= kRimParam) z += 0.005 * periodicFractal(at - glm::floor(at), {16, 16}, 3, 151);
    return glm::dvec3(at, z);
  };
  const auto brdf = [](glm::dvec2, const glm::dvec3& at) {
    const double pores = periodicFractal(glm::dvec2(at) - glm::floor(glm::dvec2(at)), {30, 30}, 2, 153);
    const double inside = glm::smoothstep(-0.02, -0.08, at.z);
    LocalBrdf b;
    b.diffuse = glm::vec3(glm::clamp(
        glm::mix(glm::dvec3(0.34, 0.17, 0.08) * (1 + 0.2 * pores), glm::dvec3(0.20, 0.13, 0.09), inside), 0.0,
        1.0));
    b.specular = float(glm::mix(0.35, 0.02, inside));
    b.exponent = float(glm::mix(30.0, 6.0, inside));
    return b;
  };
  return {position, brdf, false};
}

// --- bricks -----------------------------------------------------------------------------------------------

constexpr double kBricksAspect = 2.0 / 3;

// Which brick of two rows lies at p, and how far its edge is away; the period in x is 1.
struct BrickPoint {
  int row;
  double edge;  // negative in the mortar
};
BrickPoint brickAt(glm::dvec2 p) {
  const int row = wrapIndex(static_cast<int>(std::floor(p.y * 2)), 2);
  const double x = p.x + 0.5 * row - std::floor(p.x + 0.5 * row), y = p.y * 2 - std::floor(p.y * 2);
  constexpr double kMortar = 0.022;
  return {row, std::min({x, 1 - x, y * kBricksAspect / 2, (1 - y) * kBricksAspect / 2}) - kMortar};
}

// Base colour, or roughness in G and metalness in B, over one period; row 0 is v = 0, which is y = 1.
std::shared_ptr<const TileTexture> brickPicture(bool base_color) {
  auto picture = std::make_shared<TileTexture>();
  picture->width = 192, picture->height = 128;
  for (int j = 0; j < picture->height; ++j)
    for (int i = 0; i < picture->width; ++i) {
      const glm::dvec2 p((i + 0.5) / picture->width, 1 - (j + 0.5) / picture->height);
      const BrickPoint brick = brickAt(p);
      const double speckle = periodicFractal(p, {40, 28}, 3, 161), stain = periodicFractal(p, {5, 4}, 2, 163);
      const double inside = glm::smoothstep(-0.004, 0.004, brick.edge);
      if (base_color) {
        const glm::dvec3 clay = brick.row == 0 ? glm::dvec3(0.46, 0.15, 0.09) : glm::dvec3(0.22, 0.09, 0.08);
        const glm::dvec3 color = glm::mix(glm::dvec3(0.50, 0.47, 0.42) * (1 + 0.12 * speckle),
                                          clay * (1 + 0.22 * speckle + 0.18 * stain), inside);
        picture->texels.push_back(glm::vec3(glm::clamp(color, 0.0, 1.0)));
      } else {
        // The bricks of the second row are glazed.
        const double rough = brick.row == 0 ? 0.85 : 0.28 + 0.08 * speckle;
        picture->texels.push_back({0, float(std::clamp(glm::mix(0.95, rough, inside), 0.0, 1.0)), 0});
      }
    }
  return picture;
}

TorusSurface bricksSurface() {
  const auto position = [](glm::dvec2 p) {
    const BrickPoint brick = brickAt(p);
    const double rough = brick.row == 0 ? 0.004 : 0.0012;
    const double rise = 0.06 * glm::smoothstep(-0.012, 0.012, brick.edge);
    return glm::dvec3(p, (rise + rough * periodicFractal(p, {30, 20}, 2, 165)) / std::sqrt(kBricksAspect));
  };
  const auto brdf = [](glm::dvec2, const glm::dvec3&) {
    return brdfFromMetallicRoughness(glm::vec3(0.4f), 0, 0.8f);
  };
  return {position, brdf, true, kBricksAspect};
}

}  // namespace

Tile ringsTile(int resolution) {
  SheetTile tile("rings");
  for (int number = 0; number < 4; ++number) addRing(tile, number, resolution);
  addNap(tile, 0.085, resolution);
  return tile.take();
}

Tile shinglesTile(int resolution) {
  SheetTile tile("shingles", kShinglesAspect);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kShingles; ++column) addShingle(tile, row, column, resolution);
  return tile.take();
}

Tile leatherTile(int resolution) {
  return gridTile("leather", resolution, leatherSurface());
}

Tile bricksTile(int resolution) {
  Tile tile = gridTile("bricks", resolution, bricksSurface());
  tile.materials.push_back({"bricks", glm::vec3(1), 1, 1, brickPicture(true), brickPicture(false)});
  for (const glm::dvec2& p : tile.params) tile.texture_points.push_back({0, {p.x, 1 - p.y}, {p.x, 1 - p.y}});
  return tile;
}

}  // namespace loden::importer
