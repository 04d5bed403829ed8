// Cuts a surface into charts and flattens each, for tiles of several pieces without texture coordinates.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "importer/mesh/periodic_mesh.h"
#include "material/base/result.h"

namespace loden::importer {

// A mesh cut into charts. Vertices are copied where charts meet, and moved by whole periods so that each
// chart is in one piece.
struct ChartedMesh {
  std::vector<uint32_t> source;       // per vertex: the vertex that it is a copy of
  std::vector<glm::dvec3> positions;  // per vertex
  // Per vertex; each chart has coordinates of its own, with the area of its surface.
  std::vector<glm::dvec2> params;
  std::vector<glm::uvec3> triangles;  // in the order of the input's
  std::vector<uint16_t> charts;       // per triangle, from 1
};

// The charted mesh of positions in tile coordinates of that aspect, with period 1 in x and y. Each connected
// component is one chart if it can be flattened without folds or overlaps and without much stretch (least
// squares conformal maps, Levy et al. 2002); otherwise it is cut into two halves, and each half is treated in
// the same way. Edges of more than two triangles, or of two that face opposite ways, are refused, with
// triangle and position in the message.
Result<ChartedMesh> segmentMesh(std::span<const glm::dvec3> positions, std::span<const glm::uvec3> triangles,
                                const MeshName& name, double aspect = 1);

// Whether the triangles of one chart lie flat with these params: none is turned over, and the border does not
// cross itself.
bool isFlat(std::span<const glm::dvec2> params, std::span<const glm::uvec3> triangles);

}  // namespace loden::importer
