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

double ViewProducts::error(const MatrixXd& e) const {
  return squares - 2 * e.cwiseProduct(cross).sum() + (gram * e).cwiseProduct(e).sum();
}

ViewProducts viewProducts(const Matrix& seen, const Matrix& block) {
  ViewProducts p;
  p.gram.noalias() = eigen(seen).transpose() * eigen(seen);
  p.cross.noalias() = eigen(seen).transpose() * eigen(block);
  p.squares = eigen(block).squaredNorm();
  return p;
}

MatrixXd solveView(const ViewProducts& p) {
  constexpr double kRidge = 1e-9;  // relative; decides the tables of views that see too little
  MatrixXd ridged = p.gram;
  ridged.diagonal().array() += kRidge * p.gram.trace() / double(p.gram.rows()) + 1e-300;
  return ridged.ldlt().solve(p.cross);
}

namespace {

constexpr int kGridSteps = 40;
constexpr double kGridRoughness = 1e-5;  // relative to the mean diagonal of the data term

std::vector<ViewProducts> allProducts(const ColumnBlocks& b, const Indirection& a, const Matrix& weights,
                                      int threads) {
  std::vector<ViewProducts> products(size_t(b.blocks));
  parallelFor(size_t(b.blocks), threads, [&](size_t v) {
    Matrix block, seen;
    b.read(int(v), block);
    a.apply(int(v), weights, seen);
    products[v] = viewProducts(seen, block);
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
      rows = (rows * products_[v].gram).eval();
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
