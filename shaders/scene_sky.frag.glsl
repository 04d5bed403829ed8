// The environment behind the scene.
#include "scene_shared.h"
#include "scene_interface.glsl"
#include "scene_lights.glsl"

layout(binding = SCENE_UNIT_REFLECTIONS) uniform samplerCube scene_reflections;

layout(location = 0) in vec3 direction_ws;
layout(location = 0) out vec4 color;

void main() {
  color = vec4(sceneTone(textureLod(scene_reflections, normalize(direction_ws), scene.lambda.w).rgb), 1.0);
}
