#include "importer/fit/flat_fit.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <optional>

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
    Matrix block, seen, factor,
        product(
            a.texels,
            k);  // kept from view to view: pages that are new each time cost more than what is done with them
    for (int v = blockBegin(b.blocks, group); v < blockBegin(b.blocks, group + 1); ++v) {
      b.read(v, block);
      a.apply(v, weights, seen);
      if (b.factor) b.factor(v, factor);
      const ViewProducts p = b.factor ? viewProducts(seen, block, factor) : viewProducts(seen, block);
      const MatrixXd e = solveView(p);
      pass.basis.middleRows(Index(v) * b.block_cols, b.block_cols) = e.transpose();
      error[size_t(v)] = p.error(e) * double(a.texels) / double(p.rows);
      if (b.factor) eigen(block).array() *= eigen(factor).array();
      eigen(product).noalias() = eigen(block) * e.transpose();
      a.addTransposed(v, product, right[size_t(group)]);
    }
  });
  pass.right = eigen(right[0]);
  for (int group = 1; group < kReductionBlocks; ++group) pass.right += eigen(right[size_t(group)]);
  for (const double of_view : error) pass.error += of_view;
  return pass;
}

// sum_v A_v^T G_v A_v for data with a factor, whose every texel and view has a G of its own, the k x k matrix
// of its table under the light that comes there. A view reads four texels beside each other, so the sum ties
// a flat texel to itself and its eight neighbours alone: it is made once per table, and a step of the
// gradients does not look at the data.
class Stencil {
 public:
  Stencil(const ColumnBlocks& b, const Indirection& a, const MatrixXd& basis, int side, int threads)
      : side_(side),
        k_(static_cast<int>(basis.cols())),
        threads_(threads),
        sums_(size_t(a.flat_texels) * kReach * size_t(pairs())) {
    const Index lights = basis.rows() / a.views;
    std::vector<MatrixXd> grams(kViewsAtOnce);
    for (int first = 0; first < a.views; first += kViewsAtOnce) {
      const int count = std::min(kViewsAtOnce, a.views - first);
      parallelFor(size_t(count), threads, [&](size_t i) {
        Matrix factor;
        b.factor(first + int(i), factor);
        const MatrixXd products = componentPairs(basis.middleRows((first + Index(i)) * lights, lights));
        grams[i].noalias() = products.transpose() * eigen(factor).cwiseAbs2().transpose();  // pairs x texels
      });
      const int slices = (pairs() + kSlice - 1) / kSlice;
      parallelFor(size_t(slices), threads, [&](size_t slice) {
        const int begin = static_cast<int>(slice) * kSlice, end = std::min(begin + kSlice, pairs());
        for (int i = 0; i < count; ++i) addView(a, first + i, grams[size_t(i)], begin, end);
      });
    }
  }

  MatrixXd apply(const Matrix& d) const {
    MatrixXd out(d.rows, d.cols);
    parallelFor(size_t(side_), threads_, [&](size_t j) {
      std::vector<double> sum(static_cast<size_t>(k_));
      for (int i = 0; i < side_; ++i) {
        const int at = int(j) * side_ + i;
        std::fill(sum.begin(), sum.end(), 0.0);
        addProduct(at, 0, d, at, sum);
        for (int o = 1; o < kReach; ++o) {
          const glm::ivec2 step(kOffsets[o][0], kOffsets[o][1]);
          const int before = texel(i - step.x, int(j) - step.y);
          addProduct(at, o, d, texel(i + step.x, int(j) + step.y), sum);
          addProduct(before, o, d, before, sum);
        }
        for (int c = 0; c < k_; ++c) out(at, c) = sum[size_t(c)];
      }
    });
    return out;
  }

  MatrixXd diagonal() const {
    MatrixXd out(Index(side_) * side_, k_);
    for (int t = 0; t < side_ * side_; ++t)
      for (int c = 0; c < k_; ++c) out(t, c) = double(block(t, 0)[c * (c + 1) / 2 + c]);
    return out;
  }

 private:
  static constexpr int kReach =
      5;  // itself, and half of the eight: the other half is the same seen from there
  static constexpr int kOffsets[kReach][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {-1, 1}};
  static constexpr int kViewsAtOnce = 8;
  static constexpr int kSlice = 8;  // pairs that one task sums

  int pairs() const { return k_ * (k_ + 1) / 2; }
  int texel(int i, int j) const { return (j + side_) % side_ * side_ + (i + side_) % side_; }
  const float* block(int t, int offset) const {
    return sums_.data() + (size_t(t) * kReach + size_t(offset)) * size_t(pairs());
  }

  // Taps of Indirection: (0, 0), (1, 0), (0, 1), (1, 1) of four texels.
  void addView(const Indirection& a, int view, const MatrixXd& grams, int begin, int end) {
    struct Tie {
      int from, to, offset;
    };
    constexpr Tie kTies[] = {{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {3, 3, 0}, {0, 1, 1},
                             {2, 3, 1}, {0, 2, 2}, {1, 3, 2}, {0, 3, 3}, {1, 2, 4}};
    for (int x = 0; x < a.texels; ++x) {
      const Indirection::Taps& t = a.taps[size_t(view) * size_t(a.texels) + size_t(x)];
      const double* gram = &grams(0, x);
      for (const Tie& tie : kTies) {
        const float share = t.weight[tie.from] * t.weight[tie.to];
        float* sum =
            sums_.data() + (size_t(t.index[tie.from]) * kReach + size_t(tie.offset)) * size_t(pairs());
        for (int p = begin; p < end; ++p) sum[p] += share * float(gram[p]);
      }
    }
  }

  // sum += block * row `from` of d.
  void addProduct(int t, int offset, const Matrix& d, int from, std::vector<double>& sum) const {
    const float* entry = block(t, offset);
    for (int i = 0; i < k_; ++i) {
      for (int j = 0; j < i; ++j, ++entry) {
        sum[size_t(i)] += double(*entry) * d(from, j);
        sum[size_t(j)] += double(*entry) * d(from, i);
      }
      sum[size_t(i)] += double(*entry++) * d(from, i);
    }
  }

  int side_, k_, threads_;
  std::vector<float> sums_;  // [flat texel][offset][pair]
};

// sum_v A_v^T A_v D (E_v^T E_v) + smoothness * Laplacian(D): the normal operator of the D step.
class NormalOperator {
 public:
  NormalOperator(const ColumnBlocks& b, const Indirection& a, const MatrixXd& basis,
                 const FlatFitOptions& options)
      : a_(a),
        basis_(basis),
        owners_(options.owners),
        side_(static_cast<int>(std::lround(std::sqrt(double(a.flat_texels))))),
        threads_(options.threads) {
    if (b.factor) {
      stencil_.emplace(b, a, basis, side_, threads_);
      diagonal_ = stencil_->diagonal();
    } else {
      sumGrams();
    }
    smoothness_ = options.smoothness * diagonal_.mean();
    diagonal_.array() += 4 * smoothness_ + 1e-12 * diagonal_.maxCoeff() + 1e-300;
  }

  MatrixXd apply(const Matrix& d) const {
    MatrixXd sum = stencil_ ? stencil_->apply(d) : applyGrams(d);
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
  std::vector<MatrixXd> grams_;     // of each view, without a factor
  std::optional<Stencil> stencil_;  // with one
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
    const NormalOperator normal(b, a, pass.basis, options);
    solveWeights(normal, pass.right, options.cg_steps, weights);
    weights =
        rotated(weights, pass.basis).weights;  // keeps E near orthonormal, which conditions the next D step
  }
  const Pass last = alternate(b, a, weights, options.threads);
  const double values = double(a.texels) * b.cols();
  return {rotated(weights, last.basis), std::sqrt(std::max(last.error, 0.0) / values)};
}

}  // namespace loden::importer
