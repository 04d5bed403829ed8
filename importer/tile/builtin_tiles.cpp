// Procedural analogues of FBTF figure 1. Each is a periodic grid over p, deformed: button and isba overhang
// and are parameterized by surface area, pulli and sponge are height fields over p = xy.
#include <algorithm>
#include <array>
#include <functional>

#include "importer/base/periodic_noise.h"
#include "importer/tile/polygon_mesh.h"
#include "importer/tile/tile_parts.h"
#include "material/base/issues.h"
#include "material/model/directions.h"

namespace loden::importer {
namespace {

constexpr double kTwoPi = 2 * kPi;

double smooth(double low, double high, double x) {
  return glm::smoothstep(low, high, x);
}

// --- button: mushroom knobs on a cloth ---------------------------------------------------------------------

// A curve (radius, height) from the foot's outer edge to the axis, as a function of the parameter radius:
// equal areas of the surface of revolution get equal areas of the disk.
class MushroomProfile {
 public:
  static constexpr double kDisk = 0.232;  // radius in the parameter domain, tile periods
  static constexpr double kFoot = 0.200;  // radius in space, tile periods
  MushroomProfile();
  glm::dvec2 at(double disk_radius) const;

 private:
  static glm::dvec2 spline(double u);  // u in [0, kSpans]
  static constexpr int kSpans = 12, kSamples = 8192;
  std::vector<glm::dvec2> curve_;    // from the axis outwards
  std::vector<double> disk_radius_;  // ascending
};

glm::dvec2 MushroomProfile::spline(double u) {
  // Control points of a uniform cubic B-spline; the outermost and innermost are ghosts that make the ends
  // straight, so that the curve starts in the plane of the cloth and meets the axis at a right angle.
  static constexpr std::array<std::array<double, 2>, kSpans + 3> kControl{{{.230, -.19},
                                                                           {.200, -.19},
                                                                           {.170, -.19},
                                                                           {.125, -.19},
                                                                           {.085, -.187},
                                                                           {.080, -.150},
                                                                           {.084, -.112},
                                                                           {.120, -.096},
                                                                           {.165, -.092},
                                                                           {.190, -.055},
                                                                           {.160, -.016},
                                                                           {.110, -.003},
                                                                           {.055, .0},
                                                                           {.0, .0},
                                                                           {-.055, .0}}};
  const int span = std::clamp(static_cast<int>(u), 0, kSpans - 1);
  const double t = u - span, s = 1 - t;
  const double w[4] = {s * s * s, 3 * t * t * t - 6 * t * t + 4, 3 * s * s * s - 6 * s * s + 4, t * t * t};
  glm::dvec2 sum(0);
  for (int k = 0; k < 4; ++k) sum += w[k] / 6 * glm::dvec2(kControl[span + k][0], kControl[span + k][1]);
  return sum;
}

MushroomProfile::MushroomProfile() {
  for (int k = 0; k <= kSamples; ++k) curve_.push_back(spline(kSpans * (1 - double(k) / kSamples)));
  std::vector<double> area(1, 0.0);  // of the surface within sample k, over 2 pi
  for (int k = 1; k <= kSamples; ++k)
    area.push_back(area.back() + std::max(0.0, (curve_[k].x + curve_[k - 1].x) / 2) *
                                     glm::distance(curve_[k], curve_[k - 1]));
  for (const double share : area) disk_radius_.push_back(kDisk * std::sqrt(share / area.back()));
}

glm::dvec2 MushroomProfile::at(double disk_radius) const {
  const auto above = std::upper_bound(disk_radius_.begin() + 1, disk_radius_.end() - 1, disk_radius);
  const size_t k = static_cast<size_t>(above - disk_radius_.begin());
  const double t = (disk_radius - disk_radius_[k - 1]) / (disk_radius_[k] - disk_radius_[k - 1]);
  return glm::mix(curve_[k - 1], curve_[k], t);
}

TorusSurface buttonSurface() {
  const auto profile = std::make_shared<const MushroomProfile>();
  const auto cell = [](glm::dvec2 p) {  // two rows of two knobs, the upper row shifted by half a knob
    const double row = std::floor(p.y * 2), shift = int(row) % 2 ? 0.25 : 0.0;
    const double column = std::floor((p.x - shift) * 2);
    return glm::dvec4((column + 0.5) / 2 + shift, (row + 0.5) / 2, column, row);
  };
  const auto position = [profile, cell](glm::dvec2 p) {
    const glm::dvec4 knob = cell(p);
    const glm::dvec2 offset = p - glm::dvec2(knob);
    const double r = glm::length(offset);
    const double height = 0.82 + 0.18 * latticeRandom(wrapIndex(int(knob.z), 2), int(knob.w) & 1, 7);
    const double border =
        r * 0.25 / std::max({std::abs(offset.x), std::abs(offset.y), 1e-9});  // of the cell, along offset
    glm::dvec2 at(0, -0.19);
    if (r < MushroomProfile::kDisk)
      at = profile->at(r);
    else
      at.x = glm::mix(MushroomProfile::kFoot, border,
                      (r - MushroomProfile::kDisk) / (border - MushroomProfile::kDisk));
    glm::dvec3 point(glm::dvec2(knob) + (r > 1e-9 ? offset * (at.x / r) : glm::dvec2(0)),
                     (at.y + 0.19) * height);
    point.z +=
        0.0035 * std::sin(kTwoPi * 12 * point.x) * std::sin(kTwoPi * 12 * point.y);  // weave of the cloth
    return point;
  };
  const auto brdf = [](glm::dvec2 p, const glm::dvec3& at) {
    LocalBrdf b;
    const double cap = smooth(0.06, 0.11, at.z), tint = 1 + 0.06 * periodicFractal(p, {12, 12}, 3, 21);
    b.diffuse = glm::vec3(glm::mix(glm::dvec3(0.34, 0.075, 0.05), glm::dvec3(0.62, 0.17, 0.075), cap) * tint);
    b.specular = float(glm::mix(0.10, 0.28, cap));
    b.exponent = 26;
    return b;
  };
  return {position, brdf, false};
}

// --- isba: curled folds that lean over
// -----------------------------------------------------------------------

// One period of the folds' cross-section by arc length. A bulging wave, then a shear by height: maps of the
// plane onto itself, so the curve never meets itself.
class FoldSection {
 public:
  FoldSection();
  glm::dvec2 at(double t) const;  // (x, z), x(t + 1) = x(t) + 1

 private:
  static constexpr int kFolds = 3, kSamples = 6144;
  static glm::dvec2 curve(double u);
  std::vector<double> length_;  // share of the arc length up to sample k
};

glm::dvec2 FoldSection::curve(double u) {
  constexpr double kBulge = 0.052, kHeight = 0.21, kLean = 0.45;
  const double angle = kTwoPi * kFolds * u, z = kHeight / 2 * (std::cos(angle) + 1);
  return {u + kBulge * std::sin(2 * angle) + kLean * z * z / kHeight, z};
}

FoldSection::FoldSection() : length_(1, 0.0) {
  for (int k = 1; k <= kSamples; ++k)
    length_.push_back(length_.back() +
                      glm::distance(curve(double(k) / kSamples), curve(double(k - 1) / kSamples)));
  for (double& length : length_) length /= length_.back();
}

glm::dvec2 FoldSection::at(double t) const {
  const double period = std::floor(t), f = t - period;
  const auto above = std::upper_bound(length_.begin() + 1, length_.end() - 1, f);
  const double k = double(above - length_.begin()) - 1;
  const double u = (k + (f - *(above - 1)) / (*above - *(above - 1))) / kSamples;
  return curve(u) + glm::dvec2(period, 0);
}

TorusSurface isbaSurface() {
  const auto section = std::make_shared<const FoldSection>();
  const auto position = [section](glm::dvec2 p) {
    const glm::dvec2 before = section->at(p.x - 1e-4), after = section->at(p.x + 1e-4);
    const glm::dvec2 tangent = glm::normalize(after - before);
    const double cord = 0.0035 * std::sin(kTwoPi * (18 * p.y + 6 * p.x));  // the yarn's twist
    const glm::dvec2 at = section->at(p.x) + cord * glm::dvec2(-tangent.y, tangent.x);
    glm::dvec3 point(at.x, p.y, at.y);
    point.z *=
        1 + 0.12 * std::sin(kTwoPi * (point.x + 2 * point.y) + 1) + 0.06 * std::sin(kTwoPi * 3 * point.y);
    point.x += 0.035 * std::sin(kTwoPi * point.y) + 0.010 * std::sin(kTwoPi * 3 * point.y + 1);
    return point;
  };
  const auto brdf = [](glm::dvec2 p, const glm::dvec3&) {
    LocalBrdf b;
    const double blotch = smooth(-0.5, 0.5, periodicFractal(p, {4, 6}, 3, 5));
    const double thread =
        smooth(-0.2, 0.2, std::sin(kTwoPi * (18 * p.y + 6 * p.x)) + 0.6 * periodicNoise(p, {24, 36}, 9));
    const glm::dvec3 ground = glm::mix(glm::dvec3(0.045, 0.20, 0.19), glm::dvec3(0.10, 0.33, 0.16), blotch);
    b.diffuse = glm::vec3(glm::mix(ground, glm::dvec3(0.66, 0.52, 0.20), 0.75 * thread * blotch));
    b.specular = float(0.06 + 0.30 * blotch * (1 - 0.6 * thread));
    b.exponent = float(12 + 30 * blotch);
    return b;
  };
  return {position, brdf, false};
}

// --- pulli: a knitted pullover
// -------------------------------------------------------------------------------

constexpr int kWales = 6, kCourses = 8;  // stitches per tile, across and along

// Height of the nearest stitch legs over p, and which stitch that is. Each stitch is a V of two slanted legs.
struct Knit {
  double height = 0;  // 0 (gap) .. 1 (ridge)
  glm::ivec2 stitch{0};
  double along = 0;  // position along the leg, stitch units
};

Knit knitAt(glm::dvec2 p) {
  const glm::dvec2 q = p * glm::dvec2(kWales, kCourses);
  const glm::ivec2 centre(glm::floor(q));
  Knit knit;
  double sum = 0, nearest = -1;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      for (int leg = -1; leg <= 1; leg += 2) {
        const glm::ivec2 stitch = centre + glm::ivec2(dx, dy);
        const int wx = wrapIndex(stitch.x, kWales), wy = wrapIndex(stitch.y, kCourses);
        const double slant = 0.52 + 0.10 * (latticeRandom(wx, wy, 31) - 0.5);
        const glm::dvec2 d = q - glm::dvec2(stitch) -
                             glm::dvec2(0.5 + leg * 0.235, 0.5 + 0.12 * (latticeRandom(wx, wy, 33) - 0.5));
        const double c = std::cos(slant), s = leg * std::sin(slant);
        const double across = (c * d.x - s * d.y * 0.75) / 0.25, along = (s * d.x / 0.75 + c * d.y) / 0.78;
        const double bump = std::exp(-1.6 * (across * across + along * along * along * along));
        sum += std::pow(bump, 6);
        if (bump > nearest) nearest = bump, knit.stitch = {wx * 2 + (leg + 1) / 2, wy}, knit.along = along;
      }
  knit.height = std::min(1.0, std::pow(sum, 1.0 / 6));  // a smooth maximum
  return knit;
}

TorusSurface pulliSurface() {
  const auto position = [](glm::dvec2 p) {
    const double knit = knitAt(p).height;
    const double fibre = 0.007 * periodicNoise(p, {40, 18}, 3) + 0.012 * periodicFractal(p, {6, 4}, 2, 4);
    return glm::dvec3(p, 0.085 * knit + fibre * (0.3 + knit));
  };
  const auto brdf = [](glm::dvec2 p, const glm::dvec3&) {
    LocalBrdf b;
    const Knit knit = knitAt(p);
    const double fleck = smooth(0.2, 0.7, periodicFractal(p, {18, 13}, 2, 41));
    const double dye = latticeRandom(knit.stitch.x, knit.stitch.y, 43);
    const double band = 0.5 + 0.5 * std::sin(kTwoPi * p.y);
    const glm::dvec3 yarn =
        glm::mix(glm::dvec3(0.10, 0.16, 0.42), glm::dvec3(0.42, 0.14, 0.30), smooth(0.25, 0.75, band));
    b.diffuse = glm::vec3(glm::mix(yarn * (0.75 + 0.5 * dye), glm::dvec3(0.72, 0.66, 0.55), 0.7 * fleck));
    b.specular = float(0.03 + 0.10 * dye * (1 - fleck));
    b.exponent = float(6 + 10 * dye);
    return b;
  };
  return {position, brdf, true};
}

// --- sponge: pores in a rough slab
// ---------------------------------------------------------------------------

TorusSurface spongeSurface() {
  struct Pore {
    glm::dvec2 centre;
    double radius, depth;
  };
  std::vector<Pore> pores;
  constexpr int kSide = 7;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const glm::dvec2 jitter(latticeRandom(i, j, 51) - 0.5, latticeRandom(i, j, 52) - 0.5);
      const double radius = 0.035 + 0.065 * std::pow(latticeRandom(i, j, 53), 2);
      pores.push_back({(glm::dvec2(i, j) + 0.5 + 0.8 * jitter) / double(kSide), radius, 1.4 * radius + 0.07});
    }
  const auto position = [pores](glm::dvec2 p) {
    double z = 0.022 * periodicFractal(p, {8, 8}, 3, 61);
    for (const Pore& pore : pores) {
      const glm::dvec2 d = p - pore.centre, wrapped = d - glm::round(d);
      const double wobble = 1 + 0.25 * periodicNoise(p, {14, 14}, 67);
      z -= pore.depth * (1 - smooth(0.35, 1.0, glm::length(wrapped) / (pore.radius * wobble)));
    }
    return glm::dvec3(p, z);
  };
  const auto brdf = [](glm::dvec2 p, const glm::dvec3& at) {
    LocalBrdf b;
    const double shade = 1 + 0.05 * periodicFractal(p, {10, 10}, 3, 71);
    b.diffuse = glm::vec3(
        glm::mix(glm::dvec3(0.62, 0.34, 0.08), glm::dvec3(0.86, 0.60, 0.20), smooth(-0.15, 0.0, at.z)) *
        shade);
    b.specular = 0.06f;
    b.exponent = 14;
    return b;
  };
  return {position, brdf, true};
}

}  // namespace

namespace {

struct Maker {
  const char* name;
  Tile (*make)(int resolution);
};

template <TorusSurface (*surface)()>
Tile grid(int resolution) {
  return gridTile("", resolution, surface());
}

constexpr Maker kMakers[] = {
    {"button", grid<buttonSurface>}, {"isba", grid<isbaSurface>}, {"pulli", grid<pulliSurface>},
    {"sponge", grid<spongeSurface>}, {"weave", weaveTile},        {"stockinette", stockinetteTile},
    {"fibres", fibresTile},          {"rings", ringsTile},        {"shingles", shinglesTile},
    {"leather", leatherTile},        {"bricks", bricksTile}};

}  // namespace

const std::vector<std::string>& builtinTileNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Maker& maker : kMakers) all.push_back(maker.name);
    return all;
  }();
  return names;
}

const std::string& builtinTileList() {
  static const std::string list = [] {
    std::string all = "builtin:";
    for (const std::string& name : builtinTileNames()) all += name + "|";
    all.pop_back();
    return all;
  }();
  return list;
}

Result<Tile> builtinTile(const std::string& name, int resolution) {
  LODEN_CHECK_LT(2, resolution);
  for (const Maker& maker : kMakers) {
    if (name != maker.name) continue;
    Tile tile = maker.make(resolution);
    tile.name = name;
    return finishTile(std::move(tile), "builtin:" + name);
  }
  return Issue{issue_id::kOption, Severity::kError, "builtin:" + name,
               "no such tile; there are " + builtinTileList()};
}

}  // namespace loden::importer
