// The near term of the equation, V(P, wi) A(p; wi, wo) + C(p, wi): what is known of the surface. Mirrors
// material/eval/near_term.cpp name for name. Fetches: 2 per hit for A, shared by all lights; per light that
// the surface faces those of the lookup for V (LODEN_VISIBILITY_FAST or _DEFAULT), or with a shadow map of n
// quads (LODEN_VISIBILITY_MAP n) n, and n more per hit; 2 per hit for C (LODEN_INDIRECT), 2 for light from
// all around.

#ifdef LODEN_NEAR

const float LODEN_DIELECTRIC = 0.04;    // f0 of what is no metal (glTF 2.0, appendix B)
const float LODEN_LEAST_ALPHA = 0.002;  // of GGX
const float LODEN_LEAST_VIEW = 0.02;    // N.V that lobes are evaluated for
const float LODEN_MEAN_COSINE = 2.0 / 3.0;

// w(lambda).
float loden_near_weight(float lambda) {
#ifdef LODEN_BANDS
  return clamp((loden_material.near_end - lambda) * loden_material.near_slope, 0.0, 1.0);
#else
  return 1.0;
#endif
}

float loden_schlick(float cosine) {
  float x = max(1.0 - cosine, 0.0);
  return x * x * x * x * x;
}

// Share of light from direction w that a GGX lobe reflects, for f0 (Lazarov 2013; Karis 2014); cosine of w
// and the normal.
vec3 loden_lobe_albedo(float alpha, vec3 f0, float cosine) {
  float roughness = sqrt(alpha);
  vec4 r =
      vec4(1.0 - roughness, 0.0425 - 0.0275 * roughness, 1.04 - 0.572 * roughness, -0.04 + 0.022 * roughness);
  float a = min(r.x * r.x, exp2(-9.28 * max(cosine, 0.0))) * r.x + r.y;
  return clamp(f0 * (r.z - 1.04 * a) + (1.04 * a + r.w), 0.0, 1.0);
}

// Light from all around that a Phong lobe of strength 1 returns, white sky = 1: the integral over l of
// (N.H)^e N.L / pi, within .075 of the numerical one. Cosine of the view and the normal.
float loden_phong_albedo(float exponent, float cosine) {
  return 8.0 / (exponent + 8.0) * (2.2 + exponent * cosine * cosine) / (2.2 + exponent);
}

// Share of the diffuse light that the lobe leaves over (Kelemen and Szirmay-Kalos 2001).
float loden_ggx_coupling(LodenNear near, float cos_light, float cos_view) {
  vec3 f0 = vec3(max(max(near.f0.x, near.f0.y), near.f0.z));
  float light = 1.0 - loden_lobe_albedo(near.width, f0, cos_light).x;
  float view = 1.0 - loden_lobe_albedo(near.width, f0, cos_view).x;
  float mean = 1.0 - loden_lobe_albedo(near.width, f0, LODEN_MEAN_COSINE).x;
  return light * view / max(mean, 1e-3);
}

#ifdef LODEN_INDIRECT
// Share of diffuse light that the surface returns: of its diffuse part and, as if seen at the mean cosine, of
// its lobe.
vec3 loden_near_albedo(LodenNear near) {
  if ((loden_material.bits & LODEN_GGX) == 0)
    return near.diffuse + near.strength * loden_phong_albedo(near.width, LODEN_MEAN_COSINE);
  vec3 f0 = vec3(max(max(near.f0.x, near.f0.y), near.f0.z));
  float left = 1.0 - loden_lobe_albedo(near.width, f0, LODEN_MEAN_COSINE).x;
  return near.diffuse * left + loden_lobe_albedo(near.width, near.f0, LODEN_MEAN_COSINE);
}

// C(p, wi).
vec3 loden_indirect_light(LodenNear near, vec3 wi) {
  return near.indirect_color * max(wi.z * dot(near.indirect, vec4(1.0, wi.z, wi.xy)), 0.0);
}
#endif

LodenNear loden_near_point(vec2 p, float lambda) {
  LODEN_COUNT(LODEN_UNIT_NORMAL(LODEN_BANDS_OR_NONE), 1);
  LODEN_COUNT(LODEN_UNIT_COLOR(LODEN_BANDS_OR_NONE), 1);
  float lod = lambda - loden_material.surface_lambda;
  vec4 normal = textureLod(loden_normal, vec3(p, 0.0), lod);
  vec4 color = textureLod(loden_color, vec3(p, 0.0), lod);
  color.rgb *= color.rgb;
  LodenNear near;
  near.mapped = normal.xyz;
  near.normal = near.mapped / max(sqrt(dot(near.mapped, near.mapped)), 1e-4);
  float width = max(normal.w, 0.0);
  bool ggx = (loden_material.bits & LODEN_GGX) != 0;
  near.diffuse = ggx ? color.rgb * (1.0 - color.a) : color.rgb;
  near.f0 = mix(vec3(LODEN_DIELECTRIC), color.rgb, color.a);
  near.strength = color.a * loden_material.specular_scale;
  near.width = ggx ? max(width * width, LODEN_LEAST_ALPHA) : exp2(12.0 * width);
#ifdef LODEN_VISIBILITY_MAP
  float shadow_lod = lambda - loden_material.ambient_lambda;
  for (int quad = 0; quad < LODEN_VISIBILITY_MAP; ++quad) {
    LODEN_COUNT(LODEN_UNIT_SHADOW(LODEN_BANDS_OR_NONE), 1);
    near.shadow[quad] = textureLod(loden_shadow, vec3(p, float(quad)), shadow_lod);
  }
#endif
#ifdef LODEN_INDIRECT
  LODEN_COUNT(LODEN_UNIT_INDIRECT(LODEN_BANDS_OR_NONE), 2);
  float indirect_lod = lambda - loden_material.ambient_lambda;
  vec3 root = textureLod(loden_indirect, vec3(p, 0.0), indirect_lod).rgb;
  near.indirect_color = loden_near_albedo(near) * (root * root);
  near.indirect = textureLod(loden_indirect, vec3(p, 1.0), indirect_lod);
#endif
  return near;
}

// A(p; wi, wo).
vec3 loden_evaluate_near(LodenNear near, vec3 wi, vec3 wo) {
  float diffuse = max(dot(near.mapped, wi), 0.0);
  vec3 sum = wi + wo;
  vec3 half_ = sum / max(sqrt(dot(sum, sum)), 1e-6);
  float nl = max(dot(near.normal, wi), 0.0);
  float nh = clamp(dot(near.normal, half_), 0.0, 1.0);
  if ((loden_material.bits & LODEN_GGX) == 0)
    return near.diffuse * diffuse + near.strength * pow(max(nh, 1e-6), near.width) * nl;
  float nv = max(dot(near.normal, wo), LODEN_LEAST_VIEW);
  float a2 = near.width * near.width;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float masking = nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2);
  float shine = a2 / (d * d) * 0.5 / max(masking, 1e-6) * nl;
  vec3 fresnel = near.f0 + (1.0 - near.f0) * loden_schlick(dot(wi, half_));
  return near.diffuse * (diffuse * loden_ggx_coupling(near, nl, nv)) + fresnel * shine;
}

#ifdef LODEN_VISIBILITY_MAP
// V(p, wi) by the shadow map.
float loden_mapped_visibility(LodenNear near, vec3 wi) {
  float side = loden_material.shadow_side;
  vec2 at = (loden_square_from_direction(wi) * (side - 1.0) + 0.5) / side;
  float shadow = 0.0;
  for (int quad = 0; quad < LODEN_VISIBILITY_MAP; ++quad) {
    LODEN_COUNT(LODEN_UNIT_SHADOW_TABLE(LODEN_BANDS_OR_NONE), 1);
    shadow += dot(near.shadow[quad], textureLod(loden_shadow_table, vec3(at, float(quad)), 0.0));
  }
  return clamp(1.0 - shadow, 0.0, 1.0);
}
#endif

// V(P, wi) A(p; wi, wo) + C(p, wi).
vec3 loden_evaluate_near_term(LodenHit hit, vec3 wi, vec3 wo) {
  vec3 indirect = vec3(0.0);
#ifdef LODEN_INDIRECT
  indirect = loden_indirect_light(hit.near, wi);
#endif
  if (dot(hit.near.mapped, wi) <= 0.0) return indirect;
  float visibility = 1.0;
#if defined(LODEN_VISIBILITY)
  if (hit.relief && !hit.missed) visibility = loden_looked_up_visibility(hit, wi, LODEN_LIGHT_EFFORT);
#elif defined(LODEN_VISIBILITY_MAP)
  visibility = loden_mapped_visibility(hit.near, wi);
#endif
  if (visibility <= 0.0) return indirect;
  return visibility * loden_evaluate_near(hit.near, wi, wo) + indirect;
}
#endif  // LODEN_NEAR
