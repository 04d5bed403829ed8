#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "importer/fit/band_pack.h"
#include "importer/fit/grid_table.h"

namespace loden::importer {
namespace {

TEST(GridTable, ReproducesEveryBonnSample) {
  const DirectionSet set = bonn81Directions();
  const DirectionGrid grid = gridFor(set);
  EXPECT_NEAR(double(grid.theta_max), 75 * kPi / 180, 1e-6);
  const Matrix s = gridSampling(grid, set), r = gridResampling(grid, s);
  for (int i = 0; i < set.size(); ++i)
    for (int j = 0; j < set.size(); ++j) {
      double sum = 0;
      for (int d = 0; d < s.cols; ++d) sum += s(i, d) * r(d, j);
      EXPECT_NEAR(sum, i == j ? 1 : 0, 2e-6) << i << " " << j;
    }
}

TEST(GridTable, KeepsConstantsWhateverTheSamples) {
  for (const DirectionSet& set : {bonn81Directions(), ubo151Directions(), concentricDirections(9)}) {
    const DirectionGrid grid = gridFor(set);
    const Matrix r = gridResampling(grid, gridSampling(grid, set));
    for (int d = 0; d < r.rows; ++d) {
      double sum = 0;
      for (int j = 0; j < r.cols; ++j) sum += r(d, j);
      EXPECT_NEAR(sum, 1, 1e-6);
    }
  }
}

// Half a code of each 8-bit factor, times the other factor at full scale.
TEST(BandPack, EightBitsReadBackWithinHalfACode) {
  const DirectionSet set = bonn81Directions();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  BandFactors f;
  f.side = 4;
  f.y = {Matrix(16, 3), Matrix(81 * 81, 3)};
  f.cb = f.cr = {Matrix(16, 2), Matrix(81 * 81, 2)};
  for (Factors* c : {&f.y, &f.cb, &f.cr}) {
    for (double& v : c->weights.data) v = 5 * uniform(random);
    for (double& v : c->basis.data) v = 0.1 * uniform(random);
  }
  f.ratio.emplace_back();
  for (int t = 0; t < 16; ++t) f.ratio[0].push_back({0.2 * uniform(random), 0.1 * uniform(random)});
  const DirectionGrid grid = gridFor(set);
  for (TableLayout layout : {TableLayout::kNearest, TableLayout::kGrid}) {
    const Band band = packBand(f, set, set, {layout, Storage::kSnorm8, grid, 1, 0});
    EXPECT_EQ(band.y_quads, 1);
    EXPECT_EQ(band.chroma_quads, 1);
    EXPECT_EQ(band.weights.depth, 3);
    const BandFactors back = unpackBand(band, grid, set, set);
    for (int t = 0; t < 16; ++t) {
      for (int i = 0; i < 81 * 81; i += 97) {
        // Random tables overshoot between samples in the grid, so its scale is larger than the samples'.
        const double tolerance = layout == TableLayout::kGrid ? 0.02 : 0.005;
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR(back.y.weights(t, k) * back.y.basis(i, k), f.y.weights(t, k) * f.y.basis(i, k),
                      tolerance);
        for (int k = 0; k < 2; ++k)
          EXPECT_NEAR(back.cr.weights(t, k) * back.cr.basis(i, k), f.cr.weights(t, k) * f.cr.basis(i, k),
                      tolerance);
      }
      EXPECT_NEAR(back.ratio[0][size_t(t)].x, f.ratio[0][size_t(t)].x, 0.001);
    }
  }
}

}  // namespace
}  // namespace loden::importer
