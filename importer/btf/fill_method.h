// How a bake computes the texels of the Flat-BTF.
#pragma once

namespace loden::importer {

// How texels that a view does not see are filled.
enum class FillMethod {
  kPushPull,  // push-pull, as published (FBTF 3.3)
  // Each undefined texel is the mean of its neighbours: no steps, and linear ramps stay linear.
  kHarmonic,
  kNearestView,  // the texel's look from the nearest view that sees it; push-pull where no view does
};

// How texels that a view sees are computed.
enum class TexelMethod {
  kMean,  // the mean over the part of the texel that the view sees
  // Fitted so that the map, read with the linear filter, is as close as possible to all that the view sees.
  kLinear,
};

}  // namespace loden::importer
