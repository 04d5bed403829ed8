// Vertices of a mesh, for depth only: the camera's pre-pass, and the sun's shadow map with the sun's
// transform in clip_from_world.
#include "scene_shared.h"
#include "scene_interface.glsl"

layout(location = 0) in vec3 position;

invariant gl_Position;

void main() {
  vec4 world = object.world_from_local * vec4(position, 1.0);
  gl_Position = scene.clip_from_world * world;
}
