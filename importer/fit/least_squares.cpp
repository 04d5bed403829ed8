#include "importer/fit/least_squares.h"

#include <ceres/ceres.h>

#include <cmath>

#include "material/base/check.h"

namespace loden::importer {
namespace {

// All residuals and all parameters as one block each.
class Block : public ceres::CostFunction {
 public:
  explicit Block(const LeastSquares& problem) : problem_(problem) {
    set_num_residuals(problem.residuals);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.lower.size()));
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const size_t rows = size_t(problem_.residuals), columns = problem_.lower.size();
    std::span<double> jacobian;
    if (jacobians && jacobians[0]) jacobian = {jacobians[0], rows * columns};
    return problem_.evaluate({parameters[0], columns}, {residuals, rows}, jacobian);
  }

 private:
  const LeastSquares& problem_;
};

// `held`: parameters that stay as they are.
double solve(const LeastSquares& least_squares, const std::vector<int>& held, std::span<double> q) {
  ceres::Problem problem;
  problem.AddResidualBlock(new Block(least_squares), nullptr, q.data());
  if (!held.empty())
    problem.SetManifold(q.data(), new ceres::SubsetManifold(static_cast<int>(q.size()), held));
  for (size_t i = 0; i < q.size(); ++i) {
    if (std::isfinite(least_squares.lower[i]))
      problem.SetParameterLowerBound(q.data(), int(i), least_squares.lower[i]);
    if (std::isfinite(least_squares.upper[i]))
      problem.SetParameterUpperBound(q.data(), int(i), least_squares.upper[i]);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 2000;
  options.num_threads = 1;
  // Relative all of them: a gradient's size says nothing where nobody knows how bright white is.
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 0;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.final_cost;
}

}  // namespace

double minimise(const LeastSquares& problem, std::span<double> q) {
  LODEN_CHECK_EQ(problem.lower.size(), q.size());
  LODEN_CHECK_EQ(problem.upper.size(), q.size());
  const double cost = solve(problem, {}, q);
  // A step that is cut off at a bound is no longer the best for the other parameters, and the solver may stop
  // there: they go on without.
  std::vector<int> held;
  for (size_t i = 0; i < q.size(); ++i)
    if (q[i] <= problem.lower[i] || q[i] >= problem.upper[i]) held.push_back(static_cast<int>(i));
  return held.empty() || held.size() == q.size() ? cost : solve(problem, held, q);
}

}  // namespace loden::importer
