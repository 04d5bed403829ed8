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
const float LODEN_BIAS = 4e-3, LODEN_BENT_BIAS = 6e-3;  // tile lengths
const float LODEN_SAME_SURFACE = 3.0;                   // texels of the geometry image

// w(lambda).
float loden_near_weight(float lambda) {
#ifdef LODEN_BANDS
  return clamp((loden_material.near_end - lambda) * loden_material.near_slope, 0.0, 1.0);
#else
  return 1.0;
#endif
}

vec2 loden_bounded_slope(vec3 w) {
  float cosine = max(w.z, LODEN_VDIM_COS);
  float sine = sqrt(w.x * w.x + w.y * w.y);
  float scale = min(1.0, LODEN_VDIM_SIN / max(sine, 1e-6));
  return w.xy * (scale / cosine);
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

#if defined(LODEN_VISIBILITY_FAST) || defined(LODEN_VISIBILITY_DEFAULT)
#define LODEN_VISIBILITY
#ifdef LODEN_VISIBILITY_FAST
#define LODEN_LIGHT_EFFORT LODEN_EFFORT_FAST
#else
#define LODEN_LIGHT_EFFORT LODEN_EFFORT_DEFAULT
#endif

#ifdef LODEN_HEIGHT_FIELD
// Over a flat reference surface: the share of a pixel's footprint from which the height field leaves the ray
// free, from how closely the ray from P passes it.
float loden_height_field_visibility(LodenMaterial m, LodenHit hit, vec3 wi, vec2 exit_, vec3 leaving) {
  LodenViewRay ray = loden_view_ray(m, exit_, leaving);
  float per_length = max(sqrt(dot(ray.slope, ray.slope)), 1e-6);
  float own = LODEN_SAME_SURFACE / loden_material.geometry_side;
  float lowest = hit.position.z + max(LODEN_BIAS, own / per_length);
  if (lowest >= 0.0) return 1.0;
  // A step along the surface towards the light takes the ray down by that much; the surface itself, which is
  // not sampled within `own`, shall not shade it.
  float facing = clamp(dot(hit.near.normal, wi) / max(hit.near.normal.z * wi.z, 1e-3), 0.0, 1.0);
  float footprint = exp2(hit.lambda) / loden_material.side;
  float half_ = max(min(0.5 * footprint, 0.9 * own) * facing / per_length, 1e-6);
  float rise = loden_height_field_rise(ray, lowest, half_, loden_effort_over(LODEN_LIGHT_EFFORT, hit.lambda));
  return clamp(0.5 - 0.5 * rise / half_, 0.0, 1.0);
}
#endif

// V(P, wi): 0 where the lookup along wi meets the tile before P.
float loden_looked_up_visibility(LodenHit hit, vec3 wi) {
  // What lies beyond is looked up at it, and has to turn with the surface as what is looked up.
  wi = loden_clamp_theta(wi, vec4(0.0, LODEN_VDIM_COS, LODEN_VDIM_SIN, 0.0));
  LodenMaterial m = loden_material_default();
  m.x_from_tangent = hit.x_from_tangent;
  vec2 slope = loden_bounded_slope(wi);
  float height = hit.position.z, rise = -height, bias = LODEN_BIAS;
  vec3 leaving = wi;
#ifdef LODEN_FOLLOW_SURFACE
  m.curvature = hit.curvature;
  vec2 turn = hit.curvature * slope;
  float bend = dot(slope, turn);
  // How far the ray rises until it leaves through the reference surface.
  rise = -2.0 * hit.position.z / (1.0 + sqrt(max(1.0 - 2.0 * bend * hit.position.z, 0.0)));
  vec2 tilt = turn * rise;
  leaving = vec3(wi.xy - tilt * wi.z, wi.z + dot(tilt, wi.xy));
  leaving /= sqrt(dot(leaving, leaving));
  if (leaving.z <= 0.0) return 1.0;  // along a convex surface, past it
  // P as a height of that ray.
  vec2 out_ = loden_bounded_slope(leaving);
  float out_bend = dot(out_, hit.curvature * out_);
  height = 2.0 * hit.position.z / (1.0 + sqrt(max(1.0 + 2.0 * out_bend * hit.position.z, 0.0)));
  if (hit.curvature != mat2(0.0)) bias = LODEN_BENT_BIAS;
#endif
  vec2 exit_ = hit.position.xy + hit.x_from_tangent * slope * rise;
#ifdef LODEN_HEIGHT_FIELD
  if (bias == LODEN_BIAS) return loden_height_field_visibility(m, hit, wi, exit_, leaving);
#endif
  LodenVdimHit first =
      loden_atlas_lookup(m, exit_, leaving, loden_effort_over(LODEN_LIGHT_EFFORT, hit.lambda));
  float own = LODEN_SAME_SURFACE / loden_material.geometry_side;
  vec2 beside = first.p - hit.p;
  beside -= floor(beside + 0.5);
  bool reaches = first.missed || first.height <= height + bias || dot(beside, beside) < own * own;
  return reaches ? 1.0 : 0.0;
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
  if (hit.relief && !hit.missed) visibility = loden_looked_up_visibility(hit, wi);
#elif defined(LODEN_VISIBILITY_MAP)
  visibility = loden_mapped_visibility(hit.near, wi);
#endif
  if (visibility <= 0.0) return indirect;
  return visibility * loden_evaluate_near(hit.near, wi, wo) + indirect;
}
#endif  // LODEN_NEAR
