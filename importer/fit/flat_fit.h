// The joint fit of a flat-domain band: factors D, E that minimise the error after the indirection, sum over
// views of |A_v D E_v^T - B_v|^2, where A_v reads the flat texels through the VDIM and B_v is the view of the
// BTF.
#pragma once

#include "importer/fit/indirection.h"
#include "importer/fit/pca.h"
#include "material/model/band.h"

namespace loden::importer {

struct FlatFitOptions {
  int components = 16;
  int sweeps = 6;    // alternations of solving for E and for D
  int cg_steps = 8;  // conjugate-gradient steps for D per alternation
  // Relative weight of D's smoothness between neighbouring flat texels; fills texels that no view sees.
  double smoothness = 1e-4;
  // [flat texel]: chart; smoothness applies inside one chart. Empty: one chart.
  std::vector<uint16_t> owners;
  int threads = 0;
};

struct FlatFit {
  Factors factors;  // weights: flat texels x k; basis: (views * lights) x k, orthonormal
  double rmse = 0;  // RMSE after the last solution for E
};

// The fitted factors. `b`: reference texels x (views * lights), with a block per view; it is the part that
// the band must give (mean removed). The fit starts from the leading factors of [A_1^T B_1, A_2^T B_2, ...],
// which is the Flat-BTF weighted with how often each texel is seen. Then it alternates least squares: E by
// normal equations per view, D by conjugate gradients.
FlatFit fitFlat(const ColumnBlocks& b, const Indirection& a, const FlatFitOptions& options);

// The best table for given weights, (views * lights) x k, by least squares per view.
Matrix solveBasis(const ColumnBlocks& b, const Indirection& a, const Matrix& weights, int threads);

// The best table for given weights among those that a grid can give, (dof_o * dof_i) x k with row o * dof_i +
// i (importer/fit/grid_table.h): by conjugate gradients over all views at once, starting from the smooth
// resampling of solveBasis.
Matrix solveGridBasis(const ColumnBlocks& b, const Indirection& a, const Matrix& weights,
                      const DirectionGrid& grid, const DirectionSet& lights, const DirectionSet& views,
                      int threads);

}  // namespace loden::importer
