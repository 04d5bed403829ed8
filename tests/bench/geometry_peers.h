// Peers that draw geometry for every period of the tile, where other renderers draw one plane: the tile's own
// surface, and prisms for parallax occlusion mapping in a shell.
#pragma once

#include <memory>
#include <string>

#include "tests/bench/peer_renderers.h"

namespace loden::bench {

// The tile's own surface as triangles, as engines draw micropolygons (Karis et al. 2021, "Nanite"): builtin
// tiles at the density whose cells, two triangles each, are as wide as a pixel (from 4 to 128 a period, by
// powers of two), others as the file has them. Each pixel's nearest triangle says which parameter it sees;
// the surface maps of `material` are read there, as by the marches. No multisampling.
// `tile`, of one chart, as importer::loadTile takes it.
TileRenderer meshRenderer(const runtime::Device& device, const std::string& tile, const Material& material);

// Parallax occlusion mapping in a shell (Hirche et al. 2004, "Hardware accelerated per-pixel displacement
// mapping"): a prism per period of the tile, whose side and top faces are drawn; each pixel marches by steps
// of 1 / `steps` of the depth from where its ray enters the prism to where it leaves, then bisects; a ray
// that leaves through a side draws nothing.
TileRenderer shellRenderer(const runtime::Device& device, int steps, int bisections, const Material& material,
                           std::shared_ptr<const HeightMap> heights);

}  // namespace loden::bench
