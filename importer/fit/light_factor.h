// The light factor of a flat band (material/model/band.h): cast and attached shadows apart from shading (FBTF
// section 5).
//
// Whether light reaches a point is 0 or 1 with an edge between, and no sum of few products is. But clamp(u)
// of such a sum is: u only has to be beyond 0 or 1 where a point lies in shadow or light, and right where the
// edge runs. What is left for the band's own components is smooth, as it may be anything where there is no
// light.
#pragma once

#include "importer/fit/band_pack.h"
#include "importer/fit/indirection.h"
#include "importer/fit/pca.h"
#include "material/model/geometry_image.h"

namespace loden::importer {

// Grid of the factor's table: fine, as it knows the light alone.
DirectionGrid lightFactorGrid(const DirectionSet& lights);

// Share of each flat texel's surface that a light reaches, 0..1: side * side x gridDof(grid). A texel without
// surface takes what those around it have.
Matrix lightVisibility(const GeometryImage& image, int side, const DirectionGrid& grid, int threads);

// weights (texels x k, as storage will give them back) and basis (gridDof x k) with clamp(weights basis^T, 0,
// 1) close to `visibility`: alternating least squares over the samples that are not yet beyond the end where
// they belong.
Factors fitLightFactor(const Matrix& visibility, int components, Storage storage, int threads);

// The same factors with their basis at the sampled lights, lights x k.
Factors lightFactorAt(const Factors& factor, const DirectionGrid& grid, const DirectionSet& lights);

// One view's factor as the evaluator reads it, texels x lights; `factor` as lightFactorAt gives it.
void readLightFactor(const Factors& factor, const Indirection& a, int view, Matrix& into);

}  // namespace loden::importer
