#include "importer/mesh/weld.h"

#include <cmath>
#include <unordered_map>

namespace loden::importer {
namespace {

// Cells of a grid that is much coarser than the tolerance, so that neighbours are rarely needed.
class WeldGrid {
 public:
  WeldGrid(const glm::dvec3& period, double tolerance) : period_(period), tolerance_(tolerance) {
    for (int axis = 0; axis < 3; ++axis) {
      cell_[axis] = 64 * tolerance;
      if (period[axis] > 0)
        cell_[axis] = period[axis] / std::max(1.0, std::floor(period[axis] / cell_[axis]));
    }
  }

  uint32_t weld(std::span<const glm::dvec3> positions, uint32_t vertex) {
    const glm::dvec3& p = positions[vertex];
    const glm::i64vec3 low = cellOf(p - tolerance_), high = cellOf(p + tolerance_);
    for (int64_t z = low.z; z <= high.z; ++z)
      for (int64_t y = low.y; y <= high.y; ++y)
        for (int64_t x = low.x; x <= high.x; ++x)
          if (const auto found = cells_.find(key({x, y, z})); found != cells_.end())
            for (const uint32_t other : found->second)
              if (near(p, positions[other])) return other;
    cells_[key(cellOf(p))].push_back(vertex);
    return vertex;
  }

 private:
  glm::i64vec3 cellOf(const glm::dvec3& p) const { return glm::i64vec3(glm::floor(p / cell_)); }
  uint64_t key(glm::i64vec3 cell) const {
    uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (period_[axis] > 0) {
        const auto cells = static_cast<int64_t>(std::llround(period_[axis] / cell_[axis]));
        cell[axis] = (cell[axis] % cells + cells) % cells;
      }
      hash = (hash ^ static_cast<uint64_t>(cell[axis])) * 0x9E3779B97F4A7C15ull;
      hash ^= hash >> 29;
    }
    return hash;
  }
  bool near(const glm::dvec3& a, const glm::dvec3& b) const {
    for (int axis = 0; axis < 3; ++axis) {
      double d = a[axis] - b[axis];
      if (period_[axis] > 0) d -= period_[axis] * std::round(d / period_[axis]);
      if (std::abs(d) > tolerance_) return false;
    }
    return true;
  }

  glm::dvec3 period_, cell_;
  double tolerance_;
  std::unordered_map<uint64_t, std::vector<uint32_t>> cells_;
};

}  // namespace

std::vector<uint32_t> weldVertices(std::span<const glm::dvec3> positions, const glm::dvec3& period,
                                   double tolerance) {
  WeldGrid grid(period, tolerance);
  std::vector<uint32_t> representative(positions.size());
  for (uint32_t v = 0; v < positions.size(); ++v) representative[v] = grid.weld(positions, v);
  return representative;
}

}  // namespace loden::importer
