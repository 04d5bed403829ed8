// The error of a material against its input at the sampled directions and texel centres, by the algebra of its
// stored bands (equal to the evaluator, which a test holds it to, at a fraction of the time).
#pragma once

#include <string>

#include "importer/fit/ycc_btf.h"
#include "importer/fit/indirection.h"
#include "material/material.h"

namespace loden::importer {

struct FitError {
  double mse = 0, mae = 0;
  double rmse() const;
};

struct BtfError {
  FitError channel[3];  // Y, Cb, Cr over all texels and pairs
  // Per image: the smallest and largest mean square error.
  double min_image_mse[3] = {0, 0, 0}, max_image_mse[3] = {0, 0, 0};
};

// At lambda 0, of modes kLod and kFused. `a`: the flat domain's lookup; may be empty if no band is flat.
BtfError measureError(const Material& material, const YccBtf& btf, const DirectionSet& lights,
                      const DirectionSet& views, const Indirection& a, int threads);

}  // namespace loden::importer
