#include "importer/fit/flat_fit.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "importer/fit/eigen.h"
#include "importer/fit/reduction.h"
#include "importer/fit/view_products.h"

namespace loden::importer {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// One pass over the data: the best E for D, and sum_v A_v^T B_v E_v, the right-hand side of the D step.
struct Pass {
  MatrixXd basis;  // samples x k
  MatrixXd right;  // flat texels x k
  double error = 0;
};

Pass alternate(const ColumnBlocks& b, const Indirection& a, const Matrix& weights, int threads) {
  const int k = weights.cols;
  Pass pass;
  pass.basis.resize(b.cols(), k);
  std::vector<Matrix> right(kReductionBlocks, Matrix(a.flat_texels, k));
  std::vector<double> error(size_t(b.blocks));
  parallelFor(kReductionBlocks, threads, [&](int group) {
    Matrix block, seen,
        product(
            a.texels,
            k);  // kept from view to view: pages that are new each time cost more than what is done with them
    for (int v = blockBegin(b.blocks, group); v < blockBegin(b.blocks, group + 1); ++v) {
      b.read(v, block);
      a.apply(v, weights, seen);
      const ViewProducts p = viewProducts(seen, block);
      const MatrixXd e = solveView(p);
      pass.basis.middleRows(Index(v) * b.block_cols, b.block_cols) = e.transpose();
      error[size_t(v)] = p.error(e);
      eigen(product).noalias() = eigen(block) * e.transpose();
      a.addTransposed(v, product, right[size_t(group)]);
    }
  });
  pass.right = eigen(right[0]);
  for (int group = 1; group < kReductionBlocks; ++group) pass.right += eigen(right[size_t(group)]);
  for (const double of_view : error) pass.error += of_view;
  return pass;
}

// sum_v A_v^T A_v D (E_v^T E_v) + smoothness * Laplacian(D): the normal operator of the D step.
class NormalOperator {
 public:
  NormalOperator(const Indirection& a, const MatrixXd& basis, const FlatFitOptions& options)
      : a_(a),
        basis_(basis),
        owners_(options.owners),
        side_(static_cast<int>(std::lround(std::sqrt(double(a.flat_texels))))),
        threads_(options.threads) {
    sumGrams();
    smoothness_ = options.smoothness * diagonal_.mean();
    diagonal_.array() += 4 * smoothness_ + 1e-12 * diagonal_.maxCoeff() + 1e-300;
  }

  MatrixXd apply(const Matrix& d) const {
    MatrixXd sum = applyGrams(d);
    addSmoothness(d, sum);
    return sum;
  }

  const MatrixXd& diagonal() const { return diagonal_; }

 private:
  void sumGrams() {
    const Index lights = basis_.rows() / a_.views;
    for (int v = 0; v < a_.views; ++v) {
      const auto e = basis_.middleRows(v * lights, lights);
      grams_.push_back(e.transpose() * e);
    }
    diagonal_ = MatrixXd::Zero(a_.flat_texels, basis_.cols());
    for (int v = 0; v < a_.views; ++v)
      for (int x = 0; x < a_.texels; ++x) {
        const Indirection::Taps& t = a_.taps[size_t(v) * size_t(a_.texels) + size_t(x)];
        for (int i = 0; i < 4; ++i)
          diagonal_.row(t.index[i]) +=
              double(t.weight[i] * t.weight[i]) * grams_[size_t(v)].diagonal().transpose();
      }
  }

  MatrixXd applyGrams(const Matrix& d) const {
    std::vector<Matrix> partial(kReductionBlocks, Matrix(d.rows, d.cols));
    parallelFor(kReductionBlocks, threads_, [&](int group) {
      Matrix seen, product(a_.texels, d.cols);
      for (int v = blockBegin(a_.views, group); v < blockBegin(a_.views, group + 1); ++v) {
        a_.apply(v, d, seen);
        eigen(product).noalias() = eigen(seen) * grams_[size_t(v)];
        a_.addTransposed(v, product, partial[size_t(group)]);
      }
    });
    MatrixXd sum = eigen(partial[0]);
    for (int group = 1; group < kReductionBlocks; ++group) sum += eigen(partial[size_t(group)]);
    return sum;
  }

  void addSmoothness(const Matrix& d, MatrixXd& sum) const {
    for (int k = 0; k < d.cols; ++k)
      for (int j = 0; j < side_; ++j)
        for (int i = 0; i < side_; ++i) {
          const int at = j * side_ + i;
          const double neighbours = neighbour(d, k, at, j * side_ + (i + 1) % side_) +
                                    neighbour(d, k, at, j * side_ + (i + side_ - 1) % side_) +
                                    neighbour(d, k, at, (j + 1) % side_ * side_ + i) +
                                    neighbour(d, k, at, (j + side_ - 1) % side_ * side_ + i);
          sum(at, k) += smoothness_ * (4 * d(at, k) - neighbours);
        }
  }
  // The value next to a texel; its own where the next texel is another chart's, so that nothing pulls.
  double neighbour(const Matrix& d, int k, int at, int next) const {
    return owners_.empty() || owners_[size_t(at)] == owners_[size_t(next)] ? d(next, k) : d(at, k);
  }

  const Indirection& a_;
  const MatrixXd& basis_;
  const std::vector<uint16_t>& owners_;
  int side_, threads_;
  double smoothness_ = 0;
  std::vector<MatrixXd> grams_;  // of each view
  MatrixXd diagonal_;
};

// Jacobi-preconditioned conjugate gradients from the given D.
void solveWeights(const NormalOperator& normal, const MatrixXd& right, int steps, Matrix& d) {
  MatrixXd r = right - normal.apply(d);
  MatrixXd z = r.cwiseQuotient(normal.diagonal());
  Matrix direction = matrixFrom(z);
  double rz = r.cwiseProduct(z).sum();
  const double enough = 1e-12 * right.cwiseProduct(right.cwiseQuotient(normal.diagonal())).sum();
  for (int step = 0; step < steps && rz > enough; ++step) {
    const MatrixXd q = normal.apply(direction);
    const double curvature = eigen(direction).cwiseProduct(q).sum();
    if (!(curvature > 0)) break;
    const double alpha = rz / curvature;
    eigen(d) += alpha * eigen(direction);
    r -= alpha * q;
    z = r.cwiseQuotient(normal.diagonal());
    const double next = r.cwiseProduct(z).sum();
    eigen(direction) = z + next / rz * eigen(direction);
    rz = next;
  }
}

// Weights and basis rotated so that the basis is orthonormal and the components are ordered by energy. Of a
// tile with fewer texels than components the last ones are 0.
Factors rotated(const Matrix& weights, const MatrixXd& basis) {
  Eigen::HouseholderQR<MatrixXd> qd(eigen(weights)), qe(basis);
  const Index k = basis.cols(), kd = std::min<Index>(weights.rows, k), ke = std::min(basis.rows(), k);
  const MatrixXd rd = qd.matrixQR().topRows(kd).triangularView<Eigen::Upper>();
  const MatrixXd re = qe.matrixQR().topRows(ke).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<MatrixXd> svd(rd * re.transpose(), Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Index rank = svd.singularValues().size();
  MatrixXd u = MatrixXd::Zero(weights.rows, k), v = MatrixXd::Zero(basis.rows(), k);
  u.leftCols(rank) = qd.householderQ() * MatrixXd::Identity(weights.rows, kd) * svd.matrixU() *
                     svd.singularValues().asDiagonal();
  v.leftCols(rank) = qe.householderQ() * MatrixXd::Identity(basis.rows(), ke) * svd.matrixV();
  return {matrixFrom(u), matrixFrom(v)};
}

Matrix startWeights(const ColumnBlocks& b, const Indirection& a, int components, int threads) {
  const ColumnBlocks flat{a.flat_texels, b.blocks, b.block_cols, [&](int v, Matrix& into) {
                            Matrix block;
                            b.read(v, block);
                            into = Matrix(a.flat_texels, b.block_cols);
                            a.addTransposed(v, block, into);
                          }};
  return leadingFactors(flat, components, threads, 1).weights;  // only a start
}

}  // namespace

FlatFit fitFlat(const ColumnBlocks& b, const Indirection& a, const FlatFitOptions& options) {
  Matrix weights = startWeights(b, a, options.components, options.threads);
  for (int sweep = 0; sweep < options.sweeps; ++sweep) {
    const Pass pass = alternate(b, a, weights, options.threads);
    const NormalOperator normal(a, pass.basis, options);
    solveWeights(normal, pass.right, options.cg_steps, weights);
    weights =
        rotated(weights, pass.basis).weights;  // keeps E near orthonormal, which conditions the next D step
  }
  const Pass last = alternate(b, a, weights, options.threads);
  const double values = double(a.texels) * b.cols();
  return {rotated(weights, last.basis), std::sqrt(std::max(last.error, 0.0) / values)};
}

}  // namespace loden::importer
