// Fits the reference-domain band that is used where texels are small on the screen. It holds apparent
// reflectance, masking and shadowing included, from half the resolution down to the full average.
#pragma once

#include "importer/fit/band_pack.h"
#include "importer/fit/ycc_btf.h"

namespace loden::importer {

struct CoarseFitOptions {
  int y_components = 20;      // number of Y components, of which the first holds the average
  int chroma_components = 0;  // number of Cb and of Cr components each, in fitCoarseChroma
  DirectionGrid grid;
  int threads = 0;
};

// The band's factors over `half`, the finest level that the band gives. One basis serves all mips of the
// weights (the value is linear in them). Therefore it is chosen for the errors of all levels together, each
// counting twice as much as the finer one before it, since its error is visible over larger areas; a basis
// for the finest level alone would be spent on detail that averages out. Tables are solved on the grid.
// `mean`: the value to subtract, (views * lights) x 3.
BandFactors fitCoarse(const YccBtf& half, const DirectionSet& lights, const DirectionSet& views,
                      const Matrix& mean, const CoarseFitOptions& options);

// Factors of what ratios leave of one channel of chroma. `levels`: what they leave at each level, from the
// one of `side` texels down to a single texel; the ratios of a level are its own, so that a level is not the
// mean of the finer one. The weights of a level are. No component is kept for the average.
Factors fitCoarseChroma(const std::vector<ColumnBlocks>& levels, int side, const DirectionSet& lights,
                        const DirectionSet& views, const CoarseFitOptions& options);

// The grid of at most `phis` columns that gives the full average best. At the full average all components but
// the first have weight zero, so that a coarse band's error is the error of this one table. It depends on
// where the columns fall among the samples of the rings: 17 columns can be better than 18. The last few
// numbers of columns are tried. `means`: the means of the images; `mean`: the value to subtract; both (views
// * lights) x 3.
DirectionGrid averageGrid(const Matrix& means, const Matrix& mean, const DirectionSet& lights,
                          const DirectionSet& views, int phis);

}  // namespace loden::importer
