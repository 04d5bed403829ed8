#include "importer/linear_texels.h"

#include <algorithm>
#include <numeric>

#include "importer/bake_scene.h"
#include "importer/periodic_noise.h"

namespace loden::importer {
namespace {

constexpr int kSteps = 12;
// Of the normal equations, relative to their row sums: eigenvalues from 1/9 (a checkerboard) to 1, so that Nesterov's
// method gains a factor of at least 1.5 a step with momentum (3 - 1) / (3 + 1).
constexpr float kMomentum = 0.5f;
// Weight of the first guess, of the weight of a texel that is wholly seen.
constexpr float kPrior = 0.01f;

}  // namespace

LinearTexels::LinearTexels(int side, int per_side, size_t lights)
    : side_(side), lights_(lights), full_(float(per_side * per_side)), normal_(size_t(side) * size_t(side)), right_(normal_.size() * lights) {
  for (int place = 0; place < per_side * per_side; ++place) {
    const glm::dvec2 at = samplePosition(place, per_side) - 0.5, cell = glm::floor(at), f = at - cell;
    auto& taps = taps_.emplace_back();
    for (int k = 0; k < 4; ++k) {
      const glm::ivec2 corner(k & 1, k >> 1);
      taps[size_t(k)] = {glm::ivec2(cell) + corner, float((corner.x ? f.x : 1 - f.x) * (corner.y ? f.y : 1 - f.y))};
    }
  }
}

size_t LinearTexels::texelAt(glm::ivec2 at) const {
  return size_t(wrapIndex(at.y, side_)) * size_t(side_) + size_t(wrapIndex(at.x, side_));
}

void LinearTexels::add(glm::ivec2 texel, int place, std::span<const glm::vec3> values) {
  const auto& taps = taps_[size_t(place)];
  for (const Tap& tap : taps) {
    const size_t t = texelAt(texel + tap.step);
    for (const Tap& other : taps) {
      const glm::ivec2 off = other.step - tap.step + 1;
      normal_[t][size_t(3 * off.y + off.x)] += tap.weight * other.weight;
    }
    glm::vec3* const right = &right_[t * lights_];
    for (size_t l = 0; l < lights_; ++l) right[l] += tap.weight * values[l];
  }
}

// Projected gradient steps with momentum, each texel's scaled by its row sum.
void LinearTexels::fit(size_t light, std::span<glm::vec3> texels) const {
  const float prior = kPrior * full_;
  struct Row {
    size_t texel, around[kNear];
    float scale;
    glm::vec3 right;  // prior included
  };
  std::vector<Row> rows;  // of texels with samples around them; the others stay
  for (int j = 0; j < side_; ++j)
    for (int i = 0; i < side_; ++i) {
      Row row{texelAt({i, j}), {}, 0, {}};
      const auto& normal = normal_[row.texel];
      const float sum = std::accumulate(normal.begin(), normal.end(), 0.0f);
      if (sum == 0) continue;
      for (int k = 0; k < kNear; ++k) row.around[k] = texelAt({i + k % 3 - 1, j + k / 3 - 1});
      row.scale = 1 / (sum + prior);
      row.right = right_[row.texel * lights_ + light] + prior * texels[row.texel];
      rows.push_back(row);
    }
  std::vector<glm::vec3> ahead(texels.begin(), texels.end()), next(ahead);
  for (int step = 0; step < kSteps; ++step) {
    for (const Row& row : rows) {
      const auto& normal = normal_[row.texel];
      glm::vec3 rest = row.right - prior * ahead[row.texel];
      for (int k = 0; k < kNear; ++k) rest -= normal[size_t(k)] * ahead[row.around[k]];
      next[row.texel] = glm::max(ahead[row.texel] + row.scale * rest, glm::vec3(0));
    }
    for (const Row& row : rows) {
      ahead[row.texel] = next[row.texel] + kMomentum * (next[row.texel] - texels[row.texel]);
      texels[row.texel] = next[row.texel];
    }
  }
}

}  // namespace loden::importer
