// Shades a mesh: with its Loden material if the variant has one, else with the base material's factors.
#include "scene_shared.h"
#include "scene_interface.glsl"
#include "scene_lights.glsl"
#include "scene_surface.glsl"

layout(location = 0) in vec3 position_ws;
layout(location = 1) in vec3 normal_ws;
layout(location = 2) in vec4 tangent_ws;
layout(location = 3) in vec2 tile_x;

layout(location = 0) out vec4 color;
#ifdef SCENE_PARALLAX_DEPTH
layout(depth_greater) out float gl_FragDepth;  // the tile lies below its reference plane
#endif

// Tangent frame of the reference plane: columns along growing x.x, along growing x.y, and the normal, which
// faces the viewer. Left-handed where UVs are mirrored, so that the material is mirrored as a whole.
mat3 tangentFrame() {
  vec3 n = normalize(normal_ws);
  if (!gl_FrontFacing && (object.flags.x & SCENE_DOUBLE_SIDED) != 0) n = -n;
  vec3 px = dFdx(position_ws), py = dFdy(position_ws);
  vec2 xx = dFdx(tile_x), xy = dFdy(tile_x);
  vec3 t = tangent_ws.xyz;
  float sign_ = tangent_ws.w * float(object.flags.z) * (dot(n, normal_ws) < 0.0 ? -1.0 : 1.0);
  if (abs(tangent_ws.w) < 0.5) {
    // Inverse of the screen's Jacobian; its determinant and the surface's orientation give the sign.
    float det = xx.x * xy.y - xy.x * xx.y;
    t = (px * xy.y - py * xx.y) * (det < 0.0 ? -1.0 : 1.0);
    vec3 b = (py * xx.x - px * xy.x) * (det < 0.0 ? -1.0 : 1.0);
    sign_ = dot(cross(n, t), b) < 0.0 ? -1.0 : 1.0;
  }
  t -= n * dot(n, t);
  if (dot(t, t) < 1e-20) t = abs(n.y) < 0.9 ? cross(vec3(0.0, 1.0, 0.0), n) : vec3(1.0, 0.0, 0.0);
  t = normalize(t);
  return mat3(t, sign_ * cross(n, t), n);
}

// The direction in the tangent frame, kept above the horizon: interpolated normals may face away at silhouettes.
vec3 viewInFrame(mat3 frame, vec3 wo_ws) {
  vec3 wo = wo_ws * frame;
  wo.z = max(wo.z, 0.02);
  return normalize(wo);
}

// Where the view ray meets the tile, depth z (tile periods, <= 0) below the plane.
vec3 displacedPosition(vec3 wo_ws, vec3 wo, float z) {
#ifdef SCENE_PARALLAX_DEPTH
  vec3 position = position_ws + wo_ws * (z * object.tile.x / wo.z);
  vec4 clip = scene.clip_from_world * vec4(position, 1.0);
  gl_FragDepth = clamp(0.5 + 0.5 * clip.z / clip.w, 0.0, 1.0);
  return position;
#else
  return position_ws;
#endif
}

// Radiance towards the viewer from the surface at tile coordinate x, all lights together.
vec3 shade(vec2 x, vec2 dx, vec2 dy, mat3 frame, vec3 wo_ws, vec3 wo) {
  SurfacePoint point = surfacePoint(x, dx, dy, wo);
  vec3 position = displacedPosition(wo_ws, wo, surfaceDepth(point));
  vec3 radiance = vec3(0.0);
  if ((scene.flags.x & SCENE_SUN) != 0) {
    vec3 wi = scene.sun_direction.xyz * frame;
    if (wi.z > 0.0) {
      float visible = sceneSunVisibility(position, frame[2]);
      if (visible > 0.0) radiance += scene.sun_irradiance.rgb * visible * surfaceRadiance(point, wi, wo);
    }
  }
  for (int k = 0; k < object.flags.y; ++k) {
    vec3 irradiance;
    vec3 wi = sceneLight(object.lights[k >> 2][k & 3], position, irradiance) * frame;
    if (wi.z > 0.0 && irradiance.r + irradiance.g + irradiance.b > 1e-4)
      radiance += irradiance * surfaceRadiance(point, wi, wo);
  }
  for (int k = 0; k < scene.flags.z; ++k) {
    vec3 wi = scene.environment_suns[2 * k].xyz * frame;
    if (wi.z > 0.0) radiance += scene.environment_suns[2 * k + 1].rgb * surfaceRadiance(point, wi, wo);
  }
  // A loop, so that renderers which run both sides of every branch skip it too.
  for (int k = 0; k < scene.flags.w; ++k) radiance += surfaceEnvironment(point, frame, wo);
  return radiance;
}

void main() {
  vec2 dx = dFdx(tile_x), dy = dFdy(tile_x);
  mat3 frame = tangentFrame();
  vec3 wo_ws = normalize(scene.camera_exposure.xyz - position_ws);
  vec3 wo = viewInFrame(frame, wo_ws);
  vec2 step_;
  int taps = surfaceTaps(dx, dy, step_), tap = 0;
  vec3 sum = vec3(0.0);
  do {
    vec2 x = tile_x + (float(tap) - 0.5 * float(taps - 1)) * step_;
    sum += shade(x, dx, dy, frame, wo_ws, wo);
  } while (++tap < taps);
  color = vec4(sceneTone(object.emissive_roughness.rgb + sum / float(taps)), 1.0);
}
