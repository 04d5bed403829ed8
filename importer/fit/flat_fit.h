// The joint fit of a flat-domain band: factors D, E that minimise the error after the indirection,
// sum over views of |A_v D E_v^T - B_v|^2, or of |F_v * (A_v D E_v^T) - B_v|^2, element by element, where b
// has a factor F.
#pragma once

#include "importer/fit/indirection.h"
#include "importer/fit/pca.h"
#include "material/model/band.h"

namespace loden::importer {

struct FlatFitOptions {
  int components = 16;
  int sweeps = 6;                // alternations of E and D
  int cg_steps = 8;              // conjugate-gradient steps for D per alternation
  double smoothness = 1e-4;      // of D between neighbouring flat texels, relative; fills texels no view sees
  std::vector<uint16_t> owners;  // [flat texel] chart: smoothness stays inside one; empty: one chart
  int threads = 0;
};

struct FlatFit {
  Factors factors;  // weights: flat texels x k; basis: (views * lights) x k, orthonormal
  double rmse = 0;  // after the last E step
};

// `b`: reference texels x (views * lights), blocks are views; the part that the band must give (mean
// removed). Starts from the leading factors of [A_1^T B_1, A_2^T B_2, ...], the Flat-BTF weighted with how
// often each texel is seen, then alternates least squares: E by normal equations per view, D by conjugate
// gradients.
FlatFit fitFlat(const ColumnBlocks& b, const Indirection& a, const FlatFitOptions& options);

// The best table for given weights, (views * lights) x k: least squares per view.
Matrix solveBasis(const ColumnBlocks& b, const Indirection& a, const Matrix& weights, int threads);

// The best table for given weights among those that a grid gives, (dof_o * dof_i) x k with row o * dof_i + i
// (fit/grid_table.h): conjugate gradients over all views at once, from the smooth resampling of solveBasis.
Matrix solveGridBasis(const ColumnBlocks& b, const Indirection& a, const Matrix& weights,
                      const DirectionGrid& grid, const DirectionSet& lights, const DirectionSet& views,
                      int threads);

}  // namespace loden::importer
