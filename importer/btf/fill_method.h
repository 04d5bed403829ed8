// How a bake makes the texels of the Flat-BTF.
#pragma once

namespace loden::importer {

// What a view does not see.
enum class FillMethod {
  kPushPull,  // as published (FBTF 3.3)
  kHarmonic,  // every undefined texel is the mean of its neighbours: no steps, and linear ramps stay linear
  kNearestView,  // as the texel looks from the nearest view that sees it; push-pull where none does
};

// What it sees.
enum class TexelMethod {
  kMean,    // the mean over what the view sees of the texel
  kLinear,  // read with the linear filter, the map is as close as it can be to all that the view sees
};

}  // namespace loden::importer
