// The sun's shadow map where it meets a relief: the sun's rays take the place of the viewer's.
#include "scene_shared.h"
#include "scene_interface.glsl"
#include "scene_surface.glsl"
#include "scene_displaced.glsl"

void main() {
  mat3 frame = tangentFrame();
  vec3 to_sun = scene.sun_direction.xyz, wo = viewInFrame(frame, to_sun);
  SurfacePoint point = surfacePoint(tile_x, dFdx(tile_x), dFdy(tile_x), surfaceShape(frame), wo);
  if (surfaceMissed(point)) discard;
  // Pushed away by a texel of the map, as polygon offset does where depth is not written by hand.
  gl_FragDepth = depthOf(displacedPosition(to_sun, wo, surfaceDepth(point)) - to_sun * scene.sun_direction.w);
}
