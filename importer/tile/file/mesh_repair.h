// Repairs faults that exporters leave in meshes, or refuses the mesh. Not installed.
#pragma once

#include <string>

#include "importer/tile/polygon_mesh.h"

namespace loden::importer {

// Turns the mesh into triangles, and
// - removes triangles without area and those that repeat an earlier one;
// - removes needles (triangles that are almost a line): their corners are merged, or the edge on which one of
//   them lies is split there;
// - closes T-junctions: an open edge on which vertices of other open edges lie is split at them.
// It moves nothing by more than 1e-5 of an edge, and adds a warning to the mesh. Issues: kTileGeometry for
// edges of more than two triangles and for neighbours that face opposite ways, with the triangle (its number
// in the file, with polygons split into fans) and its position.
Status repairMesh(PolygonMesh& mesh, const std::string& where);

}  // namespace loden::importer
