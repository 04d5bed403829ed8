#include "importer/bake/linear_texels.h"

#include <algorithm>
#include <numeric>

#include "importer/base/periodic_noise.h"
#include "material/model/color.h"

namespace loden::importer {
namespace {

constexpr int kSteps = 12;
// Of the normal equations, relative to their row sums: eigenvalues from 1/9 (a checkerboard) to 1, so that
// Nesterov's method gains a factor of at least 1.5 a step with momentum (3 - 1) / (3 + 1).
constexpr float kMomentum = 0.5f;
// Weight of the first guess, of the weight of a texel that is wholly seen.
constexpr float kPrior = 0.01f;

// How much a sample counts: an error of radiance is seen about in proportion to its share of what is there,
// but black must not count without end. At .3 of white half; smaller values would cost more of the RMSE than
// they gain in Lab.
float weightOf(const glm::vec3& value) {
  constexpr float kHalf = 0.3f;
  const float y = static_cast<float>(yccFromRgb(glm::vec3(value)).x);
  return kHalf / (kHalf + std::max(y, 0.0f));
}

// The texels that the filter reads at a place of a texel, from that one.
struct Tap {
  glm::ivec2 step;
  float weight;
};
std::array<Tap, 4> tapsAt(const glm::dvec2& place) {
  const glm::dvec2 at = place - 0.5, cell = glm::floor(at), f = at - cell;
  std::array<Tap, 4> taps;
  for (int k = 0; k < 4; ++k) {
    const glm::ivec2 corner(k & 1, k >> 1);
    taps[size_t(k)] = {glm::ivec2(cell) + corner,
                       float((corner.x ? f.x : 1 - f.x) * (corner.y ? f.y : 1 - f.y))};
  }
  return taps;
}

}  // namespace

LinearTexels::LinearTexels(int side, int per_side, size_t lights)
    : side_(side),
      lights_(lights),
      full_(float(per_side * per_side)),
      normal_(size_t(side) * size_t(side) * lights),
      right_(normal_.size()) {}

size_t LinearTexels::texelAt(glm::ivec2 at) const {
  return size_t(wrapIndex(at.y, side_)) * size_t(side_) + size_t(wrapIndex(at.x, side_));
}

void LinearTexels::add(glm::ivec2 texel, const glm::dvec2& place, std::span<const glm::vec3> values) {
  const auto taps = tapsAt(place);
  std::array<size_t, 4> first;  // of each tap's lights
  for (size_t k = 0; k < taps.size(); ++k) first[k] = texelAt(texel + taps[k].step) * lights_;
  for (size_t l = 0; l < lights_; ++l) {
    const float weight = weightOf(values[l]);
    for (size_t k = 0; k < taps.size(); ++k) {
      const Tap& tap = taps[k];
      const float share = weight * tap.weight;
      Row& row = normal_[first[k] + l];
      for (const Tap& other : taps) {
        const glm::ivec2 off = other.step - tap.step + 1;
        row[size_t(3 * off.y + off.x)] += share * other.weight;
      }
      right_[first[k] + l] += share * values[l];
    }
  }
}

// Projected gradient steps with momentum, each texel's scaled by its row sum.
void LinearTexels::fit(size_t light, std::span<glm::vec3> texels) const {
  struct Equation {
    size_t texel, around[kNear];
    const Row& normal;
    float prior, scale;
    glm::vec3 right;  // prior included
  };
  std::vector<Equation> rows;  // of texels with samples around them; the others stay
  for (int j = 0; j < side_; ++j)
    for (int i = 0; i < side_; ++i) {
      const size_t texel = texelAt({i, j}), equation = texel * lights_ + light;
      const float sum = std::accumulate(normal_[equation].begin(), normal_[equation].end(), 0.0f);
      if (sum == 0) continue;
      const float prior = kPrior * full_ * weightOf(texels[texel]);
      Equation row{
          texel, {}, normal_[equation], prior, 1 / (sum + prior), right_[equation] + prior * texels[texel]};
      for (int k = 0; k < kNear; ++k) row.around[k] = texelAt({i + k % 3 - 1, j + k / 3 - 1});
      rows.push_back(row);
    }
  std::vector<glm::vec3> ahead(texels.begin(), texels.end()), next(ahead);
  for (int step = 0; step < kSteps; ++step) {
    for (const Equation& row : rows) {
      glm::vec3 rest = row.right - row.prior * ahead[row.texel];
      for (int k = 0; k < kNear; ++k) rest -= row.normal[size_t(k)] * ahead[row.around[k]];
      next[row.texel] = glm::max(ahead[row.texel] + row.scale * rest, glm::vec3(0));
    }
    for (const Equation& row : rows) {
      ahead[row.texel] = next[row.texel] + kMomentum * (next[row.texel] - texels[row.texel]);
      texels[row.texel] = next[row.texel];
    }
  }
}

}  // namespace loden::importer
