// Depth of a mesh whose alpha mask cuts parts of it out.
#include "scene_base_material.glsl"
#include "scene_interface.glsl"
#include "scene_shared.h"

void main() {
  if (isMaskedOut(baseColor().a)) discard;
}
