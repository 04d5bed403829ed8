// Light on a base material: glTF 2.0's BRDF (appendix B) under a light from one direction and under light
// from all around.
#include "scene_base_material.glsl"

// The environment as a mirror of each roughness sees it: level 0 a perfect one, the last but one a wholly
// rough one; the last level as a white Lambert surface does.
layout(binding = SCENE_UNIT_REFLECTIONS) uniform samplerCube scene_reflections;
// Over the cosine to the viewer and the roughness: reflectance = f0 * r + f90 * g; b that of sheen; a the
// share of the normal in the middle of the lobe.
layout(binding = SCENE_UNIT_REFLECTANCE) uniform sampler2D scene_reflectance;

const float kPi = 3.14159265;

vec4 reflectanceAt(float cosine, float roughness) {
  vec2 size = vec2(textureSize(scene_reflectance, 0));
  vec2 at = (vec2(cosine, roughness) * (size - 1.0) + 0.5) / size;
  return textureLod(scene_reflectance, at, 0.0);
}

// Trowbridge-Reitz, and Smith's masking and shadowing over 4 nl nv.
float ggx(float nh, float nl, float nv, float roughness) {
  float alpha = roughness * roughness, a2 = alpha * alpha;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float masking = nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2);
  return a2 / (kPi * d * d) * 0.5 / max(masking, 1e-5);
}

// Estevez and Kulla 2017, with Neubelt and Pettineo's visibility, as KHR_materials_sheen has it.
float sheenLobe(float nh, float nl, float nv, float roughness) {
  float inverse = 1.0 / (roughness * roughness);
  float sine = sqrt(max(1.0 - nh * nh, 0.0));
  float distribution = (2.0 + inverse) * pow(sine, inverse) / (2.0 * kPi);
  return distribution / (4.0 * (nl + nv - nl * nv));
}

// Share of the light that sheen lets through to what lies below.
float belowSheen(BaseSurface s, float nv) {
  float most = max(s.sheen.r, max(s.sheen.g, s.sheen.b));
  return 1.0 - most * reflectanceAt(nv, s.sheen_roughness).b;
}

vec3 schlick(vec3 f0, vec3 f90, float cosine) {
  return f0 + (f90 - f0) * pow(clamp(1.0 - cosine, 0.0, 1.0), 5.0);
}

// Radiance towards wo per unit irradiance from wi; both world, unit.
vec3 baseRadiance(BaseSurface s, vec3 wi, vec3 wo) {
  vec3 h = normalize(wi + wo);
  float vh = clamp(dot(wo, h), 0.0, 1.0);
  float nl = dot(s.normal, wi), nv = clamp(dot(s.normal, wo), 1e-3, 1.0);
  vec3 sum = vec3(0.0);
  if (nl > 0.0) {
    float nh = clamp(dot(s.normal, h), 0.0, 1.0);
    vec3 fresnel = schlick(s.f0, s.f90, vh);
    float reflected = max(fresnel.r, max(fresnel.g, fresnel.b));
    sum = (1.0 - reflected) * s.diffuse / kPi + fresnel * ggx(nh, nl, nv, s.roughness);
    if ((base_material.flags.y & SCENE_SHEEN) != 0)
      sum = sum * min(belowSheen(s, nv), belowSheen(s, nl)) +
            s.sheen * sheenLobe(nh, nl, nv, s.sheen_roughness);
    sum *= nl;
  }
  if ((base_material.flags.y & SCENE_CLEARCOAT) != 0) {
    float coat_nl = max(dot(s.coat_normal, wi), 0.0), coat_nv = clamp(dot(s.coat_normal, wo), 1e-3, 1.0);
    float fresnel = s.coat * schlick(vec3(0.04), vec3(1.0), vh).r;
    float lobe = ggx(clamp(dot(s.coat_normal, h), 0.0, 1.0), coat_nl, coat_nv, s.coat_roughness) * coat_nl;
    sum = sum * (1.0 - s.coat * schlick(vec3(0.04), vec3(1.0), coat_nv).r) + fresnel * lobe;
  }
  return sum;
}

// L(w) of one colour channel, its orders 1 and 2 scaled: 2/3 and 1/4 give the irradiance on w over pi
// (Ramamoorthi and Hanrahan 2001, eq. 8).
float environmentAt(int channel, vec3 w, float first, float second) {
  vec4 linear = scene.base_environment[3 * channel];
  vec3 d = scene.base_environment[3 * channel + 1].xyz, o = scene.base_environment[3 * channel + 2].xyz;
  float mean = (d.x + d.y + d.z) / 3.0;
  float quadratic = dot(d, w * w) + 2.0 * (o.x * w.x * w.y + o.y * w.x * w.z + o.z * w.y * w.z) - mean;
  return max(linear.w + mean + first * dot(linear.xyz, w) + second * quadratic, 0.0);
}

vec3 environmentRgb(vec3 w, float first, float second) {
  return vec3(environmentAt(0, w, first, second), environmentAt(1, w, first, second),
              environmentAt(2, w, first, second));
}

// What a mirror of this roughness shows. Without a reflection map: the polynomial, blurred as wide as the
// lobe.
vec3 mirroredLight(vec3 normal, vec3 wo, float roughness, float normal_share) {
  vec3 mirrored = normalize(mix(reflect(-wo, normal), normal, normal_share));
  if (scene.flags.w > 0)
    return textureLod(scene_reflections, mirrored, pow(roughness, 2.0 / 3.0) * float(scene.flags.w - 1)).rgb;
  float width = roughness * roughness * roughness * roughness;
  return environmentRgb(mirrored, exp(-width), exp(-3.0 * width));
}

// Irradiance over pi.
vec3 diffuseLight(vec3 normal) {
  if (scene.flags.w > 0) return textureLod(scene_reflections, normal, float(scene.flags.w)).rgb;
  return environmentRgb(normal, 2.0 / 3.0, 0.25);
}

// Light from all around. The mirror's light and its reflectance are averaged apart (Karis 2013); what is
// reflected more than once between microfacets comes back as diffuse light (Fdez-Aguera 2019).
vec3 baseEnvironment(BaseSurface s, vec3 wo) {
  float nv = clamp(dot(s.normal, wo), 0.0, 1.0);
  vec4 table = reflectanceAt(nv, s.roughness);
  vec3 once = s.f0 * table.r + s.f90 * table.g;
  float lost = max(1.0 - table.r - table.g, 0.0);
  vec3 average = s.f0 + (s.f90 - s.f0) / 21.0;
  vec3 again = once * average * lost / (1.0 - average * lost);
  vec3 around = diffuseLight(s.normal);
  vec3 sum =
      once * mirroredLight(s.normal, wo, s.roughness, table.a) +
      (again + s.diffuse * (1.0 - max(once.r + again.r, max(once.g + again.g, once.b + again.b)))) * around;
  if ((base_material.flags.y & SCENE_SHEEN) != 0)
    sum = sum * belowSheen(s, nv) + s.sheen * reflectanceAt(nv, s.sheen_roughness).b * around;
  if ((base_material.flags.y & SCENE_CLEARCOAT) != 0) {
    float coat_nv = clamp(dot(s.coat_normal, wo), 0.0, 1.0);
    vec4 coat_table = reflectanceAt(coat_nv, s.coat_roughness);
    float reflected = s.coat * (0.04 * coat_table.r + coat_table.g);
    sum = sum * (1.0 - reflected) +
          reflected * mirroredLight(s.coat_normal, wo, s.coat_roughness, coat_table.a);
  }
  return sum * s.occlusion;
}
