// How far the shader's lookup of a material is from the exact first hit on its geometry image.
#pragma once

#include "material/material.h"

namespace loden::importer {

struct LookupError {
  double mean_texels = 0;   // distance of the two points' (x, y), in reference texels
  double over_1_texel = 0;  // share of the views that are further off than a texel
  double fetches = 0;       // per lookup, on average
};

// Over 16,384 random points and views, uniform in solid angle up to kThetaMax; rays that meet nothing do not count.
LookupError measureLookup(const Material& material, const VdimAtlas& atlas, VdimTier tier, int threads);

}  // namespace loden::importer
