#include "importer/bake/push_pull.h"

#include <algorithm>

#include "importer/base/periodic_noise.h"
#include "material/base/check.h"

namespace loden::importer {
namespace {

// The fine texels under coarse texel k: two, or one at the end of an odd side.
int lastChild(int k, int fine_side) {
  return std::min(2 * k + 1, fine_side - 1);
}

}  // namespace

PushPull::PushPull(glm::ivec2 size, glm::bvec2 wraps, std::span<const float> weights) : wraps_(wraps) {
  LODEN_CHECK_EQ(weights.size(), size_t(size.x) * size_t(size.y));
  levels_.push_back({size, {}});
  for (const float w : weights) levels_[0].weight.push_back(w > 0 ? 1.0f : 0.0f);
  while (levels_.back().size != glm::ivec2(1)) {
    const Level& fine = levels_.back();
    Level coarse{(fine.size + 1) / 2, {}};
    for (int j = 0; j < coarse.size.y; ++j)
      for (int i = 0; i < coarse.size.x; ++i) {
        float sum = 0;
        for (int y = 2 * j; y <= lastChild(j, fine.size.y); ++y)
          for (int x = 2 * i; x <= lastChild(i, fine.size.x); ++x)
            sum += fine.weight[size_t(y * fine.size.x + x)];
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
    const glm::ivec2 size = levels_[k].size;
    values[k].resize(size_t(size.x * size.y));
    for (int j = 0; j < size.y; ++j)
      for (int i = 0; i < size.x; ++i) {
        glm::vec3 sum(0);
        float weight = 0;
        for (int y = 2 * j; y <= lastChild(j, fine.size.y); ++y)
          for (int x = 2 * i; x <= lastChild(i, fine.size.x); ++x) {
            const size_t texel = size_t(y * fine.size.x + x);
            sum += fine.weight[texel] * values[k - 1][texel];
            weight += fine.weight[texel];
          }
        if (weight > 0) values[k][size_t(j * size.x + i)] = sum / weight;
      }
  }
  // Push: what is missing comes from the level above, bilinearly.
  for (size_t k = levels_.size() - 1; k-- > 0;) {
    const Level& fine = levels_[k];
    const glm::ivec2 size = levels_[k + 1].size;
    const auto neighbour = [](int at, int step, int count, bool wraps) {
      return wraps ? wrapIndex(at + step, count) : std::clamp(at + step, 0, count - 1);
    };
    for (int j = 0; j < fine.size.y; ++j)
      for (int i = 0; i < fine.size.x; ++i) {
        const size_t texel = size_t(j * fine.size.x + i);
        if (fine.weight[texel] >= 1) continue;
        const int x0 = i / 2, y0 = j / 2;
        const int x1 = neighbour(x0, i % 2 ? 1 : -1, size.x, wraps_.x),
                  y1 = neighbour(y0, j % 2 ? 1 : -1, size.y, wraps_.y);
        const auto& coarse = values[k + 1];
        const glm::vec3 near_row =
            0.75f * coarse[size_t(y0 * size.x + x0)] + 0.25f * coarse[size_t(y0 * size.x + x1)];
        const glm::vec3 far_row =
            0.75f * coarse[size_t(y1 * size.x + x0)] + 0.25f * coarse[size_t(y1 * size.x + x1)];
        values[k][texel] = glm::mix(0.75f * near_row + 0.25f * far_row, values[k][texel], fine.weight[texel]);
      }
  }
  for (size_t t = 0; t < texels.size(); ++t)
    if (levels_[0].weight[t] == 0) texels[t] = values[0][t];
}

}  // namespace loden::importer
