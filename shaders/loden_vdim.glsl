// View-dependent indirection: p = VDIM(x, wo). Mirrors material/eval/vdim_lookup.cpp name for name.
// Default: 3 gathers for 12 depths, then per candidate 1 fetch (none on identity parameterizations) and a
// gather per patch visited, 1 to 5. Fast: 1 gather for 4 depths, fewer candidates. A ray that bends much does
// so for several anchors.

const float LODEN_REACH = 3.0;          // texels
const float LODEN_INSIDE = 0.2;         // texels
const float LODEN_RESIDUAL = 0.2;       // texels
const float LODEN_BENT_RESIDUAL = 0.1;  // texels
const int LODEN_PATCHES = 5;
const float LODEN_CLUSTER = 20.5 / 255.0;    // of the depth range
const float LODEN_SEPARATION = 1.5 / 255.0;  // of the depth range
const float LODEN_NONE = -1e8;               // below every depth
const int LODEN_ANCHORS = 6;                 // along a bent ray
const float LODEN_STRAIGHT = 0.2;            // change of the descent that needs no more than one
const float LODEN_LEAST_DESCENT = 0.02;
const float LODEN_SHALLOW = 0.5;  // of the depth range

const int LODEN_FAST_LAYERS = 1, LODEN_FAST_CANDIDATES = 5;
#ifdef LODEN_LOOKUP_FAST
const int LODEN_LAYERS = LODEN_FAST_LAYERS, LODEN_CANDIDATES = LODEN_FAST_CANDIDATES;
#else
const int LODEN_LAYERS = 3, LODEN_CANDIDATES = 16;
#endif

struct LodenVdimHit {
  vec2 p;        // unwrapped
  vec2 offset;   // of the point from x, tile periods
  float height;  // of the point above the tangent plane at x
  float z;       // of the point above the reference surface, <= 0
  bool converged;
  bool missed;  // the ray goes by a convex surface
};

// A view ray in the tile's own coordinates, in which a curved reference surface is flat and the ray is bent.
// Where the ray is h below the tangent plane at x and z below a surface of curvature K, it is (I - z K) h
// slope from x along the plane, and z = h + bend h^2 / 2. A ray that goes by a convex surface turns at h = -1
// / bend and leaves again.
struct LodenViewRay {
  vec2 x;      // in [0, 1)^2
  vec2 slope;  // wo.xy / wo.z, tile periods per tile length
  vec2 turn;   // K slope, likewise
  float bend;  // slope^T K slope
  bool bent;   // false: h is z. Constant in programs for planes, which leave out all that follows it
};

LodenViewRay loden_view_ray(LodenMaterial m, vec2 x, vec3 wo) {
  float cosine = max(wo.z, LODEN_VDIM_COS);
  float sine = sqrt(wo.x * wo.x + wo.y * wo.y);
  float scale = min(1.0, LODEN_VDIM_SIN / max(sine, 1e-6));
  vec2 slope = wo.xy * (scale / cosine);
  vec2 turn = m.curvature * slope;
  return LodenViewRay(x - floor(x), m.x_from_tangent * slope, m.x_from_tangent * turn, dot(slope, turn),
                      m.curvature != mat2(0.0));
}

float loden_ray_z(LodenViewRay ray, float h) {
  return h + 0.5 * ray.bend * h * h;
}

// h on the way down to z; of the turning point if the ray never gets there.
float loden_ray_height(LodenViewRay ray, float z) {
  return 2.0 * z / (1.0 + sqrt(max(1.0 + 2.0 * ray.bend * z, 0.0)));
}

// From x to there.
vec2 loden_ray_offset(LodenViewRay ray, float h) {
  return (ray.slope - loden_ray_z(ray, h) * ray.turn) * h;
}

// Growth with h: of z, and of the offset.
float loden_ray_descent(LodenViewRay ray, float h) {
  return 1.0 + ray.bend * h;
}
vec2 loden_ray_drift(LodenViewRay ray, float h) {
  return ray.slope - (loden_ray_z(ray, h) + loden_ray_descent(ray, h) * h) * ray.turn;
}

bool loden_on_its_way_out(LodenViewRay ray, float h) {
  return loden_ray_descent(ray, h) < 0.0;
}

// A straight ray that stands for a bent one: at height z it is at x, and level with the bent one's point at
// h.
struct LodenStraightRay {
  vec2 x, slope;
  float z, h, h_per_z;
};

// Through the ray's point at h and in its direction, but for how fast it goes down.
LodenStraightRay loden_straight_at(LodenViewRay ray, float h, float descent) {
  return LodenStraightRay(ray.x + loden_ray_offset(ray, h), loden_ray_drift(ray, h) / descent,
                          loden_ray_z(ray, h), h, 1.0 / descent);
}

// The tangent, or nearly so where the ray turns.
LodenStraightRay loden_tangent_ray(LodenViewRay ray, float h) {
  if (!ray.bent) return LodenStraightRay(ray.x, ray.slope, 0.0, 0.0, 1.0);
  float descent = loden_ray_descent(ray, h);
  return loden_straight_at(
      ray, h,
      loden_on_its_way_out(ray, h) ? min(descent, -LODEN_LEAST_DESCENT) : max(descent, LODEN_LEAST_DESCENT));
}

// The anchors along a ray over a convex surface: points, evenly spaced from x on, for which the atlas is
// read. Elsewhere x alone.
struct LodenRayPath {
  float end;  // h where the ray is below the tile, or above it again
  int anchors;
};
LodenRayPath loden_ray_path(LodenViewRay ray, float range) {
  if (!ray.bent) return LodenRayPath(-range, 1);
  float end = 2.0 * ray.bend * range < 1.0 ? loden_ray_height(ray, -range) : -2.0 / ray.bend;
  return LodenRayPath(end, ray.bend * end > -LODEN_STRAIGHT ? 1 : LODEN_ANCHORS);
}

// What stands for the ray in the atlas. One anchor: its chord down to half the depth range. Several: from
// each the tangent, but no more grazing than the atlas's views. That is below the ray, and what it meets not
// behind what the ray meets.
LodenStraightRay loden_seed_ray(LodenViewRay ray, LodenRayPath path, float range, int anchor) {
  if (path.anchors == 1) {
    float z = max(-0.5 * range, -0.45 / max(ray.bend, 1e-6));
    return LodenStraightRay(ray.x, z < 0.0 ? loden_ray_offset(ray, loden_ray_height(ray, z)) / z : ray.slope,
                            0.0, 0.0, 1.0);
  }
  float h = path.end * (float(anchor) / float(LODEN_ANCHORS));
  vec2 drift = loden_ray_drift(ray, h);
  return loden_straight_at(
      ray, h, max(loden_ray_descent(ray, h), sqrt(dot(drift, drift)) * (LODEN_VDIM_COS / LODEN_VDIM_SIN)));
}

// h of the ray where its straight ray is at the depth z.
float loden_seed_height(LodenViewRay ray, LodenRayPath path, LodenStraightRay line, float z) {
  if (!ray.bent) return z;
  return path.anchors == 1 ? loden_ray_height(ray, z)
                           : clamp(line.h + line.h_per_z * (z - line.z), path.end, 0.0);
}

vec3 loden_view_along(vec2 slope) {
  return vec3(slope, 1.0) / sqrt(1.0 + dot(slope, slope));
}

// The layers of the atlas nearest to the view: its own cell, the neighbour across the nearer border and the
// one across the other, with their weights in a bilinear blend whose fourth term the two neighbours share.
struct LodenNearestLayers {
  ivec3 index;
  vec3 weight;
};
LodenNearestLayers loden_nearest_layers(int directions, vec2 square) {
  vec2 grid = square * float(directions), limit = vec2(float(directions) - 1.0);
  vec2 cell = clamp(floor(grid), vec2(0.0), limit);
  vec2 off = grid - cell - 0.5;
  vec2 beside = clamp(cell + vec2(off.x > 0.0 ? 1.0 : -1.0, off.y > 0.0 ? 1.0 : -1.0), vec2(0.0), limit);
  bool x_first = abs(off.x) > abs(off.y);
  vec2 first = x_first ? vec2(beside.x, cell.y) : vec2(cell.x, beside.y);
  vec2 second = x_first ? vec2(cell.x, beside.y) : vec2(beside.x, cell.y);
  float a = min(max(abs(off.x), abs(off.y)), 0.5);
  float b = min(min(abs(off.x), abs(off.y)), 0.5);
  float shared_ = 0.5 * a * b;
  return LodenNearestLayers(ivec3(ivec2(cell.y, first.y) * directions + ivec2(cell.x, first.x),
                                  int(second.y) * directions + int(second.x)),
                            vec3((1.0 - a) * (1.0 - b), a - shared_, b - shared_));
}

// z of the four entries around x in one layer, as (lower left, lower right, upper left, upper right).
vec4 loden_gather_depths(int layer, vec2 x) {
  float n = float(loden_material.atlas_texels);
  vec2 base = floor(x * n - 0.5);
  LODEN_COUNT(LODEN_UNIT_VDIM_DEPTH, 1);
  vec4 code = textureGather(loden_vdim_depth, vec3((base + 1.0) / n, float(layer)), 0).wzxy;
  return (code - 1.0) * loden_material.geometry_range.z;
}

// Parameter of the surface near the point x + slope z.
vec2 loden_parameter_near(vec2 point, float z) {
  if ((loden_material.bits & LODEN_IDENTITY) != 0) return point;
  vec3 size = vec3(textureSize(loden_vdim_volume, 0));
  vec2 wrapped = point - floor(point);
  float slice = clamp(z / -loden_material.geometry_range.z * size.z, 0.0, size.z - 0.5);
  LODEN_COUNT(LODEN_UNIT_VDIM_VOLUME, 1);
  vec2 d = texelFetch(loden_vdim_volume, ivec3(min(vec3(wrapped * size.xy, slice), size - 1.0)), 0).xy;
  return point + d * 0.5;
}

struct LodenPatch {
  vec3 p00, p10, p01, p11;
  bool exists;
};

// The bilinear patch whose lower left corner is texel `base` (material/model/packed_geometry.h).
LodenPatch loden_fetch_patch(vec2 base) {
  vec3 range = loden_material.geometry_range;
  float n = loden_material.geometry_side;
  LODEN_COUNT(LODEN_UNIT_GEOMETRY, 1);
  uvec4 code = textureGather(loden_geometry, (base + 1.0) / n, 0);
  bool identity = (loden_material.bits & LODEN_IDENTITY) != 0;
  vec4 x = (vec4(code & 1023u) - 511.0) * (1.0 / 1022.0) * range.x;
  vec4 y = (vec4(code >> 10u & 1023u) - 511.0) * (1.0 / 1022.0) * range.y;
  x -= floor(x - x.w + 0.5);  // all corners in the period of the first
  y -= floor(y - y.w + 0.5);
  vec4 z = identity ? vec4(code & 0xffffu) * (1.0 / 65535.0) : vec4(code >> 20u & 2047u) * (1.0 / 2047.0);
  x = identity ? vec4(0.0) : x;
  y = identity ? vec4(0.0) : y;
  z = (z - 1.0) * range.z;
  vec2 lower = (base + 0.5) / n, upper = (base + 1.5) / n;
  LodenPatch patch_;
  patch_.p00 = vec3(lower.x + x.w, lower.y + y.w, z.w);
  patch_.p10 = vec3(upper.x + x.z, lower.y + y.z, z.z);
  patch_.p01 = vec3(lower.x + x.x, upper.y + y.x, z.x);
  patch_.p11 = vec3(upper.x + x.y, upper.y + y.y, z.y);
  patch_.exists = (code.w >> 31u) != 0u;
  return patch_;
}

vec2 loden_shear(vec3 p, vec2 shift, LodenStraightRay line) {
  return p.xy + shift - line.slope * (p.z - line.z) - line.x;
}

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

// What a patch says about the ray.
const int LODEN_AWAY = 0, LODEN_BESIDE = 1, LODEN_HERE = 2;

// Where the ray meets the patch: seen along the ray, the patch is Q(a, b) = P.xy - slope P.z, and Q = x is
// wanted. A ray that turned to the back of the surface is away from what the viewer sees. h: where the search
// is on the ray, before and after; miss: by how many texels the ray fails to meet a patch that faces it.
int loden_meet_patch(LodenPatch patch_, vec2 shift, LodenViewRay ray, float side, inout vec2 ab,
                     inout float h, out float miss) {
  LodenStraightRay line = loden_tangent_ray(ray, h);
  vec2 q00 = loden_shear(patch_.p00, shift, line);
  vec2 q10 = loden_shear(patch_.p10, shift, line) - q00;
  vec2 q01 = loden_shear(patch_.p01, shift, line) - q00;
  vec2 q11 = loden_shear(patch_.p11, shift, line) - q00 - q10 - q01;
  vec2 lower = ab - LODEN_REACH, upper = ab + LODEN_REACH;
  loden_newton_step(q00, q10, q01, q11, lower, upper, ab);
  loden_newton_step(q00, q10, q01, q11, lower, upper, ab);
  loden_newton_step(q00, q10, q01, q11, lower, upper, ab);
  float det = loden_newton_step(q00, q10, q01, q11, lower, upper, ab);
  float z = mix(mix(patch_.p00.z, patch_.p10.z, ab.x), mix(patch_.p01.z, patch_.p11.z, ab.x), ab.y);
  vec2 centred = abs(ab - 0.5);
  vec2 q = q00 + q10 * ab.x + q01 * ab.y + q11 * (ab.x * ab.y);
  float residual = max(abs(q.x), abs(q.y)) * side;
  if (ray.bent) {
    // On to the point of the ray that is nearest along it, and how far that is off across it.
    float descent = loden_ray_descent(ray, h);
    vec2 drift = loden_ray_drift(ray, h), point = q + line.x + line.slope * (z - line.z) - ray.x;
    det = loden_on_its_way_out(ray, h) ? -det : det;
    vec3 along = vec3(drift, descent), on = vec3(point - loden_ray_offset(ray, h), z - loden_ray_z(ray, h));
    h = patch_.exists ? min(h + dot(on, along) / dot(along, along), 0.0) : h;
    vec3 beside = vec3(point - loden_ray_offset(ray, h), z - loden_ray_z(ray, h));
    residual = sqrt(dot(beside, beside)) * side * (LODEN_RESIDUAL / LODEN_BENT_RESIDUAL);
  } else {
    h = z;
  }
  bool faces = patch_.exists && det > 0.0;
  miss = faces ? max(max(centred.x, centred.y) - 0.5, residual) : 1e9;
  bool here = max(centred.x, centred.y) <= 0.5 + LODEN_INSIDE && residual <= LODEN_RESIDUAL;
  if (!patch_.exists) return LODEN_BESIDE;
  return faces ? (here ? LODEN_HERE : LODEN_BESIDE) : LODEN_AWAY;
}

// Newton's search from p, the parameter near the point of the ray at h; gives up on the first patch that the
// ray meets from behind, unless patient. found = (p, h, 1) where it converges, or else (p, h, -miss) of the
// smallest miss so far. What leaves the loop is carried through every iteration on purpose: llvmpipe
// (Mesa 22.3) hands out the last iteration's values of anything else, also to invocations that left before.
void loden_search_from(LodenViewRay ray, float h, vec2 p, bool patient, inout vec4 found) {
  float n = loden_material.geometry_side;
  vec2 point = ray.x + loden_ray_offset(ray, h);
  int left = LODEN_PATCHES;
  do {
    vec2 texel = p * n - 0.5, base = floor(texel);
    vec2 ab = texel - base;
    LodenPatch patch_ = loden_fetch_patch(base);
    if (ray.bent) point = ray.x + loden_ray_offset(ray, h);
    vec2 shift = floor(point - patch_.p00.xy + 0.5);
    float miss;
    int meeting = loden_meet_patch(patch_, shift, ray, n, ab, h, miss);
    p = (base + ab + 0.5) / n;
    bool here = meeting == LODEN_HERE;
    found = here || miss < -found.w ? vec4(p + shift, h, here ? 1.0 : -miss) : found;
    left = here || (meeting == LODEN_AWAY && !patient) ? 0 : left - 1;
  } while (left > 0);
}

float loden_highest_below(vec4 depths, float below) {
  vec4 usable = mix(vec4(-1e9), depths, lessThan(depths, vec4(below)));
  return max(max(usable.x, usable.y), max(usable.z, usable.w));
}

// The depths that a lookup has gathered, as h of the ray.
struct LodenDepths {
  vec4 layer[3];
};

// Highest of them below one; below LODEN_NONE if there is none.
float loden_highest_below(LodenDepths depths, int layers, float below) {
  float z = loden_highest_below(depths.layer[0], below);
  if (layers > 1)
    z = max(z, max(loden_highest_below(depths.layer[1], below), loden_highest_below(depths.layer[2], below)));
  return z;
}

// Mean of the depths at or above `low`, each with its weight: where the topmost surface at x is.
float loden_cluster_mean(LodenDepths depths, int layers, float low, vec2 f, vec3 layer_weight) {
  const float floor_ = 0.02;  // so that a lone entry with weight 0 still counts
  vec4 spatial = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y) + floor_;
  float weight = 0.0, sum = 0.0;
  for (int l = 0; l < layers; ++l) {
    vec4 w = mix(vec4(0.0), spatial * layer_weight[l], greaterThanEqual(depths.layer[l], vec4(low)));
    weight += dot(w, vec4(1.0));
    sum += dot(depths.layer[l], w);
  }
  return sum / max(weight, 1e-9);
}

vec4 loden_gather_seeds(LodenViewRay ray, LodenRayPath path, LodenStraightRay line, vec2 entry, int layer) {
  vec4 z = loden_gather_depths(layer, entry);
  return vec4(loden_seed_height(ray, path, line, z.x), loden_seed_height(ray, path, line, z.y),
              loden_seed_height(ray, path, line, z.z), loden_seed_height(ray, path, line, z.w));
}

// Depths of `layers` directions, 1 or 3, and at most so many candidates; both constant where it is called.
LodenVdimHit loden_atlas_lookup(LodenMaterial m, vec2 x, vec3 wo, const int layers, const int candidates) {
  LodenViewRay ray = loden_view_ray(m, x, wo);
  float range = loden_material.geometry_range.z;
  LodenRayPath path = loden_ray_path(ray, range);
  vec4 found = vec4(0.0, 0.0, 0.0, -1e9);
  // Anchor by anchor along the ray; the first search that converges wins.
  int anchor = 0;
  do {
    LodenStraightRay line = loden_seed_ray(ray, path, range, anchor);
    LodenNearestLayers nearest = loden_nearest_layers(
        loden_material.atlas_directions, loden_vdim_square_from_view(loden_view_along(line.slope)));
    vec2 entry = line.x - line.slope * line.z;  // where it meets the plane
    if (ray.bent) entry -= floor(entry);
    LodenDepths depths;
    depths.layer[0] = loden_gather_seeds(ray, path, line, entry, nearest.index.x);
    if (layers > 1) {
      depths.layer[1] = loden_gather_seeds(ray, path, line, entry, nearest.index.y);
      depths.layer[2] = loden_gather_seeds(ray, path, line, entry, nearest.index.z);
    }
    // First the blended depth of the topmost surface, at the first anchor; then single depths from the one
    // nearest to the viewer down; then, where there is no other anchor, these once more with patience.
    float top = loden_highest_below(depths, layers, 1.0);
    float depth = range * line.h_per_z;
    float h = top, below = top - LODEN_SEPARATION * depth;
    if (anchor == 0) {
      vec2 f = fract(entry * float(loden_material.atlas_texels) - 0.5);
      h = loden_cluster_mean(depths, layers, top - LODEN_CLUSTER * depth, f, nearest.weight);
      below = 1.0;
    }
    vec2 p = loden_parameter_near(ray.x + loden_ray_offset(ray, h), loden_ray_z(ray, h));
    // Where no patch faces the ray the blended depth is near.
    found = anchor == 0 ? vec4(p, h, -1e9) : found;
    bool patient = false;
    int left = candidates;
    do {
      loden_search_from(ray, h, p, patient, found);
      float next = loden_highest_below(depths, layers, below);
      bool exhausted = next < LODEN_NONE;
      left = found.w > 0.0 || (exhausted && (patient || path.anchors > 1)) ? 0 : left - 1;
      patient = patient || exhausted;
      h = exhausted ? top : next;
      below = h - LODEN_SEPARATION * depth;
      if (left > 0) p = loden_parameter_near(ray.x + loden_ray_offset(ray, h), loden_ray_z(ray, h));
    } while (left > 0);
    ++anchor;
  } while (ray.bent && found.w <= 0.0 && anchor < path.anchors);
  LodenVdimHit hit;
  hit.converged = found.w > 0.0;
  hit.missed = !hit.converged && path.anchors > 1 && -0.5 / max(ray.bend, 1e-6) > -LODEN_SHALLOW * range;
  vec2 base = floor(x);
  hit.p = found.xy + base;
  hit.offset = loden_ray_offset(ray, found.z);
  hit.height = found.z;
  hit.z = loden_ray_z(ray, found.z);
  return hit;
}

LodenVdimHit loden_vdim_lookup(LodenMaterial m, vec2 x, vec3 wo) {
  return loden_atlas_lookup(m, x, wo, LODEN_LAYERS, LODEN_CANDIDATES);
}

#ifdef LODEN_LOOKUP_PAPER
// The published lookup (FBTF 3.5): blended over directions, reference unfiltered; 2 fetches.
vec2 loden_paper_vdim_lookup(vec2 x, vec3 wo) {
  float side = float(textureSize(loden_paper_reference, 0).x);
  vec2 texel = min(floor((x - floor(x)) * side), vec2(side - 1.0));
  LODEN_COUNT(LODEN_UNIT_PAPER_REFERENCE, 1);
  LODEN_COUNT(LODEN_UNIT_PAPER_PACKED, 1);
  vec2 reference =
      texelFetch(loden_paper_reference, ivec3(ivec2(texel), 0), 0).xy * loden_material.paper_range.x;
  // Not by acos, which GPUs compute to 1e-4 only: entries of neighbouring views may be whole periods apart.
  float theta = min(atan(sqrt(wo.x * wo.x + wo.y * wo.y), wo.z), 85.0 * LODEN_PI / 180.0);
  float phi = wo.x == 0.0 && wo.y == 0.0 ? 0.0 : atan(wo.y, wo.x);
  phi = phi < 0.0 ? phi + 2.0 * LODEN_PI : phi;
  vec2 size = loden_material.paper_size.yx;
  vec2 within = vec2(phi / (2.0 * LODEN_PI), theta / (85.0 * LODEN_PI / 180.0)) * (size - 1.0) + 0.5;
  vec4 entry = textureLod(loden_paper_packed, vec3((texel * size + within) / (side * size), 0.0), 0.0);
  float length_ = sqrt(dot(entry.xy, entry.xy));
  vec2 direction = length_ > 1e-6 ? entry.xy / length_ : vec2(0.0);
  return x + reference + direction * (entry.z * loden_material.paper_range.y);
}
#endif
