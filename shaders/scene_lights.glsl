// Light arriving at a point: direction to the light, and irradiance perpendicular to it.
#include "scene_interface.glsl"

layout(binding = SCENE_UNIT_SHADOW) uniform sampler2DShadow scene_shadow;

// Share of the sun that reaches a point, over the shadow map's texels around it: 3 x 3, or 16 points of a
// disk (Vogel 1979) where borders are to be wider. The point is moved along the normal by what these can
// hide.
float sceneSunVisibility(vec3 position, vec3 normal) {
  if ((scene.flags.x & SCENE_SHADOWS) == 0) return 1.0;
  float slope = 1.0 - clamp(dot(normal, scene.sun_direction.xyz), 0.0, 1.0);
  float width = scene.sun_irradiance.w;
  vec3 moved = position + normal * scene.sun_direction.w * (1.0 + (2.0 + width) * slope);
  vec3 c = (scene.shadow_from_world * vec4(moved, 1.0)).xyz;
  vec2 texel = 1.0 / vec2(textureSize(scene_shadow, 0));
  float lit = 0.0;
  if (width <= 1.0) {
    for (int k = 0; k < 9; ++k)
      lit += texture(scene_shadow, vec3(c.xy + texel * (vec2(k % 3, k / 3) - 1.0), c.z));
    return lit / 9.0;
  }
  for (int k = 0; k < 16; ++k) {
    float angle = 2.399963 * float(k), radius = width * sqrt((float(k) + 0.5) / 16.0);
    lit += texture(scene_shadow, vec3(c.xy + texel * radius * vec2(cos(angle), sin(angle)), c.z));
  }
  return lit / 16.0;
}

// Unit direction to light `index`, and its irradiance; KHR_lights_punctual's falloff.
vec3 sceneLight(int index, vec3 position, out vec3 irradiance) {
  SceneLight light = scene.lights[index];
  vec3 to_light = light.position_range.xyz - position;
  float square = max(dot(to_light, to_light), 1e-6);
  vec3 direction = to_light * inversesqrt(square);
  float falloff = 1.0 / square;
  if (light.position_range.w > 0.0) {
    float ratio = square / (light.position_range.w * light.position_range.w);
    falloff *= clamp(1.0 - ratio * ratio, 0.0, 1.0);
  }
  if (light.intensity_kind.w > 0.0) {
    float cosine = dot(-direction, light.direction_outer.xyz);
    float inside = clamp(
        (cosine - light.direction_outer.w) / max(light.inner.x - light.direction_outer.w, 1e-4), 0.0, 1.0);
    falloff *= inside * inside;
  }
  irradiance = light.intensity_kind.rgb * falloff;
  return direction;
}

// The curve of glTF's viewers (Khronos PBR Neutral, 2024): colours stay as they are but for what a dielectric
// mirrors of a white room, up to 0.76; what is brighter is compressed towards 1, and loses colour slowly.
vec3 neutralTone(vec3 color) {
  const float kDark = 0.08, kMirrored = 0.04, kLinearEnd = 0.76, kFade = 0.15;
  float least = min(color.r, min(color.g, color.b));
  color -= least < kDark ? least - least * least / (4.0 * kMirrored) : kMirrored;
  float most = max(color.r, max(color.g, color.b));
  if (most <= kLinearEnd) return color;
  float room = 1.0 - kLinearEnd;
  float shown = 1.0 - room * room / (most - kLinearEnd + room);
  float kept = 1.0 / (1.0 + kFade * (most - shown));
  return mix(vec3(shown), color * (shown / most), kept);
}

// Exposure and tone curve: neutral, Narkowicz 2015's fit of the ACES curve, or none.
vec3 sceneTone(vec3 color) {
  color = max(color * scene.camera_exposure.w, 0.0);
  if ((scene.flags.x & SCENE_NEUTRAL) != 0) return neutralTone(color);
  if ((scene.flags.x & SCENE_FILMIC) == 0) return color;
  return clamp(color * (2.51 * color + 0.03) / (color * (2.43 * color + 0.59) + 0.14), 0.0, 1.0);
}
