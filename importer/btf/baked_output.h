// The folder that a bake writes and the cooker reads; other tools can write it too. It holds images, and
// bake.json for everything else. All .exr images are OpenEXR, linear, in white units, written and read
// through OpenImageIO.
//
//   bake.json                what was baked, how, and from which input (hash); written last
//   btf/view_VVVV.exr        per view an atlas of the images of all lights: half RGB, columns =
//                            ceil(sqrt(lights)), light l in cell (l % columns, l / columns), cell of
//                            size x size; row 0 is y = 0
//   flat/view_VVVV.exr       per view an atlas like btf's, but over p: cell of flat_size x flat_size, holes
//                            and gutters filled
//   visible/view_VVVV.png    8 bit, flat_size x flat_size: share of the texel's surface that this view sees
//                            (0: undefined before filling)
//   vdim/latlong_ZxA.exr     float, 2 channels: per zenith z and azimuth a a cell (a, z) of size x size with
//                            p - x; views are laid out as in PaperVdim
//   vdim/concentric_N.exr    float, 1 channel: per view of the runtime's own grid of N x N directions
//                            (vdimViewFromSquare at cell centres) a cell of size x size with z of the first
//                            hit
//   surface/geometry.exr     float, geometry_size squared: X - p.x, Y - p.y, Z and chart over p. Charts
//   extend
//                            a texel beyond their borders. Chart 0 is no surface; there XYZ only continue
//                            those of the nearest chart
//   surface/normal.exr       mean of unit normals over p, surface_size squared
//   surface/diffuse.exr      RGB over p, surface_size squared
//   surface/specular.exr     strength and exponent of a Phong lobe over p, surface_size squared
//   surface/ggx.exr          RGBA: f0 and alpha of a GGX lobe, which is used instead of specular.exr; only
//                            for tiles that have such a lobe
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

// The revision of the bake code. It is raised when the same tile and options give other pixels than before.
inline constexpr int kBakeRevision = 6;

struct BakeManifest {
  int revision = kBakeRevision;
  std::string tile;        // name of the tile, as given to `loden bake`
  std::string input_hash;  // XXH3-128 of the tile's geometry, hex
  double aspect = 1;       // the tile's period in y divided by that in x
  double period = 0;       // the tile's period in x, metres; 0: not known
  int size = 64;           // reference texels per side
  int flat_size = 64;
  int surface_size = 128;  // texels per side of the surface maps
  int geometry_size = 128;
  int supersample = 2;
  int bounces = 0;
  FillMethod fill = FillMethod::kPushPull;
  TexelMethod texels = TexelMethod::kMean;
  DirectionSet directions;            // both lights and views
  std::vector<glm::ivec2> vdims;      // (zeniths, azimuths) of each stored lat-long map
  std::vector<int> concentric_vdims;  // directions per side of each stored depth map
  bool has_ggx = false;               // the tile's lobes are GGX
  bool has_btf = false, has_flat = false, has_vdim = false, has_surface = false;
  bool identity_parameterization = false;
  // The quality of the tile's parameterization: the number of triangles that are flipped in p, and the ratio
  // of surface area to parameter area relative to its mean (coefficient of variation, percentiles over p).
  int flipped_triangles = 0;
  double area_cv = 0, area_p5 = 1, area_p95 = 1;
};

// A finished baked output, read view by view, since one of 256 x 256 texels does not fit in memory at once.
class BakedOutput {
 public:
  // The baked output in a folder. Maps with values that are not finite are refused, and the message says how
  // many there are and where the first is; if there is a log, they are repaired and recorded in it
  // (importer/base/repair_log.h). The BTF's values are checked where they are used: by the fits, and by
  // bakedSource if there is a log.
  static Result<BakedOutput> open(const std::filesystem::path& folder,
                                  std::shared_ptr<RepairLog> repairs = nullptr);

  // The output of a bake that has not finished: its files may be missing.
  static BakedOutput unfinished(const std::filesystem::path& folder, BakeManifest manifest);

  const BakeManifest& manifest() const { return manifest_; }
  const std::filesystem::path& folder() const { return folder_; }
  const std::shared_ptr<RepairLog>& repairs() const { return repairs_; }

  // One view as stored: [light][texel] linear RGB; texel = j * size + i.
  Result<std::vector<glm::vec3>> btfView(int view) const;
  Result<std::vector<glm::vec3>> flatView(int view) const;
  // The share of each flat texel's surface that a view sees: [flat texel], 0..1.
  Result<std::vector<float>> visibleView(int view) const;
  // A VDIM: [zenith][azimuth][texel] p - x.
  Result<std::vector<glm::vec2>> vdim(int zeniths, int azimuths) const;
  // A depth map: [direction v][direction u][texel] z of the first hit, tile periods, <= 0.
  Result<std::vector<float>> concentricVdim(int directions) const;
  // The geometry image: [geometry texel] (X - p.x, Y - p.y, Z, chart).
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
