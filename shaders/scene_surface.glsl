// How a Loden material answers to light: radiance = irradiance * surfaceRadiance.
#include "loden_material.glsl"
#include "scene_interface.glsl"

// Screen-space derivatives of a mesh, in its tangent frame: of position (metres) and unit normal; and how far
// away it is (metres).
struct SurfaceShape {
  vec3 dp_dx, dp_dy, dn_dx, dn_dy;
  float away;
};

struct SurfacePoint {
  LodenPoint at;
  LodenHit hit;
};

#ifdef SCENE_PARALLAX_OCCLUSION
// What engines have in place of the lookup (Tatarchuk 2006): linear steps down the view ray until it is below
// the height field, then bisections between the last two. The heights have no mips. Until they are resident,
// x itself.
LodenHit occludedHit(LodenPoint m, vec2 x, float lambda, vec3 wo) {
  const int kSteps = 16, kBisections = 5;
  vec2 shift = loden_bounded_slope(wo) * loden_material.periods_per_length *
               (-loden_material.geometry_range.z * float(loden_material.geometry_resident));
  float above = 0.0, below = 1.0;
  int taken = 0;
  do {
    below = float(taken + 1) / float(kSteps);
    LODEN_COUNT(LODEN_UNIT_GEOMETRY, 1);
    if (1.0 - textureLod(loden_height, x + shift * below, 0.0).r <= below) break;
    above = below;
  } while (++taken < kSteps);
  LODEN_COUNT(LODEN_UNIT_GEOMETRY, kBisections);
  for (int i = 0; i < kBisections; ++i) {
    float middle = 0.5 * (above + below);
    if (1.0 - textureLod(loden_height, x + shift * middle, 0.0).r <= middle)
      below = middle;
    else
      above = middle;
  }
  return loden_hit_at_parameter(x, x + shift * below, min(max(m.lambda_min, lambda), LODEN_MOST_LAMBDA));
}
#endif

SurfacePoint surfacePoint(vec2 x, vec2 dx, vec2 dy, SurfaceShape shape, vec3 wo) {
  SurfacePoint point;
  point.at = loden_point_default();
  point.at.lambda_min = loden_material.resident_lambda;
  point.at.tile_length = object.tile.x;
  if ((scene.flags.x & SCENE_LAMBDA_DISTANCE) != 0)
    point.at.distance_ = shape.away * scene.lambda.y * loden_material.side / object.tile.x;
#ifdef LODEN_FOLLOW_SURFACE
  loden_follow_surface(point.at, dx, dy, shape.dp_dx, shape.dp_dy, shape.dn_dx, shape.dn_dy);
#endif
#ifdef SCENE_PARALLAX_DEPTH
  point.at.skip_parallax =
      false;  // seen from above a relief moves nothing sideways, but is deep all the same
#endif
#ifdef SCENE_PARALLAX_OCCLUSION
  float lambda = (scene.flags.x & SCENE_LAMBDA_OVERRIDE) != 0 ? scene.lambda.x
                 : point.at.distance_ > 0.0                   ? loden_lambda_from_distance(point.at.distance_)
                                                              : loden_lambda_from_footprint(dx, dy);
  point.hit = occludedHit(point.at, x, lambda, wo);
#else
  if ((scene.flags.x & SCENE_LAMBDA_OVERRIDE) != 0)
    point.hit = loden_find_hit_at(point.at, x, scene.lambda.x, wo);
  else
    point.hit = loden_find_hit(point.at, x, dx, dy, wo);
#endif
  return point;
}

// Evaluations that the footprint needs, and the step between them.
int surfaceTaps(vec2 dx, vec2 dy, out vec2 step_) {
  int taps = loden_footprint_taps(dx, dy, step_);
  return (scene.flags.x & SCENE_LAMBDA_DISTANCE) != 0 ? 1 : taps;  // the rule knows no direction
}

// Height of the hit over the tangent plane, metres, <= 0.
float surfaceDepth(SurfacePoint point) {
  return point.hit.depth * point.at.tile_length;
}

// True where the view ray leaves the tile again without meeting it.
bool surfaceMissed(SurfacePoint point) {
  return point.hit.missed;
}

// Per unit irradiance.
vec3 surfaceRadiance(SurfacePoint point, vec3 wi, vec3 wo) {
  return loden_evaluate(point.hit, wi, wo) * loden_material.value_scale;
}

// Radiance from the environment's light over the frame's hemisphere.
vec3 surfaceEnvironment(SurfacePoint point, mat3 frame, vec3 wo) {
  LodenHemisphere light = loden_hemisphere_light(scene.environment, loden_hit_frame(point.hit, frame));
  return loden_evaluate_environment(point.hit, light, wo) * (LODEN_PI * loden_material.value_scale);
}
