// A tile, which is one period of meso-geometry: a triangle mesh that repeats in x and y.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "importer/tile/tile_texture.h"
#include "material/base/result.h"

namespace loden::importer {

class RepairLog;  // importer/base/repair_log.h

// The local reflectance of the tile's own surface: f_r = (diffuse + specular * (N.H)^exponent) / pi. In white
// units (white Lambert lit from above = 1) the value is (diffuse + specular (N.H)^exponent) * max(N.L, 0).
// With alpha > 0 a GGX lobe is added, and the diffuse term is reduced by what the lobe takes
// (importer/tile/ggx.h).
struct LocalBrdf {
  glm::vec3 diffuse{0.5f};  // linear RGB albedo
  float specular = 0;       // unitless, already times the lobe's normalisation
  float exponent = 32;
  glm::vec3 f0{0};  // reflectance of the GGX lobe seen along the normal, linear RGB
  // Roughness of the GGX lobe, the square of glTF's perceptual roughness; 0: no GGX lobe.
  float alpha = 0;
};

// A tile. Positions are tile coordinates (material/model/geometry_image.h): x and y have period 1, whatever
// the period's aspect, and z is in tile lengths. The mesh covers one period: vertex positions may be outside
// of [0,1)^2, and the whole plane is covered by adding (i, j, 0). z = 0 is the top of the tile (finishTile
// moves it there), and all z <= 0. params are unwrapped: P(p + n) = P(p) + (n, 0), so that a triangle never
// spans a wrap.
struct Tile {
  std::string name;
  double aspect = 1;  // the period's length in y divided by that in x
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;  // per vertex: unit shading normals, in lengths
  std::vector<glm::dvec2> params;   // per vertex
  std::vector<LocalBrdf> brdfs;     // per vertex, interpolated linearly
  // Materials of textured surfaces: at a point their textures replace its interpolated brdf.
  std::vector<TileMaterial> materials;
  std::vector<TexturePoint> texture_points;  // per vertex; empty if nothing is textured
  std::vector<glm::uvec3> triangles;
  std::vector<uint16_t> charts;            // per triangle, from 1; one chart if the surface is connected
  bool identity_parameterization = false;  // P.xy == p everywhere
  std::vector<Issue> warnings;             // parts of the file that a bake does not show, and repairs

  // Tile coordinates per tile length, along each axis.
  glm::dvec3 perLength() const;
};

// The largest ratio of the sides of a period; larger ones are refused.
inline constexpr double kMostAspect = 8;

struct TileOptions {
  int subdivide = 0;  // levels of subdivision by OpenSubdiv, for a cage
  // The period in x and y of a file's mesh whose borders do not show it, in the file's units; 0: they do.
  glm::dvec2 mesh_period{0};
  // If set, a plane is put under a file's mesh, this far below its lowest point, in the file's units.
  std::optional<double> ground{};
  // If set, vertices of a file with values that are not finite are repaired from their neighbours and
  // recorded here; otherwise they are an error.
  std::shared_ptr<RepairLog> repairs{};
};

// The tile that TILE of the command line names: one of builtinTileList(), or a .gltf, .glb or .obj file of
// one period, whose TEXCOORD_0 is the parameterization. A connected tile without one gets one
// (importer/mesh/parameterize.h). The tile is in tile coordinates, with its top at z = 0.
Result<Tile> loadTile(const std::string& name_or_path, const TileOptions& options = {});

// A builtin tile: procedural analogues of those in FBTF figure 1 (button, isba, pulli, sponge), and tiles for
// other cases (importer/tile/tile_parts.h). `resolution`: cells per side of a period.
Result<Tile> builtinTile(const std::string& name, int resolution = 192);
const std::vector<std::string>& builtinTileNames();
const std::string& builtinTileList();  // for messages and help, such as "builtin:button|isba|..."

}  // namespace loden::importer
