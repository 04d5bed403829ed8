// Nonlinear least squares with bounds; the only place that sets up the solver.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace loden::importer {

struct LeastSquares {
  int residuals = 0;
  // Computes the residuals at q, and the jacobian, residuals x q and row-major, unless it is empty. Returns
  // whether that was possible.
  std::function<bool(std::span<const double> q, std::span<double> residual, std::span<double> jacobian)>
      evaluate;
  std::vector<double> lower, upper;  // bounds, one per parameter; infinite where there is none
};

// Minimises by Levenberg-Marquardt from q, which becomes the solution. Returns half the sum of squares there.
double minimise(const LeastSquares& problem, std::span<double> q);

}  // namespace loden::importer
