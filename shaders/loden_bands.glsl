// The sum over bands: w_b(lambda) * dot(D_b(q_b), E_b(wi, wo)). Mirrors material/eval/evaluate.cpp.
// Fetches per band and light: quads * 3 in grid layout (weights, two trilinear table fetches), quads * 2 in
// nearest layout, 1 for the ratio layer.

#ifdef LODEN_BANDS

struct LodenTablePosition {
  vec2 light, view;             // (phi / 2 pi, theta / theta_max)
  int light_index, view_index;  // of the nearest samples
};

float loden_window_weight(vec4 window, float lambda) {
  return clamp((lambda - window.x) * window.y, 0.0, 1.0) * clamp((window.z - lambda) * window.w, 0.0, 1.0);
}

LodenTablePosition loden_table_position(vec3 wi, vec3 wo) {
  LodenTablePosition at;
  at.light = loden_grid_position(wi, loden_material.theta_max);
  at.view = loden_grid_position(wo, loden_material.theta_max);
  at.light_index = 0;
  at.view_index = 0;
#ifdef LODEN_TABLES_NEAREST
  vec2 size = vec2(textureSize(loden_nearest_light, 0));
  LODEN_COUNT(LODEN_UNIT_NEAREST_LIGHT, 1);
  LODEN_COUNT(LODEN_UNIT_NEAREST_VIEW, 1);
  at.light_index = int(
      texelFetch(loden_nearest_light, ivec2(clamp((wi.xy * 0.5 + 0.5) * size, vec2(0), size - 1.0)), 0).x);
  at.view_index =
      int(texelFetch(loden_nearest_view, ivec2(clamp((wo.xy * 0.5 + 0.5) * size, vec2(0), size - 1.0)), 0).x);
#endif
  return at;
}

vec4 loden_fetch_table(int band, int quad, LodenTablePosition at) {
#ifdef LODEN_TABLES_NEAREST
  LODEN_COUNT(LODEN_UNIT_TABLE(LODEN_BANDS) + band, 1);
  return texelFetch(loden_table[band], ivec3(at.light_index, at.view_index, quad), 0);
#else
  vec2 grid = loden_material.bands[band].grid;
  vec2 light = at.light * (grid.yx - 1.0), view = at.view * (grid.yx - 1.0);
  float row = min(floor(view.y), grid.x - 2.0);
  vec3 texel_size = vec3(loden_material.bands[band].per_grid.yx, loden_material.bands[band].per_table_depth);
  vec3 texel = vec3(light.x + 0.5, row * grid.x + light.y + 0.5, float(quad) * grid.y + view.x + 0.5);
  LODEN_COUNT(LODEN_UNIT_TABLE(LODEN_BANDS) + band, 2);
  vec4 below = textureLod(loden_table[band], texel * texel_size, 0.0);
  vec4 above = textureLod(loden_table[band], (texel + vec3(0.0, grid.x, 0.0)) * texel_size, 0.0);
  return mix(below, above, view.y - row);
#endif
}

vec4 loden_fetch_weights(int band, int layer, vec2 q, float lod) {
  LODEN_COUNT(LODEN_UNIT_WEIGHTS + band, 1);
#ifdef LODEN_TABLES_NEAREST
  if ((loden_material.bands[band].bits & LODEN_BAND_LINEAR) == 0) {
    float side = loden_material.bands[band].side;
    return texelFetch(loden_weights[band], ivec3(ivec2(min(floor(fract(q) * side), vec2(side - 1.0))), layer),
                      0);
  }
#endif
  return textureLod(loden_weights[band], vec3(q, float(layer)), lod);
}

// What the quad adds of itself at that lambda: 0 up to quad_begin and from quad_end on, 1 from one level
// after the one to one level before the other. Never more than the quad before it, so that a loop over quads
// ends at the first that adds nothing.
float loden_quad_share(int band, int quad, float lambda) {
  float begin = loden_material.bands[band].quad_begin[quad >> 2][quad & 3];
  float end = loden_material.bands[band].quad_end[quad >> 2][quad & 3];
  return clamp(min(lambda - begin, end - lambda), 0.0, 1.0);
}

// (Y, Cb, Cr) that one band adds at full weight. The loop has a dynamic bound on purpose: renderers that run
// both sides of every branch still skip iterations.
vec3 loden_evaluate_band(int band, LodenHit hit, LodenTablePosition at, vec3 mean) {
  int bits = loden_material.bands[band].bits;
  vec2 q = (bits & LODEN_BAND_FLAT) != 0 ? hit.p : hit.x;
  float lod =
      clamp(hit.lambda - loden_material.bands[band].lambda_first, 0.0, loden_material.bands[band].last_mip);
  int y_quads = loden_material.bands[band].y_quads;
  int quads = y_quads + loden_material.bands[band].chroma_quads;
  vec3 sum = vec3(0.0);
  int quad = 0;
  float share = 1.0;
  do {
    vec4 product = loden_fetch_weights(band, quad, q, lod) * loden_fetch_table(band, quad, at) *
                   loden_material.bands[band].quad_scale[quad] * share;
    vec2 halves = vec2(product.x + product.y, product.z + product.w);
    sum += quad < y_quads ? vec3(halves.x + halves.y, 0.0, 0.0) : vec3(0.0, halves);
    share = ++quad < quads ? loden_quad_share(band, quad, hit.lambda) : 0.0;
  } while (share > 0.0);
  if ((bits & LODEN_BAND_RATIO) != 0) {
    vec2 ratio = loden_fetch_weights(band, loden_material.bands[band].ratio_layer, q, lod).xy *
                 loden_material.bands[band].ratio_scale;
    sum.yz += ratio * (sum.x + mean.x) - mean.yz;
  }
  return sum;
}

// The finest band whose window is open; none: the coarsest.
int loden_finest_band(float lambda) {
  int finest = LODEN_BANDS - 1;
#ifdef LODEN_NO_BRANCH
  finest = 0;
#else
  for (int b = LODEN_BANDS - 1; b >= 0; --b)
    finest = loden_window_weight(loden_material.bands[b].window, lambda) > 0.0 ? b : finest;
#endif
  return finest;
}

// All bands whose window is open at the hit's lambda, from the coarsest to the finest that is needed, so that
// the band index is the same for all invocations that execute an iteration (dynamically uniform).
vec3 loden_evaluate_bands(LodenHit hit, LodenTablePosition at, vec3 mean) {
  float lambda = hit.lambda;
  int finest = loden_finest_band(lambda);
  vec3 sum = vec3(0.0);
  int band = LODEN_BANDS - 1;
  do {
    float weight = loden_window_weight(loden_material.bands[band].window, lambda);
#ifdef LODEN_NO_BRANCH
    sum += weight * loden_evaluate_band(band, hit, at, mean);
#else
    if (weight > 0.0) sum += weight * loden_evaluate_band(band, hit, at, mean);
#endif
  } while (--band >= finest);
  return sum;
}
#endif  // LODEN_BANDS
