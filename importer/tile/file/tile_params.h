// Parameters for the mesh of a tile file; not installed.
#pragma once

#include <string>

#include "importer/tile/polygon_mesh.h"

namespace loden::importer {

// How a mesh came by its parameters.
enum class ParamOrigin {
  kLattice,  // one map that repeats with the surface, of the file or made
  kAtlas,    // the file's texture coordinates, several charts or one that does not repeat
  kCharts,   // made, each chart on its own and not yet packed
};

// The mesh in tile coordinates with parameters: the file's, where they repeat with the surface or are an
// atlas; else made (importer/mesh/parameterize.h for a surface in one closed piece, importer/mesh/segment.h
// for others, and wherever a ground is put under it). Refines a cage as the options say. Polygons may come
// back as triangles.
Result<ParamOrigin> giveParams(PolygonMesh& mesh, const TileOptions& options, const std::string& where);

std::vector<glm::uvec3> triangulate(const PolygonMesh& mesh);

}  // namespace loden::importer
