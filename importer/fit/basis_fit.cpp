// Tables for given weights: free per view, or on a grid of directions.

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <algorithm>

#include "importer/fit/eigen.h"
#include "importer/fit/flat_fit.h"
#include "importer/fit/grid_table.h"
#include "importer/fit/reduction.h"
#include "importer/fit/view_products.h"

namespace loden::importer {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd componentPairs(const Eigen::Ref<const MatrixXd>& m) {
  MatrixXd pairs(m.rows(), m.cols() * (m.cols() + 1) / 2);
  for (Index i = 0, pair = 0; i < m.cols(); ++i)
    for (Index j = 0; j <= i; ++j, ++pair) pairs.col(pair) = m.col(i).cwiseProduct(m.col(j));
  return pairs;
}

double ViewProducts::error(const MatrixXd& e) const {
  double fitted = 0;
  if (grams.empty()) fitted = (gram * e).cwiseProduct(e).sum();
  for (size_t l = 0; l < grams.size(); ++l) fitted += e.col(Index(l)).dot(grams[l] * e.col(Index(l)));
  return squares - 2 * e.cwiseProduct(cross).sum() + fitted;
}

ViewProducts viewProducts(const Matrix& seen, const Matrix& block) {
  ViewProducts p;
  p.gram.noalias() = eigen(seen).transpose() * eigen(seen);
  p.cross.noalias() = eigen(seen).transpose() * eigen(block);
  p.squares = eigen(block).squaredNorm();
  p.rows = block.rows;
  return p;
}

ViewProducts viewProducts(const Matrix& seen, const Matrix& block, const Matrix& factor) {
  // So many texels decide the few unknowns of a light well enough.
  constexpr int kEnoughTexels = 1 << 14;
  constexpr int kRowsAtOnce = 512;  // what is made of them stays in the cache
  const int step =
      seen.rows > kEnoughTexels ? seen.rows / kEnoughTexels | 1 : 1;  // odd: not always the same columns
  ViewProducts p;
  p.rows = (seen.rows + step - 1) / step;
  p.cross = MatrixXd::Zero(seen.cols, block.cols);
  MatrixXd sums = MatrixXd::Zero(
      block.cols, Index(seen.cols) * (seen.cols + 1) / 2);  // of each light the distinct entries of its gram
  MatrixXd m(kRowsAtOnce, seen.cols), f(kRowsAtOnce, block.cols), b(kRowsAtOnce, block.cols);
  for (int first = 0; first < p.rows; first += kRowsAtOnce) {
    const int count = std::min(kRowsAtOnce, p.rows - first);
    const auto take = [&](const Matrix& from, MatrixXd& to) {
      for (int c = 0; c < from.cols; ++c)
        for (int r = 0; r < kRowsAtOnce; ++r) to(r, c) = r < count ? from((first + r) * step, c) : 0.0;
    };
    take(seen, m), take(factor, f), take(block, b);
    p.squares += b.squaredNorm();
    b.array() *= f.array();
    p.cross.noalias() += m.transpose() * b;
    f.array() *= f.array();
    sums.noalias() += f.transpose() * componentPairs(m);
  }
  p.gram = MatrixXd::Zero(seen.cols, seen.cols);
  for (int l = 0; l < block.cols; ++l) {
    MatrixXd gram(seen.cols, seen.cols);
    for (Index i = 0, pair = 0; i < gram.rows(); ++i)
      for (Index j = 0; j <= i; ++j, ++pair) gram(i, j) = gram(j, i) = sums(l, pair);
    p.gram += gram / double(block.cols);
    p.grams.push_back(std::move(gram));
  }
  return p;
}

MatrixXd solveView(const ViewProducts& p) {
  constexpr double kRidge = 1e-9;  // relative; decides the tables of views that see too little
  MatrixXd ridged = p.gram;
  ridged.diagonal().array() += kRidge * p.gram.trace() / double(p.gram.rows()) + 1e-300;
  if (p.grams.empty()) return ridged.ldlt().solve(p.cross);
  // A light that reaches few texels is held to what these need at the mean of all lights.
  constexpr double kFactorRidge = 1e-4;
  MatrixXd e(p.cross.rows(), p.cross.cols());
  for (Index l = 0; l < e.cols(); ++l) {
    ridged = p.grams[size_t(l)];
    ridged.diagonal().array() += kFactorRidge * p.gram.trace() / double(p.gram.rows()) + 1e-300;
    e.col(l) = ridged.ldlt().solve(p.cross.col(l));
  }
  return e;
}

namespace {

constexpr int kGridSteps = 40;
constexpr double kGridRoughness = 1e-5;  // relative to the mean diagonal of the data term

std::vector<ViewProducts> allProducts(const ColumnBlocks& b, const Indirection& a, const Matrix& weights,
                                      int threads) {
  std::vector<ViewProducts> products(size_t(b.blocks));
  parallelFor(size_t(b.blocks), threads, [&](size_t v) {
    Matrix block, seen, factor;
    b.read(int(v), block);
    a.apply(int(v), weights, seen);
    if (b.factor) b.factor(int(v), factor);
    products[v] = b.factor ? viewProducts(seen, block, factor) : viewProducts(seen, block);
  });
  return products;
}

// Table at the samples, each view's best.
Matrix freeBasis(const std::vector<ViewProducts>& products) {
  const Index lights = products.front().cross.cols();
  Matrix basis(static_cast<int>(lights * Index(products.size())),
               static_cast<int>(products.front().gram.rows()));
  for (size_t v = 0; v < products.size(); ++v)
    eigen(basis).middleRows(Index(v) * lights, lights) = solveView(products[v]).transpose();
  return basis;
}

// sum_v |S_v-row G S_i^T ...|: the quadratic form of all views in the grid's degrees of freedom.
class GridNormal {
 public:
  using Sparse = Eigen::SparseMatrix<double>;

  GridNormal(const std::vector<ViewProducts>& products, const DirectionGrid& grid, const DirectionSet& lights,
             const DirectionSet& views)
      : products_(products),
        light_(eigen(gridSampling(grid, lights)).sparseView()),
        view_(eigen(gridSampling(grid, views)).sparseView()),
        rough_(eigen(gridRoughness(grid)).sparseView()) {
    rough_ = Sparse(rough_.transpose() * rough_);
    double trace = 0;
    for (const ViewProducts& p : products) trace += p.gram.trace();
    roughness_ = kGridRoughness * trace / double(dof()) / double(components());
  }

  Index dof() const { return light_.cols(); }
  Index components() const { return products_.front().gram.rows(); }

  // Grid tables to samples and back: (dof * dof) x k, (views * lights) x k.
  MatrixXd sample(const MatrixXd& table) const {
    MatrixXd out(light_.rows() * view_.rows(), table.cols());
    for (Index k = 0; k < table.cols(); ++k) {
      const Eigen::Map<const MatrixXd> from(table.col(k).data(), dof(), view_.cols());
      const MatrixXd rows = light_ * from;
      Eigen::Map<MatrixXd>(out.col(k).data(), light_.rows(), view_.rows()) = rows * view_.transpose();
    }
    return out;
  }
  MatrixXd sampleTransposed(const MatrixXd& samples) const {
    MatrixXd out(dof() * view_.cols(), samples.cols());
    for (Index k = 0; k < samples.cols(); ++k) {
      const Eigen::Map<const MatrixXd> from(samples.col(k).data(), light_.rows(), view_.rows());
      const MatrixXd rows = light_.transpose() * from;
      Eigen::Map<MatrixXd>(out.col(k).data(), dof(), view_.cols()) = rows * view_;
    }
    return out;
  }

  MatrixXd right() const {
    MatrixXd cross(light_.rows() * view_.rows(), components());
    for (size_t v = 0; v < products_.size(); ++v)
      cross.middleRows(Index(v) * light_.rows(), light_.rows()) = products_[v].cross.transpose();
    return sampleTransposed(cross);
  }

  MatrixXd apply(const MatrixXd& table) const {
    MatrixXd at_samples = sample(table);
    for (size_t v = 0; v < products_.size(); ++v) {
      auto rows = at_samples.middleRows(Index(v) * light_.rows(), light_.rows());
      const std::vector<MatrixXd>& grams = products_[v].grams;
      if (grams.empty()) rows = (rows * products_[v].gram).eval();
      for (size_t l = 0; l < grams.size(); ++l) rows.row(Index(l)) = (rows.row(Index(l)) * grams[l]).eval();
    }
    MatrixXd out = sampleTransposed(at_samples);
    for (Index k = 0; k < table.cols(); ++k) {
      const Eigen::Map<const MatrixXd> from(table.col(k).data(), dof(), view_.cols());
      Eigen::Map<MatrixXd> to(out.col(k).data(), dof(), view_.cols());
      to += roughness_ * (rough_ * from);
      to += roughness_ * (from * rough_);
    }
    return out;
  }

 private:
  const std::vector<ViewProducts>& products_;
  Sparse light_, view_, rough_;
  double roughness_ = 0;
};

}  // namespace

Matrix solveBasis(const ColumnBlocks& b, const Indirection& a, const Matrix& weights, int threads) {
  return freeBasis(allProducts(b, a, weights, threads));
}

Matrix solveGridBasis(const ColumnBlocks& b, const Indirection& a, const Matrix& weights,
                      const DirectionGrid& grid, const DirectionSet& lights, const DirectionSet& views,
                      int threads) {
  const std::vector<ViewProducts> products = allProducts(b, a, weights, threads);
  const GridNormal normal(products, grid, lights, views);
  const Matrix resample_light = gridResampling(grid, gridSampling(grid, lights));
  const Matrix resample_view = gridResampling(grid, gridSampling(grid, views));
  Matrix table = mapTables(freeBasis(products), resample_light, resample_view);
  MatrixXd residual = normal.right() - normal.apply(eigen(table)), direction = residual;
  double squares = residual.squaredNorm();
  for (int step = 0; step < kGridSteps && squares > 0; ++step) {
    const MatrixXd q = normal.apply(direction);
    const double alpha = squares / direction.cwiseProduct(q).sum();
    eigen(table) += alpha * direction;
    residual -= alpha * q;
    const double next = residual.squaredNorm();
    direction = residual + next / squares * direction;
    squares = next;
  }
  return table;
}

}  // namespace loden::importer
