// Light from all around. Mirrors material/model/environment.h and the environment's half of
// material/eval/evaluate.cpp. Fetches per band: quads * 7 (weights, and one of the table per basis function),
// and 1 for the ratio layer; about what two lights cost.
//
// Use, once per pixel:
//   LodenHemisphere light = loden_hemisphere_light(environment, loden_hit_frame(h, frame));
//   radiance += pi * value_scale * loden_evaluate_environment(h, light, wo_ts);

// Light over the hemisphere of a tangent frame: linear RGB per basis function 1, z, x, y, xy, x^2 - y^2.
struct LodenHemisphere {
  vec3 c[LODEN_ENVIRONMENT_BASIS];
};

// The light in the frame whose columns are tangent, bitangent and normal. environment[3 c .. 3 c + 2] is
// colour channel c: (linear, constant); diagonal of the quadratic form; its xy, xz, yz.
LodenHemisphere loden_hemisphere_light(vec4 environment[9], mat3 frame) {
  LodenHemisphere light;
  for (int c = 0; c < 3; ++c) {
    vec4 first = environment[3 * c];
    vec3 d = environment[3 * c + 1].xyz, o = environment[3 * c + 2].xyz;
    mat3 turned = mat3(d.x, o.x, o.y, o.x, d.y, o.z, o.y, o.z, d.z) * frame;
    vec3 l = first.xyz * frame;
    float xx = dot(frame[0], turned[0]), yy = dot(frame[1], turned[1]), zz = dot(frame[2], turned[2]);
    float flat_ = 0.5 * (xx + yy), squared = zz - flat_;
    light.c[0][c] = first.w + flat_ - 0.3 * squared;
    light.c[1][c] = l.z + 1.2 * squared;
    light.c[2][c] = l.x + 16.0 / 15.0 * dot(frame[2], turned[0]);
    light.c[3][c] = l.y + 16.0 / 15.0 * dot(frame[2], turned[1]);
    light.c[4][c] = 2.0 * dot(frame[1], turned[0]);
    light.c[5][c] = 0.5 * (xx - yy);
  }
  return light;
}

#ifdef LODEN_BANDS
// Per colour channel of the light (columns) Y, Cb and Cr of the mean.
mat3 loden_evaluate_mean_environment(LodenHemisphere light, vec3 wo, float row) {
  int below = min(int(row), LODEN_ENVIRONMENT_THETAS - 2);
  vec4 t = mix(loden_material.environment_mean[below], loden_material.environment_mean[below + 1],
               row - float(below));
  vec2 unit = loden_material.environment_unit;
  float sine = sqrt(wo.x * wo.x + wo.y * wo.y);
  vec2 along = sine > 1e-6 ? wo.xy / sine : vec2(1.0, 0.0);
  vec3 y = light.c[0] * t.x + light.c[1] * t.y + (light.c[2] * along.x + light.c[3] * along.y) * t.z +
           (light.c[4] * (along.x * along.y) + light.c[5] * (along.x * along.x - along.y * along.y)) * t.w;
  bool ratio = (loden_material.bits & LODEN_MEAN_RATIO) != 0;
  vec3 chroma = ratio ? y : light.c[0] * unit.x + light.c[1] * unit.y;
  return transpose(mat3(y, chroma * loden_material.mean_chroma.x, chroma * loden_material.mean_chroma.y));
}

// What one band adds at full weight; `view` as in LodenTablePosition.
mat3 loden_evaluate_band_environment(int band, LodenHit hit, vec2 view, LodenHemisphere light, mat3 mean) {
  int bits = loden_material.bands[band].bits;
  vec2 q = (bits & LODEN_BAND_FLAT) != 0 ? hit.p : hit.x;
  float lod =
      clamp(hit.lambda - loden_material.bands[band].lambda_first, 0.0, loden_material.bands[band].last_mip);
  int y_quads = loden_material.bands[band].y_quads;
  int quads = y_quads + loden_material.bands[band].chroma_quads;
  vec2 size = loden_material.bands[band].grid.yx;
  vec3 texel_size = 1.0 / vec3(size, LODEN_ENVIRONMENT_BASIS * quads);
  vec3 at = vec3(view * (size - 1.0) + 0.5, 0.5) * texel_size;
  mat3 sum = mat3(0.0);
  int quad = 0;
  float share = 1.0;
  do {
    vec4 red = vec4(0.0), green = vec4(0.0), blue = vec4(0.0);
    for (int k = 0; k < LODEN_ENVIRONMENT_BASIS; ++k) {
      LODEN_COUNT(LODEN_UNIT_ENVIRONMENT(LODEN_BANDS) + band, 1);
      vec4 texel = textureLod(loden_environment[band], at, 0.0);
      at.z += texel_size.z;
      red += light.c[k].r * texel;
      green += light.c[k].g * texel;
      blue += light.c[k].b * texel;
    }
    vec4 weights = loden_fetch_weights(band, quad, q, lod);
    bool luminance = quad < y_quads;
    weights *= float(quad) < loden_material.bands[band].first_rest
                   ? share
                   : share * loden_material.bands[band].rest_share;
    red *= weights;
    green *= weights;
    blue *= weights;
    mat3 halves = mat3(0.0, red.x + red.y, red.z + red.w, 0.0, green.x + green.y, green.z + green.w, 0.0,
                       blue.x + blue.y, blue.z + blue.w);
    for (int c = 0; c < 3; ++c) sum[c] += luminance ? vec3(halves[c].y + halves[c].z, 0.0, 0.0) : halves[c];
    share = ++quad < quads ? loden_quad_share(band, quad, hit.lambda) : 0.0;
  } while (share > 0.0);
  if ((bits & LODEN_BAND_RATIO) != 0) {
    vec2 ratio = loden_fetch_weights(band, loden_material.bands[band].ratio_layer, q, lod).xy *
                 loden_material.bands[band].ratio_scale;
    for (int c = 0; c < 3; ++c) sum[c].yz += ratio * (sum[c].x + mean[c].x) - mean[c].yz;
  }
  return sum;
}

// Bands as loden_evaluate_bands visits them.
mat3 loden_evaluate_bands_environment(LodenHit hit, vec2 view, LodenHemisphere light, mat3 mean) {
  int finest = loden_finest_band(hit.lambda);
  mat3 sum = mat3(0.0);
  int band = LODEN_BANDS - 1;
  do {
    float weight = loden_window_weight(loden_material.bands[band].window, hit.lambda);
    if (weight > 0.0) sum += weight * loden_evaluate_band_environment(band, hit, view, light, mean);
  } while (--band >= finest);
  return sum;
}
#endif

#ifdef LODEN_NEAR
// A, V and C under light from all around: the diffuse part as the ambient map has it, the light along the
// mirror direction, blurred as the lobe's width asks, times what the lobe reflects, and C.
vec3 loden_evaluate_near_environment(LodenHit hit, LodenHemisphere light, vec3 wo) {
  LODEN_COUNT(LODEN_UNIT_AMBIENT(LODEN_BANDS_OR_NONE), 2);
  float lod = hit.lambda - loden_material.ambient_lambda;
  vec4 first = textureLod(loden_ambient, vec3(hit.p, 0.0), lod);
  vec4 second = textureLod(loden_ambient, vec3(hit.p, 1.0), lod);
  vec3 irradiance = max(light.c[0] * first.x + light.c[1] * first.y + light.c[2] * first.z +
                            light.c[3] * first.w + light.c[4] * second.x + light.c[5] * second.y,
                        0.0);
  vec3 n = hit.near.normal;
  float nv = max(dot(n, wo), LODEN_LEAST_VIEW);
  vec3 r = 2.0 * dot(n, wo) * n - wo;
  r.z = max(r.z, 0.0);
  bool ggx = (loden_material.bits & LODEN_GGX) != 0;
  float exponent = ggx ? 2.0 / (hit.near.width * hit.near.width) : hit.near.width;
  float order1 = exp(-4.0 / exponent), order2 = exp(-12.0 / exponent);
  vec3 mirrored = max(light.c[0] + order1 * (light.c[1] * r.z + light.c[2] * r.x + light.c[3] * r.y) +
                          order2 * (light.c[4] * (r.x * r.y) + light.c[5] * (r.x * r.x - r.y * r.y)),
                      0.0);
  // What meets the surface of a white sky stands for what meets it along the mirror direction.
  float open = clamp(first.x / max(0.5 + 0.5 * n.z, 0.05), 0.0, 1.0);
  vec3 indirect = vec3(0.0);
#ifdef LODEN_INDIRECT
  // The integrals of the basis times wi.z (1, wi.z, wi.x, wi.y), over pi.
  vec4 k = hit.near.indirect;
  vec3 entering = light.c[0] * (k.x + 2.0 / 3.0 * k.y) + light.c[1] * (2.0 / 3.0 * k.x + 0.5 * k.y) +
                  0.25 * (light.c[2] * k.z + light.c[3] * k.w);
  indirect = hit.near.indirect_color * max(entering, 0.0);
#endif
  if (!ggx)
    return hit.near.diffuse * irradiance +
           (hit.near.strength * loden_phong_albedo(hit.near.width, nv)) * open * mirrored + indirect;
  vec3 shine = loden_lobe_albedo(hit.near.width, hit.near.f0, nv);
  vec3 f0 = vec3(max(max(hit.near.f0.x, hit.near.f0.y), hit.near.f0.z));
  float left = 1.0 - loden_lobe_albedo(hit.near.width, f0, nv).x;
  return hit.near.diffuse * (irradiance * left) + shine * open * mirrored + indirect;
}
#endif

// loden_evaluate integrated over the hemisphere's light, over pi. Linear RGB, not negative.
vec3 loden_evaluate_environment(LodenHit hit, LodenHemisphere light, vec3 wo_ts) {
  wo_ts = loden_tilted(hit.tilt, wo_ts);
  if (wo_ts.z <= 0.0) return vec3(0.0);
  vec3 shown = vec3(0.0);
#ifdef LODEN_NEAR
  if (hit.near_weight > 0.0) shown = hit.near_weight * loden_evaluate_near_environment(hit, light, wo_ts);
  if (hit.near_weight >= 1.0) return shown;
#endif
#ifdef LODEN_BANDS
  vec3 wo = loden_clamp_theta(wo_ts, loden_material.theta_max);
  vec2 view = loden_grid_position(wo, loden_material.theta_max);
  mat3 mean = loden_evaluate_mean_environment(light, wo, view.y * float(LODEN_ENVIRONMENT_THETAS - 1));
  mat3 ycc = mean + loden_evaluate_bands_environment(hit, view, light, mean);
  shown += (1.0 - hit.near_weight) *
           max(vec3(loden_rgb_from_ycc(ycc[0]).r, loden_rgb_from_ycc(ycc[1]).g, loden_rgb_from_ycc(ycc[2]).b),
               0.0);
#endif
  return shown;
}
