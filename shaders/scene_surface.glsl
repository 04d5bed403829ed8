// How a surface answers to light: radiance = irradiance * surfaceRadiance. One of two.
#include "scene_interface.glsl"

// Screen-space derivatives of a mesh, in its tangent frame: of position (metres) and unit normal; and how far
// away it is (metres).
struct SurfaceShape {
  vec3 dp_dx, dp_dy, dn_dx, dn_dy;
  float away;
};

#if defined(LODEN_BANDS) || defined(LODEN_MODE_SURFACE)
#include "loden_material.glsl"

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
#ifdef SCENE_FOLLOW_SURFACE
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

#else
// The metallic-roughness model of glTF 2.0 (appendix B), by its factors.
struct SurfacePoint {
  vec3 diffuse, f0;
  float alpha;  // roughness squared
};

const float kPi = 3.14159265;

SurfacePoint surfacePoint(vec2 x, vec2 dx, vec2 dy, SurfaceShape shape, vec3 wo) {
  vec3 base = object.base_color_metallic.rgb;
  float metallic = object.base_color_metallic.a;
  float roughness = max(object.emissive_roughness.a, 0.05);
  return SurfacePoint(base * (1.0 - metallic), mix(vec3(0.04), base, metallic), roughness * roughness);
}

int surfaceTaps(vec2 dx, vec2 dy, out vec2 step_) {
  step_ = vec2(0.0);
  return 1;
}

float surfaceDepth(SurfacePoint point) {
  return 0.0;
}

bool surfaceMissed(SurfacePoint point) {
  return false;
}

vec3 surfaceRadiance(SurfacePoint point, vec3 wi, vec3 wo) {
  vec3 h = normalize(wi + wo);
  float nh = max(h.z, 0.0), a2 = point.alpha * point.alpha;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float distribution = a2 / (kPi * d * d);
  float visibility =
      0.5 /
      max(wi.z * sqrt(wo.z * wo.z * (1.0 - a2) + a2) + wo.z * sqrt(wi.z * wi.z * (1.0 - a2) + a2), 1e-5);
  vec3 fresnel = point.f0 + (1.0 - point.f0) * pow(1.0 - max(dot(wo, h), 0.0), 5.0);
  return ((1.0 - fresnel) * point.diffuse / kPi + fresnel * distribution * visibility) * wi.z;
}

// L(w) of one colour channel, its orders 1 and 2 scaled: 2/3 and 1/4 give the irradiance on w over pi
// (Ramamoorthi and Hanrahan 2001, eq. 8).
float environmentAt(int channel, vec3 w, float first, float second) {
  vec4 linear = scene.environment[3 * channel];
  vec3 d = scene.environment[3 * channel + 1].xyz, o = scene.environment[3 * channel + 2].xyz;
  float mean = (d.x + d.y + d.z) / 3.0;
  float quadratic = dot(d, w * w) + 2.0 * (o.x * w.x * w.y + o.y * w.x * w.z + o.z * w.y * w.z) - mean;
  return max(linear.w + mean + first * dot(linear.xyz, w) + second * quadratic, 0.0);
}

// Diffuse light from all around, and the mirror direction's, blurred as wide as the lobe.
vec3 surfaceEnvironment(SurfacePoint point, mat3 frame, vec3 wo) {
  vec3 n = frame[2], mirrored = reflect(-(frame * wo), n), radiance;
  float width = point.alpha * point.alpha;
  for (int c = 0; c < 3; ++c)
    radiance[c] = point.diffuse[c] * environmentAt(c, n, 2.0 / 3.0, 0.25) +
                  point.f0[c] * environmentAt(c, mirrored, exp(-width), exp(-3.0 * width));
  return radiance;
}
#endif
