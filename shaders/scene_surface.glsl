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
  LodenMaterial material;
  LodenHit hit;
};

SurfacePoint surfacePoint(vec2 x, vec2 dx, vec2 dy, SurfaceShape shape, vec3 wo) {
  SurfacePoint point;
  point.material = loden_material_default();
  point.material.lambda_min = loden_material.resident_lambda;
  point.material.tile_length = object.tile.x;
  if ((scene.flags.x & SCENE_LAMBDA_DISTANCE) != 0)
    point.material.distance_ = shape.away * scene.lambda.y * loden_material.side / object.tile.x;
#ifdef LODEN_FOLLOW_SURFACE
  loden_follow_surface(point.material, dx, dy, shape.dp_dx, shape.dp_dy, shape.dn_dx, shape.dn_dy);
#endif
#ifdef SCENE_PARALLAX_DEPTH
  point.material.skip_parallax =
      false;  // seen from above a relief moves nothing sideways, but is deep all the same
#endif
  if ((scene.flags.x & SCENE_LAMBDA_OVERRIDE) != 0)
    point.hit = loden_find_hit_at(point.material, x, scene.lambda.x, wo);
  else
    point.hit = loden_find_hit(point.material, x, dx, dy, wo);
  return point;
}

// Evaluations that the footprint needs, and the step between them.
int surfaceTaps(vec2 dx, vec2 dy, out vec2 step_) {
  int taps = loden_footprint_taps(dx, dy, step_);
  return (scene.flags.x & SCENE_LAMBDA_DISTANCE) != 0 ? 1 : taps;  // the rule knows no direction
}

// Height of the hit over the tangent plane, metres, <= 0.
float surfaceDepth(SurfacePoint point) {
  return point.hit.depth * point.material.tile_length;
}

// True where the view ray leaves the tile again without meeting it.
bool surfaceMissed(SurfacePoint point) {
  return point.hit.missed;
}

// Per unit irradiance.
vec3 surfaceRadiance(SurfacePoint point, vec3 wi, vec3 wo) {
  return loden_evaluate(point.material, point.hit, wi, wo) * loden_material.value_scale;
}

// Radiance from the environment's light over the frame's hemisphere.
vec3 surfaceEnvironment(SurfacePoint point, mat3 frame, vec3 wo) {
  LodenHemisphere light = loden_hemisphere_light(scene.environment, loden_hit_frame(point.hit, frame));
  return loden_evaluate_environment(point.material, point.hit, light, wo) *
         (LODEN_PI * loden_material.value_scale);
}
