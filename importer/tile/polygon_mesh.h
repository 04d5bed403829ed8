// Functions and data that the code that makes tiles shares. Not installed.
#pragma once

#include <filesystem>
#include <string>

#include "importer/tile/tile.h"

namespace loden::importer {

// The finished tile: its top is at z = 0, and degenerate and duplicate triangles are removed. Values that are
// not finite (with count and first index), indices out of range, and tiles without surface are refused.
// `where` names the tile in messages.
Result<Tile> finishTile(Tile tile, const std::string& where);

// A polygon mesh before it becomes a tile, as it is in a file and as subdivision refines it. There is one
// texture coordinate per vertex, since vertices are already split where texture coordinates differ.
struct PolygonMesh {
  double aspect = 1;  // aspect of the period; once it is known, positions are tile coordinates
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;      // of any length; 0 where the file has none; empty: to be computed
  std::vector<glm::dvec2> uvs;          // texture coordinates; empty: the file has none
  std::vector<LocalBrdf> brdfs;         // per vertex; vertices are split between materials as well
  std::vector<TileMaterial> materials;  // the materials that have textures
  std::vector<TexturePoint> texture_points;  // per vertex; empty if nothing is textured
  std::vector<int> face_sizes;               // corners per face
  // Per face of a repaired mesh: the number of the triangle in the file, after polygons are split into fans;
  // otherwise empty.
  std::vector<uint32_t> numbers;
  std::vector<uint32_t> corners;  // vertex of each corner, face by face
  std::vector<uint16_t> charts;   // per face, from 1, if giveParams has cut the surface; otherwise empty
  std::vector<int> lines;       // for text files the line of each vertex's position, from 1; otherwise empty
  std::vector<Issue> warnings;  // see Tile::warnings
};

Result<PolygonMesh> readGltfMesh(const std::filesystem::path& path);
Result<PolygonMesh> readObjMesh(const std::filesystem::path& path);

// The limit surface of a cage after `levels` of Catmull-Clark subdivision (Loop if all faces are triangles),
// by OpenSubdiv: limit positions and normals; uvs and reflectance refined smoothly, and texture
// coordinates refined smoothly between their seams. The cage is treated as periodic: its borders are joined
// one period further on, so that the limit surface has no seam.
Result<PolygonMesh> subdivideMesh(const PolygonMesh& cage, const glm::dvec2& period, int levels,
                                  const std::string& where);

}  // namespace loden::importer
