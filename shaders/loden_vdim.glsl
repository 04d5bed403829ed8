// View-dependent indirection: p = VDIM(x, wo). Mirrors material/vdim_lookup.cpp name for name.
// Default: 2 gathers for 8 depths, then per candidate 1 fetch (none on identity parameterizations) and 2
// gathers (1) per patch visited. Fast: 1 gather for 4 depths, one candidate.

const float LODEN_REACH = 3.0;               // texels
const float LODEN_INSIDE = 0.4;              // texels
const float LODEN_RESIDUAL = 0.2;            // texels
const float LODEN_CLUSTER = 20.5 / 255.0;    // of the depth range
const float LODEN_SEPARATION = 1.5 / 255.0;  // of the depth range

struct LodenVdimHit {
  vec2 p;        // unwrapped
  vec3 position;  // tile periods
  bool converged;
};

struct LodenViewRay {
  vec2 x;      // in [0, 1)^2
  vec2 slope;  // X(z) = x + slope z
};

LodenViewRay loden_view_ray(vec2 x, vec3 wo) {
  float cosine = max(wo.z, LODEN_VDIM_COS);
  float sine = sqrt(wo.x * wo.x + wo.y * wo.y);
  float scale = min(1.0, LODEN_VDIM_SIN / max(sine, 1e-6));
  return LodenViewRay(x - floor(x), wo.xy * (scale / cosine));
}

// The two layers of the atlas nearest to the view: its own cell, and the neighbour across the nearer border,
// with the second one's weight in a linear blend.
struct LodenNearestLayers {
  int own, next;
  float next_weight;
};
LodenNearestLayers loden_nearest_layers(int directions, vec2 square) {
  vec2 grid = square * float(directions);
  vec2 limit = vec2(float(directions) - 1.0);
  vec2 cell = clamp(floor(grid), vec2(0.0), limit);
  vec2 off = grid - cell - 0.5;
  vec2 second = cell;
  if (abs(off.x) > abs(off.y))
    second.x = clamp(cell.x + (off.x > 0.0 ? 1.0 : -1.0), 0.0, limit.x);
  else
    second.y = clamp(cell.y + (off.y > 0.0 ? 1.0 : -1.0), 0.0, limit.y);
  return LodenNearestLayers(int(cell.y) * directions + int(cell.x), int(second.y) * directions + int(second.x),
                            min(max(abs(off.x), abs(off.y)), 0.5));
}

// z of the four entries around x in one layer, as (lower left, lower right, upper left, upper right).
vec4 loden_gather_depths(int layer, vec2 x) {
  float n = float(loden_material.flags.z);
  vec2 base = floor(x * n - 0.5);
  LODEN_COUNT(1);
  vec4 code = textureGather(loden_vdim_depth, vec3((base + 1.0) / n, float(layer)), 0).wzxy;
  return (code - 1.0) * loden_material.geometry.z;
}

// Parameter of the surface near the point x + slope z.
vec2 loden_parameter_near(vec2 point, float z) {
  if ((loden_material.flags.x & LODEN_IDENTITY) != 0) return point;
  vec3 size = vec3(textureSize(loden_vdim_volume, 0));
  vec2 wrapped = point - floor(point);
  float slice = clamp(z / -loden_material.geometry.z * size.z, 0.0, size.z - 0.5);
  LODEN_COUNT(1);
  vec2 d = texelFetch(loden_vdim_volume, ivec3(min(vec3(wrapped * size.xy, slice), size - 1.0)), 0).xy;
  return point + d * 0.5;
}

struct LodenPatch {
  vec3 p00, p10, p01, p11;
  bool exists;
};

// The bilinear patch whose lower left corner is texel `base`. The geometry image's RGBA16 texels are bound as
// RG32UI, so that one gather returns two channels of four corners: (dx | dy << 16, z | chart << 16).
LodenPatch loden_fetch_patch(vec2 base) {
  vec3 range = loden_material.geometry.xyz;
  float n = loden_material.geometry.w;
  const float unit = 1.0 / 65535.0;
  vec2 uv = (base + 1.0) / n;
  LODEN_COUNT(1);
  uvec4 z_chart = textureGather(loden_geometry, uv, 1);
  vec4 x = vec4(0.0), y = vec4(0.0);
  if ((loden_material.flags.x & LODEN_IDENTITY) == 0) {
    LODEN_COUNT(1);
    uvec4 xy = textureGather(loden_geometry, uv, 0);
    x = (vec4(xy & 0xffffu) * unit - 0.5) * range.x;
    y = (vec4(xy >> 16u) * unit - 0.5) * range.y;
  }
  vec4 z = (vec4(z_chart & 0xffffu) * unit - 1.0) * range.z;
  uvec4 chart = z_chart >> 16u;
  vec2 lower = (base + 0.5) / n, upper = (base + 1.5) / n;
  LodenPatch patch_;
  patch_.p00 = vec3(lower.x + x.w, lower.y + y.w, z.w);
  patch_.p10 = vec3(upper.x + x.z, lower.y + y.z, z.z);
  patch_.p01 = vec3(lower.x + x.x, upper.y + y.x, z.x);
  patch_.p11 = vec3(upper.x + x.y, upper.y + y.y, z.y);
  patch_.exists = chart.x != 0u && chart.x == chart.y && chart.x == chart.z && chart.x == chart.w;
  return patch_;
}

vec2 loden_shear(vec3 p, vec2 shift, LodenViewRay ray) { return p.xy + shift - ray.slope * p.z - ray.x; }

// One step of Newton's method on Q(a, b) = q00 + q10 a + q01 b + q11 a b = 0, kept within the bounds. Returns
// det Q', which has the sign of N.wo.
float loden_newton_step(vec2 q00, vec2 q10, vec2 q01, vec2 q11, vec2 lower, vec2 upper, inout vec2 ab) {
  vec2 q = q00 + q10 * ab.x + q01 * ab.y + q11 * (ab.x * ab.y);
  vec2 qa = q10 + q11 * ab.y, qb = q01 + q11 * ab.x;
  float det = qa.x * qb.y - qa.y * qb.x;
  float inverse_ = 1.0 / (abs(det) > 1e-12 ? det : 1e-12);
  ab = clamp(ab - vec2(qb.y * q.x - qb.x * q.y, qa.x * q.y - qa.y * q.x) * inverse_, lower, upper);
  return det;
}

// Where the ray meets the patch: seen along the ray, the patch is Q(a, b) = P.xy - slope P.z, and Q = x is wanted.
bool loden_meet_patch(LodenPatch patch_, vec2 shift, LodenViewRay ray, float side, inout vec2 ab, out float z) {
  vec2 q00 = loden_shear(patch_.p00, shift, ray);
  vec2 q10 = loden_shear(patch_.p10, shift, ray) - q00;
  vec2 q01 = loden_shear(patch_.p01, shift, ray) - q00;
  vec2 q11 = loden_shear(patch_.p11, shift, ray) - q00 - q10 - q01;
  vec2 lower = ab - LODEN_REACH, upper = ab + LODEN_REACH;
  loden_newton_step(q00, q10, q01, q11, lower, upper, ab);
  loden_newton_step(q00, q10, q01, q11, lower, upper, ab);
  loden_newton_step(q00, q10, q01, q11, lower, upper, ab);
  float det = loden_newton_step(q00, q10, q01, q11, lower, upper, ab);
  z = mix(mix(patch_.p00.z, patch_.p10.z, ab.x), mix(patch_.p01.z, patch_.p11.z, ab.x), ab.y);
  vec2 centred = abs(ab - 0.5);
  vec2 residual = abs(q00 + q10 * ab.x + q01 * ab.y + q11 * (ab.x * ab.y));
  return det > 0.0 && max(centred.x, centred.y) <= 0.5 + LODEN_INSIDE &&
         max(residual.x, residual.y) * side <= LODEN_RESIDUAL;
}

// Newton's search from p, the parameter near the point of the ray at height z. found = (p, z, 1) if it
// converged, else as it was. What leaves the loop is carried through every iteration on purpose: llvmpipe
// (Mesa 22.3) hands out the last iteration's values of anything else, also to invocations that left before.
void loden_search_from(LodenViewRay ray, float z, vec2 p, int patches, inout vec4 found) {
  float n = loden_material.geometry.w;
  vec2 point = ray.x + ray.slope * z;
  int left = patches;
  do {
    vec2 texel = p * n - 0.5, base = floor(texel);
    vec2 ab = texel - base;
    LodenPatch patch_ = loden_fetch_patch(base);
    vec2 shift = floor(point - patch_.p00.xy + 0.5);
    float hit_z;
    bool converged = loden_meet_patch(patch_, shift, ray, n, ab, hit_z) && patch_.exists;
    p = (base + ab + 0.5) / n;
    found = converged ? vec4(p + shift, hit_z, 1.0) : found;
    left = converged ? 0 : left - 1;
  } while (left > 0);
}

float loden_highest_below(vec4 depths, float below) {
  vec4 usable = mix(vec4(-1e9), depths, lessThan(depths, vec4(below)));
  return max(max(usable.x, usable.y), max(usable.z, usable.w));
}

// Mean of the entries at or above `low`, each with its weight: the depth of the topmost surface at x.
float loden_cluster_mean(vec4 own, vec4 next, float low, vec2 f, float next_weight) {
  const float floor_ = 0.02;  // so that a lone entry with weight 0 still counts
  vec4 spatial = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y) + floor_;
  vec4 w_own = mix(vec4(0.0), spatial * (1.0 - next_weight), greaterThanEqual(own, vec4(low)));
  vec4 w_next = mix(vec4(0.0), spatial * next_weight, greaterThanEqual(next, vec4(low)));
  return (dot(own, w_own) + dot(next, w_next)) / max(dot(w_own + w_next, vec4(1.0)), 1e-9);
}

LodenVdimHit loden_vdim_lookup(vec2 x, vec3 wo) {
  LodenViewRay ray = loden_view_ray(x, wo);
  LodenNearestLayers layers = loden_nearest_layers(loden_material.flags.w, loden_vdim_square_from_view(wo));
  vec4 own = loden_gather_depths(layers.own, ray.x);
#ifdef LODEN_LOOKUP_FAST
  vec4 next = own;
  int patches = (loden_material.flags.x & LODEN_IDENTITY) != 0 ? 4 : 2;
#else
  vec4 next = loden_gather_depths(layers.next, ray.x);
  const int candidates = 8, patches = 4;
#endif
  // First the blended depth of the topmost surface; then single entries from the one nearest to the viewer
  // down. The first search that converges wins.
  float range = loden_material.geometry.z;
  float top = max(loden_highest_below(own, 1.0), loden_highest_below(next, 1.0));
  vec2 f = fract(ray.x * float(loden_material.flags.z) - 0.5);
  float z = loden_cluster_mean(own, next, top - LODEN_CLUSTER * range, f, layers.next_weight);
  // Where searches that fail end up means nothing; the blended depth is near.
  vec4 found = vec4(loden_parameter_near(ray.x + ray.slope * z, z), z, 0.0);
  loden_search_from(ray, z, found.xy, patches, found);
#ifndef LODEN_LOOKUP_FAST
  if (found.w == 0.0) {
    float below = 1.0;
    int left = candidates - 1;
    do {
      z = max(loden_highest_below(own, below), loden_highest_below(next, below));
      below = z - LODEN_SEPARATION * range;
      loden_search_from(ray, z, loden_parameter_near(ray.x + ray.slope * z, z), patches, found);
      bool more = max(loden_highest_below(own, below), loden_highest_below(next, below)) > -1e8;
      left = found.w > 0.0 || !more ? 0 : left - 1;
    } while (left > 0);
  }
#endif
  LodenVdimHit hit;
  hit.converged = found.w > 0.0;
  vec2 base = floor(x);
  hit.p = found.xy + base;
  hit.position = vec3(ray.x + ray.slope * found.z + base, found.z);
  return hit;
}

#ifdef LODEN_LOOKUP_PAPER
// The published lookup (FBTF 3.5): blended over directions, reference unfiltered; 2 fetches.
vec2 loden_paper_vdim_lookup(vec2 x, vec3 wo) {
  float side = float(textureSize(loden_paper_reference, 0).x);
  vec2 texel = min(floor((x - floor(x)) * side), vec2(side - 1.0));
  LODEN_COUNT(2);
  vec2 reference = texelFetch(loden_paper_reference, ivec3(ivec2(texel), 0), 0).xy * loden_material.paper.x;
  float theta = min(acos(clamp(wo.z, -1.0, 1.0)), 85.0 * LODEN_PI / 180.0);
  float phi = wo.x == 0.0 && wo.y == 0.0 ? 0.0 : atan(wo.y, wo.x);
  phi = phi < 0.0 ? phi + 2.0 * LODEN_PI : phi;
  vec2 size = loden_material.paper.wz;
  vec2 within = vec2(phi / (2.0 * LODEN_PI), theta / (85.0 * LODEN_PI / 180.0)) * (size - 1.0) + 0.5;
  vec4 entry = textureLod(loden_paper_packed, vec3((texel * size + within) / (side * size), 0.0), 0.0);
  float length_ = sqrt(dot(entry.xy, entry.xy));
  vec2 direction = length_ > 1e-6 ? entry.xy / length_ : vec2(0.0);
  return x + reference + direction * (entry.z * loden_material.paper.y);
}
#endif
