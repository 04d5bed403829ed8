#include "importer/param_map.h"

#include <algorithm>
#include <cmath>

#include "importer/periodic_noise.h"

namespace loden::importer {
namespace {

constexpr double kInside = 1e-9;  // tolerance of barycentric weights, so that samples on shared edges are met

void rasterize(const glm::dvec2 (&corner)[3], uint32_t triangle, int side, glm::dvec2 position, std::vector<ParamSample>& samples) {
  const glm::dvec2 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
  const double area = e1.x * e2.y - e1.y * e2.x;
  if (area == 0) return;
  const glm::dvec2 low = glm::min(corner[0], glm::min(corner[1], corner[2]));
  const glm::dvec2 high = glm::max(corner[0], glm::max(corner[1], corner[2]));
  const glm::ivec2 first(glm::ceil(low * double(side) - position - 1e-6)), last(glm::floor(high * double(side) - position + 1e-6));
  for (int j = first.y; j <= last.y; ++j)
    for (int i = first.x; i <= last.x; ++i) {
      ParamSample& sample = samples[size_t(wrapIndex(j, side)) * size_t(side) + size_t(wrapIndex(i, side))];
      if (sample.covered()) continue;
      const glm::dvec2 d = (glm::dvec2(i, j) + position) / double(side) - corner[0];
      const double b1 = (d.x * e2.y - d.y * e2.x) / area, b2 = (e1.x * d.y - e1.y * d.x) / area;
      if (b1 < -kInside || b2 < -kInside || b1 + b2 > 1 + kInside) continue;
      sample = {triangle, glm::vec2(b1, b2)};
    }
}

}  // namespace

std::vector<ParamSample> locateParams(const Tile& tile, int side, glm::dvec2 position) {
  std::vector<ParamSample> samples(size_t(side) * size_t(side));
  for (uint32_t t = 0; t < tile.triangles.size(); ++t) {
    const glm::uvec3& v = tile.triangles[t];
    rasterize({tile.params[v.x], tile.params[v.y], tile.params[v.z]}, t, side, position, samples);
  }
  return samples;
}

}  // namespace loden::importer
