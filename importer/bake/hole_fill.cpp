// Filling chart by chart.
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <optional>

#include "importer/bake/push_pull.h"
#include "importer/base/periodic_noise.h"
#include "material/base/check.h"

namespace loden::importer {
namespace {

// Values of undefined texels from the defined ones: each is the mean of those of its four neighbours that
// belong to the same chart. Factored once.
class Harmonic {
 public:
  // texels: of one chart; defined: over the whole map.
  Harmonic(int side, std::span<const uint32_t> texels, std::span<const float> weights,
           std::span<const uint16_t> owners);
  void apply(std::span<glm::vec3> texels) const;

 private:
  std::vector<uint32_t> unknown_;  // texels
  struct Known {
    uint32_t row, texel;
  };
  std::vector<Known> known_;  // defined neighbours
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

Harmonic::Harmonic(int side, std::span<const uint32_t> texels, std::span<const float> weights,
                   std::span<const uint16_t> owners) {
  std::vector<int> row_of(weights.size(), -1);
  for (const uint32_t t : texels)
    if (!(weights[t] > 0)) row_of[t] = int(unknown_.size()), unknown_.push_back(t);
  std::vector<Eigen::Triplet<double>> entries;
  for (const uint32_t t : unknown_) {
    const int row = row_of[t], i = int(t) % side, j = int(t) / side;
    // Far weaker than any neighbour, towards 0: islands without a defined neighbour must not be singular.
    double diagonal = 1e-12;
    for (int k = 0; k < 4; ++k) {
      const int x = wrapIndex(i + (k == 0) - (k == 1), side), y = wrapIndex(j + (k == 2) - (k == 3), side);
      const auto other = uint32_t(y * side + x);
      if (other == t || (!owners.empty() && owners[other] != owners[t])) continue;
      diagonal += 1;
      if (row_of[other] >= 0)
        entries.emplace_back(row, row_of[other], -1.0);
      else
        known_.push_back({uint32_t(row), other});
    }
    entries.emplace_back(row, row, diagonal);
  }
  Eigen::SparseMatrix<double> matrix(Eigen::Index(unknown_.size()), Eigen::Index(unknown_.size()));
  matrix.setFromTriplets(entries.begin(), entries.end());
  solver_.compute(matrix);
  LODEN_CHECK(solver_.info() == Eigen::Success);
}

void Harmonic::apply(std::span<glm::vec3> texels) const {
  if (unknown_.empty()) return;
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(Eigen::Index(unknown_.size()), 3);
  for (const Known& known : known_)
    for (int c = 0; c < 3; ++c) right(known.row, c) += double(texels[known.texel][c]);
  const Eigen::MatrixX3d solution = solver_.solve(right);
  for (size_t k = 0; k < unknown_.size(); ++k)
    for (int c = 0; c < 3; ++c) texels[unknown_[k]][c] = float(solution(Eigen::Index(k), c));
}

// The shortest run of indices, modulo side, that holds all used ones: (first, count).
glm::ivec2 shortestRun(const std::vector<bool>& used) {
  const int side = int(used.size());
  glm::ivec2 best(0, side);
  int free = 0;
  for (int k = 0; k < 2 * side; ++k) {
    if (!used[size_t(k % side)])
      ++free;
    else {
      if (side - free < best.y) best = {k % side, side - free};
      free = 0;
    }
  }
  return best;
}

// Push-pull over the rectangle around a chart.
class Framed {
 public:
  Framed(int side, std::span<const uint32_t> texels, std::span<const float> weights) : side_(side) {
    const auto extent = size_t(side);
    std::vector<bool> columns(extent), rows(extent);
    for (const uint32_t t : texels) columns[t % extent] = true, rows[t / extent] = true;
    const glm::ivec2 x = shortestRun(columns), y = shortestRun(rows);
    low_ = {x.x, y.x}, size_ = {x.y, y.y};
    std::vector<float> framed(size_t(size_.x) * size_t(size_.y));
    for (const uint32_t t : texels) {
      const glm::ivec2 at(wrapIndex(int(t % extent) - low_.x, side),
                          wrapIndex(int(t / extent) - low_.y, side));
      places_.push_back({t, uint32_t(at.y * size_.x + at.x)});
      framed[places_.back().framed] = weights[t];
    }
    fill_.emplace(size_, glm::equal(size_, glm::ivec2(side)), framed);
  }
  void apply(std::span<glm::vec3> texels) const {
    std::vector<glm::vec3> framed(size_t(size_.x) * size_t(size_.y));
    for (const Place& place : places_) framed[place.framed] = texels[place.texel];
    fill_->apply(framed);
    for (const Place& place : places_) texels[place.texel] = framed[place.framed];
  }

 private:
  struct Place {
    uint32_t texel, framed;
  };
  int side_;
  glm::ivec2 low_{0}, size_{0};
  std::vector<Place> places_;
  std::optional<PushPull> fill_;
};

}  // namespace

struct HoleFill::Part {
  std::optional<Harmonic> harmonic;
  std::optional<Framed> framed;
};

HoleFill::HoleFill(FillMethod method, int side, std::span<const float> weights,
                   std::span<const uint16_t> owners) {
  LODEN_CHECK_EQ(weights.size(), size_t(side) * size_t(side));
  LODEN_CHECK(owners.empty() || owners.size() == weights.size());
  std::vector<std::vector<uint32_t>> charts(1);
  for (uint32_t t = 0; t < weights.size(); ++t) {
    const size_t chart = owners.empty() ? 0 : owners[t];
    if (charts.size() <= chart) charts.resize(chart + 1);
    charts[chart].push_back(t);
    if (weights[t] > 0) defined_.push_back(t);
  }
  for (const auto& texels : charts) {
    const auto defined =
        size_t(std::count_if(texels.begin(), texels.end(), [&](uint32_t t) { return weights[t] > 0; }));
    if (defined == texels.size()) continue;
    if (defined == 0) {
      orphans_.insert(orphans_.end(), texels.begin(), texels.end());
      continue;
    }
    parts_.push_back(std::make_unique<Part>());
    if (method == FillMethod::kHarmonic)
      parts_.back()->harmonic.emplace(side, texels, weights, owners);
    else
      parts_.back()->framed.emplace(side, texels, weights);
  }
}

HoleFill::~HoleFill() = default;
HoleFill::HoleFill(HoleFill&&) noexcept = default;

void HoleFill::apply(std::span<glm::vec3> texels) const {
  for (const auto& part : parts_) {
    if (part->harmonic)
      part->harmonic->apply(texels);
    else
      part->framed->apply(texels);
  }
  if (defined_.empty()) return;
  glm::dvec3 mean(0);
  for (const uint32_t t : defined_) mean += glm::dvec3(texels[t]) / double(defined_.size());
  for (const uint32_t t : orphans_) texels[t] = glm::vec3(mean);
}

}  // namespace loden::importer
