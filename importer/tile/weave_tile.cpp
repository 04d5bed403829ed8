// builtin:weave: plain weave of two warp and two weft yarns over a dark lining. Every yarn is a surface of
// its own, open below where nothing sees it, and passes over and under the yarns that it crosses.
#include <cmath>

#include "importer/base/periodic_noise.h"
#include "importer/tile/charts.h"
#include "importer/tile/tile_parts.h"
#include "material/model/directions.h"

namespace loden::importer {
namespace {

constexpr double kTwoPi = 2 * kPi;
constexpr int kYarns = 2;                                 // each way; a plain weave repeats after two
constexpr double kHalfWidth = 0.22, kHalfHeight = 0.052;  // of a yarn's section, tile periods
constexpr double kLens =
    0.6;  // the section is an ellipse at 0, a lens with sharp edges at 1: room for what it crosses
constexpr double kAmplitude = 0.072;          // of a yarn's axis, tile periods; yarns that cross do not touch
constexpr double kOpening = 140 * kPi / 180;  // radians from the section's top to its open border
constexpr double kUnderside =
    0.35;  // parameter length per length below the section's widest point, where little is seen
constexpr double kLiningScale = 0.28;  // parameter length per length of the lining

double sectionHeight(double angle) {
  return std::cos(angle) * (1 - kLens + kLens * std::abs(std::cos(angle)));
}

// The yarn along y (warp) or x (weft) with number 0 or 1. `along` runs over one period; it starts and ends
// where the yarn is hidden under another.
struct Yarn {
  bool warp = true;
  int number = 0;

  double start() const { return (warp ? number + 1 : number) % 2 == 0 ? 0.25 : 0.75; }
  double axisHeight(double along) const {
    return ((warp ? number : number + 1) % 2 == 0 ? 1 : -1) * kAmplitude * std::sin(kTwoPi * along);
  }
  double axisSlope(double along) const {
    return ((warp ? number : number + 1) % 2 == 0 ? 1 : -1) * kAmplitude * kTwoPi * std::cos(kTwoPi * along);
  }

  // angle: from the top of the section, radians.
  glm::dvec3 position(double along, double angle) const {
    const double twist = 1 + 0.035 * std::sin(5 * angle + kTwoPi * (9 * along + 0.37 * number));
    const double across = kHalfWidth * twist * std::sin(angle),
                 up = kHalfHeight * twist * sectionHeight(angle);
    const double slope = axisSlope(along), length = std::sqrt(1 + slope * slope);
    const double centre = (number + 0.5) / kYarns;
    const double on = along - up * slope / length, z = axisHeight(along) + up / length;
    return warp ? glm::dvec3(centre + across, on, z) : glm::dvec3(on, centre - across, z);
  }
  glm::dvec3 normal(double along, double angle) const {
    constexpr double kStep = 5e-4;
    return glm::normalize(glm::cross(position(along, angle + kStep) - position(along, angle - kStep),
                                     position(along + kStep, angle) - position(along - kStep, angle)));
  }
  LocalBrdf brdf(double along, double angle) const {
    const double fibre =
        periodicFractal({along, angle / kTwoPi}, {24, 16}, 2, warp ? 83 + number : 91 + number);
    const double ply = 0.5 + 0.5 * std::sin(5 * angle + kTwoPi * (9 * along + 0.37 * number));
    const glm::dvec3 dye = warp ? glm::dvec3(0.07, 0.13, 0.33) : glm::dvec3(0.60, 0.52, 0.38);
    LocalBrdf b;
    b.diffuse = glm::vec3(glm::clamp(dye * (0.75 + 0.35 * ply + 0.12 * fibre), 0.0, 1.0));
    b.specular = float(0.08 + 0.10 * ply);
    b.exponent = 18;
    return b;
  }
};

// Parameter length across the section up to each column, by arc length, less below the widest point.
std::vector<double> sectionLengths(int columns) {
  std::vector<double> lengths(1, 0.0);
  for (int k = 0; k < columns; ++k) {
    const double from = kOpening * (2.0 * k / columns - 1), to = kOpening * (2.0 * (k + 1) / columns - 1),
                 angle = (from + to) / 2;
    const double length = std::hypot(kHalfWidth * (std::sin(to) - std::sin(from)),
                                     kHalfHeight * (sectionHeight(to) - sectionHeight(from)));
    lengths.push_back(lengths.back() + length * (std::abs(angle) < kPi / 2 ? 1 : kUnderside));
  }
  return lengths;
}

// Two triangles per cell of columns x rows vertices that have been added last.
void addGrid(Tile& tile, uint32_t columns, uint32_t rows, uint16_t chart) {
  const uint32_t first = uint32_t(tile.positions.size()) - columns * rows;
  for (uint32_t j = 0; j + 1 < rows; ++j)
    for (uint32_t i = 0; i + 1 < columns; ++i) {
      const uint32_t a = first + j * columns + i;
      tile.triangles.push_back({a, a + 1, a + columns + 1});
      tile.triangles.push_back({a, a + columns + 1, a + columns});
      tile.charts.insert(tile.charts.end(), 2, chart);
    }
}

void addYarn(Tile& tile, const Yarn& yarn, int resolution, uint16_t chart) {
  const int columns = std::max(8, resolution / 3);
  const auto lengths = sectionLengths(columns);
  double v = 0;
  for (int j = 0; j <= resolution; ++j) {
    const double along = yarn.start() + double(j) / resolution;
    for (int i = 0; i <= columns; ++i) {
      const double angle = kOpening * (2.0 * i / columns - 1);
      // The last row is the first, one period on: evaluated there, so that they agree exactly.
      const double at = j == resolution ? yarn.start() : along;
      const double period = j == resolution ? 1 : 0;
      tile.positions.push_back(yarn.position(at, angle) +
                               (yarn.warp ? glm::dvec3(0, period, 0) : glm::dvec3(period, 0, 0)));
      tile.normals.push_back(yarn.normal(at, angle));
      tile.params.push_back({lengths[size_t(i)], v});
      tile.brdfs.push_back(yarn.brdf(at, angle));
    }
    v += std::hypot(1.0, yarn.axisSlope(along)) / resolution;
  }
  addGrid(tile, uint32_t(columns) + 1, uint32_t(resolution) + 1, chart);
}

// Cut where yarns hide it.
void addLining(Tile& tile, uint16_t chart) {
  constexpr int kCells = 8;
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i) {
      const glm::dvec2 q = glm::dvec2(i, j) / double(kCells);
      tile.positions.push_back({q + 0.25, -kAmplitude - kHalfHeight * 1.08});
      tile.normals.push_back({0, 0, 1});
      tile.params.push_back(q * kLiningScale);
      tile.brdfs.push_back({glm::vec3(0.03f, 0.028f, 0.025f), 0, 8});
    }
  addGrid(tile, kCells + 1, kCells + 1, chart);
}

}  // namespace

Tile weaveTile(int resolution) {
  Tile tile;
  tile.name = "weave";
  uint16_t chart = 0;
  for (const bool warp : {true, false})
    for (int number = 0; number < kYarns; ++number) addYarn(tile, {warp, number}, resolution, ++chart);
  addLining(tile, ++chart);
  packCharts(tile);
  return tile;
}

}  // namespace loden::importer
