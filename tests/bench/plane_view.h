// How a picture sees a plane of a tile: which point of the plane each place of the picture shows, and from
// which direction. Renderers and the traced truth of a benchmark share this.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "importer/tile/tile_tracer.h"

namespace loden::bench {

// Directions to the lights. Pictures with one light have the first of them, pictures with four have all.
inline constexpr int kMostLights = 4;
extern const glm::dvec3 kPlaneLights[kMostLights];

struct PlaneView {
  int pixels = 192;     // per side of the picture
  int texels = 64;      // reference texels per side of the tile
  double aspect = 1;    // of the tile
  double lambda = 0;    // a pixel covers 2^lambda texels
  double degrees = 0;   // angle of the view to the normal; pixels grow along x by the reciprocal cosine
  double turn = 0;      // angle by which eye and picture are turned about the plane's normal, radians
  glm::dvec2 shift{0};  // tile periods that the eye has moved along the plane
};

// The two sides of the picture on the plane, in tile periods, as columns.
glm::dmat2 periodsOf(const PlaneView& view);
// The point of the plane that the picture's lower left corner shows, in tile periods.
glm::dvec2 cornerOf(const PlaneView& view);
// Point of the plane, tile periods, that the picture shows at uv in [0,1]^2, v upwards.
glm::dvec2 onPlane(const PlaneView& view, glm::dvec2 uv);

// The unit direction to the eye at uv: with a field of view of a hundred degrees if the plane is seen from
// straight above, else of an eye so distant that directions spread by kSpread only.
glm::dvec3 towardsEye(const PlaneView& view, glm::dvec2 uv);
inline constexpr double kSpread = 0.1;  // radians between the sides of the picture

// The level of detail that shaders ask for: loden_lambda_from_footprint of this view's pixels.
double askedLambda(const PlaneView& view);

// The ray traced picture, with samples x samples rays a pixel, as the mean over the first `lights` lights.
// Rows go from v = 0 up, as those of a render target do when it is read.
std::vector<glm::vec3> tracedPicture(const importer::TileTracer& tracer, const PlaneView& view, int samples,
                                     int lights);

}  // namespace loden::bench
