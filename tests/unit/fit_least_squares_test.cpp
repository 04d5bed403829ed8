// The set-up of the nonlinear solver (options, tolerances, bounds) on NIST's Statistical Reference Datasets
// for nonlinear regression: certified parameters, from both starts that NIST gives, the first of which is far
// off. Data and values: National Institute of Standards and Technology, public domain.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "importer/fit/least_squares.h"

namespace loden::importer {
namespace {

using Model = double (*)(std::span<const double> b, double x, double* gradient);

struct Dataset {
  const char* name;
  Model model;
  std::vector<double> x, y;
  std::vector<std::vector<double>> starts;
  std::vector<double> certified;
  double certified_squares;
};

// b1 (1 - exp(-b2 x))
double misra1a(std::span<const double> b, double x, double* g) {
  const double e = std::exp(-b[1] * x);
  g[0] = 1 - e;
  g[1] = b[0] * x * e;
  return b[0] * (1 - e);
}

// b1 (x^2 + b2 x) / (x^2 + b3 x + b4)
double mgh09(std::span<const double> b, double x, double* g) {
  const double top = x * x + b[1] * x, below = x * x + b[2] * x + b[3];
  g[0] = top / below;
  g[1] = b[0] * x / below;
  g[2] = -b[0] * top * x / (below * below);
  g[3] = -b[0] * top / (below * below);
  return b[0] * top / below;
}

// (b1 + b2 x + b3 x^2 + b4 x^3) / (1 + b5 x + b6 x^2 + b7 x^3)
double thurber(std::span<const double> b, double x, double* g) {
  const double top = b[0] + x * (b[1] + x * (b[2] + x * b[3])),
               below = 1 + x * (b[4] + x * (b[5] + x * b[6]));
  double power = 1;
  for (int i = 0; i < 4; ++i, power *= x) g[i] = power / below;
  power = x;
  for (int i = 4; i < 7; ++i, power *= x) g[i] = -top * power / (below * below);
  return top / below;
}

std::vector<Dataset> datasets() {
  return {
      {"Misra1a",
       misra1a,
       {77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0},
       {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78},
       {{500, 0.0001}, {250, 0.0005}},
       {2.3894212918e+02, 5.5015643181e-04},
       1.2455138894e-01},
      {"MGH09",
       mgh09,
       {4, 2, 1, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625},
       {1.957e-01, 1.947e-01, 1.735e-01, 1.600e-01, 8.44e-02, 6.27e-02, 4.56e-02, 3.42e-02, 3.23e-02,
        2.35e-02, 2.46e-02},
       {{25, 39, 41.5, 39}, {0.25, 0.39, 0.415, 0.39}},
       {1.9280693458e-01, 1.9128232873e-01, 1.2305650693e-01, 1.3606233068e-01},
       3.0750560385e-04},
      {"Thurber",
       thurber,
       {-3.067, -2.981, -2.921, -2.912, -2.840, -2.797, -2.702, -2.699, -2.633, -2.481,
        -2.363, -2.322, -1.501, -1.460, -1.274, -1.212, -1.100, -1.046, -0.915, -0.714,
        -0.566, -0.545, -0.400, -0.309, -0.109, -0.103, 0.010,  0.119,  0.377,  0.790,
        0.963,  1.006,  1.115,  1.572,  1.841,  2.047,  2.200},
       {80.574,   84.248,   87.264,   87.195,   89.076,   89.608,   89.868,   90.101,   92.405,   95.854,
        100.696,  101.060,  401.672,  390.724,  567.534,  635.316,  733.054,  759.087,  894.206,  990.785,
        1090.109, 1080.914, 1122.643, 1178.351, 1260.531, 1273.514, 1288.339, 1327.543, 1353.863, 1414.509,
        1425.208, 1421.384, 1442.962, 1464.350, 1468.705, 1447.894, 1457.628},
       {{1000, 1000, 400, 40, 0.7, 0.3, 0.03}, {1300, 1500, 500, 75, 1, 0.4, 0.05}},
       {1.2881396800e+03, 1.4910792535e+03, 5.8323836877e+02, 7.5416644291e+01, 9.6629502864e-01,
        3.9797285797e-01, 4.9727297349e-02},
       5.6427082397e+03},
  };
}

LeastSquares problemOf(const Dataset& data) {
  LeastSquares problem;
  problem.residuals = static_cast<int>(data.y.size());
  problem.lower.assign(data.certified.size(), -INFINITY);
  problem.upper.assign(data.certified.size(), INFINITY);
  problem.evaluate = [&data](std::span<const double> b, std::span<double> residual,
                             std::span<double> jacobian) {
    std::vector<double> gradient(b.size());
    for (size_t i = 0; i < data.y.size(); ++i) {
      residual[i] = data.model(b, data.x[i], gradient.data()) - data.y[i];
      for (size_t k = 0; k < b.size() && !jacobian.empty(); ++k) jacobian[i * b.size() + k] = gradient[k];
    }
    return true;
  };
  return problem;
}

// Digits in which a value agrees with the certified one (NIST's log relative error).
double digits(double value, double certified) {
  return -std::log10(std::max(std::abs(value - certified) / std::abs(certified), 1e-11));
}

TEST(LeastSquares, GivesFourDigitsOfNistsCertifiedParametersFromBothStarts) {
  for (const Dataset& data : datasets())
    for (const std::vector<double>& start : data.starts) {
      std::vector<double> q = start;
      const double cost = minimise(problemOf(data), q);
      EXPECT_GE(digits(2 * cost, data.certified_squares), 8) << data.name;
      for (size_t i = 0; i < q.size(); ++i)
        EXPECT_GE(digits(q[i], data.certified[i]), 4) << data.name << " b" << i + 1 << " = " << q[i];
    }
}

TEST(LeastSquares, StopsAtABoundThatTheSolutionLiesBeyond) {
  const std::vector<Dataset> all = datasets();
  LeastSquares problem = problemOf(all[0]);
  problem.upper[0] = 230;  // the free solution is 238.94
  std::vector<double> q{200, 0.0005};
  minimise(problem, q);
  EXPECT_NEAR(q[0], 230, 1e-6);
  // And there the other parameter is the best for the first.
  const auto squares = [&](double b2) {
    const std::vector<double> b{230, b2};
    std::vector<double> residual(all[0].y.size());
    problem.evaluate(b, residual, {});
    double sum = 0;
    for (const double r : residual) sum += r * r;
    return sum;
  };
  EXPECT_LT(squares(q[1]), squares(1.0001 * q[1]));
  EXPECT_LT(squares(q[1]), squares(0.9999 * q[1]));
}

}  // namespace
}  // namespace loden::importer
