// The three analytic surfaces on which `loden trace` and `loden_walk --surface` show a tile, and their
// camera. They are pure mathematics, so that ray tracer and renderer draw exactly the same thing. Lengths are
// in metres; z is up.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string_view>

#include "material/base/result.h"

namespace loden {

enum class SurfaceKind { kPlane, kCylinder, kSphere };
std::optional<SurfaceKind> surfaceKindByName(std::string_view name);

// A surface over (s, t) in [0,1]^2, covered with tiles. The tile coordinate is x = (s, t) * tiles.
//   plane     2 m x 2 m around the origin in z = 0, normal +z, s along +x, t along +y, 16 x 16 tiles
//   cylinder  axis +z through the origin, z in [-1, 1], radius 24 / (8 * 2 pi) m, 24 x 16 tiles, s around
//   sphere    radius as the cylinder's, 24 x 12 tiles, s around, t from the south to the north pole
// One tile period is therefore 1/8 m (on the sphere: at the equator). A tile whose period is not square
// covers the same area: there are as many more in x as there are fewer in y, rounded to whole numbers around
// and along curved surfaces.
struct AnalyticSurface {
  SurfaceKind kind = SurfaceKind::kPlane;
  glm::dvec2 tiles{16, 16};
  // Metres; the tile length, which is the square root of the area of a period.
  static constexpr double kTilePeriod = 0.125;
};
// The surface of this kind; `aspect` is the tile's (material/model/geometry_image.h).
AnalyticSurface analyticSurface(SurfaceKind kind, double aspect = 1);

struct SurfaceFrame {
  glm::dvec3 position, normal;    // metres; unit, outwards
  glm::dvec3 tangent, bitangent;  // unit, along s and t
};
SurfaceFrame surfaceFrame(const AnalyticSurface& surface, glm::dvec2 st);

// A pinhole camera; fov_degrees is the vertical field of view. As JSON: {"position":[x,y,z],"target":[x,y,z],
// "up":[x,y,z],"fov_degrees":f}; "up" defaults to +z, "fov_degrees" to 40.
struct Camera {
  glm::dvec3 position{0, -1.2, 1.0}, target{0, 0, 0}, up{0, 0, 1};
  double fov_degrees = 40;
};
// The unit direction through the pixel position (px, py), in pixels from the top left corner.
glm::dvec3 cameraRay(const Camera& camera, double px, double py, int width, int height);

}  // namespace loden
