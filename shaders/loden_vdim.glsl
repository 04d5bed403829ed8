// View-dependent indirection: p = VDIM(x, wo). C++ compiles this text too (material/eval/vdim_lookup.cpp).
// Height fields over flat surfaces: 1 or 3 gathers for 4 or 12 depths, between whose bounds a march samples
// the heights, and one gather for the patch at its end. Elsewhere 1 or 3 gathers for 4 or 12 depths, then per
// visit of a patch one gather, and per candidate depth one fetch. A ray that bends much does so for several
// anchors.

const float LODEN_INSIDE = 0.1;         // texels beyond a patch at which its extension still counts
const float LODEN_INSIDE_SHARE = 0.05;  // of the footprint: the same
const float LODEN_INSIDE_MOST = 0.5;    // the same, at most
const float LODEN_STEP_SHARE = 0.25;    // of the footprint: steps of the march
const float LODEN_STEEP = 1.5;          // slope of walls that a step of the march shall not pass by
const float LODEN_SHORTEST = 0.8;       // of a step: the shortest near the surface
const float LODEN_LONGEST = 2.0;        // the same: the longest far above it
const float LODEN_COARSE = 6.0;         // units of a footprint over which both efforts are one
const float LODEN_SPAN = 128.0;         // units to a period, where finer images are read in steps that long

// What a lookup spends. One of the constants, but for what grows with the footprint that the answer is shown
// over. Units of length are texels of the geometry image; of one with more than 128 per side they are 128ths
// of the period, but two texels at most, so that a finer image takes no more fetches.
struct LodenEffort {
  int layers;     // directions of the atlas whose depths are read: 1 or 3
  int visits;     // of patches, at most
  float step_;    // of the march along the plane, units
  float samples;  // of the march in equal steps, at most
  float inside;   // texels beyond a patch at which its extension still counts as the surface
};
const LodenEffort LODEN_EFFORT_FAST = {1, 24, 2.0, 16.0, LODEN_INSIDE};
const LodenEffort LODEN_EFFORT_DEFAULT = {3, 48, 1.0, 32.0, LODEN_INSIDE};

// Units of LodenEffort in a period.
float loden_effort_units() {
  float n = loden_material.geometry_side;
  return max(0.5 * n, min(n, LODEN_SPAN));
}

// Of an answer that is shown at that level of detail, which hides what is finer.
LodenEffort loden_effort_over(LodenEffort effort, float lambda) {
  float footprint = exp2(lambda) * loden_effort_units() / loden_material.side;
  bool coarse = footprint > LODEN_COARSE;
  effort.layers = coarse ? LODEN_EFFORT_FAST.layers : effort.layers;
  effort.visits = coarse ? LODEN_EFFORT_FAST.visits : effort.visits;
  effort.samples = coarse ? LODEN_EFFORT_DEFAULT.samples : effort.samples;
  effort.step_ = max(coarse ? LODEN_EFFORT_DEFAULT.step_ : effort.step_, LODEN_STEP_SHARE * footprint);
  float texels = footprint * loden_material.geometry_side / loden_effort_units();
  effort.inside = clamp(LODEN_INSIDE_SHARE * texels, LODEN_INSIDE, LODEN_INSIDE_MOST);
  return effort;
}
#ifdef LODEN_LOOKUP_FAST
#define LODEN_EFFORT LODEN_EFFORT_FAST
#else
#define LODEN_EFFORT LODEN_EFFORT_DEFAULT
#endif

const float LODEN_REACH = 3.0;  // texels that one visit may move by
// Texels within which a root of a patch that faces away may be met: not LODEN_REACH itself, which is how far
// a search that comes back from that root has gone.
const float LODEN_NEXT_ROOT = 2.8;
const float LODEN_BENT_RESIDUAL = 0.1;     // texels between surface and bent ray at which they meet
const int LODEN_EACH = 6;                  // visits for each candidate depth
const float LODEN_BACK = 0.02;             // of a step: how far the next one leads back at least, if it does
const int LODEN_BENT_EACH = 6;             // the same of a bent ray, whose direction changes on the way
const float LODEN_CLUSTER = 20.5 / 255.0;  // of the depth range
const float LODEN_SEPARATION = 1.5 / 255.0;  // of the depth range
const float LODEN_MARGIN = 15.5 / 255.0;     // of the depth range
const float LODEN_TOUCHING = 1e-5;           // of the depth range: rounding, where a sample is on the surface
const float LODEN_NONE = -1e8;               // below every depth
const int LODEN_ANCHORS = 6;                 // along a bent ray
const float LODEN_STRAIGHT = 0.2;            // change of the descent that needs no more than one
const float LODEN_LEAST_DESCENT = 0.02;
const float LODEN_SHALLOW = 0.5;  // of the depth range

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
  bool bent;  // false: h is z. Constant without LODEN_FOLLOW_SURFACE, so that all that follows it is left out
};

LodenViewRay loden_view_ray(LodenPoint m, vec2 x, vec3 wo) {
  vec2 slope = loden_bounded_slope(wo);
  LodenViewRay ray = {x - floor(x), m.x_from_tangent * slope, vec2(0.0), 0.0, false};
#ifdef LODEN_FOLLOW_SURFACE
  vec2 turn = m.curvature * slope;
  ray.turn = m.x_from_tangent * turn;
  ray.bend = dot(slope, turn);
  ray.bent = m.curvature != mat2(0.0);
#endif
  return ray;
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
  LodenStraightRay line = {ray.x + loden_ray_offset(ray, h), loden_ray_drift(ray, h) / descent,
                           loden_ray_z(ray, h), h, 1.0 / descent};
  return line;
}

// The tangent, or nearly so where the ray turns.
LodenStraightRay loden_tangent_ray(LodenViewRay ray, float h) {
  LodenStraightRay straight = {ray.x, ray.slope, 0.0, 0.0, 1.0};
  if (!ray.bent) return straight;
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
  LodenRayPath path = {-range, 1};
  if (!ray.bent) return path;
  path.end = 2.0 * ray.bend * range < 1.0 ? loden_ray_height(ray, -range) : -2.0 / ray.bend;
  path.anchors = ray.bend * path.end > -LODEN_STRAIGHT ? 1 : LODEN_ANCHORS;
  return path;
}

// What stands for the ray in the atlas. One anchor: its chord down to half the depth range. Several: from
// each the tangent, but no more grazing than the atlas's views. That is below the ray, and what it meets not
// behind what the ray meets.
LodenStraightRay loden_seed_ray(LodenViewRay ray, LodenRayPath path, float range, int anchor) {
  if (path.anchors == 1) {
    float z = max(-0.5 * range, -0.45 / max(ray.bend, 1e-6));
    LodenStraightRay chord = {ray.x, ray.slope, 0.0, 0.0, 1.0};
    if (z < 0.0) chord.slope = loden_ray_offset(ray, loden_ray_height(ray, z)) / z;
    return chord;
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
  LodenNearestLayers nearest = {ivec3(ivec2(cell.y, first.y) * directions + ivec2(cell.x, first.x),
                                      int(second.y) * directions + int(second.x)),
                                vec3((1.0 - a) * (1.0 - b), a - shared_, b - shared_)};
  return nearest;
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
#ifdef LODEN_HEIGHT_FIELD
  return point;
#else
  vec3 size = vec3(textureSize(loden_vdim_volume, 0));
  vec2 wrapped = point - floor(point);
  float slice = clamp(z / -loden_material.geometry_range.z * size.z, 0.0, size.z - 0.5);
  LODEN_COUNT(LODEN_UNIT_VDIM_VOLUME, 1);
  vec2 d = texelFetch(loden_vdim_volume, ivec3(min(vec3(wrapped * size.xy, slice), size - 1.0)), 0).xy;
  return point + d - 128.0 / 255.0;
#endif
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
  vec2 lower = (base + 0.5) / n, upper = (base + 1.5) / n;
#ifdef LODEN_HEIGHT_FIELD
  vec4 height = (textureGather(loden_height, (base + 1.0) / n, 0) - 1.0) * range.z;
  LodenPatch patch_ = {vec3(lower, height.w), vec3(upper.x, lower.y, height.z),
                       vec3(lower.x, upper.y, height.x), vec3(upper, height.y), true};
  return patch_;
#else
  uvec4 code = textureGather(loden_geometry, (base + 1.0) / n, 0);
  vec4 x = (vec4(code & 1023u) - 511.0) * (1.0 / 1022.0) * range.x;
  vec4 y = (vec4(code >> 10u & 1023u) - 511.0) * (1.0 / 1022.0) * range.y;
  x -= floor(x - x.w + 0.5);  // all corners in the period of the first
  y -= floor(y - y.w + 0.5);
  vec4 z = (vec4(code >> 20u & 2047u) * (1.0 / 2047.0) - 1.0) * range.z;
  LodenPatch patch_;
  patch_.p00 = vec3(lower.x + x.w, lower.y + y.w, z.w);
  patch_.p10 = vec3(upper.x + x.z, lower.y + y.z, z.z);
  patch_.p01 = vec3(lower.x + x.x, upper.y + y.x, z.x);
  patch_.p11 = vec3(upper.x + x.y, upper.y + y.y, z.y);
  patch_.exists = (code.w >> 31u) != 0u;
  return patch_;
#endif
}

vec2 loden_shear(vec3 p, vec2 shift, LodenStraightRay line) {
  return p.xy + shift - line.slope * (p.z - line.z) - line.x;
}

float loden_cross(vec2 a, vec2 b) {
  return a.x * b.y - a.y * b.x;
}

// What visiting a patch has found: where the ray meets it or its extension.
struct LodenVisit {
  vec2 p;      // unwrapped
  float h;     // of the ray
  float miss;  // by how many texels the ray fails to meet the patch; LODEN_ABSENT where there is none,
               // LODEN_AWAY where no side of it faces the ray
};
const float LODEN_ABSENT = 1e9, LODEN_AWAY = 2e9;

// Visits the patch in which p lies, on behalf of the ray at h. Seen along the ray the patch is Q(a, b) = P.xy
// - slope P.z - x = q00 + q10 a + q01 b + q11 a b, and Q = 0 is wanted. Along the line of all b the vectors
// q00 + q10 a and q01 + q11 a are parallel, which is a quadratic in a; its growth at a root is det Q', which
// has the sign of N.wo. So the root where it grows is that of the side that faces the viewer.
LodenVisit loden_visit(LodenViewRay ray, float h, vec2 p) {
  float n = loden_material.geometry_side;
  vec2 texel = p * n - 0.5, base = floor(texel), ab = texel - base;
  LodenPatch patch_ = loden_fetch_patch(base);
  LodenStraightRay line = loden_tangent_ray(ray, h);
  vec2 shift = floor(ray.x + loden_ray_offset(ray, h) - patch_.p00.xy + 0.5);
  vec2 q00 = loden_shear(patch_.p00, shift, line);
  vec2 q10 = loden_shear(patch_.p10, shift, line) - q00;
  vec2 q01 = loden_shear(patch_.p01, shift, line) - q00;
  vec2 q11 = loden_shear(patch_.p11, shift, line) - q00 - q10 - q01;
  float side = ray.bent && loden_on_its_way_out(ray, h) ? -1.0 : 1.0;
  float c2 = side * loden_cross(q10, q11);
  float c1 = side * (loden_cross(q10, q01) + loden_cross(q00, q11));
  float c0 = side * loden_cross(q00, q01);
  float square = c1 * c1 - 4.0 * c2 * c0, root = sqrt(max(square, 0.0));
  float a = c1 > 0.0 ? -2.0 * c0 / (c1 + root) : (root - c1) / (abs(c2) > 1e-20 ? 2.0 * c2 : 1e-20);
  bool faces = c1 > 0.0 || (square > 0.0 && abs(a - ab.x) < LODEN_NEXT_ROOT);
  // A patch that faces away is of the underside of a fold: what the ray may meet there is uphill.
  vec2 rise = vec2(patch_.p10.z, patch_.p01.z) - patch_.p00.z;
  vec2 uphill = rise * (LODEN_REACH / max(max(abs(rise.x), abs(rise.y)), 1e-9));
  a = ab.x + (faces ? clamp(a - ab.x, -LODEN_REACH, LODEN_REACH) : uphill.x);
  vec2 from = q00 + q10 * a, along = q01 + q11 * a;
  float b = -dot(from, along) / max(dot(along, along), 1e-20);
  b = ab.y + (faces ? clamp(b - ab.y, -LODEN_REACH, LODEN_REACH) : uphill.y);
  vec2 q = from + along * b;
  float z = mix(mix(patch_.p00.z, patch_.p10.z, a), mix(patch_.p01.z, patch_.p11.z, a), b);
  float residual = max(abs(q.x), abs(q.y)) * n;
  LodenVisit visit;
  visit.h = z;
  if (ray.bent) {
    // On to the point of the ray that is nearest along it, and how far that is off across it.
    vec2 point = q + line.x + line.slope * (z - line.z) - ray.x;
    vec3 ahead = vec3(loden_ray_drift(ray, h), loden_ray_descent(ray, h));
    vec3 on = vec3(point - loden_ray_offset(ray, h), z - loden_ray_z(ray, h));
    visit.h = patch_.exists ? min(h + dot(on, ahead) / dot(ahead, ahead), 0.0) : h;
    vec3 beside = vec3(point - loden_ray_offset(ray, visit.h), z - loden_ray_z(ray, visit.h));
    residual = sqrt(dot(beside, beside)) * n * (LODEN_INSIDE / LODEN_BENT_RESIDUAL);
  }
  vec2 centred = abs(vec2(a, b) - 0.5);
  visit.p = (base + vec2(a, b) + 0.5) / n + shift;
  visit.miss = max(max(centred.x, centred.y) - 0.5, residual);
  if (!faces)
    visit.miss = LODEN_AWAY;
  else if (!patch_.exists)
    visit.miss = LODEN_ABSENT;
  return visit;
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

#ifdef LODEN_HEIGHT_FIELD
float loden_height_at(vec2 x) {
  LODEN_COUNT(LODEN_UNIT_GEOMETRY, 1);
  return (textureLod(loden_height, x, 0.0).x - 1.0) * loden_material.geometry_range.z;
}

// A march down a straight ray, in steps by how high it is above the surface: the last sample above the height
// field and the first below it.
struct LodenMarch {
  float above, below;          // z
  float gap_above, gap_below;  // heights of the surface over them; of the first sample a little below 0
  bool found;                  // false: none is below, and all of this is of the two lowest
};

// The part of a straight ray that is marched: between the bounds that depths of the nearest directions set,
// and not below `lowest`.
struct LodenStretch {
  float top, step_, samples;  // z; step_ <= 0
};
LodenStretch loden_marched_stretch(LodenViewRay ray, float lowest, LodenEffort effort) {
  float range = loden_material.geometry_range.z;
  LodenNearestLayers nearest = loden_nearest_layers(loden_material.atlas_directions,
                                                    loden_vdim_square_from_view(loden_view_along(ray.slope)));
  float high = -range, low = 0.0;
  int layer = 0;
  do {
    vec4 z = loden_gather_depths(nearest.index[layer], ray.x);
    high = max(high, max(max(z.x, z.y), max(z.z, z.w)));
    low = min(low, min(min(z.x, z.y), min(z.z, z.w)));
  } while (++layer < effort.layers);
  lowest = max(lowest, -range);
  float top = clamp(high + LODEN_MARGIN * range, lowest, 0.0);
  float bottom = max(low - LODEN_MARGIN * range, lowest);
  float travel = (top - bottom) * sqrt(dot(ray.slope, ray.slope)) * loden_effort_units();
  float samples = clamp(ceil(travel / effort.step_), 2.0, effort.samples);
  LodenStretch stretch = {top, min(bottom - top, 0.0) / samples, samples};
  return stretch;
}

LodenMarch loden_march(LodenViewRay ray, LodenEffort effort) {
  float range = loden_material.geometry_range.z;
  LodenStretch stretch = loden_marched_stretch(ray, LODEN_NONE, effort);
  float samples = stretch.samples / LODEN_SHORTEST, step_ = stretch.step_;
  float bottom = stretch.top + stretch.step_ * stretch.samples;
  float per_gap = 1.0 / (1.0 + LODEN_STEEP * sqrt(dot(ray.slope, ray.slope)));
  LodenMarch march = {stretch.top, stretch.top, 0.0, -1e-4 * range, false};
  do {
    march.above = march.below;
    march.gap_above = march.gap_below;
    march.below = max(march.below + step_, bottom);
    march.gap_below = loden_height_at(ray.x + ray.slope * march.below) - march.below;
    step_ = clamp(march.gap_below * per_gap, LODEN_LONGEST * stretch.step_, LODEN_SHORTEST * stretch.step_);
    march.found = march.gap_below >= -LODEN_TOUCHING * range;
    samples = march.found || march.below <= bottom ? 0.0 : samples - 1.0;
  } while (samples > 0.0);
  return march;
}

// By how much the height field rises above a straight ray at most, above z = `lowest`; negative where the ray
// clears it. Of samples up to the first that is `enough` above.
float loden_height_field_rise(LodenViewRay ray, float lowest, float enough, LodenEffort effort) {
  LodenStretch stretch = loden_marched_stretch(ray, lowest, effort);
  float z = stretch.top, samples = stretch.samples, rise = LODEN_NONE;
  do {
    z += stretch.step_;
    rise = max(rise, loden_height_at(ray.x + ray.slope * z) - z);
    samples = rise >= enough ? 0.0 : samples - 1.0;
  } while (samples > 0.0);
  return rise;
}

// z at which the straight ray meets the bilinear patch that it is over at z, or its extension: along the ray
// that patch is a quadratic.
float loden_meet_height(LodenViewRay ray, float z) {
  float n = loden_material.geometry_side;
  vec2 texel = (ray.x + ray.slope * z) * n - 0.5, base = floor(texel), ab = texel - base;
  LODEN_COUNT(LODEN_UNIT_GEOMETRY, 1);
  vec4 h = (textureGather(loden_height, (base + 1.0) / n, 0).wzxy - 1.0) * loden_material.geometry_range.z;
  vec2 d = ray.slope * n;
  float e = h.y - h.x, f = h.z - h.x, g = h.w - h.z - e;
  float c0 = h.x + e * ab.x + f * ab.y + g * ab.x * ab.y - z;
  float c1 = e * d.x + f * d.y + g * (ab.x * d.y + ab.y * d.x) - 1.0;
  float c2 = g * d.x * d.y;
  float t = 2.0 * c0 / max(-c1 + sqrt(max(c1 * c1 - 4.0 * c2 * c0, 0.0)), 1e-6);
  float reach = LODEN_REACH / max(max(abs(d.x), abs(d.y)), 1e-3);
  return c1 > -0.02 ? z : z + clamp(t, -reach, reach);  // climbing with the ray: it is not met from above
}

LodenVdimHit loden_height_lookup(LodenViewRay ray, vec2 x, LodenEffort effort) {
  LodenMarch march = loden_march(ray, effort);
  float share = march.gap_above / min(march.gap_above - march.gap_below, -1e-9);
  float z = loden_meet_height(ray, march.found ? mix(march.above, march.below, share) : march.below);
  vec2 offset = ray.slope * z;
  LodenVdimHit hit = {ray.x + offset + floor(x), offset, z, z, march.found, false};
  return hit;
}
#endif

// By depths of the atlas, to a hit on the geometry image.
LodenVdimHit loden_patch_lookup(LodenViewRay ray, vec2 x, LodenEffort effort) {
  float range = loden_material.geometry_range.z;
  LodenRayPath path = loden_ray_path(ray, range);
  int layers = effort.layers;
  LodenVisit found;
  int each = ray.bent ? LODEN_BENT_EACH : LODEN_EACH;
  // Anchor by anchor along the ray; the first patch that is met wins.
  int anchor = 0;
#ifdef LODEN_FOLLOW_SURFACE
  do
#endif
  {
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
    // nearest to the viewer down.
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
    if (anchor == 0) {
      found.p = p;
      found.h = h;
      found.miss = 1e8;
    }
    int left = effort.visits, again = each;
    bool folded = false;
    vec2 last = vec2(0.0);  // step
    do {
      LodenVisit visit = loden_visit(ray, h, p);
      bool nearer = visit.miss < found.miss;
      found.p = nearer ? visit.p : found.p;
      found.h = nearer ? visit.h : found.h;
      found.miss = min(visit.miss, found.miss);
      // The blended depth's search goes on, once, from a patch that faces away, and then by steps that are
      // half as long where they lead back over the fold.
      bool away = visit.miss > LODEN_ABSENT;
      again = away && (folded || below < 1.0) ? 0 : again - 1;
      folded = folded || away;
      vec2 step_ = visit.p - p;
      last = step_ * (folded && dot(step_, last) < -LODEN_BACK * dot(last, last) ? 0.5 : 1.0);
      p = p + last;
      h = visit.h;
      float next = loden_highest_below(depths, layers, below);
      left = found.miss <= effort.inside || (again == 0 && next < LODEN_NONE) ? 0 : left - 1;
      if (again == 0) {
        h = next;
        below = next - LODEN_SEPARATION * depth;
        p = loden_parameter_near(ray.x + loden_ray_offset(ray, h), loden_ray_z(ray, h));
        again = each;
        folded = false;
        last = vec2(0.0);
      }
    } while (left > 0);
    ++anchor;
  }
#ifdef LODEN_FOLLOW_SURFACE
  while (ray.bent && found.miss > effort.inside && anchor < path.anchors);
#endif
  LodenVdimHit hit;
  hit.converged = found.miss <= effort.inside;
  hit.missed = !hit.converged && path.anchors > 1 && -0.5 / max(ray.bend, 1e-6) > -LODEN_SHALLOW * range;
  hit.p = found.p + floor(x);
  hit.offset = loden_ray_offset(ray, found.h);
  hit.height = found.h;
  hit.z = loden_ray_z(ray, found.h);
  return hit;
}

LodenVdimHit loden_atlas_lookup(LodenPoint m, vec2 x, vec3 wo, LodenEffort effort) {
  LodenViewRay ray = loden_view_ray(m, x, wo);
#ifdef LODEN_HEIGHT_FIELD
  if (!ray.bent) return loden_height_lookup(ray, x, effort);
#endif
  return loden_patch_lookup(ray, x, effort);
}

// `lambda` is the level of detail at which what is found will be shown: it need not be closer than that.
LodenVdimHit loden_vdim_lookup(LodenPoint m, vec2 x, float lambda, vec3 wo) {
  return loden_atlas_lookup(m, x, wo, loden_effort_over(LODEN_EFFORT, lambda));
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
