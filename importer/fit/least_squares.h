// Nonlinear least squares with bounds: the one place that sets up the solver.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace loden::importer {

struct LeastSquares {
  int residuals = 0;
  // Residuals at q; jacobian: residuals x q, row-major, or empty where it is not asked for. Returns whether
  // it could.
  std::function<bool(std::span<const double> q, std::span<double> residual, std::span<double> jacobian)>
      evaluate;
  std::vector<double> lower, upper;  // one per parameter, infinite where there is none
};

// Levenberg-Marquardt from q, which becomes the solution. Returns half the sum of squares there.
double minimise(const LeastSquares& problem, std::span<double> q);

}  // namespace loden::importer
