// Fits that several modes use: data with the mean removed, and factors that keep the average exact.
#pragma once

#include "importer/fit/band_pack.h"
#include "importer/fit/pca.h"
#include "importer/fit/phong.h"
#include "importer/fit/ycc_btf.h"

namespace loden::importer {

// One channel as a matrix of texels x (views * lights), with a block per view. `btf` must outlive it.
ColumnBlocks channelBlocks(const YccBtf& btf, int channel);
// One channel minus one value per image, which is column `channel` of `means` ((views * lights) x 3).
ColumnBlocks centredBlocks(const YccBtf& btf, int channel, const Matrix& means);

// The mean of each column over its rows, and the data without these means.
std::vector<double> columnMeans(const ColumnBlocks& f, int threads);
ColumnBlocks withoutMeans(const ColumnBlocks& f,
                          const std::vector<double>& means);  // `means` must outlive the result

// Leading factors whose first component has weight 1 everywhere and the mean over the texels as its basis.
// The average over all texels is therefore exact, and stays exact when weights are mip-mapped.
Factors meanFirstFactors(const ColumnBlocks& f, int k, int threads);

}  // namespace loden::importer
