#include "importer/fit/band_fit.h"

#include "importer/fit/eigen.h"
#include "importer/fit/reduction.h"

namespace loden::importer {

ColumnBlocks channelBlocks(const YccBtf& btf, int channel) {
  return {btf.texels(), btf.views(), btf.lights(),
          [&btf, channel](int v, Matrix& into) { btf.read(channel, v, into); }};
}

ColumnBlocks centredBlocks(const YccBtf& btf, int channel, const Matrix& means) {
  return {btf.texels(), btf.views(), btf.lights(), [&btf, channel, &means](int v, Matrix& into) {
            btf.read(channel, v, into);
            for (int l = 0; l < into.cols; ++l)
              for (double& value : into.col(l)) value -= means(v * btf.lights() + l, channel);
          }};
}

std::vector<double> columnMeans(const ColumnBlocks& f, int threads) {
  std::vector<double> means(size_t(f.cols()));
  parallelFor(f.blocks, threads, [&](int b) {
    Matrix block;
    f.read(b, block);
    for (int c = 0; c < f.block_cols; ++c)
      means[size_t(b) * size_t(f.block_cols) + size_t(c)] = eigenCols(block, c, 1).mean();
  });
  return means;
}

ColumnBlocks withoutMeans(const ColumnBlocks& f, const std::vector<double>& means) {
  return {f.rows, f.blocks, f.block_cols, [f, &means](int b, Matrix& into) {
            f.read(b, into);
            for (int c = 0; c < f.block_cols; ++c)
              for (double& value : into.col(c)) value -= means[size_t(b) * size_t(f.block_cols) + size_t(c)];
          }};
}

Factors meanFirstFactors(const ColumnBlocks& f, int k, int threads) {
  const std::vector<double> mean = columnMeans(f, threads);
  const Factors rest = leadingFactors(withoutMeans(f, mean), k - 1, threads);
  Factors out{Matrix(f.rows, k), Matrix(f.cols(), k)};
  eigenCols(out.weights, 0, 1).setOnes();
  std::copy(mean.begin(), mean.end(), out.basis.data.begin());
  eigenCols(out.weights, 1, k - 1) = eigen(rest.weights);
  eigenCols(out.basis, 1, k - 1) = eigen(rest.basis);
  return out;
}

}  // namespace loden::importer
