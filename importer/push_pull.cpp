#include "importer/push_pull.h"

#include <algorithm>

#include "importer/periodic_noise.h"
#include "material/check.h"

namespace loden::importer {
namespace {

// The fine texels under coarse texel k: two, or one at the end of an odd side.
int lastChild(int k, int fine_side) { return std::min(2 * k + 1, fine_side - 1); }

}  // namespace

PushPull::PushPull(int side, std::span<const float> weights) {
  LODEN_CHECK_EQ(weights.size(), size_t(side) * size_t(side));
  levels_.push_back({side, {}});
  for (const float w : weights) levels_[0].weight.push_back(w > 0 ? 1.0f : 0.0f);
  while (levels_.back().side > 1) {
    const Level& fine = levels_.back();
    Level coarse{(fine.side + 1) / 2, {}};
    for (int j = 0; j < coarse.side; ++j)
      for (int i = 0; i < coarse.side; ++i) {
        float sum = 0;
        for (int y = 2 * j; y <= lastChild(j, fine.side); ++y)
          for (int x = 2 * i; x <= lastChild(i, fine.side); ++x) sum += fine.weight[size_t(y * fine.side + x)];
        coarse.weight.push_back(std::min(sum, 1.0f));
      }
    levels_.push_back(std::move(coarse));
  }
}

void PushPull::apply(std::span<glm::vec3> texels) const {
  LODEN_CHECK_EQ(texels.size(), levels_[0].weight.size());
  if (levels_.back().weight[0] == 0) return;
  // Pull: weighted means of the defined texels.
  std::vector<std::vector<glm::vec3>> values(levels_.size());
  values[0].assign(texels.begin(), texels.end());
  for (size_t k = 1; k < levels_.size(); ++k) {
    const Level& fine = levels_[k - 1];
    const int side = levels_[k].side;
    values[k].resize(size_t(side * side));
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        glm::vec3 sum(0);
        float weight = 0;
        for (int y = 2 * j; y <= lastChild(j, fine.side); ++y)
          for (int x = 2 * i; x <= lastChild(i, fine.side); ++x) {
            const size_t texel = size_t(y * fine.side + x);
            sum += fine.weight[texel] * values[k - 1][texel];
            weight += fine.weight[texel];
          }
        if (weight > 0) values[k][size_t(j * side + i)] = sum / weight;
      }
  }
  // Push: what is missing comes from the level above, bilinearly.
  for (size_t k = levels_.size() - 1; k-- > 0;) {
    const Level& fine = levels_[k];
    const int coarse_side = levels_[k + 1].side;
    for (int j = 0; j < fine.side; ++j)
      for (int i = 0; i < fine.side; ++i) {
        const size_t texel = size_t(j * fine.side + i);
        if (fine.weight[texel] >= 1) continue;
        const int x0 = i / 2, y0 = j / 2;
        const int x1 = wrapIndex(x0 + (i % 2 ? 1 : -1), coarse_side), y1 = wrapIndex(y0 + (j % 2 ? 1 : -1), coarse_side);
        const auto& coarse = values[k + 1];
        const glm::vec3 near_row = 0.75f * coarse[size_t(y0 * coarse_side + x0)] + 0.25f * coarse[size_t(y0 * coarse_side + x1)];
        const glm::vec3 far_row = 0.75f * coarse[size_t(y1 * coarse_side + x0)] + 0.25f * coarse[size_t(y1 * coarse_side + x1)];
        values[k][texel] = glm::mix(0.75f * near_row + 0.25f * far_row, values[k][texel], fine.weight[texel]);
      }
  }
  for (size_t t = 0; t < texels.size(); ++t)
    if (levels_[0].weight[t] == 0) texels[t] = values[0][t];
}

}  // namespace loden::importer
