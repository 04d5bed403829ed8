// Moves the texels of a geometry image so that its patches lie on the tile's surface. Not installed.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "importer/tile/tile.h"

namespace loden::importer {

// Texels that lie on a surface make patches that lie inside of it where it is convex, and cut its edges off.
// These instead are placed so that the patches between them are nearest to the surface at equal p, in least
// squares, but for a little weight on where they were.
//
// `displacements`: P - p, where (x, y) is only fitted if the parameterization is not the identity, of a side
// x side image's texels, row-major, z in [-`depth`, 0], which is kept. `charts`: of each texel, 0 where there
// is none; those stay.
void fitPatches(const Tile& tile, int side, double depth, std::span<const uint16_t> charts,
                std::span<glm::dvec3> displacements);

}  // namespace loden::importer
