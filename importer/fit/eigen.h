// Matrix as an Eigen map. Only .cpp files that compute include this.
#pragma once

#include <Eigen/Core>

#include "importer/fit/matrix.h"

namespace loden::importer {

inline Eigen::Map<Eigen::MatrixXd> eigen(Matrix& m) {
  return {m.data.data(), m.rows, m.cols};
}
inline Eigen::Map<const Eigen::MatrixXd> eigen(const Matrix& m) {
  return {m.data.data(), m.rows, m.cols};
}

// Columns [first, first + count).
inline Eigen::Map<Eigen::MatrixXd> eigenCols(Matrix& m, int first, int count) {
  return {m.data.data() + size_t(first) * size_t(m.rows), m.rows, count};
}
inline Eigen::Map<const Eigen::MatrixXd> eigenCols(const Matrix& m, int first, int count) {
  return {m.data.data() + size_t(first) * size_t(m.rows), m.rows, count};
}

template <class Derived>
Matrix matrixFrom(const Eigen::MatrixBase<Derived>& e) {
  Matrix m(static_cast<int>(e.rows()), static_cast<int>(e.cols()));
  eigen(m) = e;
  return m;
}

}  // namespace loden::importer
