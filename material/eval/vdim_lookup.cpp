// The lookups. Those of the atlas and of the published map are mirrored name for name by
// shaders/loden_vdim.glsl; keep the order of operations.

#include <algorithm>
#include <array>
#include <cmath>

#include "material/model/vdim.h"

namespace loden {
namespace {

constexpr float kInside = 0.1f;        // texels beyond a patch at which its extension still counts
constexpr float kInsideShare = 0.05f;  // of the footprint: the same
constexpr float kInsideMost = 0.5f;    // the same, at most
constexpr float kStepShare = 0.25f;    // of the footprint: steps of the march
constexpr float kReach = 3;            // texels that one visit of a patch may move by
constexpr float kBentResidual = 0.1f;  // texels between surface and bent ray at which they meet
constexpr int kEach = 6;               // visits for each candidate depth
constexpr int kBentEach = 6;           // the same of a bent ray, whose direction changes on the way
// Depths are 8-bit codes, so thresholds lie between codes: rounding cannot tip a comparison.
constexpr float kCluster = 20.5f / 255.0f;    // of the depth range: entries this close are one surface
constexpr float kSeparation = 1.5f / 255.0f;  // of the depth range: closer candidates are one candidate
constexpr float kMargin = 15.5f / 255.0f;  // of the depth range: how far off neighbouring entries bound a hit
constexpr float kTouching = 1e-5f;         // of the depth range: rounding, where a sample is on the surface
constexpr float kNone = -1e8f;             // below every depth
constexpr int kAnchors = 6;                // along a bent ray
constexpr float kStraight =
    0.2f;  // share by which a ray's descent may change on its way down: one anchor will do
constexpr float kLeastDescent = 0.02f;  // of the straight line that stands for a ray where it turns
constexpr float kShallow = 0.5f;  // of the depth range: rays that turn below it are not taken to leave again

// What a lookup spends. Lengths are in texels of the geometry image.
template <class T>
struct Effort {
  int layers;  // directions of the atlas whose depths are read
  int visits;  // of patches, at most
  T step;      // of the march, along the plane
  T samples;   // of the march, at most
  T inside;    // beyond a patch, at which its extension still counts as the surface
};
// Of an answer that is shown over a footprint of so many texels, which hides what is finer.
template <class T>
Effort<T> effortOf(Lookup lookup, T footprint) {
  const bool coarse = footprint > T(kCoarseFootprint), fast = lookup == Lookup::kFast && !coarse;
  const bool one_direction = fast || coarse;
  return {one_direction ? 1 : 3, one_direction ? 18 : 36,
          std::max(T(fast ? 2 : 1), T(kStepShare) * footprint), T(fast ? 16 : 32),
          std::clamp(T(kInsideShare) * footprint, T(kInside), T(kInsideMost))};
}

// A view ray in the tile's own coordinates, in which a curved reference surface is flat and the ray is bent.
// Where the ray is h below the tangent plane at x and z below a surface of curvature K, it is (I - z K) h
// slope from x along the plane, and z = h + bend h^2 / 2. A ray that goes by a convex surface turns at h = -1
// / bend and leaves again.
template <class T>
struct ViewRay {
  glm::vec<2, T> x;      // in [0, 1)^2
  glm::vec<2, T> slope;  // wo.xy / wo.z, tile periods per tile length
  glm::vec<2, T> turn;   // K slope, likewise
  T bend;                // slope^T K slope
  bool bent;

  T z(T h) const { return h + T(0.5) * bend * h * h; }
  // h on the way down to z; of its turning point if it never gets there.
  T height(T z) const { return T(2) * z / (T(1) + std::sqrt(std::max(T(1) + T(2) * bend * z, T(0)))); }
  // From x to there.
  glm::vec<2, T> offset(T h) const { return (slope - z(h) * turn) * h; }
  // Growth with h: of z, and of the offset.
  T descent(T h) const { return T(1) + bend * h; }
  bool onItsWayOut(T h) const { return descent(h) < 0; }
  glm::vec<2, T> drift(T h) const { return slope - (z(h) + descent(h) * h) * turn; }
};

template <class T>
ViewRay<T> viewRay(const LocalSurface<T>& surface, glm::vec<2, T> x, const glm::vec<3, T>& wo) {
  const T cosine = std::max(wo.z, T(std::cos(kThetaMax)));
  const T sine = std::sqrt(wo.x * wo.x + wo.y * wo.y);
  const T scale = std::min(T(1), T(std::sin(kThetaMax)) / std::max(sine, T(1e-6)));
  const glm::vec<2, T> slope = glm::vec<2, T>(wo.x, wo.y) * (scale / cosine);
  const glm::vec<2, T> turn = surface.curvature * slope;
  return {x - glm::floor(x), surface.x_from_tangent * slope, surface.x_from_tangent * turn,
          glm::dot(slope, turn), surface.curvature != glm::mat<2, 2, T>(0)};
}

// A straight ray that stands for a bent one: at height z it is at x, and level with the bent one's point at
// h.
template <class T>
struct StraightRay {
  glm::vec<2, T> x, slope;
  T z = 0, h = 0, h_per_z = 1;
};

// Through the ray's point at h and in its direction, but for how fast it goes down.
template <class T>
StraightRay<T> straightAt(const ViewRay<T>& ray, T h, T descent) {
  return {ray.x + ray.offset(h), ray.drift(h) / descent, ray.z(h), h, T(1) / descent};
}

// The tangent, or nearly so where the ray turns.
template <class T>
StraightRay<T> tangentRay(const ViewRay<T>& ray, T h) {
  if (!ray.bent) return {ray.x, ray.slope};
  const T descent = ray.descent(h);
  return straightAt(
      ray, h,
      ray.onItsWayOut(h) ? std::min(descent, T(-kLeastDescent)) : std::max(descent, T(kLeastDescent)));
}

// The anchors along a ray over a convex surface: points, evenly spaced from x on, for which the atlas is
// read. Elsewhere x alone.
template <class T>
struct RayPath {
  T end;  // h where the ray is below the tile, or above it again
  int anchors;
};
template <class T>
RayPath<T> rayPath(const ViewRay<T>& ray, T range) {
  if (!ray.bent) return {-range, 1};
  const T end = T(2) * ray.bend * range < T(1) ? ray.height(-range) : T(-2) / ray.bend;
  return {end, ray.bend * end > T(-kStraight) ? 1 : kAnchors};
}

// What stands for the ray in the atlas. One anchor: its chord down to half the depth range. Several: from
// each the tangent, but no more grazing than the atlas's views. That is below the ray, and what it meets not
// behind what the ray meets.
template <class T>
StraightRay<T> seedRay(const ViewRay<T>& ray, const RayPath<T>& path, T range, int anchor) {
  if (path.anchors == 1) {
    const T z = std::max(T(-0.5) * range, T(-0.45) / std::max(ray.bend, T(1e-6)));
    return {ray.x, z < 0 ? ray.offset(ray.height(z)) / z : ray.slope};
  }
  const T h = path.end * (T(anchor) / T(kAnchors));
  const glm::vec<2, T> drift = ray.drift(h);
  return straightAt(ray, h,
                    std::max(ray.descent(h), std::sqrt(glm::dot(drift, drift)) *
                                                 T(std::cos(kThetaMax) / std::sin(kThetaMax))));
}

// h of the ray where its straight ray is at the depth z.
template <class T>
T seedHeight(const ViewRay<T>& ray, const RayPath<T>& path, const StraightRay<T>& line, T z) {
  if (!ray.bent) return z;
  return path.anchors == 1 ? ray.height(z) : std::clamp(line.h + line.h_per_z * (z - line.z), path.end, T(0));
}

template <class T>
glm::vec<3, T> viewAlong(glm::vec<2, T> slope) {
  return glm::vec<3, T>(slope, T(1)) / std::sqrt(T(1) + glm::dot(slope, slope));
}

// The layers of the atlas nearest to the view: its own cell, the neighbour across the nearer border and the
// one across the other, with their weights in a bilinear blend whose fourth term the two neighbours share.
template <class T>
struct NearestLayers {
  int index[3] = {0, 0, 0};
  T weight[3] = {1, 0, 0};
};
template <class T>
NearestLayers<T> nearestLayers(int directions, glm::vec<2, T> square) {
  using V2 = glm::vec<2, T>;
  const V2 grid = square * T(directions), limit(T(directions) - 1);
  const V2 cell = glm::clamp(glm::floor(grid), V2(0), limit);
  const V2 off = grid - cell - T(0.5);
  const V2 beside = glm::clamp(cell + V2(off.x > 0 ? 1 : -1, off.y > 0 ? 1 : -1), V2(0), limit);
  const bool x_first = std::abs(off.x) > std::abs(off.y);
  const V2 first = x_first ? V2(beside.x, cell.y) : V2(cell.x, beside.y);
  const V2 second = x_first ? V2(cell.x, beside.y) : V2(beside.x, cell.y);
  const T a = std::min(std::max(std::abs(off.x), std::abs(off.y)), T(0.5));
  const T b = std::min(std::min(std::abs(off.x), std::abs(off.y)), T(0.5));
  const auto layer = [&](V2 at) { return static_cast<int>(at.y) * directions + static_cast<int>(at.x); };
  const T shared = T(0.5) * a * b;
  return {{layer(cell), layer(first), layer(second)}, {(1 - a) * (1 - b), a - shared, b - shared}};
}

// z of the four entries around x in one layer: texels (0,0), (1,0), (0,1), (1,1) from the lower left one.
template <class T>
glm::vec<4, T> gatherDepths(const VdimAtlas& atlas, int layer, glm::vec<2, T> x) {
  const int n = atlas.size.texels;
  const int i = static_cast<int>(std::floor(x.x * T(n) - T(0.5))),
            j = static_cast<int>(std::floor(x.y * T(n) - T(0.5)));
  const auto* codes =
      reinterpret_cast<const uint8_t*>(atlas.depth.data.data()) + static_cast<size_t>(layer) * n * n;
  const auto z = [&](int ci, int cj) {
    const T code = T(codes[((cj + n) % n) * n + (ci + n) % n]) / T(255);
    return (code - T(1)) * T(atlas.geometry.range.z);
  };
  return {z(i, j), z(i + 1, j), z(i, j + 1), z(i + 1, j + 1)};
}

// Parameter of the surface near the point x + slope z.
template <class T>
glm::vec<2, T> parameterNear(const VdimAtlas& atlas, glm::vec<2, T> point, T z) {
  if (atlas.volume.empty()) return point;
  const Texture& v = atlas.volume;
  const glm::vec<2, T> wrapped = point - glm::floor(point);
  const T slice = std::clamp(z / -T(atlas.geometry.range.z) * T(v.depth), T(0), T(v.depth) - T(0.5));
  const glm::vec4 d =
      fetchTexel(v, 0, std::min(static_cast<int>(wrapped.x * T(v.width)), v.width - 1),
                 std::min(static_cast<int>(wrapped.y * T(v.height)), v.height - 1), static_cast<int>(slice));
  return point + glm::vec<2, T>(T(d.x), T(d.y)) * T(0.5);
}

template <class T>
T cross(glm::vec<2, T> a, glm::vec<2, T> b) {
  return a.x * b.y - a.y * b.x;
}

// What visiting a patch has found: where the ray meets it or its extension.
template <class T>
struct Visit {
  glm::vec<2, T> p;  // of any copy
  T h;               // of the ray
  T miss;  // by how many texels the ray fails to meet the patch; kAbsent where there is none, kAway where no
           // side of it faces the ray
};
constexpr float kAbsent = 1e9f, kAway = 2e9f;

// Visits the patch in which p lies, on behalf of the ray at h. Seen along the ray the patch is Q(a, b) = P.xy
// - slope P.z - x = q00 + q10 a + q01 b + q11 a b, and Q = 0 is wanted. Along the line of all b the vectors
// q00 + q10 a and q01 + q11 a are parallel, which is a quadratic in a; its growth at a root is det Q', which
// has the sign of N.wo. So the root where it grows is that of the side that faces the viewer.
template <class T>
Visit<T> visitPatch(const PackedGeometry& geometry, const ViewRay<T>& ray, T h, glm::vec<2, T> p) {
  using V2 = glm::vec<2, T>;
  const T n = T(geometry.side());
  const V2 texel = p * n - T(0.5), base = glm::floor(texel), ab = texel - base;
  const Patch<T> patch = fetchPatch<T>(geometry, static_cast<int>(base.x), static_cast<int>(base.y));
  const StraightRay<T> line = tangentRay(ray, h);
  const auto shear = [&](const glm::vec<3, T>& at, V2 shift) {
    return V2(at.x, at.y) + shift - line.slope * (at.z - line.z) - line.x;
  };
  const V2 shift = glm::floor(ray.x + ray.offset(h) - V2(patch.p00.x, patch.p00.y) + T(0.5));
  const V2 q00 = shear(patch.p00, shift), q10 = shear(patch.p10, shift) - q00,
           q01 = shear(patch.p01, shift) - q00, q11 = shear(patch.p11, shift) - q00 - q10 - q01;
  const T side = ray.bent && ray.onItsWayOut(h) ? T(-1) : T(1);
  const T c2 = side * cross(q10, q11), c1 = side * (cross(q10, q01) + cross(q00, q11)),
          c0 = side * cross(q00, q01);
  const T square = c1 * c1 - T(4) * c2 * c0, root = std::sqrt(std::max(square, T(0)));
  T a = c1 > 0 ? T(-2) * c0 / (c1 + root) : (root - c1) / (std::abs(c2) > T(1e-20) ? T(2) * c2 : T(1e-20));
  const bool faces = c1 > 0 || (square > 0 && std::abs(a - ab.x) < T(kReach));
  a = std::clamp(a, ab.x - T(kReach), ab.x + T(kReach));
  const V2 from = q00 + q10 * a, along = q01 + q11 * a;
  T b = -glm::dot(from, along) / std::max(glm::dot(along, along), T(1e-20));
  b = std::clamp(b, ab.y - T(kReach), ab.y + T(kReach));
  const V2 q = from + along * b;
  const T z = glm::mix(glm::mix(patch.p00.z, patch.p10.z, a), glm::mix(patch.p01.z, patch.p11.z, a), b);
  T residual = std::max(std::abs(q.x), std::abs(q.y)) * n;
  Visit<T> visit{(base + V2(a, b) + T(0.5)) / n + shift, z, faces ? T(kAbsent) : T(kAway)};
  if (ray.bent) {
    // On to the point of the ray that is nearest along it, and how far that is off across it.
    using V3 = glm::vec<3, T>;
    const V2 point = q + line.x + line.slope * (z - line.z) - ray.x;
    const V3 ahead(ray.drift(h), ray.descent(h)), on(point - ray.offset(h), z - ray.z(h));
    visit.h = patch.chart != 0 ? std::min(h + glm::dot(on, ahead) / glm::dot(ahead, ahead), T(0)) : h;
    const V3 beside(point - ray.offset(visit.h), z - ray.z(visit.h));
    residual = std::sqrt(glm::dot(beside, beside)) * n * T(kInside / kBentResidual);
  }
  const V2 centred = glm::abs(V2(a, b) - T(0.5));
  if (faces && patch.chart != 0) visit.miss = std::max(std::max(centred.x, centred.y) - T(0.5), residual);
  return visit;
}

// The depths that a lookup has gathered, as h of the ray.
template <class T>
struct Depths {
  glm::vec<4, T> layer[3];
  int layers;
};

// Highest of them below one; below kNone if there is none.
template <class T>
T highestBelow(const Depths<T>& depths, T below) {
  T z = T(-1e9);
  for (int l = 0; l < depths.layers; ++l)
    for (int k = 0; k < 4; ++k) z = depths.layer[l][k] < below ? std::max(z, depths.layer[l][k]) : z;
  return z;
}

// Mean of the depths at or above `low`, each with its weight: where the topmost surface at x is.
template <class T>
T clusterMean(const Depths<T>& depths, T low, glm::vec<2, T> f, const T (&layer_weight)[3]) {
  using V4 = glm::vec<4, T>;
  constexpr float kFloor = 0.02f;  // so that a lone entry with weight 0 still counts
  const V4 spatial = V4((1 - f.x) * (1 - f.y), f.x * (1 - f.y), (1 - f.x) * f.y, f.x * f.y) + T(kFloor);
  T weight = 0, sum = 0;
  for (int l = 0; l < depths.layers; ++l)
    for (int k = 0; k < 4; ++k) {
      const T w = depths.layer[l][k] >= low ? spatial[k] * layer_weight[l] : T(0);
      weight += w;
      sum += depths.layer[l][k] * w;
    }
  return sum / std::max(weight, T(1e-9));
}

template <class T>
T heightAt(const PackedGeometry& geometry, glm::vec<2, T> x) {
  const glm::vec<2, T> texel = x * T(geometry.side()) - T(0.5), base = glm::floor(texel), ab = texel - base;
  const Patch<T> patch = fetchPatch<T>(geometry, static_cast<int>(base.x), static_cast<int>(base.y));
  return glm::mix(glm::mix(patch.p00.z, patch.p10.z, ab.x), glm::mix(patch.p01.z, patch.p11.z, ab.x), ab.y);
}

// A march down a straight ray: the last sample above the height field and the first below it.
template <class T>
struct March {
  T above, below;          // z
  T gap_above, gap_below;  // heights of the surface over them; of the first sample a little below 0
  bool found;              // false: none is below, and all of this is of the two lowest
  int fetches;
};

// The part of a straight ray that is marched: between the bounds that depths of the nearest directions set,
// and not below `lowest`.
template <class T>
struct Stretch {
  T top, step, samples;  // z; step <= 0
};
template <class T>
Stretch<T> marchedStretch(const VdimAtlas& atlas, const ViewRay<T>& ray, T lowest, const Effort<T>& effort) {
  const T range = T(atlas.geometry.range.z);
  const NearestLayers<T> nearest =
      nearestLayers(atlas.size.directions, vdimSquareFromView(viewAlong(ray.slope)));
  T high = -range, low = 0;
  for (int l = 0; l < effort.layers; ++l) {
    const glm::vec<4, T> z = gatherDepths(atlas, nearest.index[l], ray.x);
    high = std::max({high, z.x, z.y, z.z, z.w});
    low = std::min({low, z.x, z.y, z.z, z.w});
  }
  lowest = std::max(lowest, -range);
  const T top = std::clamp(high + T(kMargin) * range, lowest, T(0));
  const T bottom = std::max(low - T(kMargin) * range, lowest);
  const T travel = (top - bottom) * std::sqrt(glm::dot(ray.slope, ray.slope)) * T(atlas.geometry.side());
  const T samples = std::clamp(std::ceil(travel / effort.step), T(2), effort.samples);
  return {top, std::min(bottom - top, T(0)) / samples, samples};
}

template <class T>
March<T> marchDown(const VdimAtlas& atlas, const ViewRay<T>& ray, const Effort<T>& effort) {
  const T range = T(atlas.geometry.range.z);
  const Stretch<T> stretch = marchedStretch(atlas, ray, T(kNone), effort);
  T samples = stretch.samples;
  March<T> march{stretch.top, stretch.top, T(0), T(-1e-4) * range, false, effort.layers};
  do {
    march.above = march.below, march.gap_above = march.gap_below;
    march.below += stretch.step;
    march.gap_below = heightAt(atlas.geometry, ray.x + ray.slope * march.below) - march.below;
    ++march.fetches;
    march.found = march.gap_below >= T(-kTouching) * range;
    samples = march.found ? T(0) : samples - T(1);
  } while (samples > 0);
  return march;
}

// z at which the straight ray meets the bilinear patch that it is over at z, or its extension: along the ray
// that patch is a quadratic.
template <class T>
T meetHeight(const PackedGeometry& geometry, const ViewRay<T>& ray, T z) {
  using V2 = glm::vec<2, T>;
  const T n = T(geometry.side());
  const V2 texel = (ray.x + ray.slope * z) * n - T(0.5), base = glm::floor(texel), ab = texel - base;
  const Patch<T> patch = fetchPatch<T>(geometry, static_cast<int>(base.x), static_cast<int>(base.y));
  const V2 d = ray.slope * n;
  const T e = patch.p10.z - patch.p00.z, f = patch.p01.z - patch.p00.z, g = patch.p11.z - patch.p01.z - e;
  const T c0 = patch.p00.z + e * ab.x + f * ab.y + g * ab.x * ab.y - z;
  const T c1 = e * d.x + f * d.y + g * (ab.x * d.y + ab.y * d.x) - T(1);
  const T c2 = g * d.x * d.y;
  const T t = T(2) * c0 / std::max(-c1 + std::sqrt(std::max(c1 * c1 - T(4) * c2 * c0, T(0))), T(1e-6));
  const T reach = T(kReach) / std::max(std::max(std::abs(d.x), std::abs(d.y)), T(1e-3));
  return c1 > T(-0.02) ? z : z + std::clamp(t, -reach, reach);  // climbing: it is not met from above
}

template <class T>
VdimHit<T> heightLookup(const VdimAtlas& atlas, const ViewRay<T>& ray, glm::vec<2, T> x,
                        const Effort<T>& effort) {
  const March<T> march = marchDown(atlas, ray, effort);
  const T share = march.gap_above / std::min(march.gap_above - march.gap_below, T(-1e-9));
  VdimHit<T> hit;
  hit.height =
      meetHeight(atlas.geometry, ray, march.found ? glm::mix(march.above, march.below, share) : march.below);
  hit.fetches = march.fetches + 1;
  hit.converged = march.found;
  hit.offset = ray.slope * hit.height;
  hit.p = ray.x + hit.offset + glm::floor(x);
  hit.position = glm::vec<3, T>(hit.p, hit.height);
  return hit;
}

// By depths of the atlas, to a hit on the geometry image.
template <class T>
VdimHit<T> patchLookup(const VdimAtlas& atlas, const ViewRay<T>& ray, glm::vec<2, T> x,
                       const Effort<T>& effort) {
  const T range = T(atlas.geometry.range.z);
  const RayPath<T> path = rayPath(ray, range);
  VdimHit<T> hit;
  const auto parameter = [&](T h) {
    hit.fetches += atlas.volume.empty() ? 0 : 1;
    return parameterNear(atlas, ray.x + ray.offset(h), ray.z(h));
  };
  Visit<T> found{};
  const int each = ray.bent ? kBentEach : kEach;
  // Anchor by anchor along the ray; the first patch that is met wins.
  int anchor = 0;
  do {
    const StraightRay<T> line = seedRay(ray, path, range, anchor);
    const NearestLayers<T> layers =
        nearestLayers(atlas.size.directions, vdimSquareFromView(viewAlong(line.slope)));
    glm::vec<2, T> entry = line.x - line.slope * line.z;  // where it meets the plane
    if (ray.bent) entry -= glm::floor(entry);
    Depths<T> depths{{}, effort.layers};
    for (int l = 0; l < effort.layers; ++l) {
      const glm::vec<4, T> z = gatherDepths(atlas, layers.index[l], entry);
      for (int k = 0; k < 4; ++k) depths.layer[l][k] = seedHeight(ray, path, line, z[k]);
    }
    hit.fetches += effort.layers;
    // First the blended depth of the topmost surface, at the first anchor; then single depths from the one
    // nearest to the viewer down.
    const T top = highestBelow(depths, T(1));
    const T depth = range * line.h_per_z;  // codes are as far apart in h as they are in it
    T h = top, below = top - T(kSeparation) * depth;
    if (anchor == 0) {
      const glm::vec<2, T> f = glm::fract(entry * T(atlas.size.texels) - T(0.5));
      h = clusterMean(depths, top - T(kCluster) * depth, f, layers.weight);
      below = T(1);
    }
    glm::vec<2, T> p = parameter(h);
    // Where no patch faces the ray the blended depth is near.
    if (anchor == 0) found = {p, h, T(1e8)};
    int left = effort.visits, again = each;
    do {
      const Visit<T> visit = visitPatch(atlas.geometry, ray, h, p);
      hit.fetches += 1;  // one gather
      if (visit.miss < found.miss) found = visit;
      again = visit.miss > T(kAbsent) ? 0 : again - 1;
      h = visit.h;
      p = visit.p;
      const T next = highestBelow(depths, below);
      left = found.miss <= effort.inside || (again == 0 && next < T(kNone)) ? 0 : left - 1;
      if (again == 0) {
        h = next;
        below = next - T(kSeparation) * depth;
        p = parameter(h);
        again = each;
      }
    } while (left > 0);
    ++anchor;
  } while (ray.bent && found.miss > effort.inside && anchor < path.anchors);
  const T turning = T(-0.5) / std::max(ray.bend, T(1e-6));
  hit.converged = found.miss <= effort.inside;
  hit.missed = !hit.converged && path.anchors > 1 && turning > T(-kShallow) * range;
  const glm::vec<2, T> base = glm::floor(x);
  hit.p = found.p + base;
  hit.height = found.h;
  hit.offset = ray.offset(hit.height);
  hit.position = glm::vec<3, T>(ray.x + hit.offset + base, ray.z(hit.height));
  return hit;
}

// loden_vdim_lookup of the shaders.
template <class T>
VdimHit<T> atlasLookup(const VdimAtlas& atlas, Lookup lookup, glm::vec<2, T> x, const glm::vec<3, T>& wo,
                       const LocalSurface<T>& surface, T footprint) {
  const ViewRay<T> ray = viewRay(surface, x, wo);
  const Effort<T> effort = effortOf(lookup, footprint * T(atlas.geometry.side()));
  if (atlas.geometry.identity_parameterization && !ray.bent) return heightLookup(atlas, ray, x, effort);
  return patchLookup(atlas, ray, x, effort);
}

// loden_paper_vdim_lookup of the shaders.
template <class T>
VdimHit<T> paperLookup(const PaperVdim& vdim, glm::vec<2, T> x, const glm::vec<3, T>& wo) {
  using V2 = glm::vec<2, T>;
  const V2 base = glm::floor(x);
  const V2 texel = glm::min(glm::floor((x - base) * T(vdim.side)), V2(T(vdim.side) - 1));
  const V2 reference =
      V2(nearestRepeat(vdim.reference, 0, 0, V2((texel + T(0.5)) / T(vdim.side)))) * T(vdim.range.x);
  // Not by acos, which GPUs compute to 1e-4 only: entries of neighbouring views may be whole periods apart.
  const T theta = std::min(std::atan2(std::sqrt(wo.x * wo.x + wo.y * wo.y), wo.z), T(kThetaMax));
  T phi = wo.x == 0 && wo.y == 0 ? T(0) : std::atan2(wo.y, wo.x);
  if (phi < 0) phi += T(2 * kPi);
  const V2 size(T(vdim.azimuths), T(vdim.zeniths));
  // FBTF 3.5 leaves open which alpha and beta keep texels' blocks apart: (n - 1) / n and 1 / (2n), here in
  // texels.
  const V2 within = V2(phi / T(2 * kPi), theta / T(kThetaMax)) * (size - T(1)) + T(0.5);
  const V2 uv = (texel * size + within) / (T(vdim.side) * size);
  const glm::vec<4, T> entry = sampleRepeat(vdim.packed, 0, 0, uv);
  const V2 direction(entry.x, entry.y);
  const T length = std::sqrt(glm::dot(direction, direction));
  VdimHit<T> hit;
  hit.p = x + reference + (length > T(1e-6) ? direction / length : V2(0)) * (entry.z * T(vdim.range.y));
  hit.fetches = 2;
  return hit;
}

template <class T>
VdimHit<T> tracedLookup(const GeometryTracer& tracer, glm::vec<2, T> x, const glm::vec<3, T>& wo,
                        const LocalSurface<T>& surface) {
  const ViewRay<T> ray = viewRay({glm::mat<2, 2, T>(0), surface.x_from_tangent}, x, wo);
  const glm::vec<2, T> base = glm::floor(x);
  VdimHit<T> hit;
  hit.p = x, hit.position = {x, T(0)};
  // Where texture coordinates are stretched the ray is that of an unstretched tile.
  const glm::vec<2, T> slope = ray.slope / glm::vec<2, T>(periodsPerLength(tracer.aspect()));
  const auto found = tracer.traceView(glm::dvec2(ray.x), glm::dvec3(viewAlong(slope)));
  if (!found) return hit;
  hit.converged = true;
  hit.height = T(found->position.z);
  hit.offset = ray.offset(hit.height);
  hit.position = glm::vec<3, T>(ray.x + hit.offset + base, hit.height);
  hit.p = glm::vec<2, T>(found->p) + base;
  return hit;
}

}  // namespace

template <class T>
T heightFieldRise(const VdimAtlas& atlas, Lookup lookup, glm::vec<2, T> x, const glm::vec<3, T>& wo,
                  const LocalSurface<T>& surface, T lowest, T enough, T footprint, int* fetches) {
  const Effort<T> effort = effortOf(lookup, footprint * T(atlas.geometry.side()));
  const ViewRay<T> ray = viewRay(surface, x, wo);
  const Stretch<T> stretch = marchedStretch(atlas, ray, lowest, effort);
  T z = stretch.top, samples = stretch.samples, rise = T(kNone);
  int count = effort.layers;
  do {
    z += stretch.step;
    rise = std::max(rise, heightAt(atlas.geometry, ray.x + ray.slope * z) - z);
    ++count;
    samples = rise >= enough ? T(0) : samples - T(1);
  } while (samples > 0);
  if (fetches) *fetches += count;
  return rise;
}

std::string_view lookupName(Lookup lookup) {
  switch (lookup) {
    case Lookup::kNone:
      return "none";
    case Lookup::kPaper:
      return "paper";
    case Lookup::kFast:
      return "fast";
    case Lookup::kDefault:
      return "default";
    case Lookup::kQuality:
      return "quality";
  }
  return "unknown";
}

std::optional<Lookup> lookupNamed(std::string_view name) {
  for (const Lookup lookup : kLookups)
    if (lookupName(lookup) == name) return lookup;
  return std::nullopt;
}

bool VdimMaps::serve(Lookup lookup) const {
  switch (lookup) {
    case Lookup::kNone:
      return false;
    case Lookup::kPaper:
      return paper != nullptr;
    case Lookup::kFast:
    case Lookup::kDefault:
      return atlas != nullptr;
    case Lookup::kQuality:
      return tracer != nullptr;
  }
  return false;
}

float VdimMaps::aspect() const {
  if (atlas) return atlas->geometry.aspect;
  return tracer ? tracer->aspect() : 1.0f;
}

template <class T>
VdimHit<T> vdimLookup(const VdimMaps& maps, Lookup lookup, glm::vec<2, T> x, const glm::vec<3, T>& wo) {
  return vdimLookup(maps, lookup, x, wo, LocalSurface<T>::flat(maps.aspect()));
}

template <class T>
VdimHit<T> vdimLookup(const VdimMaps& maps, Lookup lookup, glm::vec<2, T> x, const glm::vec<3, T>& wo,
                      const LocalSurface<T>& surface, T footprint) {
  if (maps.serve(lookup)) switch (lookup) {
      case Lookup::kNone:
        break;
      case Lookup::kPaper:
        return paperLookup(*maps.paper, x, wo);
      case Lookup::kFast:
      case Lookup::kDefault:
        return atlasLookup(*maps.atlas, lookup, x, wo, surface, footprint);
      case Lookup::kQuality:
        return tracedLookup(*maps.tracer, x, wo, surface);
    }
  VdimHit<T> hit;
  hit.p = x, hit.position = {x, T(0)};
  return hit;
}

template float heightFieldRise(const VdimAtlas&, Lookup, glm::vec<2, float>, const glm::vec<3, float>&,
                               const LocalSurface<float>&, float, float, float, int*);
template double heightFieldRise(const VdimAtlas&, Lookup, glm::vec<2, double>, const glm::vec<3, double>&,
                                const LocalSurface<double>&, double, double, double, int*);
template VdimHit<float> vdimLookup(const VdimMaps&, Lookup, glm::vec<2, float>, const glm::vec<3, float>&,
                                   const LocalSurface<float>&, float);
template VdimHit<double> vdimLookup(const VdimMaps&, Lookup, glm::vec<2, double>, const glm::vec<3, double>&,
                                    const LocalSurface<double>&, double);
template VdimHit<float> vdimLookup(const VdimMaps&, Lookup, glm::vec<2, float>, const glm::vec<3, float>&);
template VdimHit<double> vdimLookup(const VdimMaps&, Lookup, glm::vec<2, double>, const glm::vec<3, double>&);

}  // namespace loden
