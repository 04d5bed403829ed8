// The ambient layer of a band with a light factor (material/model/band.h).
#pragma once

#include "importer/fit/matrix.h"
#include "material/model/material.h"

namespace loden::importer {

// Four components over the band's texels (texels x 4) that, with those of Y and tables of their own, come
// closest to what light from all around, in the basis of material/model/environment.h, makes of the band: the
// leading factors over the views of its table of what those of Y leave. `band` is packed but for this layer;
// of `material` the mean, theta_max and the cosine are read. Deterministic at any number of threads.
Matrix ambientWeights(const Material& material, const Band& band, int threads);

}  // namespace loden::importer
