// Between sampled directions and the lat-long grid of TableLayout::kGrid (material/model/band.h).
#pragma once

#include "importer/fit/matrix.h"
#include "material/model/band.h"
#include "material/model/directions.h"

namespace loden::importer {

// Degrees of freedom of a grid: one for the pole row, phis - 1 for every other row (the last column repeats
// the first). dof 0 is the pole; row r >= 1, column c is 1 + (r - 1) * (phis - 1) + c.
int gridDof(const DirectionGrid& grid);
int gridDofIndex(const DirectionGrid& grid, int row, int column);

// samples x dof: how the evaluator's bilinear fetch reads the grid at each direction (beyond grid.theta_max
// the last row).
Matrix gridSampling(const DirectionGrid& grid, const DirectionSet& set);

// dof x samples: the smoothest grid that gives the samples back: minimises |S g - e|^2 + epsilon |second
// differences of g|^2 for a tiny epsilon, so that samples are reproduced exactly (to 1e-6) wherever the grid
// has the freedom and in the least-squares sense elsewhere.
Matrix gridResampling(const DirectionGrid& grid, const Matrix& sampling);

// Rows of second differences over the grid, along phi and theta; unitless.
Matrix gridRoughness(const DirectionGrid& grid);

// Tables of k components at the samples, (views * lights) x k with row = view * lights + light, to or from
// grid tables, (dof_o * dof_i) x k with row = o * dof_i + i. `light` and `view` are the operators above.
Matrix mapTables(const Matrix& tables, const Matrix& light, const Matrix& view);

// The 6 x 25 grid to the outermost ring of the set; `phis` counts the repeated column.
DirectionGrid gridFor(const DirectionSet& set, int thetas = 6, int phis = 25);

}  // namespace loden::importer
