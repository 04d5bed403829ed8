// How a bake fills what a view does not see.
#pragma once

namespace loden::importer {

enum class FillMethod {
  kPushPull,  // as published (FBTF 3.3)
  kHarmonic,  // every undefined texel is the mean of its neighbours: no steps, and linear ramps stay linear
};

}  // namespace loden::importer
