// Where a fragment of a mesh lies once its tile's relief counts: one rule for pre-pass, shadow map and
// shading pass.
#include "scene_interface.glsl"
#include "scene_surface.glsl"

layout(location = 0) in vec3 position_ws;
layout(location = 1) in vec3 normal_ws;
layout(location = 2) in vec4 tangent_ws;
layout(location = 3) in vec2 tile_x;

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

SurfaceShape surfaceShape(mat3 frame) {
  vec3 n = normalize(normal_ws);
  n = dot(frame[2], n) < 0.0 ? -n : n;  // double-sided surfaces, seen from behind
  return SurfaceShape(dFdx(position_ws) * frame, dFdy(position_ws) * frame, dFdx(n) * frame, dFdy(n) * frame,
                      distance(scene.camera_exposure.xyz, position_ws));
}

// The direction in the tangent frame, kept above the horizon: interpolated normals may face away at
// silhouettes.
vec3 viewInFrame(mat3 frame, vec3 wo_ws) {
  vec3 wo = wo_ws * frame;
  wo.z = max(wo.z, 0.02);
  return normalize(wo);
}

// Where the ray along wo_ws meets the tile, at height z (metres, <= 0) over the tangent plane.
vec3 displacedPosition(vec3 wo_ws, vec3 wo, float z) {
  return position_ws + wo_ws * (z / wo.z);
}

// Tile coordinate of one evaluation of several along a fragment's footprint (surfaceTaps).
vec2 tapX(int tap, int taps, vec2 step_) {
  return tile_x + (float(tap) - 0.5 * float(taps - 1)) * step_;
}

// Depth of a point in the frame's own view.
float depthOf(vec3 position) {
  vec4 clip = scene.clip_from_world * vec4(position, 1.0);
  return clamp(0.5 + 0.5 * clip.z / clip.w, 0.0, 1.0);
}
