// Shades a mesh with its Loden material.
#include "scene_shared.h"
#include "scene_interface.glsl"
#include "scene_lights.glsl"
#include "scene_surface.glsl"
#include "scene_displaced.glsl"

#ifdef SCENE_HEAT
#include "scene_heat.glsl"
vec2 heat_hit;  // of the last evaluation: lambda, and the near term's weight
#endif

layout(location = 0) out vec4 color;

#ifdef SCENE_PARALLAX_DEPTH
int missed_taps = 0;
#else
float sun_visible = -1.0;  // all taps lie at one point: asked for once
#endif

float sunVisibility(vec3 position, vec3 normal) {
#ifdef SCENE_PARALLAX_DEPTH
  return sceneSunVisibility(position, normal);
#else
  if (sun_visible < 0.0) sun_visible = sceneSunVisibility(position, normal);
  return sun_visible;
#endif
}

// Radiance towards the viewer from the surface at tile coordinate x, all lights together. Where depth is
// written, taps whose ray meets nothing are left out, and the last that meets something gives the depth, as
// in the pre-pass.
vec3 shade(vec2 x, vec2 dx, vec2 dy, SurfaceShape shape, mat3 frame, vec3 wo_ws, vec3 wo) {
  SurfacePoint point = surfacePoint(x, dx, dy, shape, wo);
  float z = 0.0;
  vec3 position = position_ws;
#ifdef SCENE_PARALLAX_DEPTH
  if (surfaceMissed(point)) {
    ++missed_taps;
    return vec3(0.0);
  }
  z = surfaceDepth(point);
  position = displacedPosition(wo_ws, wo, z);
  gl_FragDepth = depthOf(position);
#endif
#ifdef SCENE_HEAT
  heat_hit = vec2(point.hit.lambda, point.hit.near_weight);
#endif
  vec3 radiance = vec3(0.0);
  if ((scene.flags.x & SCENE_SUN) != 0) {
    vec3 wi = scene.sun_direction.xyz * frame;
    if (wi.z > 0.0) {
      // Asked for where the ray to the sun leaves the tile: what happens below the reference plane is part of
      // the material's own values.
      vec3 exit_ = position - scene.sun_direction.xyz * (z / max(wi.z, 0.1));
      float visible = sunVisibility(exit_, frame[2]);
      if (visible > 0.0) radiance += scene.sun_irradiance.rgb * visible * surfaceRadiance(point, wi, wo);
    }
  }
  for (int k = 0; k < object.flags.y; ++k) {
    vec3 irradiance;
    vec3 wi = sceneLight(object.lights[k >> 2][k & 3], position, irradiance) * frame;
    if (wi.z > 0.0 && irradiance.r + irradiance.g + irradiance.b > 1e-4)
      radiance += irradiance * surfaceRadiance(point, wi, wo);
  }
  for (int k = 0; k < scene.flags.y; ++k) {
    vec3 wi = scene.environment_suns[2 * k].xyz * frame;
    if (wi.z <= 0.0) continue;
    float visible = 1.0;
    if (k == 0 && (scene.flags.x & SCENE_ENVIRONMENT_SHADOW) != 0)
      visible = sunVisibility(position - scene.sun_direction.xyz * (z / max(wi.z, 0.1)), frame[2]);
    if (visible > 0.0)
      radiance += visible * scene.environment_suns[2 * k + 1].rgb * surfaceRadiance(point, wi, wo);
  }
  // A loop, so that renderers which run both sides of every branch skip it too.
  for (int k = 0; k < scene.flags.z; ++k) radiance += surfaceEnvironment(point, frame, wo);
  return radiance;
}

void main() {
  vec2 dx = dFdx(tile_x), dy = dFdy(tile_x);
  mat3 frame = tangentFrame();
  SurfaceShape shape = surfaceShape(frame);
  vec3 wo_ws = normalize(scene.camera_exposure.xyz - position_ws);
  vec3 wo = viewInFrame(frame, wo_ws);
  vec2 step_;
  int taps = surfaceTaps(dx, dy, step_), tap = 0;
  vec3 sum = vec3(0.0);
  do {
    sum += shade(tapX(tap, taps, step_), dx, dy, shape, frame, wo_ws, wo);
  } while (++tap < taps);
#ifdef SCENE_PARALLAX_DEPTH
  if (missed_taps == taps) discard;
  taps -= missed_taps;
#endif
  color = vec4(sceneTone(object.emissive.rgb + sum / float(taps)), 1.0);
#ifdef SCENE_HEAT
  // The radiance keeps compilers from leaving out what it takes to find it.
  color.rgb = heat(heat_hit.x, heat_hit.y, log2(loden_material.side), loden_fetches) + 1e-7 * color.rgb;
#endif
}
