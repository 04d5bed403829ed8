// What the makers of tiles share; not installed.
#pragma once

#include <filesystem>
#include <string>

#include "importer/tile/tile.h"

namespace loden::importer {

// The tile with its top at z = 0, without degenerate and duplicate triangles; refuses non-finite values (with
// count and first index), indices out of range, and tiles without surface. `where` names the tile in
// messages.
Result<Tile> finishTile(Tile tile, const std::string& where);

// A polygon mesh before it is a tile: what files hold and what subdivision refines. Uv 0 per vertex: vertices
// are already split where texture coordinates are.
struct PolygonMesh {
  double aspect = 1;  // of the period, once that is known; positions are tile coordinates then
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;      // of any length; 0 where the file has none; empty: to be computed
  std::vector<glm::dvec2> uvs;          // empty: none in the file
  std::vector<LocalBrdf> brdfs;         // per vertex; vertices are split between materials, too
  std::vector<TileMaterial> materials;  // those with textures
  std::vector<TexturePoint> texture_points;  // per vertex; empty if nothing is textured
  std::vector<int> face_sizes;               // corners per face
  std::vector<uint32_t>
      numbers;  // per face, of a repaired mesh: of the triangle in the file, polygons fanned; else empty
  std::vector<uint32_t> corners;  // vertex of each corner, face by face
  std::vector<uint16_t> charts;   // per face, from 1; where giveParams has cut the surface, else empty
  std::vector<int> lines;  // where the file is text: the line of each vertex's position, from 1; else empty
  std::vector<Issue> warnings;  // as the tile's
};

Result<PolygonMesh> readGltfMesh(const std::filesystem::path& path);
Result<PolygonMesh> readObjMesh(const std::filesystem::path& path);

// Limit surface of the cage after `levels` of Catmull-Clark (Loop if all faces are triangles) subdivision:
// limit positions and normals, uvs and reflectance refined smoothly, and so texture coordinates between their
// seams. The cage is taken as periodic: its borders are joined one period on, so that the limit surface has
// no seam. OpenSubdiv behind it.
Result<PolygonMesh> subdivideMesh(const PolygonMesh& cage, const glm::dvec2& period, int levels,
                                  const std::string& where);

}  // namespace loden::importer
