// The tile's surface over its own parameter domain: position per texel of p (Gu et al. 2002), and a ray
// tracer over it. The bilinear patches between texel centres are the surface that the runtime sees.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include "material/model/texture.h"

namespace loden {

// A period may be a rectangle, `aspect` times as long in y as in x. Tile coordinates have period 1 in both
// all the same, and z in tile lengths: the length of a tile is the square root of its period's area. These
// are the tile coordinates to a tile length along x and y; both are 1 where the period is square. So a length
// in the plane, and a slope against z, becomes one of tile coordinates by multiplication, and a normal one of
// lengths.
inline glm::dvec2 periodsPerLength(double aspect) {
  const double root = std::sqrt(aspect);
  return {root, 1 / root};
}

// Tile coordinates: the tile repeats with period 1 in x and y, the reference plane is z = 0 at the tile's
// top, and all of the tile lies in [z_min, 0]. P(p + n) = P(p) + (n, 0) for integer n.
struct GeometryImage {
  // side x side x 1, RGBA16 unorm; texel (i, j) stands for p = ((i + .5), (j + .5)) / side.
  // rgb = (P.xy - p, P.z) as (code - .5) * range.xy for xy and (code - 1) * range.z for z;
  // a = chart / 65535, 0 where no surface is: there rgb only leads searches back to a chart. Patches exist
  // only where all four corners share a chart.
  Texture texels;
  glm::vec3 range{1, 1, 1};  // tile periods; range.z = -z_min
  // True if P.xy == p everywhere: the tile is a height field parameterized by its own x and y.
  bool identity_parameterization = false;
  float aspect = 1;  // Material::aspect

  int side() const { return texels.width; }
  bool empty() const { return texels.empty(); }
  double zMin() const { return -double(range.z); }
};

// Encodes positions (P, tile periods, P.xy near p) with charts (0 = none) of a side x side image,
// row-major; picks the range, from charts != 0; other positions are clamped to it. z must be <= 0.
GeometryImage encodeGeometryImage(int side, std::span<const glm::dvec3> positions,
                                  std::span<const uint16_t> charts, bool identity_parameterization);

// The four corners of a bilinear patch, P + shift applied, and its chart (0 if the patch is no surface).
template <class T>
struct Patch {
  glm::vec<3, T> p00, p10, p01, p11;
  uint32_t chart = 0;
};
// The index of 0 .. n - 1 that i stands for in a row that repeats.
inline int wrapIndex(int i, int n) {
  const int r = i % n;
  return r < 0 ? r + n : r;
}

// Patch (i, j) spans the texel centres (i, j) .. (i + 1, j + 1); indices of any sign wrap, and positions
// are returned unwrapped for the p that the indices name.
template <class T>
Patch<T> fetchPatch(const GeometryImage& image, int i, int j);

// Position in tile coordinates and unit normal of lengths (facing up where it can) at p. Chart 0 if p lies on
// no patch; then they are those between the texels around it all the same, which lead to the charts beside.
template <class T>
struct SurfacePoint {
  glm::vec<3, T> position{0}, normal{0, 0, 1};
  uint32_t chart = 0;
};
template <class T>
SurfacePoint<T> surfaceAt(const GeometryImage& image, glm::vec<2, T> p);

// Where a ray first meets the periodic surface of the geometry image.
struct TraceHit {
  glm::dvec2 p{0};         // unwrapped parameter, of the copy that was hit
  glm::dvec3 position{0};  // tile periods, on the ray
  glm::dvec3 normal{0};    // unit, of lengths, geometric, towards the ray's origin
};

// The surface between the texels of a geometry image.
enum class Interpolation {
  kBilinear,  // what the runtime sees; each patch is two triangles
  kCubic,     // smooth, and nearer to the tile: .04 to .06 texels off where triangles are .10 to .11 (`loden
           // study vdim-interpolation`). 32 triangles a patch, 60 MB for 128 x 128 texels; 8 of images with
           // over 512 texels a side
};
inline constexpr int kMostCubicSide = 1024;  // texels; what larger images would take is out of proportion

// Exact first hits against the geometry image, periodic, by marching a grid of cells with height bounds.
// Places are tile coordinates, directions those of lengths. Thread safe after construction.
class GeometryTracer {
 public:
  // kCubic: image.side() <= kMostCubicSide.
  explicit GeometryTracer(const GeometryImage& image, Interpolation between = Interpolation::kBilinear);
  ~GeometryTracer();
  GeometryTracer(GeometryTracer&&) noexcept;
  GeometryTracer& operator=(GeometryTracer&&) noexcept;

  // The view ray through x on the reference plane: comes from wo (wo.z > 0), goes down.
  std::optional<TraceHit> traceView(glm::dvec2 x, const glm::dvec3& wo) const;
  // Any ray; false if nothing stands between origin and the plane z = 0 along direction (direction.z > 0).
  bool occluded(const glm::dvec3& origin, const glm::dvec3& direction) const;
  // The first hit of any ray from a point of the tile, in any direction, no further off than kReach.
  std::optional<TraceHit> trace(const glm::dvec3& origin, const glm::dvec3& direction) const;
  static constexpr double kReach = 16;  // tile lengths
  float aspect() const;                 // of the image

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loden
