// Vertices of a mesh with a base material. gl_Position is invariant: the depth pre-pass computes the same.
#include "scene_interface.glsl"
#include "scene_shared.h"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tangent;
layout(location = 4) in vec4 uv_sets01;
layout(location = 5) in vec4 uv_sets23;
layout(location = 6) in vec4 color;

layout(location = 0) out vec3 position_ws;
layout(location = 1) out vec3 normal_ws;
layout(location = 2) out vec4 tangent_ws;
layout(location = 3) out vec4 uv01;
layout(location = 4) out vec4 uv23;
layout(location = 5) out vec4 vertex_color;

invariant gl_Position;

void main() {
  vec4 world = object.world_from_local * vec4(position, 1.0);
  gl_Position = scene.clip_from_world * world;
  position_ws = world.xyz;
  normal_ws = mat3(object.normal_from_local) * normal;
  tangent_ws = vec4(mat3(object.world_from_local) * tangent.xyz, tangent.w);
  uv01 = uv_sets01;
  uv23 = uv_sets23;
  vertex_color = color;
}
