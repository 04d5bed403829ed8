// Charts of a tile: pieces of its surface that lie apart in the parameter domain, and the gutters between
// them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "importer/tile/tile.h"
#include "material/model/geometry_image.h"

namespace loden::importer {

// Connected components of the parameterization, one per triangle, numbered from 1 by their first triangle.
// Triangles are connected where they share a parameter, counted modulo the period.
std::vector<uint16_t> findCharts(const Tile& tile);

// The same by shared vertices alone, for charts that still lie on one another.
std::vector<uint16_t> chartsByVertices(const Tile& tile);

// Whether params lie in [0,1]^2, no triangle turned over and no two over each other (to a 1024th of the
// domain).
bool isAtlas(std::span<const glm::dvec2> params, std::span<const glm::uvec3> triangles);

// Moves, turns and scales the charts (all by one factor; vertices must not be shared between charts) into
// disjoint rectangles of [0,1)^2, at least one gutter apart also across the period's border. Params in must
// have the charts' areas in the wanted proportion. Returns the gutter, in periods: 1/16 (2 texels of a map
// with 32 texels per side) or, where that would waste the domain on many small charts, less.
double packCharts(Tile& tile);

// Side of the largest square, in periods, that never overlaps two charts (texels, and what a linear filter
// reads, are squares), nor, where they lie along x or y, a chart and its own repetition; 1 if there is one
// chart that meets itself everywhere. Counted in cells of 1/256 that no triangle overlaps: less than two
// cells too little, and never too much of charts that are the nearest to the centre of some cell.
double gutterOf(const Tile& tile);

// Who a texel of a map over p belongs to: the chart that covers it, or in gutters the nearest one. labels:
// chart per texel of a side x side map, 0 where none; periodic. All 0 stay 0. Ties go to the lower label.
std::vector<uint16_t> chartOwners(int side, std::span<const uint16_t> labels);

// Owners of a side x side map over p, from the charts of a geometry image; empty if it has only one.
std::vector<uint16_t> chartOwners(int side, const GeometryImage& geometry);

// 2 x 2 owners of the halved map: the label that holds most of the four texels, the lowest of equals.
std::vector<uint16_t> halvedOwners(int side, std::span<const uint16_t> owners);

// Which of the four texels under texel (i, j) of a halved map count: those of its owner, as bits; all if
// owners are empty. The texels are (2 i, 2 j), (2 i + 1, 2 j), (2 i, 2 j + 1), (2 i + 1, 2 j + 1).
unsigned childrenOf(int side, std::span<const uint16_t> owners, std::span<const uint16_t> halved, int i,
                    int j);

}  // namespace loden::importer
