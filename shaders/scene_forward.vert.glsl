// Vertices of a mesh, for shading. gl_Position is invariant: the depth pre-pass computes the same.
#include "scene_shared.h"
#include "scene_interface.glsl"
#ifdef SCENE_PARALLAX_DEPTH
#include "loden_shared.h"
#include "loden_interface.glsl"
#endif

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tangent;
layout(location = 3) in vec2 x;

layout(location = 0) out vec3 position_ws;
layout(location = 1) out vec3 normal_ws;
layout(location = 2) out vec4 tangent_ws;
layout(location = 3) out vec2 tile_x;

invariant gl_Position;

void main() {
  vec4 world = object.world_from_local * vec4(position, 1.0);
  normal_ws = mat3(object.normal_from_local) * normal;
#ifdef SCENE_PARALLAX_DEPTH
  // The reference surface of a shell lies above its mesh by the depth of the tile.
  if ((scene.flags.x & SCENE_SHELL) != 0) {
    float depth = loden_material.geometry_range.z * object.tile.x * float(loden_material.geometry_resident);
    world.xyz += normal_ws * (depth * inversesqrt(max(dot(normal_ws, normal_ws), 1e-20)));
  }
#endif
  gl_Position = scene.clip_from_world * world;
  position_ws = world.xyz;
  tangent_ws = vec4(mat3(object.world_from_local) * tangent.xyz, tangent.w);
  tile_x = x;
}
