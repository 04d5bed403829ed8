// Low-rank factors of a matrix that is read by blocks of columns and need not fit in memory.
#pragma once

#include <functional>

#include "importer/fit/matrix.h"

namespace loden::importer {

// A matrix of rows x (blocks * block_cols); `read` may be called from several threads. For a BTF rows are
// texels, a block is a view, and its columns are lights.
struct ColumnBlocks {
  int rows = 0, blocks = 0, block_cols = 0;
  std::function<void(int block, Matrix& into)> read;
  int cols() const { return blocks * block_cols; }
};
ColumnBlocks blocksOf(const Matrix& m);  // one block; `m` must outlive it

// Factors of a matrix F ~ weights * basis^T. The basis has orthonormal columns, ordered by singular value. If
// F has a lower rank than the number of components, the surplus ones have zero weights.
struct Factors {
  Matrix weights;  // texels x components
  Matrix basis;    // samples x components
  int components() const { return weights.cols; }
};

// The best rank-k factors (without centring): by a thin SVD if one side is small, otherwise by a randomised
// range finder with subspace iteration (Halko, Martinsson and Tropp 2011, algorithms 4.4 and 5.1), in double
// and never through a Gram matrix. Deterministic. More subspace steps (two passes over the data each) come
// closer to the optimum.
Factors leadingFactors(const ColumnBlocks& f, int k, int threads = 0, int subspace_steps = 4);

}  // namespace loden::importer
