// Conversion between tables at sampled directions and on the lat-long grid of TableLayout::kGrid
// (material/model/band.h).
#pragma once

#include "importer/fit/matrix.h"
#include "material/model/band.h"
#include "material/model/directions.h"

namespace loden::importer {

// The degrees of freedom (dof) of a grid: one for the pole row, and phis - 1 for every other row (the last
// column repeats the first). dof 0 is the pole; row r >= 1, column c is dof 1 + (r - 1) * (phis - 1) + c.
int gridDof(const DirectionGrid& grid);
int gridDofIndex(const DirectionGrid& grid, int row, int column);

// The matrix samples x dof of how the evaluator's bilinear fetch reads the grid at each direction (beyond
// grid.theta_max it reads the last row).
Matrix gridSampling(const DirectionGrid& grid, const DirectionSet& set);

// The matrix dof x samples that gives the smoothest grid for the samples: it minimises |S g - e|^2 + epsilon
// |second differences of g|^2 for a tiny epsilon. Samples are reproduced exactly (to 1e-6) where the grid has
// the freedom, and in the least-squares sense elsewhere.
Matrix gridResampling(const DirectionGrid& grid, const Matrix& sampling);

// The matrix of second differences over the grid, along phi and theta; unitless.
Matrix gridRoughness(const DirectionGrid& grid);

// Converts tables of k components between samples, (views * lights) x k with row = view * lights + light, and
// grid tables, (dof_o * dof_i) x k with row = o * dof_i + i. `light` and `view` are results of gridSampling
// or gridResampling.
Matrix mapTables(const Matrix& tables, const Matrix& light, const Matrix& view);

// The grid of 6 x 25 (by default) up to the outermost ring of the set; `phis` includes the repeated column.
DirectionGrid gridFor(const DirectionSet& set, int thetas = 6, int phis = 25);

}  // namespace loden::importer
