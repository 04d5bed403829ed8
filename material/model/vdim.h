// View-dependent indirection: p = VDIM(x, wo), where the view ray through x first meets the tile
// (Hadim et al. 2009, eq. 1). Two representations:
//   PaperVdim   the published one: reference indirection, direction and distance per view (eqs. 2, 3; 3.5)
//   VdimAtlas   depths per (direction, texel) that seed a search on the packed geometry image; built from the
//               geometry image at load, at the size that a scene's budget allows
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string_view>

#include "material/base/for_each.h"
#include "material/base/result.h"
#include "material/model/directions.h"
#include "material/model/packed_geometry.h"
#include "material/model/texture.h"

namespace loden {

// Views beyond this are looked up at it, in the maps and in the search; radians.
inline constexpr double kThetaMax = 85.0 * kPi / 180.0;

// The published map (FBTF 3.5): latlong Z x A directions, theta_z = kThetaMax * z / (Z - 1), phi_a = 2 pi a /
// (A - 1) (the last column repeats the first, the pole row repeats one value). The paper's zeniths end at 90
// degrees, where displacements grow without bound; ours end at kThetaMax, which is kinder to it.
struct PaperVdim {
  int side = 0;  // reference texels per side
  int zeniths = 0, azimuths = 0;
  // side x side x 1, RG16 snorm: R - x in tile periods / range.x, the indirection along the normal.
  Texture reference;
  // (side * azimuths) x (side * zeniths) x 1, RGBA16 snorm: unit displacement direction delta (rg), distance
  // d / range.y (b), a unused; VDIM = R + d delta. Texel (i, j)'s directions are contiguous (FBTF fig. 7).
  Texture packed;
  glm::vec2 range{1, 1};  // tile periods
};

// Texels x directions of the atlas; bytes = texels^2 * directions^2 + volume + packed geometry. Few
// directions cost missed occluders, few texels long searches; which split is best depends on the tile, so an
// asset names its own (Material::atlas). By default one that is good for all of them, .41 MB with the rest.
struct VdimAtlasSize {
  int texels = 28;
  int directions = 20;
  friend bool operator==(VdimAtlasSize, VdimAtlasSize) = default;
};

// The atlas that the runtime shows first, until the full one is built: a tenth of it in bytes, a seventh in
// the time it takes to build. Its mean error is 1.5 to 2.7 times the full one's, .55 texels at most (`loden
// study vdim-interpolation`).
inline constexpr VdimAtlasSize kFirstVdimAtlas{16, 12};

// All that a lookup reads.
struct VdimAtlas {
  VdimAtlasSize size;
  PackedGeometry geometry;
  // texels x texels x directions^2 layers, R8 unorm: z of the first hit = (code - 1) * geometry.range.z.
  // Layer v * directions + u is the direction at square ((u + .5), (v + .5)) / directions (vdimDirection).
  Texture depth;
  // 38 x 38 x 11 volume over [0,1)^2 x [0, -range.z] (z slice 0 is the top), RG8 unorm: p - X.xy, wrapped
  // into [-.5, .5], plus 128 / 255, of the surface point nearest to the voxel's centre, but for undersides.
  // Empty on identity parameterizations.
  Texture volume;
  size_t bytes() const { return geometry.texels.data.size() + depth.data.size() + volume.data.size(); }
};
// VdimAtlas::bytes() of the atlas that would be built, from the image's description alone.
uint64_t vdimAtlasBytes(const GeometryImage& image, VdimAtlasSize size);
// Of its depths alone.
uint64_t vdimDepthBytes(VdimAtlasSize size);
// What the runtime holds once it has built an atlas: the first one, where that is smaller, stays beside it.
uint64_t residentAtlasBytes(const GeometryImage& image, VdimAtlasSize size);

// Square of the concentric grid <-> view direction. The radius is atanh(sin theta) / atanh(sin kThetaMax),
// dense towards grazing; directions beyond kThetaMax land on the rim.
template <class T>
glm::vec<2, T> vdimSquareFromView(const glm::vec<3, T>& wo);
glm::dvec3 vdimViewFromSquare(glm::dvec2 square);

// Bounds on what building an atlas costs, in visits of a patch that covers no sample, and in surface patches
// per column of the search for the nearest one. A torn image could need hours.
inline constexpr uint64_t kMaxVdimWork = uint64_t{1} << 32;
inline constexpr uint64_t kMaxVdimColumn = uint64_t{1} << 18;
// Whether an atlas of that size may be built from the image; what it costs is estimated in one pass over the
// patches. Issues: kAtlasWork, kAtlasColumn.
Status checkVdimWork(const GeometryImage& image, VdimAtlasSize size);

// The atlas of an image, which if it comes from elsewhere must have passed checkVdimWork. A piece of work is
// one direction or one row of the volume; the result does not depend on their order, and is 0 where
// `for_each` left one out.
VdimAtlas buildVdimAtlas(const GeometryImage& image, VdimAtlasSize size, const ForEach& for_each = inOrder);
// VdimAtlas::depth alone.
Texture buildVdimDepth(const GeometryImage& image, VdimAtlasSize size, const ForEach& for_each = inOrder);

// How the reference surface bends at x, and how x lies on it (shaders/loden_types.glsl: LodenPoint).
// Lengths are tile lengths: the square root of the area that a tile takes on the surface.
template <class T>
struct LocalSurface {
  // A flat one with texture coordinates that stretch no tile of that aspect.
  static LocalSurface flat(float aspect) {
    const glm::vec<2, T> scale(periodsPerLength(double(aspect)));
    return {glm::mat<2, 2, T>(T(0)), glm::mat<2, 2, T>(scale.x, T(0), T(0), scale.y)};
  }

  glm::mat<2, 2, T> curvature{T(0)};  // tilt of the normal per tile length, symmetric, positive if convex
  glm::mat<2, 2, T> x_from_tangent{T(1)};  // tile periods per tile length along the tangent frame
};

// How p is found. The shaders have all but kQuality.
enum class Lookup : uint32_t {
  kNone,   // it is not: p = x
  kPaper,  // the published map, blended over directions, its reference unfiltered (FBTF 3.5); 2 fetches
  // By the atlas. In height fields over flat surfaces a march over the heights between the bounds that depths
  // of the nearest directions set; else a search from depths, at each of several points of a ray that bends
  // much.
  kFast,     // 1 direction; steps of some 2 texels, at most 20, or at most 24 visits of a patch
  kDefault,  // 3 directions; steps of some 1 texel, at most 40, or at most 48 visits
  kQuality,  // the exact first hit on the geometry image, for comparisons; no texture fetch
};
// Whether kFast and kDefault spend the same on an answer for a footprint that is so many tile periods wide,
// on a geometry image with geometry_side texels per side: over wide footprints both take few, long steps.
bool effortsAreOne(int geometry_side, double footprint);
inline constexpr Lookup kLookups[] = {Lookup::kNone, Lookup::kPaper, Lookup::kFast, Lookup::kDefault,
                                      Lookup::kQuality};
// "none", "paper", "fast", "default", "quality".
std::string_view lookupName(Lookup lookup);
std::optional<Lookup> lookupNamed(std::string_view name);

// What lookups read; each needs its own.
struct VdimMaps {
  const PaperVdim* paper = nullptr;        // kPaper
  const VdimAtlas* atlas = nullptr;        // kFast, kDefault
  const GeometryTracer* tracer = nullptr;  // kQuality
  bool serve(Lookup lookup) const;
  float aspect() const;  // of the tile
};

// What a lookup found. `fetches` counts texture instructions exactly as the shader issues them.
template <class T>
struct VdimHit {
  glm::vec<2, T> p{0};  // of any copy: whole periods mean nothing
  // Of all but kPaper, which knows p alone:
  glm::vec<3, T> position{0};  // tile periods, on the view ray; z below the reference surface
  glm::vec<2, T> offset{0};    // of position from x
  T height = 0;  // of it over the tangent plane at x, tile lengths; position.z where the surface is flat
  int fetches = 0;
  bool converged = false;  // the ray meets the surface there; else p is the best there was
  bool missed = false;     // the ray goes by a convex surface; p and position are near where it comes closest
};

// What the lookup finds from x, in tile periods, along wo, unit, wo.z > 0. `footprint` is how wide, in tile
// periods, what is read there is filtered, since a lookup need not be closer than that. Without the map that
// the lookup reads p is x. kQuality knows no curvature, kPaper nothing of the surface. The atlas's lookups
// and the published one run the shaders' own text (shaders/loden_vdim.glsl), in double whatever T is.
template <class T>
VdimHit<T> vdimLookup(const VdimMaps& maps, Lookup lookup, glm::vec<2, T> x, const glm::vec<3, T>& wo,
                      const LocalSurface<T>& surface, T footprint = T(0));
// On a flat surface without stretch.
template <class T>
VdimHit<T> vdimLookup(const VdimMaps& maps, Lookup lookup, glm::vec<2, T> x, const glm::vec<3, T>& wo);

// V(P, wi), the share of the light from wi that reaches the point P of the tile, by the lookup towards the
// light (shaders/loden_visibility.glsl). `position` is P, tile periods in the plane and tile lengths, <= 0,
// below the reference surface; p its parameter, `normal` the unit normal there; wi unit, in the frame where
// the view ray meets the tile. On height fields over a flat surface the mean over a footprint that is
// `footprint` tile periods wide, from how closely the ray passes the surface; elsewhere 0 or 1. The lookup is
// kFast or kDefault. Adds the texture instructions to *fetches, if it is not null.
template <class T>
T lookedUpVisibility(const VdimAtlas& atlas, Lookup lookup, const LocalSurface<T>& surface,
                     const glm::vec<3, T>& position, glm::vec<2, T> p, const glm::vec<3, T>& normal,
                     const glm::vec<3, T>& wi, T footprint, int* fetches = nullptr);

}  // namespace loden
