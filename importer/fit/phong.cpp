#include "importer/fit/phong.h"

#include <Eigen/QR>
#include <cmath>

#include "importer/fit/eigen.h"
#include "importer/fit/least_squares.h"

namespace loden::importer {
namespace {

constexpr double kMaxExponent = 512;

// What eq. 5 needs of one pair of directions.
struct Sample {
  double n_l = 0, n_h = 0, y = 0;
};

std::vector<Sample> samplesOf(const Matrix& means, const DirectionSet& lights, const DirectionSet& views) {
  std::vector<Sample> samples;
  for (int v = 0; v < views.size(); ++v)
    for (int l = 0; l < lights.size(); ++l) {
      const glm::dvec3 wi = lights.samples[size_t(l)], half = glm::normalize(wi + views.samples[size_t(v)]);
      samples.push_back({wi.z, half.z, means(v * lights.size() + l, 0)});
    }
  return samples;
}

// Eq. 5 minus the samples; parameters ka, kd, ks, ln alpha.
bool phongResiduals(std::span<const Sample> samples, std::span<const double> q, std::span<double> residual,
                    std::span<double> jacobian) {
  const double alpha = std::exp(q[3]);
  for (size_t i = 0; i < samples.size(); ++i) {
    const Sample& s = samples[i];
    const double lobe = std::pow(s.n_h, alpha);
    residual[i] = q[0] + q[1] * s.n_l + q[2] * lobe - s.y;
    if (jacobian.empty()) continue;
    double* row = jacobian.data() + 4 * i;
    row[0] = 1;
    row[1] = s.n_l;
    row[2] = lobe;
    row[3] = q[2] * lobe * alpha * std::log(std::max(s.n_h, 1e-12));
  }
  return true;
}

// For a given exponent eq. 5 is linear: the start of the iteration.
Eigen::Vector3d linearStart(std::span<const Sample> samples, double alpha, bool constrained) {
  Eigen::MatrixXd a(samples.size(), 3);
  Eigen::VectorXd y(samples.size());
  for (size_t i = 0; i < samples.size(); ++i) {
    a.row(Eigen::Index(i)) << 1, samples[i].n_l, std::pow(samples[i].n_h, alpha);
    y[Eigen::Index(i)] = samples[i].y;
  }
  Eigen::Vector3d q = a.colPivHouseholderQr().solve(y);
  if (constrained) q.tail<2>() = q.tail<2>().cwiseMax(0.0);
  return q;
}

struct Solution {
  double q[4] = {0, 0, 0, 0};
  double cost = 0;
};

Solution solveFrom(std::span<const Sample> samples, double alpha, bool constrained) {
  Solution s;
  const Eigen::Vector3d start = linearStart(samples, alpha, constrained);
  std::copy(start.data(), start.data() + 3, s.q);
  s.q[3] = std::log(alpha);
  LeastSquares problem;
  problem.residuals = static_cast<int>(samples.size());
  problem.evaluate = [&](std::span<const double> q, std::span<double> residual, std::span<double> jacobian) {
    return phongResiduals(samples, q, residual, jacobian);
  };
  const double least = constrained ? 0 : -INFINITY;
  problem.lower = {-INFINITY, least, least, 0};
  problem.upper = {INFINITY, INFINITY, INFINITY, std::log(kMaxExponent)};
  s.cost = minimise(problem, s.q);
  return s;
}

void fitChroma(PhongMean& mean, const Matrix& means) {
  double yy = 0;
  glm::dvec2 sum(0), cross(0);
  for (int i = 0; i < means.rows; ++i) {
    const glm::dvec2 c(means(i, 1), means(i, 2));
    sum += c;
    cross += means(i, 0) * c;
    yy += means(i, 0) * means(i, 0);
  }
  const glm::dvec2 c = mean.chroma == MeanChroma::kConstant ? sum / double(std::max(means.rows, 1))
                       : yy > 0                             ? cross / yy
                                                            : glm::dvec2(0);
  mean.cb = static_cast<float>(c.x);
  mean.cr = static_cast<float>(c.y);
}

}  // namespace

PhongFit fitPhong(const Matrix& means, const DirectionSet& lights, const DirectionSet& views,
                  const PhongOptions& options) {
  const std::vector<Sample> samples = samplesOf(means, lights, views);
  Solution best;
  best.cost = INFINITY;
  for (double alpha : {1.5, 4.0, 16.0, 64.0}) {
    const Solution s = solveFrom(samples, alpha, options.constrained);
    if (s.cost < best.cost) best = s;
  }
  PhongFit fit;
  fit.mean.ka = static_cast<float>(best.q[0]);
  fit.mean.kd = static_cast<float>(best.q[1]);
  fit.mean.ks = static_cast<float>(best.q[2]);
  fit.mean.alpha = static_cast<float>(std::exp(best.q[3]));
  fit.mean.chroma = options.chroma;
  fit.rmse = std::sqrt(2 * best.cost / double(std::max<size_t>(samples.size(), 1)));
  fitChroma(fit.mean, means);
  return fit;
}

Matrix sampleMean(const PhongMean& mean, const DirectionSet& lights, const DirectionSet& views) {
  Matrix out(views.size() * lights.size(), 3);
  for (int v = 0; v < views.size(); ++v)
    for (int l = 0; l < lights.size(); ++l) {
      const glm::dvec3 m = evaluateMean(mean, lights.samples[size_t(l)], views.samples[size_t(v)]);
      for (int c = 0; c < 3; ++c) out(v * lights.size() + l, c) = m[c];
    }
  return out;
}

}  // namespace loden::importer
