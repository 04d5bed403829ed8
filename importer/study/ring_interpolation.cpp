#include "importer/study/ring_interpolation.h"

#include <algorithm>
#include <cmath>

namespace loden::importer {

DirectionWeights interpolateRings(const std::vector<Ring>& rings, const glm::dvec3& w) {
  const Spherical s = sphericalFromDirection(w);
  size_t lower = 0;
  while (lower + 2 < rings.size() && s.theta > rings[lower + 1].theta) ++lower;
  const double between = (s.theta - rings[lower].theta) / (rings[lower + 1].theta - rings[lower].theta);
  int first = 0;
  for (size_t r = 0; r < lower; ++r) first += rings[r].count;
  DirectionWeights result;
  for (int k = 0; k < 2; ++k) {
    const Ring& ring = rings[lower + k];
    const double ring_weight = k == 0 ? 1 - std::clamp(between, 0.0, 1.0) : std::clamp(between, 0.0, 1.0);
    const double position = (s.phi - ring.first_phi) / (2 * kPi) * ring.count;
    const double cell = std::floor(position), share = position - cell;
    const int left = ((static_cast<int>(cell) % ring.count) + ring.count) % ring.count;
    result.index[2 * k] = first + left;
    result.index[2 * k + 1] = first + (left + 1) % ring.count;
    result.weight[2 * k] = ring_weight * (1 - share);
    result.weight[2 * k + 1] = ring_weight * share;
    first += ring.count;
  }
  return result;
}

}  // namespace loden::importer
