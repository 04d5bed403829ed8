// The folder that a bake writes and the cooker reads (also what other tools can write): images, and bake.json
// for the rest. All images are OpenEXR written and read through OpenImageIO, linear, white units.
//
//   bake.json                  what, how, and from which input (hash); written last
//   btf/view_VVVV.exr          per view: an atlas of light images, half RGB, columns = ceil(sqrt(lights)),
//                              light l in cell (l % columns, l / columns); cell = size x size; row 0 is y = 0
//   flat/view_VVVV.exr         the same over p, cell = flat_size x flat_size, holes filled, gutters too
//   visible/view_VVVV.png      8 bit, flat_size x flat_size: share of the texel's surface that this view sees
//                              (0 = undefined before filling)
//   vdim/latlong_ZxA.exr       float, channels: per (zenith z, azimuth a) a cell of size x size with
//                              p - x (2 channels), cell (a, z); views as PaperVdim lays them out
//   vdim/concentric_N.exr      float, 1 channel: per view of the runtime's own grid of N x N directions
//                              (vdimViewFromSquare at cell centres) a cell of size x size with z of the first
//                              hit
//   surface/geometry.exr       float: X - p.x, Y - p.y, Z, chart over p, geometry_size squared; charts reach
//   a
//                              texel beyond their borders; chart 0 is no surface, there XYZ only continue the
//                              nearest
//   surface/normal.exr (mean of unit normals), diffuse.exr (RGB), specular.exr (strength, exponent of a Phong
//                              lobe): over p, surface_size squared
//   surface/ggx.exr            RGBA: f0 and alpha of a GGX lobe that takes specular.exr's place; of tiles
//   that
//                              have such a lobe
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "importer/btf/fill_method.h"
#include "material/base/result.h"
#include "material/model/directions.h"

namespace loden::importer {

class RepairLog;

// Raised when the same tile and options bake to other pixels than before.
inline constexpr int kBakeRevision = 5;

struct BakeManifest {
  int revision = kBakeRevision;
  std::string tile;        // as given to `loden bake`
  std::string input_hash;  // XXH3-128 of the tile's geometry, hex
  double aspect = 1;       // of the tile: its period in y to that in x
  double period = 0;       // of the tile in x, metres; 0: not known
  int size = 64;           // reference texels per side
  int flat_size = 64;
  int surface_size = 128;  // of the surface maps
  int geometry_size = 128;
  int supersample = 2;
  int bounces = 0;
  FillMethod fill = FillMethod::kPushPull;
  TexelMethod texels = TexelMethod::kMean;
  DirectionSet directions;            // lights and views alike
  std::vector<glm::ivec2> vdims;      // (zeniths, azimuths) of each stored latlong map
  std::vector<int> concentric_vdims;  // directions per side of each stored depth map
  bool has_ggx = false;               // the tile's lobes are GGX
  bool has_btf = false, has_flat = false, has_vdim = false, has_surface = false;
  bool identity_parameterization = false;
  // Of the tile's parameterization: triangles that lie the wrong way round in p, and surface area per
  // parameter area relative to its mean (coefficient of variation, percentiles over p).
  int flipped_triangles = 0;
  double area_cv = 0, area_p5 = 1, area_p95 = 1;
};

// A finished baked output, read view by view (a 256 x 256 one does not fit in memory at once).
class BakedOutput {
 public:
  // Maps with values that are not finite are refused, with count and first place; with a log they are
  // repaired and noted there (importer/base/repair_log.h). The BTF's values are looked at where they are
  // used: by the fits, and by bakedSource if there is a log.
  static Result<BakedOutput> open(const std::filesystem::path& folder,
                                  std::shared_ptr<RepairLog> repairs = nullptr);

  // Of a bake that has not finished: its files may be missing.
  static BakedOutput unfinished(const std::filesystem::path& folder, BakeManifest manifest);

  const BakeManifest& manifest() const { return manifest_; }
  const std::filesystem::path& folder() const { return folder_; }
  const std::shared_ptr<RepairLog>& repairs() const { return repairs_; }

  // [light][texel] linear RGB of one view; texel = j * size + i. As stored.
  Result<std::vector<glm::vec3>> btfView(int view) const;
  Result<std::vector<glm::vec3>> flatView(int view) const;
  // [flat texel], 0..1.
  Result<std::vector<float>> visibleView(int view) const;
  // [zenith][azimuth][texel] p - x.
  Result<std::vector<glm::vec2>> vdim(int zeniths, int azimuths) const;
  // [direction v][direction u][texel] z of the first hit, tile periods, <= 0.
  Result<std::vector<float>> concentricVdim(int directions) const;
  // [geometry texel] (X - p.x, Y - p.y, Z, chart).
  Result<std::vector<glm::vec4>> geometry() const;
  struct Surface {
    std::vector<glm::vec3> normal, diffuse;  // [surface texel]
    std::vector<glm::vec2> specular;         // strength, exponent
    std::vector<glm::vec4> ggx;              // f0, alpha; empty if the lobes are Phong
  };
  Result<Surface> surface() const;

 private:
  std::filesystem::path folder_;
  BakeManifest manifest_;
  std::shared_ptr<RepairLog> repairs_;
};

}  // namespace loden::importer
