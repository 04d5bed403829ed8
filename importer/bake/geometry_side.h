// How many texels a tile's geometry image needs. Not installed.
#pragma once

#include "importer/tile/tile.h"

namespace loden::importer {

// Mean distance between the tile's surface and the bilinear patches between side x side samples of it, in
// texels of that image. For identity parameterizations.
double patchError(const Tile& tile, int side);

// Texels per side of the tile's geometry image: `least`, or twice as many for a height field whose patches
// would otherwise be too far off. Other tiles take four times the bytes per texel, and get `least`.
int geometrySideOf(const Tile& tile, int least);

}  // namespace loden::importer
