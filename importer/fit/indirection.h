// The matrices A_v of the joint fit: for each view a sparse matrix that reads a flat map at VDIM(x, wo) for
// every reference texel x, with the bilinear filter of the shader.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "importer/fit/matrix.h"
#include "material/model/directions.h"

namespace loden::importer {

// Returns p = VDIM(x, wo), unwrapped; called from several threads.
using IndirectionLookup = std::function<glm::dvec2(glm::dvec2 x, const glm::dvec3& wo)>;

struct Indirection {
  struct Taps {
    int32_t index[4];  // flat texels
    float weight[4];   // sum 1
  };
  int texels = 0;       // reference texels (rows of A_v)
  int flat_texels = 0;  // flat texels (columns)
  int views = 0;
  std::vector<Taps> taps;  // [view][texel]

  // into = A_v * flat; flat is flat_texels x k, into becomes texels x k.
  void apply(int view, const Matrix& flat, Matrix& into) const;
  // sum += A_v^T * values.
  void addTransposed(int view, const Matrix& values, Matrix& sum) const;
};

// The indirection of a look-up, at the centres of side x side reference texels for every view.
Indirection makeIndirection(int side, int flat_side, const DirectionSet& views,
                            const IndirectionLookup& lookup, int threads);

// The identity: every texel reads the flat texel of its own index, in every view.
Indirection identityIndirection(int texels, int views);

}  // namespace loden::importer
