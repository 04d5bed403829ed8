// How a picture sees a plane of a tile: which point of the plane each place of the picture shows, and from
// where. Renderers and the traced truth of one benchmark share it.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "importer/tile/tile_tracer.h"

namespace loden::bench {

// The first is drawn with one light, all with four.
inline constexpr int kMostLights = 4;
extern const glm::dvec3 kPlaneLights[kMostLights];

struct PlaneView {
  int pixels = 192;     // per side of the picture
  int texels = 64;      // reference texels per side of the tile
  double aspect = 1;    // of the tile
  double lambda = 0;    // a pixel covers 2^lambda texels
  double degrees = 0;   // off the normal; pixels grow by the reciprocal cosine along x then
  double turn = 0;      // radians: the eye and its picture go round the normal through the picture's centre
  glm::dvec2 shift{0};  // tile periods that the eye has moved along the plane
};

// Tile periods per picture along each of its sides, as columns; and what its lower left corner shows.
glm::dmat2 periodsOf(const PlaneView& view);
glm::dvec2 cornerOf(const PlaneView& view);
// Point of the plane, tile periods, that the picture shows at uv in [0,1]^2, v upwards.
glm::dvec2 onPlane(const PlaneView& view, glm::dvec2 uv);

// Through a lens of a hundred degrees if seen from straight above, of a distant eye if not.
glm::dvec3 towardsEye(const PlaneView& view, glm::dvec2 uv);
inline constexpr double kSpread = 0.1;  // radians from side to side of a tilted picture

// The level of detail that shaders ask for: loden_lambda_from_footprint of this view's pixels.
double askedLambda(const PlaneView& view);

// Ray traced, samples x samples a pixel, the mean over the first `lights` lights. Rows from v = 0 up, as a
// render target is read.
std::vector<glm::vec3> tracedPicture(const importer::TileTracer& tracer, const PlaneView& view, int samples,
                                     int lights);

}  // namespace loden::bench
