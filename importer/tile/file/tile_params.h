// Gives the mesh of a tile file its parameters. Not installed.
#pragma once

#include <string>

#include "importer/tile/polygon_mesh.h"

namespace loden::importer {

// Where the parameters of a mesh come from.
enum class ParamOrigin {
  kLattice,  // one map that repeats with the surface, from the file or computed
  kAtlas,    // the file's texture coordinates: several charts, or one that does not repeat
  kCharts,   // computed; each chart is separate and not yet packed
};

// Converts the mesh to tile coordinates and gives it parameters: the file's, if they repeat with the surface
// or are an atlas; otherwise computed ones (importer/mesh/parameterize.h for a surface in one closed piece,
// importer/mesh/segment.h for others, and whenever a ground is put under it). Refines a cage as the options
// say. Polygons may become triangles.
Result<ParamOrigin> giveParams(PolygonMesh& mesh, const TileOptions& options, const std::string& where);

std::vector<glm::uvec3> triangulate(const PolygonMesh& mesh);

}  // namespace loden::importer
