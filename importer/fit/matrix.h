// A dense matrix without a library in the header; fit/eigen.h maps it for the files that compute.
#pragma once

#include <span>
#include <vector>

namespace loden::importer {

struct Matrix {
  int rows = 0, cols = 0;
  std::vector<double> data;  // column-major

  Matrix() = default;
  Matrix(int rows_, int cols_) : rows(rows_), cols(cols_), data(size_t(rows_) * size_t(cols_), 0.0) {}

  double& operator()(int r, int c) { return data[size_t(c) * size_t(rows) + size_t(r)]; }
  double operator()(int r, int c) const { return data[size_t(c) * size_t(rows) + size_t(r)]; }
  std::span<double> col(int c) { return {data.data() + size_t(c) * size_t(rows), size_t(rows)}; }
  std::span<const double> col(int c) const { return {data.data() + size_t(c) * size_t(rows), size_t(rows)}; }
};

}  // namespace loden::importer
