// Ground truth: pictures of a tile on a surface, by ray tracing the tile itself.
#pragma once

#include <optional>

#include "importer/base/picture.h"
#include "importer/tile/tile.h"
#include "material/model/analytic_surface.h"
#include "material/model/environment.h"

namespace loden::importer {

struct TraceOptions {
  SurfaceKind surface = SurfaceKind::kPlane;
  Camera camera;
  // Unit direction towards the light, world space; its perpendicular irradiance is pi (white Lambert = 1).
  // Empty: no such light.
  std::optional<glm::dvec3> light = glm::dvec3(0, 0, 1);
  // Light from all around, z up; 1 everywhere gives white Lambert the value 1. One random light of it is
  // taken per sample.
  std::optional<Panorama> environment;
  int width = 800, height = 600;
  int samples = 16;  // per pixel, stratified over its area
  int bounces = 0;   // 0: direct light and cast shadows
  int threads = 0;
  bool quiet = false;
};

// The picture: linear RGB averaged over each pixel's area, alpha = coverage, black background. On the plane
// the tile repeats without end and is seen through the 2 m patch. On cylinder and sphere every tile is bent
// with the surface: P = S(x, y) + z * kTilePeriod * N. The picture does not depend on the number of threads.
// Issues: kOption for a camera without a direction, or whose up vector lies along it.
Result<Picture> trace(const Tile& tile, const TraceOptions& options);

}  // namespace loden::importer
