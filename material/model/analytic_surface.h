// The three surfaces on which `loden trace` and `loden_walk --surface` show a tile, and their camera: pure
// mathematics, so that the ray tracer and the renderer draw exactly the same thing. Units: metres, z up.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string_view>

#include "material/base/result.h"

namespace loden {

enum class SurfaceKind { kPlane, kCylinder, kSphere };
std::optional<SurfaceKind> surfaceKindByName(std::string_view name);

// A patch of surface over (s, t) in [0,1]^2. Tile coordinate x = (s, t) * tiles.
//   plane     2 m x 2 m around the origin in z = 0, normal +z, s along +x, t along +y, 16 x 16 tiles
//   cylinder  axis +z through the origin, z in [-1, 1], radius 24 / (8 * 2 pi) m, 24 x 16 tiles, s around
//   sphere    the same radius, 24 x 12 tiles, s around, t from the south to the north pole
// so that one tile period is 1/8 m (on the sphere: at the equator). Tiles whose period is no square are as
// large: as many more in x as there are fewer in y, in whole numbers around and along curved surfaces.
struct AnalyticSurface {
  SurfaceKind kind = SurfaceKind::kPlane;
  glm::dvec2 tiles{16, 16};
  static constexpr double kTilePeriod = 0.125;  // metres: a tile length
};
// `aspect` of the tile (material/model/geometry_image.h).
AnalyticSurface analyticSurface(SurfaceKind kind, double aspect = 1);

struct SurfaceFrame {
  glm::dvec3 position, normal;    // metres; unit, outwards
  glm::dvec3 tangent, bitangent;  // unit, along s and t
};
SurfaceFrame surfaceFrame(const AnalyticSurface& surface, glm::dvec2 st);

// Pinhole; the picture's vertical field of view. JSON: {"position":[x,y,z],"target":[x,y,z],
// "up":[x,y,z],"fov_degrees":f}; "up" defaults to +z, fov to 40.
struct Camera {
  glm::dvec3 position{0, -1.2, 1.0}, target{0, 0, 0}, up{0, 0, 1};
  double fov_degrees = 40;
};
// Unit direction through pixel position (px, py), in pixels from the top left corner.
glm::dvec3 cameraRay(const Camera& camera, double px, double py, int width, int height);

}  // namespace loden
