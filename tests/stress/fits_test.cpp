// The fits on problems with known or certified answers that break careless numerics. Certified values:
// National Institute of Standards and Technology, Statistical Reference Datasets, public domain;
// tests/unit/fit_least_squares_test.cpp has three more of them.

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <random>

#include "importer/base/parallel.h"
#include "importer/cook/modes.h"
#include "importer/fit/least_squares.h"
#include "importer/fit/pca.h"
#include "importer/fit/phong.h"
#include "importer/fit/ycc_btf.h"
#include "material/asset/asset.h"
#include "material/eval/evaluate.h"
#include "tests/stress/stress.h"
#include "tests/stress/stress_materials.h"
#include "tests/unit/fit_synthetic.h"

namespace loden::stress {
namespace {

using namespace importer;

// --- low-rank factors ---

// Columns in several blocks, as a BTF's views are.
ColumnBlocks inBlocks(const Matrix& m, int blocks) {
  const int cols = m.cols / blocks;
  return {m.rows, blocks, cols, [&m, cols](int b, Matrix& into) {
            into = Matrix(m.rows, cols);
            for (int c = 0; c < cols; ++c)
              for (int r = 0; r < m.rows; ++r) into(r, c) = m(r, b * cols + c);
          }};
}

// Frobenius norm of what the factors leave, summed in long double.
long double residualOf(const Matrix& m, const Factors& f) {
  long double sum = 0;
  for (int c = 0; c < m.cols; ++c)
    for (int r = 0; r < m.rows; ++r) {
      long double value = m(r, c);
      for (int k = 0; k < f.components(); ++k) value -= (long double)f.weights(r, k) * f.basis(c, k);
      sum += value * value;
    }
  return std::sqrt(sum);
}

double offOrthonormal(const Matrix& basis) {
  double worst = 0;
  for (int a = 0; a < basis.cols; ++a)
    for (int b = 0; b <= a; ++b) {
      double dot = 0;
      for (int r = 0; r < basis.rows; ++r) dot += basis(r, a) * basis(r, b);
      worst = std::max(worst, std::abs(dot - (a == b)));
    }
  return worst;
}

// Läuchli 1961: ones over e times the identity. Singular values sqrt(n + e^2) and n - 1 times e; from e =
// 1e-8 on the normal equations, of 1 + e^2, know nothing of e.
TEST(StressFits, LaeuchliKeepsItsSmallSingularValues) {
  double worst = 0, skew = 0;
  for (const int n : {3, 40, 200})
    for (const double e : {1e-4, 1e-8, 1e-10}) {
      Matrix m(n + 1, n);
      for (int c = 0; c < n; ++c) m(0, c) = 1, m(c + 1, c) = e;
      for (const int k : {1, 2, std::min(n, 12)}) {
        const Factors f = leadingFactors(n == 200 ? inBlocks(m, 8) : blocksOf(m), k);
        // The best that k factors leave: n - k values of e; rounding of the ones, 1e-16 each, on top.
        const double best = e * std::sqrt(double(n - k));
        worst = std::max(worst, (double(residualOf(m, f)) - best) / (e + 1e-15 * n));
        if (k < n || n == 3) skew = std::max(skew, offOrthonormal(f.basis));
      }
    }
  record("Läuchli, 3 to 200 columns, e to 1e-10: residual over the best that a rank leaves, in e", worst,
         "<= 1e-3");
  record("Läuchli, 3 to 200 columns, e to 1e-10: difference of the basis to an orthonormal one", skew,
         "<= 1e-12");
  EXPECT_LE(worst, 1e-3);
  EXPECT_LE(skew, 1e-12);
}

// Known ranks: the residual is that of the rounding, and surplus components have no weight.
TEST(StressFits, RankDeficientConstantAndExtremeDataComesBack) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double worst = 0, surplus = 0;
  const auto tryMatrix = [&](const Matrix& m, int rank, int k) {
    double largest = 0;
    for (const double v : m.data) largest = std::max(largest, std::abs(v));
    const Factors f = leadingFactors(m.cols % 4 == 0 ? inBlocks(m, 4) : blocksOf(m), k);
    worst = std::max(
        worst, double(residualOf(m, f)) / (std::max(largest, 1e-300) * std::sqrt(double(m.rows) * m.cols)));
    for (int c = rank; c < k; ++c)
      for (const double w : f.weights.col(c))
        surplus = std::max(surplus, std::abs(w) / std::max(largest, 1e-300));
    for (const double v : f.basis.data) EXPECT_TRUE(std::isfinite(v));
  };
  for (const double scale : {1.0, 1e-6, 1e6, 1e-150, 1e150})
    for (const auto& [rows, cols] : {std::pair{1, 1}, {1, 400}, {400, 1}, {4, 400}, {256, 400}, {400, 128}}) {
      Matrix constant(rows, cols), zero(rows, cols), low(rows, cols);
      for (double& v : constant.data) v = 0.7 * scale;
      const int rank = std::min({3, rows, cols});
      for (int k = 0; k < rank; ++k) {
        std::vector<double> left, right;
        for (int r = 0; r < rows; ++r) left.push_back(normal(random));
        for (int c = 0; c < cols; ++c) right.push_back(normal(random));
        for (int c = 0; c < cols; ++c)
          for (int r = 0; r < rows; ++r)
            low(r, c) += scale * std::pow(1e-3, k) * left[size_t(r)] * right[size_t(c)];
      }
      for (const int k : {1, 4, 16}) {
        tryMatrix(constant, 1, k);
        tryMatrix(zero, 0, k);
        if (k >= rank) tryMatrix(low, rank, k);
      }
    }
  record("rank 0 to 3, one row to 400, values 1e-150 to 1e150: residual, of the largest value", worst,
         "<= 1e-13");
  record("rank 0 to 3, one row to 400, values 1e-150 to 1e150: weights of components beyond the rank",
         surplus, "<= 1e-12");
  EXPECT_LE(worst, 1e-13);
  EXPECT_LE(surplus, 1e-12);
}

// --- least squares ---

using Model = std::function<double(std::span<const double> b, double x, double* gradient)>;

struct Dataset {
  const char* name;
  Model model;
  std::vector<double> x, y;
  std::vector<std::vector<double>> starts;
  std::vector<double> certified;
  double certified_squares;
};

std::vector<Dataset> nonlinear() {
  std::vector<double> mgh10_x, rat43_x;
  for (int k = 0; k < 16; ++k) mgh10_x.push_back(50 + 5 * k);
  for (int k = 1; k <= 15; ++k) rat43_x.push_back(k);
  const auto growth = [](std::span<const double> b, double x, double* g) {  // b1 (1 - exp(-b2 x))
    const double e = std::exp(-b[1] * x);
    g[0] = 1 - e, g[1] = b[0] * x * e;
    return b[0] * (1 - e);
  };
  const auto mgh10 = [](std::span<const double> b, double x, double* g) {  // b1 exp(b2 / (x + b3))
    const double e = std::exp(b[1] / (x + b[2]));
    g[0] = e, g[1] = b[0] * e / (x + b[2]), g[2] = -b[0] * e * b[1] / ((x + b[2]) * (x + b[2]));
    return b[0] * e;
  };
  const auto rat42 = [](std::span<const double> b, double x, double* g) {  // b1 / (1 + exp(b2 - b3 x))
    const double e = std::exp(b[1] - b[2] * x), below = 1 + e;
    g[0] = 1 / below, g[1] = -b[0] * e / (below * below), g[2] = b[0] * e * x / (below * below);
    return b[0] / below;
  };
  const auto rat43 = [](std::span<const double> b, double x, double* g) {  // b1 / (1 + exp(b2 - b3 x))^(1/b4)
    const double e = std::exp(b[1] - b[2] * x), below = 1 + e, value = std::pow(below, -1 / b[3]);
    const double slope = -b[0] / b[3] * std::pow(below, -1 / b[3] - 1) * e;
    g[0] = value, g[1] = slope, g[2] = -slope * x, g[3] = b[0] * value * std::log(below) / (b[3] * b[3]);
    return b[0] * value;
  };
  const auto eckerle = [](std::span<const double> b, double x, double* g) {  // b1/b2 exp(-((x-b3)/b2)^2 / 2)
    const double z = (x - b[2]) / b[1], e = std::exp(-0.5 * z * z);
    g[0] = e / b[1], g[1] = b[0] * e / (b[1] * b[1]) * (z * z - 1), g[2] = b[0] * e * z / (b[1] * b[1]);
    return b[0] / b[1] * e;
  };
  return {
      // Its first start lies on the slope of another minimum, b2 without end, and a solver that goes down
      // ends
      // there.
      {"BoxBOD",
       growth,
       {1, 2, 3, 5, 7, 10},
       {109, 149, 149, 191, 213, 224},
       {{100, 0.75}},
       {2.1380940889e+02, 5.4723748542e-01},
       1.1680088766e+03},
      {"MGH10",
       mgh10,
       mgh10_x,
       {34780, 28610, 23650, 19630, 16370, 13720, 11540, 9744, 8261, 7030, 6005, 5147, 4427, 3820, 3307,
        2872},
       {{2, 400000, 25000}, {0.02, 4000, 250}},
       {5.6096364710e-03, 6.1813463463e+03, 3.4522363462e+02},
       8.7945855171e+01},
      {"Rat42",
       rat42,
       {9, 14, 21, 28, 42, 57, 63, 70, 79},
       {8.93, 10.80, 18.59, 22.33, 39.35, 56.11, 61.73, 64.62, 67.08},
       {{100, 1, 0.1}, {75, 2.5, 0.07}},
       {7.2462237576e+01, 2.6180768402e+00, 6.7359200066e-02},
       8.0565229338e+00},
      {"Rat43",
       rat43,
       rat43_x,
       {16.08, 33.83, 65.80, 97.20, 191.55, 326.20, 386.87, 520.53, 590.03, 651.92, 724.93, 699.56, 689.96,
        637.56, 717.41},
       {{100, 10, 1, 1}, {700, 5, 0.75, 1.3}},
       {6.9964151270e+02, 5.2771253025e+00, 7.5962938329e-01, 1.2792483859e+00},
       8.7864049080e+03},
      {"Eckerle4",
       eckerle,
       {400,   405, 410,   415, 420,   425, 430,   435, 436.5, 438, 439.5, 441,
        442.5, 444, 445.5, 447, 448.5, 450, 451.5, 453, 454.5, 456, 457.5, 459,
        460.5, 462, 463.5, 465, 470,   475, 480,   485, 490,   495, 500},
       {0.0001575, 0.0001699, 0.0002350, 0.0003102, 0.0004917, 0.0008710, 0.0017418, 0.0046400, 0.0065895,
        0.0097302, 0.0149002, 0.0237310, 0.0401683, 0.0712559, 0.1264458, 0.2073413, 0.2902366, 0.3445623,
        0.3698049, 0.3668534, 0.3106727, 0.2078154, 0.1164354, 0.0616764, 0.0337200, 0.0194023, 0.0117831,
        0.0074357, 0.0022732, 0.0008800, 0.0004579, 0.0002345, 0.0001586, 0.0001143, 0.0000710},
       {{1, 10, 500}, {1.5, 5, 450}},
       {1.5543827178e+00, 4.0888321754e+00, 4.5154121844e+02},
       1.4635887487e-03},
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
      if (!std::isfinite(residual[i])) return false;
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

double sumOfSquares(const LeastSquares& problem, std::span<const double> q) {
  std::vector<double> residual(size_t(problem.residuals));
  if (!problem.evaluate(q, residual, {})) return INFINITY;
  double sum = 0;
  for (const double r : residual) sum += r * r;
  return sum;
}

TEST(StressFits, CertifiedParametersFromNistsStarts) {
  for (const Dataset& data : nonlinear()) {
    // First the data themselves: at the certified parameters they have the certified squares.
    const LeastSquares problem = problemOf(data);
    EXPECT_GE(digits(sumOfSquares(problem, data.certified), data.certified_squares), 8) << data.name;
    double least = 11;
    for (const std::vector<double>& start : data.starts) {
      std::vector<double> q = start;
      minimise(problem, q);
      for (size_t i = 0; i < q.size(); ++i) least = std::min(least, digits(q[i], data.certified[i]));
    }
    record(std::string(data.name) + ", from " + std::to_string(data.starts.size()) +
               " of NIST's starts: digits of the certified parameters",
           least, ">= 6");
    EXPECT_GE(least, 6) << data.name;
  }
}

// Linear problems through the same solver: NIST's Longley, Wampler1 and Wampler2, and Läuchli's.
TEST(StressFits, LinearProblemsOfHighConditionAreSolved) {
  struct Linear {
    std::string name;
    int columns;
    std::vector<std::vector<double>> rows;
    std::vector<double> y, certified;
    double least_digits;
  };
  std::vector<Linear> all;
  Linear longley{"Longley",
                 7,
                 {},
                 {},
                 {-3482258.63459582, 15.0618722713733, -0.358191792925910e-01, -2.02022980381683,
                  -1.03322686717359, -0.511041056535807e-01, 1829.15146461355},
                 6};
  const double data[16][7] = {
      {60323, 83.0, 234289, 2356, 1590, 107608, 1947},  {61122, 88.5, 259426, 2325, 1456, 108632, 1948},
      {60171, 88.2, 258054, 3682, 1616, 109773, 1949},  {61187, 89.5, 284599, 3351, 1650, 110929, 1950},
      {63221, 96.2, 328975, 2099, 3099, 112075, 1951},  {63639, 98.1, 346999, 1932, 3594, 113270, 1952},
      {64989, 99.0, 365385, 1870, 3547, 115094, 1953},  {63761, 100.0, 363112, 3578, 3350, 116219, 1954},
      {66019, 101.2, 397469, 2904, 3048, 117388, 1955}, {67857, 104.6, 419180, 2822, 2857, 118734, 1956},
      {68169, 108.4, 442769, 2936, 2798, 120445, 1957}, {66513, 110.8, 444546, 4681, 2637, 121950, 1958},
      {68655, 112.6, 482704, 3813, 2552, 123366, 1959}, {69564, 114.2, 502601, 3931, 2514, 125368, 1960},
      {69331, 115.7, 518173, 4806, 2572, 127852, 1961}, {70551, 116.9, 554894, 4007, 2827, 130081, 1962}};
  for (const auto& row : data) {
    longley.rows.push_back({1, row[1], row[2], row[3], row[4], row[5], row[6]});
    longley.y.push_back(row[0]);
  }
  all.push_back(longley);
  for (const bool small : {false, true}) {
    Linear wampler{small ? "Wampler2" : "Wampler1", 6, {}, {}, {}, 6};
    for (int p = 0; p < 6; ++p) wampler.certified.push_back(small ? std::pow(0.1, p) : 1);
    for (int x = 0; x <= 20; ++x) {
      std::vector<double> row;
      double y = 0;
      for (int p = 0; p < 6; ++p)
        row.push_back(std::pow(x, p)), y += wampler.certified[size_t(p)] * row.back();
      wampler.rows.push_back(row), wampler.y.push_back(y);
    }
    all.push_back(wampler);
  }
  for (const double e : {1e-4, 1e-7}) {
    Linear laeuchli{
        "Läuchli, e = " + shortNumber(e), 5, {std::vector<double>(5, 1.0)}, {5}, {1, 1, 1, 1, 1}, 6};
    for (int c = 0; c < 5; ++c) {
      std::vector<double> row(5, 0.0);
      row[size_t(c)] = e;
      laeuchli.rows.push_back(row), laeuchli.y.push_back(e);
    }
    all.push_back(laeuchli);
  }
  for (const Linear& linear : all) {
    LeastSquares problem;
    problem.residuals = static_cast<int>(linear.y.size());
    problem.lower.assign(size_t(linear.columns), -INFINITY);
    problem.upper.assign(size_t(linear.columns), INFINITY);
    problem.evaluate = [&](std::span<const double> b, std::span<double> residual,
                           std::span<double> jacobian) {
      for (size_t i = 0; i < linear.y.size(); ++i) {
        residual[i] = -linear.y[i];
        for (size_t k = 0; k < b.size(); ++k) residual[i] += linear.rows[i][k] * b[k];
        for (size_t k = 0; k < b.size() && !jacobian.empty(); ++k)
          jacobian[i * b.size() + k] = linear.rows[i][k];
      }
      return true;
    };
    std::vector<double> q(size_t(linear.columns), 0.0);
    minimise(problem, q);
    double least = 11;
    for (size_t k = 0; k < q.size(); ++k) least = std::min(least, digits(q[k], linear.certified[k]));
    record(linear.name + ", linear: digits of the certified parameters", least,
           ">= " + shortNumber(linear.least_digits));
    EXPECT_GE(least, linear.least_digits) << linear.name;
  }
}

// --- the mean ---

struct MeanCase {
  const char* name;
  std::function<double(const glm::dvec3& wi, const glm::dvec3& wo)> y;
  double most;  // RMSE that is left, of the largest value
};

// Levenberg-Marquardt on data that says nothing of its lobe, or more than a lobe can follow.
TEST(StressFits, MeansOfFlatBlackAndMirrorLikeDataAreFound) {
  const DirectionSet set = bonn81Directions();
  const auto lobe = [](double exponent) {
    return [exponent](const glm::dvec3& wi, const glm::dvec3& wo) {
      return 0.1 + 0.2 * wi.z + std::pow(glm::normalize(wi + wo).z, exponent);
    };
  };
  const auto mirror = [](const glm::dvec3& wi, const glm::dvec3& wo) {
    return glm::length(wi + wo - glm::dvec3(0, 0, 2 * wo.z)) < 1e-6 ? 50.0 : 0.0;
  };
  double sum = 0, square = 0;
  for (const glm::dvec3& wi : set.samples) sum += wi.z, square += wi.z * wi.z;
  const std::vector<MeanCase> cases{
      {"black", [](const auto&, const auto&) { return 0.0; }, 0},
      {"flat", [](const auto&, const auto&) { return 0.37; }, 1e-9},
      {"Lambert", [](const glm::dvec3& wi, const auto&) { return wi.z; }, 1e-9},
      {"lobe of exponent 1", lobe(1), 1e-7},
      {"lobe of exponent 500", lobe(500), 1e-7},
      // Between samples nobody sees that the lobe is wider than the data's.
      {"lobe of exponent 20,000, at the bound of 512", lobe(20000), 2e-3},
      {"mirror, 81 of 6,561 samples lit", mirror, 2e-3},
      {"one sample lit",
       [](const glm::dvec3& wi, const glm::dvec3& wo) { return wi.z == 1 && wo.z == 1 ? 1.0 : 0.0; },
       1.0 / 81},
      // With kd >= 0 the best is a constant: what is left is the deviation of the data, .9 times that of z.
      {"brighter towards the horizon", [](const glm::dvec3& wi, const auto&) { return 1 - 0.9 * wi.z; },
       0.9 * std::sqrt(square / 81 - sum / 81 * sum / 81) / (1 - 0.9 * std::cos(75 * kPi / 180))}};
  for (const MeanCase& c : cases) {
    double worst = 0;
    bool finite = true;
    for (const double scale : {1.0, 1e-6, 1e6})
      for (const bool constrained : {false, true}) {
        Matrix means(set.size() * set.size(), 3);
        double largest = 0;
        for (int v = 0; v < set.size(); ++v)
          for (int l = 0; l < set.size(); ++l) {
            const double y = scale * c.y(set.samples[size_t(l)], set.samples[size_t(v)]);
            largest = std::max(largest, std::abs(y));
            means(v * set.size() + l, 0) = y;
            means(v * set.size() + l, 1) = 0.1 * y, means(v * set.size() + l, 2) = -0.05 * y;
          }
        const PhongFit fit = fitPhong(means, set, set, {constrained, MeanChroma::kRatio});
        const PhongMean& m = fit.mean;
        for (const float value : {m.ka, m.kd, m.ks, m.alpha, m.cb, m.cr})
          finite = finite && std::isfinite(value);
        EXPECT_TRUE(m.alpha >= 1 && m.alpha <= 512.01f) << c.name;
        // The error of the stored mean by its definition, not by the solver's own account.
        double squares = 0;
        for (int v = 0; v < set.size(); ++v)
          for (int l = 0; l < set.size(); ++l) {
            const glm::dvec3 &wi = set.samples[size_t(l)], &wo = set.samples[size_t(v)];
            const double y = double(m.ka) + double(m.kd) * wi.z +
                             double(m.ks) * std::pow(glm::normalize(wi + wo).z, double(m.alpha));
            squares += std::pow(y - means(v * set.size() + l, 0), 2);
          }
        const double error = std::sqrt(squares / double(means.rows));
        worst = std::max(worst, largest > 0 ? error / largest : error);
      }
    // Coefficients are stored as floats.
    record(std::string("mean of ") + c.name + ", times 1e-6, 1 and 1e6: error, of the largest value", worst,
           "<= " + shortNumber(c.most + 1e-6));
    EXPECT_TRUE(finite) << c.name;
    EXPECT_LE(worst, c.most + 1e-6) << c.name;
  }
}

// --- whole cooks ---

SyntheticSource cloth(int side, double scale) {
  return SyntheticSource(
      side, bonn81Directions(), [scale](glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3& wo) {
        const double weave = 0.5 + 0.3 * std::sin(2 * kPi * x.x) * std::cos(2 * kPi * x.y);
        return scale * glm::dvec3(0.8, 0.6, 0.4) * wi.z *
               (weave + 0.2 * wo.x * std::sin(2 * kPi * x.x) + 0.3 * std::pow(glm::normalize(wi + wo).z, 20));
      });
}

Result<GeometryImage> plane(int side) {
  return planeImage(side == 0 ? 16 : side, 0.0);
}

std::vector<std::byte> cookedBytes(const SyntheticSource& source, Mode mode, Preset preset, int threads) {
  CookOptions options;
  options.quiet = true;
  options.mode = mode, options.preset = preset, options.threads = threads;
  options.levels = preset == Preset::kSeed ? 2 : 0;
  const auto material =
      mode == Mode::kLod ? cookLod(source, options) : cookFused(source, plane, BakedSurface{}, options);
  EXPECT_TRUE(material.ok()) << (material.ok() ? "" : material.issue().text);
  if (!material) return {};
  auto bytes = serializeAsset(*material);
  EXPECT_TRUE(bytes.ok()) << (bytes.ok() ? "" : bytes.issue().text);
  return bytes ? std::move(*bytes) : std::vector<std::byte>{};
}

TEST(StressFits, AssetsAreTheSameBytesAtOneToEightThreads) {
  const SyntheticSource source = cloth(static_cast<int>(amount(8, 16)), 1);
  const int step = static_cast<int>(amount(6, 1));
  int64_t assets = 0, different = 0;
  for (const auto& [mode, preset] : {std::pair{Mode::kLod, Preset::kSeed},
                                     {Mode::kLod, Preset::kGame},
                                     {Mode::kLod, Preset::kReference},
                                     {Mode::kFused, Preset::kGame}}) {
    const std::vector<std::byte> one = cookedBytes(source, mode, preset, 1);
    for (int threads = 2; threads <= 8; threads += step) {
      ++assets;
      different += cookedBytes(source, mode, preset, threads) != one;
    }
  }
  record("assets cooked with 2 to 8 threads asked for, on " + std::to_string(usableThreads(0)) +
             " cores, four plans",
         double(assets), "all tried");
  record("assets cooked with 2 to 8 threads that differ in a byte from those of one thread",
         double(different), "0");
  EXPECT_EQ(different, 0);
}

// Halves hold up to 65504 and lose digits below 6e-5; what is stored in them is in a unit of its own.
TEST(StressFits, HalvesOfAnyBrightnessKeepElevenBits) {
  double worst = 0;
  for (const double scale : {1e-12, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e12, 1e30}) {
    const SyntheticSource source = cloth(4, scale);
    const auto btf = loadYcc(source, 0, YccBtf::Store::kHalf);
    ASSERT_TRUE(btf.ok()) << scale << ": " << btf.issue().text;
    double most = 0;
    for (int v = 0; v < 81; v += 10) {
      Matrix luma;
      btf->read(0, v, luma);
      for (int t = 0; t < 16; ++t)
        for (int l = 0; l < 81; ++l) {
          const glm::dvec3 c =
              source.valueAt(glm::dvec2(t % 4 + 0.5, t / 4 + 0.5) / 4.0, source.lights().samples[size_t(l)],
                             source.views().samples[size_t(v)]);
          const double y = 0.299 * c.x + 0.587 * c.y + 0.114 * c.z;
          most = std::max(most, std::abs(luma(t, l) - y) / y);
        }
    }
    worst = std::max(worst, most);
  }
  record("BTFs in halves, times 1e-12 to 1e30: largest relative error", worst, "<= 4.9e-4");
  EXPECT_LE(worst, 4.9e-4);  // 2^-11, and the rounding to float
}

// An input of any brightness: what is written, read back and evaluated has the same relative error.
TEST(StressFits, AssetsOfAnyBrightnessAreWrittenReadAndRight) {
  std::vector<double> at_one;
  double worst_growth = 0, worst_sky = 0;
  for (const double scale : {1.0, 1e-6, 1e-3, 1e3, 1e6}) {
    const SyntheticSource source = cloth(8, scale);
    size_t plan = 0;
    for (const auto& [mode, preset] : {std::pair{Mode::kLod, Preset::kSeed},
                                       {Mode::kLod, Preset::kGame},
                                       {Mode::kLod, Preset::kReference}}) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << ", plan " << plan);
      const std::vector<std::byte> bytes = cookedBytes(source, mode, preset, 0);
      ASSERT_FALSE(bytes.empty());
      const auto material = parseAsset(bytes, "cooked");
      ASSERT_TRUE(material.ok()) << material.issue().text;
      Evaluator evaluator(*material);
      evaluator.prepareEnvironment();
      // Radiance under unit irradiance times pi: what the BTF's values are.
      const double white = double(material->value_scale) * kPi;
      double squares = 0, largest = 0;
      int64_t count = 0;
      for (int t = 0; t < 64; ++t)
        for (int l = 0; l < 81; l += 7)
          for (int v = 0; v < 81; v += 5) {
            const glm::dvec2 x = glm::dvec2(t % 8 + 0.5, t / 8 + 0.5) / 8.0;
            const glm::dvec3 wi = source.lights().samples[size_t(l)], wo = source.views().samples[size_t(v)];
            const glm::vec3 got = evaluator.evaluate(evaluator.findHit(glm::vec2(x), 0.0f, glm::vec3(wo)),
                                                     glm::vec3(wi), glm::vec3(wo));
            const glm::dvec3 expected = source.valueAt(x, wi, wo);
            squares += std::pow(double(got.y) * white - expected.y, 2), ++count;
            largest = std::max(largest, expected.y);
          }
      const double error = std::sqrt(squares / double(count)) / largest;
      if (scale == 1)
        at_one.push_back(error);
      else
        worst_growth = std::max(worst_growth, error / at_one[plan] - 1);
      // White all around, at a view of the grid, against the integral by definition.
      const glm::dvec3 wo = directionFromSpherical({15 * kPi / 180, 0});
      EnvironmentLight sky;
      sky.constant = glm::vec3(1);
      const glm::vec3 shown =
          evaluator.evaluateEnvironment(evaluator.findHit(glm::vec2(0.3f, 0.3f), 0.0f, glm::vec3(wo)),
                                        hemisphereLight(sky, glm::mat3(1)), glm::vec3(wo));
      double truth = 0;
      constexpr int kRows = 100;
      for (int j = 0; j < kRows; ++j)
        for (int i = 0; i < 2 * kRows; ++i)
          truth +=
              source
                  .valueAt({0.3, 0.3},
                           directionFromSpherical({std::acos((j + 0.5) / kRows), kPi * (i + 0.5) / kRows}),
                           wo)
                  .y /
              double(kRows * kRows);
      worst_sky = std::max(worst_sky, std::abs(double(shown.y) * white - truth) / truth);
      ++plan;
    }
  }
  record("inputs times 1e-6 to 1e6: growth of the relative error over that at 1", worst_growth, "<= .02");
  record("inputs times 1e-6 to 1e6, under a white sky: relative error against the integral", worst_sky,
         "<= .1");
  EXPECT_LE(worst_growth, 0.02);
  EXPECT_LE(worst_sky, 0.1);
}

}  // namespace
}  // namespace loden::stress
