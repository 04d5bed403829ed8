// Charts of a tile, which are pieces of its surface that are apart in the parameter domain, and the gutters
// between them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "importer/tile/tile.h"
#include "material/model/geometry_image.h"

namespace loden::importer {

// The chart of each triangle: connected components of the parameterization, numbered from 1 by their first
// triangle. Triangles are connected if they share a parameter, counted modulo the period.
std::vector<uint16_t> findCharts(const Tile& tile);

// The chart of each triangle, by shared vertices alone: for charts that still overlap in the parameter
// domain.
std::vector<uint16_t> chartsByVertices(const Tile& tile);

// Whether params are an atlas: they lie in [0,1]^2, no triangle is turned over, and no two overlap (to a
// 1024th of the domain).
bool isAtlas(std::span<const glm::dvec2> params, std::span<const glm::uvec3> triangles);

// Moves, turns and scales the charts (all by one factor; vertices must not be shared between charts) into
// disjoint rectangles of [0,1)^2, which are at least one gutter apart, also across the period's border. On
// input the params must have the charts' areas in the desired proportion. Returns the gutter, in periods:
// 1/16 (2 texels of a map with 32 texels per side), or less if that would waste the domain on many small
// charts.
double packCharts(Tile& tile);

// The side, in periods, of the largest square that never overlaps two charts, nor, where they extend along x
// or y, a chart and its own repetition. (Texels, and what a linear filter reads, are squares.) 1 if there is
// one chart that meets itself everywhere. It is counted in cells of 1/256 that no triangle overlaps, and is
// less than two cells too small. It is never too large, unless a chart is so small that it is the nearest one
// to no cell's centre.
double gutterOf(const Tile& tile);

// The chart that each texel of a map over p belongs to: the one that covers it, or in gutters the nearest
// one. `labels`: chart per texel of a side x side periodic map, 0 where there is none. If all are 0 they stay
// 0. Of equally near charts the lower label is taken.
std::vector<uint16_t> chartOwners(int side, std::span<const uint16_t> labels);

// The owners of a side x side map over p, from the charts of a geometry image; empty if it has only one.
std::vector<uint16_t> chartOwners(int side, const GeometryImage& geometry);

// The owners of the halved map: of each 2 x 2 texels the label that most of them have, and the lowest of
// equals.
std::vector<uint16_t> halvedOwners(int side, std::span<const uint16_t> owners);

// The texels, as bits, of the four under texel (i, j) of a halved map that have its owner; all four if owners
// are empty. The texels are (2 i, 2 j), (2 i + 1, 2 j), (2 i, 2 j + 1), (2 i + 1, 2 j + 1).
unsigned childrenOf(int side, std::span<const uint16_t> owners, std::span<const uint16_t> halved, int i,
                    int j);

}  // namespace loden::importer
