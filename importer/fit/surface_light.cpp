#include "importer/fit/surface_light.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "importer/base/parallel.h"
#include "importer/base/random.h"
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
constexpr int kRays = 8;                      // per side of the square of rays that a point sees its tile by
constexpr int kRounds = 12, kLastRounds = 3;  // of the fit; the last ones solve the table alone
// Towards the last round, relative: samples beyond the ends leave components free.
constexpr double kPull = 1e-3;

// Rows of texels that are not known become the mean of their neighbours' that are, step by step; returns what
// is left.
std::vector<uint8_t> fillAround(std::initializer_list<Matrix*> maps, int side, std::vector<uint8_t> known) {
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
      for (Matrix* m : maps)
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

// Coefficients of wi.z, wi.z^2, wi.z wi.x and wi.z wi.y in columns, closest in the mean square to the rows of
// `lit`.
MatrixXd polynomialOf(const Matrix& lit, std::span<const glm::dvec3> directions) {
  MatrixXd terms(Index(directions.size()), kIndirectTerms);
  for (Index l = 0; l < terms.rows(); ++l) {
    const glm::dvec3& w = directions[size_t(l)];
    terms.row(l) << w.z, w.z * w.z, w.z * w.x, w.z * w.y;
  }
  const MatrixXd gram = terms.transpose() * terms;
  return eigen(lit) * terms * gram.ldlt().solve(MatrixXd::Identity(kIndirectTerms, kIndirectTerms));
}

// A texel that another sees, and the share of its hemisphere that it takes, weighted by the cosine.
struct Seen {
  uint32_t texel = 0;
  float share = 0;
};

// What every texel of p sees of the tile, by rays from points x points places; nothing where it has no
// surface, the share 0 of itself where it sees none.
std::vector<std::vector<Seen>> seenOf(const GeometryImage& image, int side, int points, int threads) {
  const GeometryTracer tracer(image);
  const glm::dvec3 lift = kLift * glm::dvec3(periodsPerLength(image.aspect), 1);
  std::vector<std::vector<Seen>> seen(size_t(side) * size_t(side));
  parallelFor(seen.size(), threads, [&](size_t texel) {
    std::vector<uint32_t> met;
    int found = 0;
    for (int s = 0; s < points * points; ++s) {
      const glm::dvec2 inside((s % points + 0.5) / points, (s / points + 0.5) / points);
      const glm::dvec2 corner(int(texel) % side, int(texel) / side);
      const auto point = surfaceAt<double>(image, (corner + inside) / double(side));
      if (point.chart == 0) continue;
      ++found;
      const uint64_t seed = mixSeed(texel, uint64_t(s));
      for (int k = 0; k < kRays * kRays; ++k) {
        const glm::dvec2 cell(k % kRays + uniform(seed, uint64_t(2 * k)),
                              k / kRays + uniform(seed, uint64_t(2 * k + 1)));
        const glm::dvec3 direction = cosineDirection(point.normal, cell.x / kRays, cell.y / kRays);
        const auto hit = tracer.trace(point.position + lift * point.normal, direction);
        if (!hit) continue;
        const auto at = [&](double p) { return wrapIndex(static_cast<int>(std::floor(p * side)), side); };
        met.push_back(uint32_t(at(hit->p.y) * side + at(hit->p.x)));
      }
    }
    std::sort(met.begin(), met.end());
    if (found > 0 && met.empty()) seen[texel].push_back({uint32_t(texel), 0});
    const float share = 1 / float(std::max(found, 1) * kRays * kRays);
    for (const uint32_t other : met) {
      if (seen[texel].empty() || seen[texel].back().texel != other) seen[texel].push_back({other, 0});
      seen[texel].back().share += share;
    }
  });
  return seen;
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
    known = fillAround({&light.open, &light.lit}, side, std::move(known));
  }
  for (int t = 0; t < texels; ++t)
    for (int l = 0; l < lights && !known[size_t(t)]; ++l)
      light.open(t, l) = light.lit(t, l) = directions[size_t(l)].z;
  return light;
}

Matrix indirectLight(const GeometryImage& image, int side, const Matrix& lit,
                     std::span<const glm::dvec3> directions, std::span<const glm::vec3> albedo, int bounces,
                     int points, int threads) {
  const int texels = side * side;
  Matrix light(texels, 3 * kIndirectTerms);
  if (image.empty() || bounces <= 0) return light;
  const MatrixXd direct = polynomialOf(lit, directions);
  const std::vector<std::vector<Seen>> seen = seenOf(image, side, points, threads);
  for (int bounce = 0; bounce < bounces; ++bounce) {
    Matrix leaving(texels, light.cols);
    for (int column = 0; column < light.cols; ++column)
      for (int t = 0; t < texels; ++t)
        leaving(t, column) = double(albedo[size_t(t)][column / kIndirectTerms]) *
                             (direct(t, column % kIndirectTerms) + light(t, column));
    parallelFor(size_t(light.cols), threads, [&](size_t column) {
      for (int t = 0; t < texels; ++t) {
        double sum = 0;
        for (const Seen& other : seen[size_t(t)])
          sum += double(other.share) * leaving(int(other.texel), int(column));
        light(t, int(column)) = sum;
      }
    });
  }
  std::vector<uint8_t> known;
  for (const auto& of_texel : seen) known.push_back(!of_texel.empty());
  fillAround({&light}, side, std::move(known));
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
