// Shades a mesh with glTF's own material.
#include "scene_base_lighting.glsl"
#include "scene_base_material.glsl"
#include "scene_interface.glsl"
#include "scene_lights.glsl"
#include "scene_shared.h"

layout(location = 0) out vec4 color;

vec3 litRadiance(BaseSurface s, vec3 wo) {
  vec3 radiance = vec3(0.0);
  if ((scene.flags.x & SCENE_SUN) != 0) {
    vec3 geometric = normalize(normal_ws) * facing();
    float visible = sceneSunVisibility(position_ws, geometric);
    if (visible > 0.0)
      radiance += scene.sun_irradiance.rgb * visible * baseRadiance(s, scene.sun_direction.xyz, wo);
  }
  for (int k = 0; k < object.flags.y; ++k) {
    vec3 irradiance;
    vec3 wi = sceneLight(object.lights[k >> 2][k & 3], position_ws, irradiance);
    if (irradiance.r + irradiance.g + irradiance.b > 1e-4) radiance += irradiance * baseRadiance(s, wi, wo);
  }
  float sun_visible = 1.0;
  if ((scene.flags.x & SCENE_ENVIRONMENT_SHADOW) != 0)
    sun_visible = sceneSunVisibility(position_ws, normalize(normal_ws) * facing());
  // A reflection map has the suns in it.
  for (int k = 0; k < (scene.flags.w > 0 ? 0 : scene.flags.y); ++k)
    radiance += (k == 0 ? sun_visible : 1.0) * scene.environment_suns[2 * k + 1].rgb *
                baseRadiance(s, scene.environment_suns[2 * k].xyz, wo);
  vec3 around = vec3(0.0);
  for (int k = 0; k < scene.flags.z; ++k) around += baseEnvironment(s, wo);
  // ... of which a shadow takes the diffuse share away.
  if (scene.flags.w > 0 && sun_visible < 1.0)
    around = max(around - (1.0 - sun_visible) * scene.environment_suns[1].rgb * s.occlusion * s.diffuse /
                              kPi * max(dot(s.normal, scene.environment_suns[0].xyz), 0.0),
                 0.0);
  return radiance + around;
}

void main() {
  vec4 base = baseColor();
  if (isMaskedOut(base.a)) discard;
  float alpha = (base_material.flags.y & SCENE_ALPHA_BLEND) != 0 ? base.a : 1.0;
  if ((base_material.flags.y & SCENE_UNLIT) != 0) {
    color = vec4(base.rgb, alpha);
    return;
  }
  BaseSurface s = baseSurface(base.rgb);
  vec3 wo = normalize(scene.camera_exposure.xyz - position_ws);
  vec3 emitted = emittedLight();
  if ((base_material.flags.y & SCENE_CLEARCOAT) != 0)
    emitted *= 1.0 - s.coat * schlick(vec3(0.04), vec3(1.0), clamp(dot(s.coat_normal, wo), 0.0, 1.0)).r;
  color = vec4(sceneTone(emitted + litRadiance(s, wo)), alpha);
}
