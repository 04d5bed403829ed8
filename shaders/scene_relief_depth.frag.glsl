// Depth of a relief: in the pre-pass as the camera meets it, in the shadow map as the sun's rays do.
#include "scene_shared.h"
#include "scene_interface.glsl"
#include "scene_surface.glsl"
#include "scene_displaced.glsl"

void main() {
  bool from_sun = (scene.flags.x & SCENE_SUN_VIEW) != 0;
  vec3 to_camera = scene.camera_exposure.xyz - position_ws;
  vec3 to_viewer = from_sun ? scene.sun_direction.xyz : normalize(to_camera);
  mat3 frame = tangentFrame();
  vec3 wo = viewInFrame(frame, to_viewer);
  vec2 dx = dFdx(tile_x), dy = dFdy(tile_x);
  SurfaceShape shape = surfaceShape(frame);
  SurfacePoint point;
  vec2 step_;
  int taps = surfaceTaps(dx, dy, step_), tap = taps;
  // The last tap that meets something, as in the shading pass.
  do {
    point = surfacePoint(tapX(--tap, taps, step_), dx, dy, shape, wo);
  } while (surfaceMissed(point) && tap > 0);
  if (surfaceMissed(point)) discard;
  // Pushed away: by a texel of the shadow map, as polygon offset does where depth is not written by hand; in
  // the pre-pass by what two programs may round apart.
  float away = from_sun ? scene.sun_direction.w : 1e-4 * length(to_camera);
  gl_FragDepth = depthOf(displacedPosition(to_viewer, wo, surfaceDepth(point)) - to_viewer * away);
}
