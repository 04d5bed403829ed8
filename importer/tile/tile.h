// One period of meso-geometry: a triangle mesh that repeats in x and y.
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

// Local reflectance of the tile's own surface: f_r = (diffuse + specular * (N.H)^exponent) / pi. In white
// units (white Lambert lit from above = 1) the value is (diffuse + specular (N.H)^exponent) * max(N.L, 0).
// With alpha > 0 a GGX lobe is added, and the diffuse term gives way to it (importer/tile/ggx.h).
struct LocalBrdf {
  glm::vec3 diffuse{0.5f};  // linear RGB albedo
  float specular = 0;       // unitless, already times the lobe's normalisation
  float exponent = 32;
  glm::vec3 f0{0};  // reflectance of the GGX lobe seen along the normal, linear RGB
  float alpha = 0;  // its roughness, squared perceptual roughness of glTF; 0: no such lobe
};

// Positions are tile coordinates (material/model/geometry_image.h): of period 1 in x and y, whatever the
// period's aspect, and z in tile lengths. The mesh covers one period: vertex positions may leave [0,1)^2, and
// the whole plane is covered by adding (i, j, 0). z = 0 is the top of the tile (finishTile sees to it), all
// z <= 0. params are unwrapped: P(p + n) = P(p) + (n, 0), so a triangle never spans a wrap.
struct Tile {
  std::string name;
  double aspect = 1;  // of the period: its length in y to that in x
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;  // unit shading normals, of lengths, per vertex
  std::vector<glm::dvec2> params;   // per vertex
  std::vector<LocalBrdf> brdfs;     // per vertex, interpolated linearly
  // Textured surfaces: what their pictures say at a point stands in for its interpolated brdf.
  std::vector<TileMaterial> materials;
  std::vector<TexturePoint> texture_points;  // per vertex; empty if nothing is textured
  std::vector<glm::uvec3> triangles;
  std::vector<uint16_t> charts;            // per triangle, 1-based; one chart if the surface is connected
  bool identity_parameterization = false;  // P.xy == p everywhere
  std::vector<Issue> warnings;             // what of the file a bake does not show, or was repaired

  // Tile coordinates to a tile length, along each axis.
  glm::dvec3 perLength() const;
};

// Sides of a period that are more unequal than this to one are refused.
inline constexpr double kMostAspect = 8;

struct TileOptions {
  int subdivide = 0;  // OpenSubdiv levels, for a cage
  // At which a file's mesh repeats in x and y, in the file's units, where its borders do not say so; 0: they
  // do.
  glm::dvec2 mesh_period{0};
  // Set: a plane goes under a file's mesh, so far below its lowest point, in the file's units.
  std::optional<double> ground{};
  // Set: vertices of a file with values that are not finite are repaired from their neighbours and noted
  // here; else an error.
  std::shared_ptr<RepairLog> repairs{};
};

// TILE of the command line: builtinTileList() or a .gltf/.glb/.obj file of one period whose TEXCOORD_0 is the
// parameterization; a connected tile without gets one (importer/mesh/parameterize.h). The tile comes back in
// tile coordinates with its top at z = 0.
Result<Tile> loadTile(const std::string& name_or_path, const TileOptions& options = {});

// Procedural analogues of FBTF figure 1 (button, isba, pulli, sponge), and tiles of what surfaces are made of
// besides (importer/tile/tile_parts.h); `resolution` cells per side of a period.
Result<Tile> builtinTile(const std::string& name, int resolution = 192);
const std::vector<std::string>& builtinTileNames();
const std::string& builtinTileList();  // for messages and help: "builtin:button|isba|..."

}  // namespace loden::importer
