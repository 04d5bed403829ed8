#include "importer/study/cone_map.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "importer/base/parallel.h"
#include "material/base/check.h"
#include "material/model/vdim.h"

namespace loden::importer {
namespace {

constexpr double kWidest = 16;  // wider cones are not stored; the lookup's most grazing ray leaves at 11.4

double heightOf(const ConeMap& map, int i, int j) {
  return map.texels[size_t(wrapIndex(j, map.side)) * size_t(map.side) + size_t(wrapIndex(i, map.side))].x;
}

// Ring by ring of texels outwards, until even the highest point of the tile could not narrow the cone.
double widestCone(const ConeMap& map, int i, int j, double z_max) {
  const double z = heightOf(map, i, j);
  double widest = kWidest;
  const auto visit = [&](int di, int dj) {
    const double above = heightOf(map, i + di, j + dj) - z;
    if (above > 0) widest = std::min(widest, std::hypot(di, dj) / map.side / above);
  };
  for (int ring = 1; ring < widest * (z_max - z) * map.side; ++ring)
    for (int k = -ring; k < ring; ++k) visit(k, -ring), visit(ring, k), visit(-k, ring), visit(-ring, -k);
  return widest;
}

glm::dvec2 bilinear(const ConeMap& map, glm::dvec2 x) {
  const glm::dvec2 texel = x * double(map.side) - .5, base = glm::floor(texel), f = texel - base;
  const auto at = [&](int di, int dj) {
    return map.texels[size_t(wrapIndex(int(base.y) + dj, map.side)) * size_t(map.side) +
                      size_t(wrapIndex(int(base.x) + di, map.side))];
  };
  return glm::mix(glm::mix(at(0, 0), at(1, 0), f.x), glm::mix(at(0, 1), at(1, 1), f.x), f.y);
}

}  // namespace

ConeMap buildConeMap(const GeometryImage& geometry, int threads) {
  LODEN_CHECK_EQ(geometry.identity_parameterization, true);
  ConeMap map{geometry.side(), geometry.aspect, {}};
  const int n = map.side;
  double z_max = geometry.zMin();
  for (int t = 0; t < n * n; ++t) {
    map.texels.emplace_back(fetchPatch<double>(geometry, t % n, t / n).p00.z, kWidest);
    z_max = std::max(z_max, map.texels.back().x);
  }
  parallelFor(size_t(n), threads, [&](size_t j) {
    for (int i = 0; i < n; ++i) map.texels[j * size_t(n) + size_t(i)].y = widestCone(map, i, int(j), z_max);
  });
  return map;
}

ConeHit coneLookup(const ConeMap& map, int taps, glm::dvec2 x, const glm::dvec3& wo) {
  const double sine = std::hypot(wo.x, wo.y);
  const glm::dvec2 slope = periodsPerLength(map.aspect) * glm::dvec2(wo) *
                           std::min(1.0, std::sin(kThetaMax) / std::max(sine, 1e-6)) /
                           std::max(wo.z, std::cos(kThetaMax));
  const double steepness = glm::length(slope), enough = .02 / map.side;
  struct Tap {
    double z, above;  // of the ray; over the surface there
  };
  std::optional<Tap> over, under, before;
  ConeHit hit;
  const auto secant = [](const Tap& a, const Tap& b) {
    return a.above == b.above ? b.z : b.z - b.above * (b.z - a.z) / (b.above - a.above);
  };
  double z = 0;
  while (hit.fetches < taps) {
    const glm::dvec2 texel = bilinear(map, x + slope * z);
    const Tap tap{z, z - texel.x};
    ++hit.fetches;
    (tap.above > 0 ? over : under) = tap;
    const bool last = hit.fetches == taps || std::abs(tap.above) * std::max(1.0, steepness) < enough;
    if (under && over)
      z = secant(*over, *under);
    else if (last && before)
      z = std::min(0.0, secant(*before, tap));
    else
      z -= tap.above * texel.y / (texel.y + steepness);
    if (last) break;
    before = tap;
  }
  hit.p = x + slope * z;
  return hit;
}

}  // namespace loden::importer
