// Cuts a surface into charts and flattens each: for tiles of several pieces without texture coordinates.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "importer/mesh/periodic_mesh.h"
#include "material/base/result.h"

namespace loden::importer {

// Vertices are copied where charts meet, and moved by whole periods so that each chart is in one piece.
struct ChartedMesh {
  std::vector<uint32_t> source;       // per vertex: the vertex that it is a copy of
  std::vector<glm::dvec3> positions;  // per vertex
  std::vector<glm::dvec2> params;     // per vertex; each chart on its own, as large as its surface
  std::vector<glm::uvec3> triangles;  // of the same order as the input's
  std::vector<uint16_t> charts;       // per triangle, from 1
};

// Positions are tile coordinates of that aspect, with period 1 in x and y. Every connected component is a
// chart if it can be flattened without folds or overlaps and without much stretch (least squares conformal
// maps, Levy et al. 2002); else it is cut into two halves, and so on. Refuses, with triangle and position
// named, edges of more than two triangles or of two that face opposite ways.
Result<ChartedMesh> segmentMesh(std::span<const glm::dvec3> positions, std::span<const glm::uvec3> triangles,
                                const MeshName& name, double aspect = 1);

// Whether triangles with these params, one chart, lie the right way round and nowhere over each other: none
// is turned over, and the border does not cross itself.
bool isFlat(std::span<const glm::dvec2> params, std::span<const glm::uvec3> triangles);

}  // namespace loden::importer
