// One triangle over the whole picture, behind everything, and the world directions through its corners.
#include "scene_shared.h"
#include "scene_interface.glsl"

layout(location = 0) out vec3 direction_ws;

void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 1.0, 1.0);
  vec4 far_ = inverse(scene.clip_from_world) * vec4(corner, 1.0, 1.0);
  direction_ws = far_.xyz / far_.w - scene.camera_exposure.xyz;
}
