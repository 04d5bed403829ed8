// builtin:stockinette, yarns that interlock, and builtin:fibres, loose fibres over a weave.
#include <algorithm>
#include <cmath>

#include "importer/base/periodic_noise.h"
#include "importer/tile/charts.h"
#include "importer/tile/tile_parts.h"
#include "material/model/directions.h"

namespace loden::importer {
namespace {

constexpr double kTwoPi = 2 * kPi;

// --- stockinette ------------------------------------------------------------------------------------------

constexpr int kWales = 2, kCourses = 2;    // stitches per period, across and along
constexpr double kAspect = 0.77;           // of the period
constexpr double kRadius = 0.072;          // of a yarn; the period in x is 1
constexpr int kChartsOfYarn = 2 * kWales;  // a yarn is cut where its loops turn

// The axis of a course's yarn: the plane curve t + a sin 2t, cos t of weft knits, which dives below its
// neighbours where it turns. t counts stitches.
glm::dvec3 knitAxis(int course, double t) {
  constexpr double kSway = 0.20, kRise = 0.315, kDepth = 0.078;
  const double angle = kTwoPi * t, step = kAspect / kCourses;
  return {(t + kSway * std::sin(2 * angle)) / kWales, (course + 0.5) * step + kRise * std::cos(angle),
          -kDepth * std::cos(2 * angle)};
}

// Two plies, twisted.
double plied(double radius, double turns, double angle) {
  return radius * (1 + 0.07 * std::cos(2 * (angle - kTwoPi * turns)));
}

void addCourse(SheetTile& tile, int course, int resolution) {
  for (int part = 0; part < kChartsOfYarn; ++part) {
    const auto along = [part](double u) { return kWales * (part + u) / kChartsOfYarn; };
    Sheet sheet;
    // The seam lies below.
    sheet.position = [=](glm::dvec2 uv) {
      const double angle = kTwoPi * (uv.y - 0.5), t = along(uv.x);
      return tubePoint([course](double s) { return knitAxis(course, s); }, t, -angle,
                       plied(kRadius, 7 * t, angle));
    };
    sheet.brdf = [=](glm::dvec2 uv, const glm::dvec3&) {
      const double angle = kTwoPi * (uv.y - 0.5), t = along(uv.x);
      const double ply = 0.5 + 0.5 * std::cos(2 * (angle - kTwoPi * 7 * t));
      const double fibre = periodicFractal({t / kWales, uv.y}, {40, 12}, 2, 101u + uint32_t(course));
      LocalBrdf b;
      b.diffuse =
          glm::vec3(glm::clamp(glm::dvec3(0.55, 0.16, 0.13) * (0.7 + 0.35 * ply + 0.10 * fibre), 0.0, 1.0));
      b.specular = 0.08f;
      b.exponent = 12;
      return b;
    };
    sheet.cells = {std::max(6, resolution / 6), std::max(8, resolution / 8)};
    tile.add(sheet);
  }
}

Sheet groundSheet(double depth, double aspect, const glm::vec3& color, int cells) {
  Sheet sheet;
  sheet.position = [=](glm::dvec2 uv) { return glm::dvec3(uv.x, aspect * uv.y, -depth); };
  sheet.brdf = [color](glm::dvec2, const glm::dvec3&) {
    LocalBrdf b;
    b.diffuse = color, b.exponent = 8;
    return b;
  };
  sheet.cells = glm::ivec2(cells);
  sheet.density = 0.4;  // little of it is seen
  return sheet;
}

// --- fibres -----------------------------------------------------------------------------------------------

// A hair that lies in a bow over the cloth.
struct Fibre {
  glm::dvec2 middle{0};
  double angle = 0, length = 0, sway = 0, lift = 0;

  explicit Fibre(int number) {
    const auto random = [number](uint32_t seed) { return latticeRandom(number, 7, seed); };
    middle = {random(111), random(112)};
    angle = kPi * random(113);
    length = 0.25 + 0.35 * random(114);
    sway = 0.12 * (random(115) - 0.5);
    lift = 0.02 + 0.05 * random(116);
  }
  glm::dvec3 at(double t) const {  // t in [0, 1]
    const double s = t - 0.5, across = sway * std::sin(kTwoPi * t), c = std::cos(angle), n = std::sin(angle);
    // Its ends sink into the cloth.
    const double z = 0.122 + lift * (1 - 16 * s * s * s * s);
    return {middle + glm::dvec2(c * s * length - n * across, n * s * length + c * across), z};
  }
};

void addFibre(SheetTile& tile, int number, int resolution) {
  constexpr double kThickness = 0.006;
  const Fibre fibre(number);
  Sheet sheet;
  sheet.position = [fibre](glm::dvec2 uv) {
    return tubePoint([&](double t) { return fibre.at(t); }, uv.x, -kTwoPi * (uv.y - 0.5),
                     kThickness * (1.15 - 0.5 * uv.x));
  };
  sheet.brdf = [number](glm::dvec2, const glm::dvec3&) {
    LocalBrdf b;
    b.diffuse = glm::vec3(number % 3 == 0 ? glm::dvec3(0.10, 0.16, 0.36) : glm::dvec3(0.66, 0.60, 0.48));
    b.specular = 0.2f, b.exponent = 20;
    return b;
  };
  sheet.cells = {std::max(8, resolution / 8), 6};
  sheet.density = 1.5;  // its width is a texel or two
  tile.add(sheet);
}

}  // namespace

Tile stockinetteTile(int resolution) {
  SheetTile tile("stockinette", kAspect);
  for (int course = 0; course < kCourses; ++course) addCourse(tile, course, resolution);
  tile.add(groundSheet(0.20, kAspect, {0.05f, 0.03f, 0.03f}, 8));
  return tile.take();
}

Tile fibresTile(int resolution) {
  constexpr int kFibres = 20;
  Tile weave = weaveTile(resolution);
  SheetTile hairs("fibres");
  for (int number = 0; number < kFibres; ++number) addFibre(hairs, number, resolution);
  Tile tile = hairs.take();
  // Both are packed already, each into a square of its own: the weave is brought to the scale of its lengths.
  const auto scaleOf = [](const Tile& t) {
    double surface = 0, parameter = 0;
    for (const glm::uvec3& v : t.triangles) {
      surface +=
          glm::length(glm::cross(t.positions[v.y] - t.positions[v.x], t.positions[v.z] - t.positions[v.x]));
      const glm::dvec2 a = t.params[v.y] - t.params[v.x], b = t.params[v.z] - t.params[v.x];
      parameter += std::abs(a.x * b.y - a.y * b.x);
    }
    return std::sqrt(surface / parameter);
  };
  constexpr double kHairDensity = 1.5;
  const double of_weave = scaleOf(weave), of_hairs = scaleOf(tile) * kHairDensity;
  for (glm::dvec2& p : tile.params) p *= of_hairs;
  for (glm::dvec2& p : weave.params) p *= of_weave;
  const auto first = uint32_t(tile.positions.size());
  const uint16_t charts = *std::max_element(tile.charts.begin(), tile.charts.end());
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(tile.positions, weave.positions), append(tile.normals, weave.normals);
  append(tile.params, weave.params), append(tile.brdfs, weave.brdfs);
  for (const glm::uvec3& t : weave.triangles) tile.triangles.push_back(t + first);
  for (const uint16_t chart : weave.charts) tile.charts.push_back(uint16_t(chart + charts));
  packCharts(tile);
  return tile;
}

}  // namespace loden::importer
