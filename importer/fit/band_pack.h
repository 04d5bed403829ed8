// From fitted factors to a Band as the GPU gets it, and back for measuring.
#pragma once

#include <vector>

#include "importer/fit/pca.h"
#include "material/model/band.h"
#include "material/model/directions.h"

namespace loden::importer {

// What one band holds before storage. A quad of chroma holds two Cb and two Cr components, so cb and cr have
// equal component counts. Weights are over side x side texels; the basis over (views * lights), row =
// view * lights + light, or over the grid's degrees of freedom (fit/grid_table.h) if on_grid.
struct BandFactors {
  int side = 0;
  Factors y, cb, cr;
  bool on_grid = false;
  // Cb/Y and Cr/Y, [mip][texel]; mips that are not given are means of the one before; empty: no ratio layer.
  std::vector<std::vector<glm::dvec2>> ratio;
};

enum class Storage {
  kSnorm8,  // weights and tables, one scale per component
  kSnorm16,
  kFloat32,  // as published
};

TexelFormat formatOf(Storage storage);

struct PackOptions {
  TableLayout layout = TableLayout::kGrid;
  Storage storage = Storage::kSnorm8;
  DirectionGrid grid;    // of kGrid
  int mips = 1;          // of the weights, by 2 x 2 means
  int spare_layers = 0;  // zero layers behind the weights
  std::vector<uint16_t> owners =
      {};  // [texel] chart of the weights: mips average inside one (charts.h); empty: one chart
};

// domain, filter, window and lambda_first are the caller's to set.
Band packBand(const BandFactors& factors, const DirectionSet& lights, const DirectionSet& views,
              const PackOptions& options);

// A stored band as the evaluator reads it at the sampled directions: mip 0 of the weights and the table at
// the samples, scales folded into the basis.
BandFactors unpackBand(const Band& band, const DirectionGrid& grid, const DirectionSet& lights,
                       const DirectionSet& views);

// Codes of mip 0 as they will read back, before the table is fitted: lets the basis be solved for the weights
// that are really stored.
Matrix quantisedWeights(const Matrix& weights, Storage storage);

}  // namespace loden::importer
