#include "importer/fit/pca.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <random>

#include "importer/fit/eigen.h"
#include "importer/fit/reduction.h"

namespace loden::importer {
namespace {

using Eigen::MatrixXd;

constexpr int kDirectSide = 64;   // at most this many rows or columns: thin SVD
constexpr int kOversampling = 8;  // extra columns of the range finder

MatrixXd orthonormal(const MatrixXd& m) {
  Eigen::HouseholderQR<MatrixXd> qr(m);
  return qr.householderQ() * MatrixXd::Identity(m.rows(), m.cols());
}

// F * right, summed over fixed groups of blocks.
MatrixXd timesRight(const ColumnBlocks& f, const MatrixXd& right, int threads) {
  std::vector<MatrixXd> partial(kReductionBlocks);
  parallelFor(kReductionBlocks, threads, [&](int group) {
    MatrixXd& sum = partial[size_t(group)];
    sum = MatrixXd::Zero(f.rows, right.cols());
    Matrix block;
    for (int b = blockBegin(f.blocks, group); b < blockBegin(f.blocks, group + 1); ++b) {
      f.read(b, block);
      sum.noalias() += eigen(block) * right.middleRows(Eigen::Index(b) * f.block_cols, f.block_cols);
    }
  });
  for (int group = 1; group < kReductionBlocks; ++group) partial[0] += partial[size_t(group)];
  return std::move(partial[0]);
}

// F^T * left.
MatrixXd timesLeft(const ColumnBlocks& f, const MatrixXd& left, int threads) {
  MatrixXd out(f.cols(), left.cols());
  parallelFor(f.blocks, threads, [&](int b) {
    Matrix block;
    f.read(b, block);
    out.middleRows(Eigen::Index(b) * f.block_cols, f.block_cols).noalias() = eigen(block).transpose() * left;
  });
  return out;
}

MatrixXd gaussian(int rows, int cols) {
  std::mt19937_64 random(81);
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

Factors padded(const MatrixXd& weights, const MatrixXd& basis, int k) {
  Factors out{Matrix(static_cast<int>(weights.rows()), k), Matrix(static_cast<int>(basis.rows()), k)};
  const int have = std::min<int>(k, static_cast<int>(weights.cols()));
  eigen(out.weights).leftCols(have) = weights.leftCols(have);
  eigen(out.basis).leftCols(have) = basis.leftCols(have);
  return out;
}

Factors directFactors(const ColumnBlocks& f, int k) {
  MatrixXd all(f.rows, f.cols());
  Matrix block;
  for (int b = 0; b < f.blocks; ++b) {
    f.read(b, block);
    all.middleCols(Eigen::Index(b) * f.block_cols, f.block_cols) = eigen(block);
  }
  const Eigen::BDCSVD<MatrixXd> svd(all, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return padded(svd.matrixU() * svd.singularValues().asDiagonal(), svd.matrixV(), k);
}

}  // namespace

ColumnBlocks blocksOf(const Matrix& m) {
  return {m.rows, 1, m.cols, [&m](int, Matrix& into) { into = m; }};
}

Factors leadingFactors(const ColumnBlocks& f, int k, int threads, int subspace_steps) {
  if (std::min(f.rows, f.cols()) <= std::max(kDirectSide, k + kOversampling)) return directFactors(f, k);
  const int r = std::min({k + kOversampling, f.rows, f.cols()});
  MatrixXd range = orthonormal(timesRight(f, gaussian(f.cols(), r), threads));
  for (int step = 0; step < subspace_steps; ++step)
    range = orthonormal(timesRight(f, orthonormal(timesLeft(f, range, threads)), threads));
  // F ~ range (F^T range)^T, and the small factor is decomposed exactly.
  const Eigen::BDCSVD<MatrixXd> svd(timesLeft(f, range, threads), Eigen::ComputeThinU | Eigen::ComputeThinV);
  return padded(range * svd.matrixV() * svd.singularValues().asDiagonal(), svd.matrixU(), k);
}

}  // namespace loden::importer
