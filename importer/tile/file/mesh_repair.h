// Repairs what exporters leave in meshes, or refuses it; not installed.
#pragma once

#include <string>

#include "importer/tile/polygon_mesh.h"

namespace loden::importer {

// Turns the mesh into triangles, and
// - drops triangles without area and those that repeat an earlier one,
// - takes needles away: their corners are moved together, or the edge that one of them lies on is split
// there,
// - closes T-junctions: an open edge with vertices of other open edges on it is split at them.
// Moves nothing by more than 1e-5 of an edge, and leaves a warning with the mesh. Refuses edges of more than
// two triangles and neighbours that face opposite ways: kTileGeometry, with the triangle (its number in the
// file, polygons fanned) and its position.
Status repairMesh(PolygonMesh& mesh, const std::string& where);

}  // namespace loden::importer
