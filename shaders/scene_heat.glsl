// What a pixel costs or is made of, as a colour, in place of what it looks like.
#include "scene_interface.glsl"

// From dark blue by green and yellow to red, over 0 to 1; the heights of equal steps are told apart by hue
// and by lightness.
vec3 heatColor(float share) {
  const vec3 kStops[6] = vec3[6](vec3(0.02, 0.02, 0.12), vec3(0.02, 0.10, 0.55), vec3(0.0, 0.45, 0.45),
                                 vec3(0.12, 0.65, 0.05), vec3(0.95, 0.75, 0.02), vec3(0.85, 0.02, 0.02));
  float at = clamp(share, 0.0, 1.0) * 5.0;
  int stop = min(int(at), 4);
  return mix(kStops[stop], kStops[stop + 1], at - float(stop));
}

// `lambda` and the near term's weight of the last evaluation, texture instructions of all.
vec3 heat(float lambda, float near_weight, float coarsest, int fetches) {
  int kind = int(scene.lambda.z);
  if (kind == SCENE_HEAT_LAMBDA) return heatColor(lambda / 8.0);
  if (kind == SCENE_HEAT_FETCHES) return heatColor(float(fetches) / 100.0);
  float bands = (1.0 - near_weight) * clamp(coarsest + 1.0 - lambda, 0.0, 1.0);
  return vec3(near_weight, bands, 1.0 - near_weight - bands);  // near term, bands, mean alone
}
