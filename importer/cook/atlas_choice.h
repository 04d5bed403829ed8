// Chooses the size of a tile's VDIM atlas by measuring the error of the shader's look-up: first how to split
// given bytes into texels and directions, then how few bytes are enough.
#pragma once

#include <vector>

#include "importer/fit/lookup_error.h"
#include "material/model/vdim.h"

namespace loden::importer {

// The most bytes of the atlas's depths. With a geometry image of 128 x 128 and a closest-point volume this
// makes .5 MB. More bytes gain little, since the look-up's misses then depend on the number of its
// candidates.
inline constexpr uint64_t kMostAtlasBytes = 400'000;  // bytes of the depths
// The same for this tile: a height field that takes more than 128 x 128 heights has so many fewer depths,
// down to half of them, since they only bound the march over its heights.
uint64_t mostAtlasBytes(const GeometryImage& geometry);

struct AtlasTrial {
  VdimAtlasSize size;
  LookupError error;  // error of the default look-up
};

struct AtlasChoice {
  VdimAtlasSize size;
  // First the candidates, fewest directions first; then the smaller sizes, largest first.
  std::vector<AtlasTrial> trials;
};

// The splits that are tried: even numbers of directions per side, each with as many texels as the bytes
// allow.
std::vector<VdimAtlasSize> atlasCandidates(uint64_t bytes = kMostAtlasBytes);

// The chosen size. First the candidate with the least product of mean error and share of errors over a texel
// is found, which weighs equally how often the look-up misses and by how much. Then half, a quarter and an
// eighth of its bytes, split in the same way, are tried as long as the product stays nearly as it was, since
// a shallow tile needs no large atlas. `side`: reference texels per tile period. Deterministic at any number
// of threads.
AtlasChoice chooseAtlas(const GeometryImage& geometry, int side, int threads);

}  // namespace loden::importer
