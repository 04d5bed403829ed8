#include "importer/bake/geometry_fit.h"

#include <algorithm>
#include <array>
#include <vector>

#include "importer/tile/param_map.h"
#include "material/base/check.h"
#include "material/model/geometry_image.h"

namespace loden::importer {
namespace {

constexpr int kAcross = 4;  // samples of the surface per side of a texel
// Weight of where a texel was, in samples; those around it have 7 together. Without it the patches are no
// nearer to the surface, and lookups fail on the ripples that edges make.
constexpr double kHold = 6;
constexpr int kSweeps = 12;  // until a thousandth of the change is left

glm::dvec3 displacementAt(const Tile& tile, const ParamSample& at) {
  const glm::uvec3& v = tile.triangles[at.triangle];
  const auto of = [&](uint32_t k) { return tile.positions[k] - glm::dvec3(tile.params[k], 0); };
  const glm::dvec2 b(at.b);
  return (1 - b.x - b.y) * of(v.x) + b.x * of(v.y) + b.y * of(v.z);
}

// Normal equations: a texel's row has the weights of itself and its eight neighbours, which are the same for
// all three coordinates.
struct Row {
  std::array<double, 9> weight{};
  glm::dvec3 right{0};
};

class Fit {
 public:
  Fit(const Tile& tile, int side, std::span<const uint16_t> charts, std::span<glm::dvec3> displacements)
      : tile_(tile), side_(side), charts_(charts), displacements_(displacements), rows_(charts.size()) {
    for (size_t t = 0; t < rows_.size(); ++t)
      rows_[t].weight[4] = kHold, rows_[t].right = kHold * displacements[t];
  }

  // The surface at the same place, in [0, 1)^2, of every texel.
  void addSamples(glm::dvec2 place) {
    const auto located = locateParams(tile_, side_, place);
    const glm::ivec2 lower(place.x < 0.5 ? -1 : 0, place.y < 0.5 ? -1 : 0);
    const glm::dvec2 f = place - 0.5 - glm::dvec2(lower);
    const std::array<double, 4> weights{(1 - f.x) * (1 - f.y), f.x * (1 - f.y), (1 - f.x) * f.y, f.x * f.y};
    for (int j = 0; j < side_; ++j)
      for (int i = 0; i < side_; ++i)
        if (const ParamSample& at = located[index(i, j)]; at.covered())
          add({i + lower.x, j + lower.y}, weights, tile_.charts[at.triangle], displacementAt(tile_, at));
  }

  // Gauss-Seidel.
  void sweep(double depth) {
    for (int j = 0; j < side_; ++j)
      for (int i = 0; i < side_; ++i) {
        const size_t t = index(i, j);
        if (charts_[t] == 0) continue;
        const Row& row = rows_[t];
        glm::dvec3 rest = row.right;
        for (int k = 0; k < 9; ++k)
          if (k != 4) rest -= row.weight[size_t(k)] * displacements_[index(i + k % 3 - 1, j + k / 3 - 1)];
        glm::dvec3 fitted = rest / row.weight[4];
        if (tile_.identity_parameterization) fitted.x = fitted.y = 0;
        fitted.z = std::clamp(fitted.z, -depth, 0.0);
        displacements_[t] = fitted;
      }
  }

 private:
  size_t index(int i, int j) const {
    return size_t(wrapIndex(j, side_)) * size_t(side_) + size_t(wrapIndex(i, side_));
  }

  // A point of the surface in the patch whose lower left corner is `base`; `weights`: of its corners.
  void add(glm::ivec2 base, const std::array<double, 4>& weights, uint16_t chart, const glm::dvec3& point) {
    std::array<size_t, 4> corners;
    for (int k = 0; k < 4; ++k) {
      corners[size_t(k)] = index(base.x + k % 2, base.y + k / 2);
      if (charts_[corners[size_t(k)]] != chart) return;
    }
    for (int k = 0; k < 4; ++k) {
      Row& row = rows_[corners[size_t(k)]];
      row.right += weights[size_t(k)] * point;
      for (int l = 0; l < 4; ++l)
        row.weight[size_t(4 + (l % 2 - k % 2) + 3 * (l / 2 - k / 2))] +=
            weights[size_t(k)] * weights[size_t(l)];
    }
  }

  const Tile& tile_;
  int side_;
  std::span<const uint16_t> charts_;
  std::span<glm::dvec3> displacements_;
  std::vector<Row> rows_;
};

}  // namespace

void fitPatches(const Tile& tile, int side, double depth, std::span<const uint16_t> charts,
                std::span<glm::dvec3> displacements) {
  LODEN_CHECK_EQ(charts.size(), size_t(side) * size_t(side));
  LODEN_CHECK_EQ(displacements.size(), charts.size());
  Fit fit(tile, side, charts, displacements);
  for (int sample = 0; sample < kAcross * kAcross; ++sample)
    fit.addSamples((glm::dvec2(sample % kAcross, sample / kAcross) + 0.5) / double(kAcross));
  for (int k = 0; k < kSweeps; ++k) fit.sweep(depth);
}

}  // namespace loden::importer
