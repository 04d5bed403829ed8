#include "importer/fit/grid_table.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "importer/fit/eigen.h"
#include "material/base/check.h"

namespace loden::importer {
namespace {

constexpr double kEpsilon = 1e-8;      // weight of roughness against the squared misfit
constexpr double kThetaWeight = 0.25;  // second differences along theta against those along phi

// Bilinear taps of a direction in (row, column) units, as two rows x two columns.
struct Taps {
  int row[2], column[2];
  double row_weight[2], column_weight[2];
};

Taps tapsOf(const DirectionGrid& grid, const glm::dvec3& w) {
  const Spherical s = sphericalFromDirection(w);
  const double r = std::min(s.theta / double(grid.theta_max), 1.0) * (grid.thetas - 1);
  const double c = s.phi / (2 * kPi) * (grid.phis - 1);
  Taps t;
  t.row[0] = std::min(static_cast<int>(r), grid.thetas - 1);
  t.row[1] = std::min(t.row[0] + 1, grid.thetas - 1);
  t.column[0] = static_cast<int>(c) % (grid.phis - 1);
  t.column[1] = (t.column[0] + 1) % (grid.phis - 1);
  t.row_weight[1] = r - t.row[0];
  t.row_weight[0] = 1 - t.row_weight[1];
  t.column_weight[1] = c - std::floor(c);
  t.column_weight[0] = 1 - t.column_weight[1];
  return t;
}

}  // namespace

int gridDof(const DirectionGrid& grid) {
  return 1 + (grid.thetas - 1) * (grid.phis - 1);
}

int gridDofIndex(const DirectionGrid& grid, int row, int column) {
  return row == 0 ? 0 : 1 + (row - 1) * (grid.phis - 1) + column % (grid.phis - 1);
}

Matrix gridSampling(const DirectionGrid& grid, const DirectionSet& set) {
  Matrix s(set.size(), gridDof(grid));
  for (int i = 0; i < set.size(); ++i) {
    const Taps t = tapsOf(grid, set.samples[size_t(i)]);
    for (int r = 0; r < 2; ++r)
      for (int c = 0; c < 2; ++c)
        s(i, gridDofIndex(grid, t.row[r], t.column[c])) += t.row_weight[r] * t.column_weight[c];
  }
  return s;
}

Matrix gridRoughness(const DirectionGrid& grid) {
  const int unique = grid.phis - 1, rows = grid.thetas;
  Matrix l((rows - 1) * unique + std::max(rows - 2, 0) * unique, gridDof(grid));
  int at = 0;
  for (int r = 1; r < rows; ++r)
    for (int c = 0; c < unique; ++c, ++at) {
      l(at, gridDofIndex(grid, r, c + unique - 1)) += 1;
      l(at, gridDofIndex(grid, r, c)) -= 2;
      l(at, gridDofIndex(grid, r, c + 1)) += 1;
    }
  for (int r = 1; r + 1 < rows; ++r)
    for (int c = 0; c < unique; ++c, ++at) {
      l(at, gridDofIndex(grid, r - 1, c)) += kThetaWeight;
      l(at, gridDofIndex(grid, r, c)) -= 2 * kThetaWeight;
      l(at, gridDofIndex(grid, r + 1, c)) += kThetaWeight;
    }
  return l;
}

Matrix gridResampling(const DirectionGrid& grid, const Matrix& sampling) {
  const Matrix rough = gridRoughness(grid);
  Eigen::MatrixXd stacked(sampling.rows + rough.rows, sampling.cols);
  stacked << eigen(sampling), std::sqrt(kEpsilon) * eigen(rough);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(stacked.rows(), sampling.rows);
  right.topRows(sampling.rows).setIdentity();
  return matrixFrom(stacked.colPivHouseholderQr().solve(right));
}

Matrix mapTables(const Matrix& tables, const Matrix& light, const Matrix& view) {
  LODEN_CHECK_EQ(tables.rows, light.cols * view.cols);
  Matrix out(light.rows * view.rows, tables.cols);
  for (int k = 0; k < tables.cols; ++k) {
    const Eigen::Map<const Eigen::MatrixXd> from(tables.col(k).data(), light.cols, view.cols);
    Eigen::Map<Eigen::MatrixXd>(out.col(k).data(), light.rows, view.rows) =
        eigen(light) * from * eigen(view).transpose();
  }
  return out;
}

DirectionGrid gridFor(const DirectionSet& set, int thetas, int phis) {
  double theta_max = 0;
  for (const glm::dvec3& w : set.samples) theta_max = std::max(theta_max, sphericalFromDirection(w).theta);
  DirectionGrid grid{thetas, phis, static_cast<float>(theta_max)};
  if (theta_max <= 0) grid.theta_max = static_cast<float>(75.0 * kPi / 180.0);
  return grid;
}

}  // namespace loden::importer
