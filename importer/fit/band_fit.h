// Fits that more than one mode uses: data with the mean removed, factors that carry the exact average,
// chroma.
#pragma once

#include "importer/fit/band_pack.h"
#include "importer/fit/pca.h"
#include "importer/fit/phong.h"
#include "importer/fit/ycc_btf.h"

namespace loden::importer {

// One channel, texels x (views * lights), blocks are views. `btf` must outlive it.
ColumnBlocks channelBlocks(const YccBtf& btf, int channel);
// The same minus one value per image: column `channel` of `means` ((views * lights) x 3).
ColumnBlocks centredBlocks(const YccBtf& btf, int channel, const Matrix& means);

// Mean over the rows of each column, and the data without them.
std::vector<double> columnMeans(const ColumnBlocks& f, int threads);
ColumnBlocks withoutMeans(const ColumnBlocks& f,
                          const std::vector<double>& means);  // `means` must outlive it

// Leading factors whose first component has weight 1 everywhere and the mean over the texels as its basis, so
// that the average over all texels is exact and stays exact when weights are mip-mapped.
Factors meanFirstFactors(const ColumnBlocks& f, int k, int threads);

}  // namespace loden::importer
