// Interpolation between the samples of a ring-ordered direction set.
#pragma once

#include <array>

#include "material/model/directions.h"

namespace loden::importer {

struct DirectionWeights {
  std::array<int, 4> index{};      // samples
  std::array<double, 4> weight{};  // sum 1
};

// The interpolation weights of direction w: linear in azimuth on the two rings around w, and linear in theta
// between them. A direction beyond the last ring reads that ring.
DirectionWeights interpolateRings(const std::vector<Ring>& rings, const glm::dvec3& w);

}  // namespace loden::importer
