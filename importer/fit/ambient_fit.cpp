#include "importer/fit/ambient_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "importer/fit/eigen.h"
#include "importer/fit/reduction.h"
#include "material/eval/evaluate.h"
#include "material/model/environment.h"
#include "material/model/mu.h"

namespace loden::importer {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;

constexpr int kRows = 8;  // of the quadrature over lights
constexpr int kAround =
    2;  // functions of the basis that do not turn with the light around the normal: 1 and z
constexpr int kMostTexels = 1 << 12;  // that the components are found from
constexpr int kTexelsAtOnce = 256;
constexpr double kLinearShare =
    0.5;  // weight of what depends on where the light comes from around the normal

// The integrals of a band over lights, for each view of its table's grid and each function of the basis.
class Integrals {
 public:
  Integrals(const Material& material, const Band& band)
      : m_(material), band_(band), basis_(2 * kRows * kRows, kEnvironmentBasis) {
    for (const LightSample& light : lightQuadrature(material, kRows)) {
      for (int k = 0; k < kEnvironmentBasis; ++k)
        basis_(Index(lights_.size()), k) =
            light.measure * (k < kAround ? 1 : kLinearShare) * light.basis[size_t(k)];
      lights_.push_back(clampTheta(light.direction, double(m_.theta_max)));
    }
    const DirectionGrid grid = environmentGrid(band, m_.theta_max);
    for (int row = 0; row < grid.thetas; ++row)
      for (int column = 0; column + 1 < grid.phis && (row > 0 || column == 0); ++column)
        addView(directionFromSpherical(
            {double(grid.theta_max) * row / (grid.thetas - 1), 2 * kPi * column / (grid.phis - 1)}));
  }

  Index columns() const { return Index(views_.size()) * kEnvironmentBasis; }

  // The components of Y of the same texels, scaled: count x 4 y_quads.
  MatrixXd luma(int first, int stride, int count) const {
    MatrixXd weights(count, 4 * band_.y_quads);
    const int side = band_.weights.width;
    for (int i = 0; i < count; ++i)
      for (int k = 0; k < band_.y_quads; ++k) {
        const int t = first + i * stride;
        const glm::vec4 texel = fetchTexel(band_.weights, 0, t % side, t / side, k);
        for (int c = 0; c < 4; ++c) weights(i, 4 * k + c) = double(texel[c] * band_.quad_scale[size_t(k)][c]);
      }
    return weights;
  }

  // Every `stride`-th texel from `first`, `count` of them: count x columns().
  MatrixXd of(int first, int stride, int count) const {
    const int side = band_.weights.width;
    const MatrixXd weights = luma(first, stride, count);
    MatrixXd factor(count, Index(lights_.size()));
    for (int i = 0; i < count; ++i) {
      const int t = first + i * stride;
      const glm::vec2 q = (glm::vec2(t % side, t / side) + 0.5f) / float(side);
      for (size_t l = 0; l < lights_.size(); ++l)
        factor(i, Index(l)) = double(lightFactorAt(m_, band_, q, glm::vec3(lights_[l])));
    }
    MatrixXd integrals(count, columns());
    for (size_t v = 0; v < views_.size(); ++v) {
      MatrixXd value = weights * views_[v].table;
      value.rowwise() += views_[v].mean;
      value = value.cwiseMax(0.0).cwiseProduct(factor);
      value.rowwise() -= views_[v].mean;
      integrals.middleCols(Index(v) * kEnvironmentBasis, kEnvironmentBasis) = value * basis_;
    }
    return integrals;
  }

 private:
  struct View {
    MatrixXd table;    // 4 y_quads x lights
    RowVectorXd mean;  // of Y, lights
  };

  void addView(const glm::dvec3& wo) {
    View view{MatrixXd(4 * band_.y_quads, Index(lights_.size())), RowVectorXd(Index(lights_.size()))};
    for (size_t l = 0; l < lights_.size(); ++l) {
      for (int k = 0; k < band_.y_quads; ++k) {
        const glm::vec4 value = tableValue(m_, band_, k, glm::vec3(lights_[l]), glm::vec3(wo));
        for (int c = 0; c < 4; ++c) view.table(4 * k + c, Index(l)) = double(value[c]);
      }
      view.mean[Index(l)] = evaluateMean(m_.mean, lights_[l], wo).x;
    }
    views_.push_back(std::move(view));
  }

  const Material& m_;
  const Band& band_;
  std::vector<glm::dvec3> lights_;
  MatrixXd basis_;  // lights x kEnvironmentBasis, with the measure
  std::vector<View> views_;
};

}  // namespace

Matrix ambientWeights(const Material& material, const Band& band, int threads) {
  const Integrals integrals(material, band);
  const int texels = band.weights.width * band.weights.width,
            stride = (texels + kMostTexels - 1) / kMostTexels;
  const int some = (texels + stride - 1) / stride;
  // Of the components of Y and the integrals side by side.
  const Index y = 4 * band.y_quads, all = y + integrals.columns();
  std::vector<MatrixXd> grams(kReductionBlocks, MatrixXd::Zero(all, all));
  parallelFor(kReductionBlocks, threads, [&](int block) {
    for (int first = blockBegin(some, block), end = blockBegin(some, block + 1); first < end;
         first += kTexelsAtOnce) {
      const int count = std::min(kTexelsAtOnce, end - first);
      MatrixXd rows(count, all);
      rows << integrals.luma(first * stride, stride, count), integrals.of(first * stride, stride, count);
      grams[size_t(block)].noalias() += rows.transpose() * rows;
    }
  });
  for (int block = 1; block < kReductionBlocks; ++block) grams[0] += grams[size_t(block)];
  const MatrixXd own = grams[0].topLeftCorner(y, y), cross = grams[0].topRightCorner(y, integrals.columns());
  const MatrixXd ridged =
      own + MatrixXd(Eigen::VectorXd::Constant(y, 1e-6 * own.trace() / double(y) + 1e-300).asDiagonal());
  const MatrixXd fitted = ridged.ldlt().solve(cross);  // the integrals by the components of Y
  const MatrixXd rest = grams[0].bottomRightCorner(integrals.columns(), integrals.columns()) -
                        cross.transpose() * fitted - fitted.transpose() * cross +
                        fitted.transpose() * own * fitted;
  // A few leading factors of many, which the squared condition number does not touch.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> leading(rest);
  const MatrixXd basis = leading.eigenvectors().rightCols(4).rowwise().reverse();
  Matrix weights(texels, 4);
  parallelFor((texels + kTexelsAtOnce - 1) / kTexelsAtOnce, threads, [&](int block) {
    const int first = block * kTexelsAtOnce, count = std::min(kTexelsAtOnce, texels - first);
    eigen(weights).middleRows(first, count) =
        (integrals.of(first, 1, count) - integrals.luma(first, 1, count) * fitted) * basis;
  });
  return weights;
}

}  // namespace loden::importer
