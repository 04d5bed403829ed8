#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "importer/fit/band_fit.h"
#include "importer/fit/matrix.h"
#include "importer/fit/pca.h"

namespace loden::importer {
namespace {

Matrix product(const Factors& f) {
  Matrix out(f.weights.rows, f.basis.rows);
  for (int c = 0; c < out.cols; ++c)
    for (int r = 0; r < out.rows; ++r)
      for (int k = 0; k < f.components(); ++k) out(r, c) += f.weights(r, k) * f.basis(c, k);
  return out;
}

double largestDifference(const Matrix& a, const Matrix& b) {
  double m = 0;
  for (size_t i = 0; i < a.data.size(); ++i) m = std::max(m, std::abs(a.data[i] - b.data[i]));
  return m;
}

Matrix randomLowRank(int rows, int cols, int rank, double scale) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Factors f{Matrix(rows, rank), Matrix(cols, rank)};
  for (double& v : f.weights.data) v = normal(random) * scale;
  for (double& v : f.basis.data) v = normal(random);
  return product(f);
}

ColumnBlocks inBlocks(const Matrix& m, int blocks) {
  const int cols = m.cols / blocks;
  return {m.rows, blocks, cols, [&m, cols](int b, Matrix& into) {
            into = Matrix(m.rows, cols);
            for (int c = 0; c < cols; ++c)
              for (int r = 0; r < m.rows; ++r) into(r, c) = m(r, b * cols + c);
          }};
}

// A Gram matrix loses e below the square root of the precision (1.5e-8); a thin SVD does not.
TEST(Pca, KeepsSmallSingularValuesOfLaeuchli) {
  for (double e : {1e-6, 1e-9, 1e-12}) {
    Matrix m(4, 3);
    for (int c = 0; c < 3; ++c) m(0, c) = 1, m(c + 1, c) = e;
    const Factors f = leadingFactors(blocksOf(m), 3);
    double smallest = INFINITY;
    for (int k = 0; k < 3; ++k) {
      double squares = 0;
      for (double w : f.weights.col(k)) squares += w * w;
      smallest = std::min(smallest, std::sqrt(squares));
    }
    EXPECT_NEAR(smallest / e, 1, 1e-3) << e;
    EXPECT_LT(largestDifference(product(f), m), 1e-15);
  }
}

// NIST StRD, univariate, NumAcc4: mean 10000000.2, standard deviation 0.1 of 1001 values. A sum of squares
// minus the square of the sum keeps no digit of the deviation, even in double precision.
TEST(Pca, MeanAndSpreadOfNistNumAcc4) {
  Matrix values(1001, 1);
  for (int i = 0; i < 1001; ++i) values(i, 0) = i == 0 ? 10000000.2 : i % 2 == 1 ? 10000000.1 : 10000000.3;
  const ColumnBlocks blocks = blocksOf(values);
  const std::vector<double> means = columnMeans(blocks, 1);
  EXPECT_NEAR(means[0], 10000000.2, 1e-7);
  const Factors f = leadingFactors(withoutMeans(blocks, means), 1);
  double squares = 0;
  for (double w : f.weights.col(0)) squares += w * w;
  EXPECT_NEAR(std::sqrt(squares / 1000), 0.1, 1e-8);  // 7 digits: the data themselves are rounded to 2e-9
}

TEST(Pca, RandomisedFindsTheExactRank) {
  const Matrix m = randomLowRank(150, 240, 5, 1);
  const Factors f = leadingFactors(inBlocks(m, 24), 8);
  EXPECT_LT(largestDifference(product(f), m), 1e-11);
  for (int k = 5; k < 8; ++k)
    for (double w : f.weights.col(k)) EXPECT_NEAR(w, 0, 1e-11);
}

TEST(Pca, SameAtAnyThreadCount) {
  const Matrix m = randomLowRank(150, 240, 20, 1);
  const Factors one = leadingFactors(inBlocks(m, 24), 4, 1), three = leadingFactors(inBlocks(m, 24), 4, 3);
  EXPECT_EQ(one.weights.data, three.weights.data);
  EXPECT_EQ(one.basis.data, three.basis.data);
}

TEST(Pca, SurvivesZeroConstantOneTexelAndHugeRange) {
  const Matrix zero(100, 200);
  for (double w : leadingFactors(inBlocks(zero, 10), 4).weights.data) EXPECT_EQ(w, 0);

  Matrix constant(100, 200);
  std::fill(constant.data.begin(), constant.data.end(), 0.25);
  EXPECT_LT(largestDifference(product(leadingFactors(inBlocks(constant, 10), 4)), constant), 1e-12);

  Matrix texel(1, 200);
  std::fill(texel.data.begin(), texel.data.end(), 3.0);
  EXPECT_LT(largestDifference(product(leadingFactors(inBlocks(texel, 10), 4)), texel), 1e-12);

  for (double scale : {1e-6, 1e6}) {
    const Matrix m = randomLowRank(150, 240, 3, scale);
    EXPECT_LT(largestDifference(product(leadingFactors(inBlocks(m, 24), 4)), m), 1e-11 * scale);
  }
}

}  // namespace
}  // namespace loden::importer
