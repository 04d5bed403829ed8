// Geometry image (Gu et al. 2002): the tile's surface as a texture of positions over the surface's parameters
// p, and a ray tracer for it. The runtime's surface consists of the bilinear patches between texel centres.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include "material/model/texture.h"

namespace loden {

// Tile coordinates per tile length, along x and y. A tile's period may be a rectangle, `aspect` times as long
// in y as in x. Tile coordinates have period 1 in x and in y nevertheless, and z is in tile lengths, where
// the tile length is the square root of the period's area. Both values are 1 for a square period.
// Multiplication by them turns a length in the plane, or a slope against z, into tile coordinates, and a
// normal in tile coordinates into one in lengths.
inline glm::dvec2 periodsPerLength(double aspect) {
  const double root = std::sqrt(aspect);
  return {root, 1 / root};
}

// A geometry image in tile coordinates: the tile repeats with period 1 in x and y, the reference plane is z =
// 0 at the tile's top, and the whole tile lies in [z_min, 0]. P(p + n) = P(p) + (n, 0) for integer n.
struct GeometryImage {
  // side x side x 1, RGBA16 unorm; texel (i, j) is the point p = ((i + .5), (j + .5)) / side.
  // rgb = (P.xy - p, P.z), coded as (code - .5) * range.xy for xy and (code - 1) * range.z for z.
  // a = chart / 65535, and 0 where there is no surface; there rgb only leads a search back to a chart. A
  // patch exists only if its four corners are in the same chart.
  Texture texels;
  glm::vec3 range{1, 1, 1};  // tile periods; range.z = -z_min
  // True if P.xy == p everywhere, which means that the tile is a height field whose parameters are its own x
  // and y.
  bool identity_parameterization = false;
  float aspect = 1;  // Material::aspect

  int side() const { return texels.width; }
  bool empty() const { return texels.empty(); }
  double zMin() const { return -double(range.z); }
};

// A geometry image that encodes row-major positions P (tile periods, P.xy near p) and charts (0 = none). The
// range is chosen from the positions with charts != 0; other positions are clamped to it. z must be <= 0.
GeometryImage encodeGeometryImage(int side, std::span<const glm::dvec3> positions,
                                  std::span<const uint16_t> charts, bool identity_parameterization);

// The four corners of a bilinear patch, P with the period's shift applied, and its chart (0 if there is no
// surface).
template <class T>
struct Patch {
  glm::vec<3, T> p00, p10, p01, p11;
  uint32_t chart = 0;
};
// The index in 0 .. n - 1 that i stands for in a row that repeats with period n.
inline int wrapIndex(int i, int n) {
  const int r = i % n;
  return r < 0 ? r + n : r;
}

// Patch (i, j), which spans the texel centres (i, j) .. (i + 1, j + 1). Indices of any sign wrap, and
// positions are returned unwrapped, at the p that the indices name.
template <class T>
Patch<T> fetchPatch(const GeometryImage& image, int i, int j);

// The surface at p: position in tile coordinates and unit normal in lengths (facing up where it can). If p
// lies on no patch, chart is 0, and position and normal are interpolated between the texels around p all the
// same, so that they lead to the charts next to it.
template <class T>
struct SurfacePoint {
  glm::vec<3, T> position{0}, normal{0, 0, 1};
  uint32_t chart = 0;
};
template <class T>
SurfacePoint<T> surfaceAt(const GeometryImage& image, glm::vec<2, T> p);

// The first intersection of a ray with the periodic surface of the geometry image.
struct TraceHit {
  glm::dvec2 p{0};         // unwrapped parameter of the copy of the tile that was hit
  glm::dvec3 position{0};  // tile periods, on the ray
  glm::dvec3 normal{0};    // geometric unit normal in lengths, towards the ray's origin
};

// How the surface is interpolated between the texels of a geometry image.
enum class Interpolation {
  kBilinear,  // as in the runtime; each patch is two triangles
  // Smooth and closer to the tile: .04 to .06 texels off where the triangles are .10 to .11 off (`loden study
  // vdim-interpolation`). 32 triangles per patch, 60 MB for 128 x 128 texels; 8 triangles for images of over
  // 512 texels per side.
  kCubic,
};
inline constexpr int kMostCubicSide = 1024;  // texels per side; larger images would take too much memory

// Finds exact first hits of rays on the periodic surface of a geometry image, by marching through a grid of
// cells with height bounds. Positions are in tile coordinates, directions in lengths. Thread safe after
// construction.
class GeometryTracer {
 public:
  // For Interpolation::kCubic, image.side() must be at most kMostCubicSide.
  explicit GeometryTracer(const GeometryImage& image, Interpolation between = Interpolation::kBilinear);
  ~GeometryTracer();
  GeometryTracer(GeometryTracer&&) noexcept;
  GeometryTracer& operator=(GeometryTracer&&) noexcept;

  // The first hit of the view ray through x on the reference plane: it comes from wo (wo.z > 0) and goes
  // down.
  std::optional<TraceHit> traceView(glm::dvec2 x, const glm::dvec3& wo) const;
  // Whether anything lies between origin and the plane z = 0 along direction (direction.z > 0).
  bool occluded(const glm::dvec3& origin, const glm::dvec3& direction) const;
  // The first hit of a ray from a point of the tile in any direction, at most kReach away.
  std::optional<TraceHit> trace(const glm::dvec3& origin, const glm::dvec3& direction) const;
  static constexpr double kReach = 16;  // tile lengths
  float aspect() const;                 // GeometryImage::aspect of the image

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loden
