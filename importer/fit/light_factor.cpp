#include "importer/fit/light_factor.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "importer/fit/eigen.h"
#include "importer/fit/grid_table.h"
#include "importer/fit/reduction.h"

namespace loden::importer {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kPhis = 25, kThetas = 6;
constexpr int kMostSubsamples =
    3;  // per side of a flat texel, where the geometry image is fine enough to tell them apart
constexpr double kLift = 2e-3;  // tile periods along the normal: where shadow rays start
constexpr int kRounds = 12;
constexpr double kPull =
    1e-3;  // towards the last round, relative: samples beyond the ends leave components free
constexpr int kFillSteps = 8;

std::vector<glm::dvec3> gridDirections(const DirectionGrid& grid) {
  std::vector<glm::dvec3> directions(size_t(gridDof(grid)));
  for (int row = 0; row < grid.thetas; ++row)
    for (int column = 0; column + 1 < grid.phis; ++column)
      directions[size_t(gridDofIndex(grid, row, column))] = directionFromSpherical(
          {double(grid.theta_max) * row / (grid.thetas - 1), 2 * kPi * column / (grid.phis - 1)});
  return directions;
}

// Texels without surface become the mean of the neighbours that have some, step by step; what is left is lit.
void fillAround(Matrix& visibility, int side, std::vector<uint8_t> known) {
  for (int step = 0; step < kFillSteps; ++step) {
    std::vector<uint8_t> next = known;
    for (int t = 0; t < side * side; ++t) {
      if (known[size_t(t)]) continue;
      std::vector<int> around;
      for (const auto& [dx, dy] : {std::pair{1, 0}, {side - 1, 0}, {0, 1}, {0, side - 1}}) {
        const int n = (t / side + dy) % side * side + (t % side + dx) % side;
        if (known[size_t(n)]) around.push_back(n);
      }
      if (around.empty()) continue;
      for (int c = 0; c < visibility.cols; ++c) {
        double sum = 0;
        for (const int n : around) sum += visibility(n, c);
        visibility(t, c) = sum / double(around.size());
      }
      next[size_t(t)] = 1;
    }
    known = std::move(next);
  }
  for (int t = 0; t < side * side; ++t)
    for (int c = 0; c < visibility.cols && !known[size_t(t)]; ++c) visibility(t, c) = 1;
}

// Beyond the end where it belongs, a value is as good as there.
bool satisfied(double u, double v) {
  return (v >= 1 && u >= 1) || (v <= 0 && u <= 0);
}

// The component vector that brings `rows` . x to the targets of one texel or light, near `last`.
VectorXd solveOpen(const MatrixXd& rows, const VectorXd& u, const VectorXd& target, const VectorXd& last) {
  const Index k = rows.cols();
  MatrixXd gram = MatrixXd::Zero(k, k);
  VectorXd right = VectorXd::Zero(k);
  for (Index i = 0; i < rows.rows(); ++i) {
    if (satisfied(u[i], target[i])) continue;
    gram.noalias() += rows.row(i).transpose() * rows.row(i);
    right.noalias() += target[i] * rows.row(i).transpose();
  }
  const double pull = kPull * rows.squaredNorm() / double(k) + 1e-300;
  gram.diagonal().array() += pull;
  right += pull * last;
  return gram.ldlt().solve(right);
}

}  // namespace

DirectionGrid lightFactorGrid(const DirectionSet& lights) {
  return gridFor(lights, kThetas, kPhis);
}

Matrix lightVisibility(const GeometryImage& image, int side, const DirectionGrid& grid, int threads) {
  const GeometryTracer tracer(image);
  const std::vector<glm::dvec3> lights = gridDirections(grid);
  Matrix visibility(side * side, static_cast<int>(lights.size()));
  std::vector<uint8_t> known(size_t(side) * size_t(side));
  const int subsamples = std::clamp(2 * image.side() / side, 1, kMostSubsamples);
  parallelFor(size_t(side) * size_t(side), threads, [&](size_t texel) {
    const int t = static_cast<int>(texel);
    int points = 0;
    for (int s = 0; s < subsamples * subsamples; ++s) {
      const glm::dvec2 inside((s % subsamples + 0.5) / subsamples, (s / subsamples + 0.5) / subsamples);
      const auto point = surfaceAt<double>(image, (glm::dvec2(t % side, t / side) + inside) / double(side));
      if (point.chart == 0) continue;
      ++points;
      for (size_t l = 0; l < lights.size(); ++l)
        if (glm::dot(point.normal, lights[l]) > 0 &&
            !tracer.occluded(point.position + kLift * point.normal, lights[l]))
          visibility(t, int(l)) += 1;
    }
    known[texel] = points > 0;
    for (size_t l = 0; l < lights.size() && points > 0; ++l) visibility(t, int(l)) /= points;
  });
  fillAround(visibility, side, std::move(known));
  return visibility;
}

Factors fitLightFactor(const Matrix& visibility, int components, Storage storage, int threads) {
  const auto v = eigen(visibility);
  // The start: leading factors, of the few lights' Gram matrix, in double, where any start would do.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> leading(v.transpose() * v);
  MatrixXd basis = leading.eigenvectors().rightCols(components).rowwise().reverse();
  Matrix weights = matrixFrom(v * basis);
  const auto solveBasis = [&](const MatrixXd& u) {
    MatrixXd next(basis.rows(), basis.cols());
    const MatrixXd d = eigen(weights);
    parallelFor(size_t(v.cols()), threads, [&](size_t l) {
      next.row(Index(l)) =
          solveOpen(d, u.col(Index(l)), v.col(Index(l)), basis.row(Index(l)).transpose()).transpose();
    });
    basis = next;
  };
  for (int round = 0; round < kRounds; ++round) {
    MatrixXd u = eigen(weights) * basis.transpose();
    parallelFor(size_t(v.rows()), threads, [&](size_t t) {
      const VectorXd last = eigen(weights).row(Index(t)).transpose();
      eigen(weights).row(Index(t)) =
          solveOpen(basis, u.row(Index(t)).transpose(), v.row(Index(t)).transpose(), last).transpose();
    });
    u = eigen(weights) * basis.transpose();
    solveBasis(u);
    const Eigen::RowVectorXd norms = basis.colwise().norm().cwiseMax(1e-12);
    basis = basis.array().rowwise() / norms.array();
    eigen(weights) = eigen(weights).array().rowwise() * norms.array();
  }
  weights = quantisedWeights(weights, storage);
  for (int round = 0; round < 3; ++round) solveBasis(eigen(weights) * basis.transpose());
  return {std::move(weights), matrixFrom(basis)};
}

Factors lightFactorAt(const Factors& factor, const DirectionGrid& grid, const DirectionSet& lights) {
  const Matrix sampling = gridSampling(grid, lights);
  return {factor.weights, matrixFrom(eigen(sampling) * eigen(factor.basis))};
}

void readLightFactor(const Factors& factor, const Indirection& a, int view, Matrix& into) {
  Matrix seen;
  a.apply(view, factor.weights, seen);
  if (into.rows != a.texels || into.cols != factor.basis.rows) into = Matrix(a.texels, factor.basis.rows);
  eigen(into).noalias() = eigen(seen) * eigen(factor.basis).transpose();
  eigen(into) = eigen(into).cwiseMax(0.0).cwiseMin(1.0);
}

}  // namespace loden::importer
