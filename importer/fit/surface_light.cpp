#include "importer/fit/surface_light.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "importer/base/parallel.h"
#include "importer/fit/band_pack.h"
#include "importer/fit/eigen.h"
#include "material/model/directions.h"
#include "material/model/vdim.h"

namespace loden::importer {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLift = 2e-3;  // tile lengths along the normal: where shadow rays start
constexpr int kFillSteps = 8;
constexpr int kRounds = 12, kLastRounds = 3;  // of the fit; the last ones solve the table alone
// Towards the last round, relative: samples beyond the ends leave components free.
constexpr double kPull = 1e-3;

// Rows of texels that are not known become the mean of their neighbours' that are, step by step; returns what
// is left.
std::vector<uint8_t> fillAround(SurfaceLight& light, int side, std::vector<uint8_t> known) {
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
      for (Matrix* m : {&light.open, &light.lit})
        for (int l = 0; l < m->cols; ++l) {
          double sum = 0;
          for (const int n : around) sum += (*m)(n, l);
          (*m)(t, l) = sum / double(around.size());
        }
      next[size_t(t)] = 1;
    }
    known = std::move(next);
  }
  return known;
}

// Beyond the end where it belongs, a value is as good as there.
bool satisfied(double u, double target) {
  return (target >= 1 && u >= 1) || (target <= 0 && u <= 0);
}

// The component vector that brings `rows` . x to the targets of one texel or direction, near `last`.
VectorXd solveOpen(const MatrixXd& rows, const VectorXd& u, const VectorXd& target, const VectorXd& weight,
                   const VectorXd& last) {
  const Index k = rows.cols();
  MatrixXd gram = MatrixXd::Zero(k, k);
  VectorXd right = VectorXd::Zero(k);
  double squares = 0;
  for (Index i = 0; i < rows.rows(); ++i) {
    squares += weight[i] * rows.row(i).squaredNorm();
    if (weight[i] == 0 || satisfied(u[i], target[i])) continue;
    gram.noalias() += weight[i] * rows.row(i).transpose() * rows.row(i);
    right.noalias() += weight[i] * target[i] * rows.row(i).transpose();
  }
  const double pull = kPull * squares / double(k) + 1e-300;
  gram.diagonal().array() += pull;
  right += pull * last;
  return gram.ldlt().solve(right);
}

}  // namespace

SurfaceLight surfaceLight(const GeometryImage& image, int side, std::span<const glm::dvec3> directions,
                          int points, int threads) {
  const int texels = side * side, lights = static_cast<int>(directions.size());
  SurfaceLight light{Matrix(texels, lights), Matrix(texels, lights)};
  std::vector<uint8_t> known(size_t(texels), 0);
  if (!image.empty()) {
    const GeometryTracer tracer(image);
    const glm::dvec3 lift = kLift * glm::dvec3(periodsPerLength(image.aspect), 1);
    parallelFor(size_t(texels), threads, [&](size_t texel) {
      const int t = static_cast<int>(texel);
      int found = 0;
      for (int s = 0; s < points * points; ++s) {
        const glm::dvec2 inside((s % points + 0.5) / points, (s / points + 0.5) / points);
        const auto point = surfaceAt<double>(image, (glm::dvec2(t % side, t / side) + inside) / double(side));
        if (point.chart == 0) continue;
        ++found;
        for (int l = 0; l < lights; ++l) {
          const double cosine = glm::dot(point.normal, directions[size_t(l)]);
          if (cosine <= 0) continue;
          light.open(t, l) += cosine;
          if (!tracer.occluded(point.position + lift * point.normal, directions[size_t(l)]))
            light.lit(t, l) += cosine;
        }
      }
      known[texel] = found > 0;
      for (int l = 0; l < lights && found > 0; ++l) light.open(t, l) /= found, light.lit(t, l) /= found;
    });
    known = fillAround(light, side, std::move(known));
  }
  for (int t = 0; t < texels; ++t)
    for (int l = 0; l < lights && !known[size_t(t)]; ++l)
      light.open(t, l) = light.lit(t, l) = directions[size_t(l)].z;
  return light;
}

std::vector<glm::dvec3> shadowDirections(int side) {
  std::vector<glm::dvec3> directions;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i)
      directions.push_back(
          clampTheta(directionFromSquare(glm::dvec2(i, j) / double(side - 1)), double(kThetaMax)));
  return directions;
}

Factors fitShadow(const SurfaceLight& light, int components, int threads) {
  const auto open = eigen(light.open), lit = eigen(light.lit);
  const MatrixXd target =
      (open.array() > 0).select(1 - lit.array() / open.array().max(1e-300), 0.0).cwiseMax(0.0).cwiseMin(1.0);
  // The start: leading factors of the weighted targets, of the few directions' Gram matrix, in double, where
  // any start would do.
  const MatrixXd weighted = open.cwiseProduct(target);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> leading(weighted.transpose() * weighted);
  const Index k = std::min<Index>(components, target.cols());
  MatrixXd basis = MatrixXd::Zero(target.cols(), components);
  basis.leftCols(k) = leading.eigenvectors().rightCols(k).rowwise().reverse();
  Matrix weights = matrixFrom(target * basis);
  const auto solveBasis = [&] {
    const MatrixXd d = eigen(weights), u = d * basis.transpose();
    MatrixXd next(basis.rows(), basis.cols());
    parallelFor(size_t(basis.rows()), threads, [&](size_t l) {
      const auto column = Index(l);
      next.row(column) =
          solveOpen(d, u.col(column), target.col(column), open.col(column), basis.row(column).transpose())
              .transpose();
    });
    basis = next;
  };
  for (int round = 0; round < kRounds; ++round) {
    const MatrixXd u = eigen(weights) * basis.transpose();
    parallelFor(size_t(u.rows()), threads, [&](size_t t) {
      const auto row = Index(t);
      const VectorXd last = eigen(weights).row(row).transpose();
      eigen(weights).row(row) = solveOpen(basis, u.row(row).transpose(), target.row(row).transpose(),
                                          open.row(row).transpose(), last)
                                    .transpose();
    });
    solveBasis();
    // Weights within -1..1, as they are stored.
    const Eigen::RowVectorXd scales = eigen(weights).cwiseAbs().colwise().maxCoeff().cwiseMax(1e-12);
    eigen(weights) = eigen(weights).array().rowwise() / scales.array();
    basis = basis.array().rowwise() * scales.array();
  }
  weights = quantisedWeights(weights, Storage::kSnorm8);
  for (int round = 0; round < kLastRounds; ++round) solveBasis();
  return {std::move(weights), matrixFrom(basis)};
}

}  // namespace loden::importer
