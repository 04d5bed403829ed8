// Peers that draw geometry for every period of the tile, where other renderers draw one plane: the tile's own
// surface, and prisms for parallax occlusion mapping in a shell.
#pragma once

#include <memory>
#include <string>

#include "tests/bench/peer_renderers.h"

namespace loden::bench {

// Draws the tile's own surface as triangles, as engines draw micropolygons (Karis et al. 2021, "Nanite"),
// without multisampling. `tile` is a name or file that importer::loadTile takes, of a tile with one chart. A
// builtin tile has the density at which a cell of two triangles is as wide as a pixel (4 to 128 cells a
// period, a power of two); a tile from a file has the file's triangles. The nearest triangle in a pixel gives
// the parameter at which the surface maps of `material` are read.
TileRenderer meshRenderer(const runtime::Device& device, const std::string& tile, const Material& material);

// Draws by parallax occlusion mapping in a shell (Hirche et al. 2004, "Hardware accelerated per-pixel
// displacement mapping"). Each period of the tile is a prism whose side and top faces are drawn. In each
// pixel a march goes, by steps of 1 / `steps` of the depth, from where the ray enters the prism to where it
// leaves, and ends with bisections. A ray that leaves through a side draws nothing.
TileRenderer shellRenderer(const runtime::Device& device, int steps, int bisections, const Material& material,
                           std::shared_ptr<const HeightMap> heights);

}  // namespace loden::bench
