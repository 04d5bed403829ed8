// The reference-domain band that takes over where texels shrink: apparent reflectance, masking and shadowing
// included, from half the resolution down to the full average.
#pragma once

#include "importer/fit/band_pack.h"
#include "importer/fit/ycc_btf.h"

namespace loden::importer {

struct CoarseFitOptions {
  int y_components = 20;  // the first carries the average
  DirectionGrid grid;
  int threads = 0;
};

// Factors over `half`, the finest level that the band gives. One basis serves all mips of the weights (the
// value is linear in them), so it is chosen for the errors of all levels together, each counting twice as
// much as the finer one before it, as its error shows on ever larger areas: a basis for the finest level
// alone spends itself on what averages away. Tables are solved on the grid. `mean`: value to take away,
// (views * lights) x 3.
BandFactors fitCoarse(const YccBtf& half, const DirectionSet& lights, const DirectionSet& views,
                      const Matrix& mean, const CoarseFitOptions& options);

// The grid of at most `phis` columns that gives the full average best. There all components but the first
// have no weight, so a coarse band's error is what this one table misses; and where the columns fall among
// the samples of the rings decides that: 17 columns can beat 18. Tries the last few numbers of columns.
// `means`: of the images, `mean`: what is taken away, both (views * lights) x 3.
DirectionGrid averageGrid(const Matrix& means, const Matrix& mean, const DirectionSet& lights,
                          const DirectionSet& views, int phis);

}  // namespace loden::importer
