// Packs fitted factors into a Band in the form that the GPU reads, and unpacks a Band for measuring.
#pragma once

#include <vector>

#include "importer/fit/pca.h"
#include "material/model/band.h"
#include "material/model/directions.h"

namespace loden::importer {

// The factors of one band before storage. A quad of chroma holds two Cb and two Cr components, so that cb and
// cr have the same number of components. Weights are over side x side texels. The basis is over (views *
// lights), row = view * lights + light, or, if on_grid, over the grid's degrees of freedom
// (importer/fit/grid_table.h).
struct BandFactors {
  int side = 0;
  Factors y, cb, cr;
  bool on_grid = false;
  // Cb/Y and Cr/Y, [mip][texel]. Mips that are not given are means of the one before. Empty: the band has no
  // ratio layer.
  std::vector<std::vector<glm::dvec2>> ratio;
};

enum class Storage {
  kSnorm8,  // 8 bits for weights and tables, one scale per component
  kSnorm16,
  kFloat32,  // 32-bit floats, as published
};

TexelFormat formatOf(Storage storage);

struct PackOptions {
  TableLayout layout = TableLayout::kGrid;
  Storage storage = Storage::kSnorm8;
  DirectionGrid grid;    // for TableLayout::kGrid
  int mips = 1;          // mips of the weights, by 2 x 2 means
  int spare_layers = 0;  // zero layers after the weights
  // [texel]: chart of the weights; mips are averages inside one chart (importer/tile/charts.h). Empty: one
  // chart.
  std::vector<uint16_t> owners = {};
};

// The factors as a Band. Its domain, filter, window and lambda_first are left for the caller to set.
Band packBand(const BandFactors& factors, const DirectionSet& lights, const DirectionSet& views,
              const PackOptions& options);

// The factors of a stored band as the evaluator reads it at the sampled directions: mip 0 of the weights, and
// the table at the samples, with scales multiplied into the basis.
BandFactors unpackBand(const Band& band, const DirectionGrid& grid, const DirectionSet& lights,
                       const DirectionSet& views);

// The weights of mip 0 as they are read back from storage, so that the basis can be solved for the weights
// that are really stored.
Matrix quantisedWeights(const Matrix& weights, Storage storage);

}  // namespace loden::importer
