// Which VDIM atlas suits a tile: texels against directions at equal bytes, then fewer bytes, by the error of
// the shader's lookup.
#pragma once

#include <vector>

#include "importer/fit/lookup_error.h"
#include "material/model/vdim.h"

namespace loden::importer {

// With a geometry image of 128 x 128 and a closest-point volume, .5 MB. More bytes gain little: what the
// lookup then misses depends on the number of its candidates.
inline constexpr uint64_t kMostAtlasBytes = 400'000;  // of the depths

struct AtlasTrial {
  VdimAtlasSize size;
  LookupError error;  // of the default lookup
};

struct AtlasChoice {
  VdimAtlasSize size;
  std::vector<AtlasTrial> trials;  // fewest directions first, then the smaller ones, largest first
};

// The splits that are tried: even numbers of directions per side, each with the most texels that
// kMostAtlasBytes have room for.
std::vector<VdimAtlasSize> atlasCandidates();

// The candidate whose product of mean error and share over a texel is least: how often the lookup misses and
// how far off it then is weigh alike. Then half, a quarter and an eighth of the bytes, split alike, as long
// as that leaves the product nearly what it was: a shallow tile needs no large atlas. `side`: reference
// texels per tile period. Deterministic at any number of threads.
AtlasChoice chooseAtlas(const GeometryImage& geometry, int side, int threads);

}  // namespace loden::importer
