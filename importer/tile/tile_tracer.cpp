#include "importer/tile/tile_tracer.h"

#include <embree3/rtcore.h>
#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "importer/tile/textured_brdf.h"
#include "material/base/check.h"
#include "material/model/directions.h"

namespace loden::importer {
namespace {

constexpr double kLift = 1e-5;  // of ray origins off the surface, tile periods; 40 times the float rounding
constexpr double kOverlap = 1e-5;      // of two consecutive segments of a long ray, tile periods
constexpr double kStartHeight = 1e-3;  // of view rays above z = 0, tile periods
constexpr double kSlack = 1e-4;        // of the slab, so that surfaces in its planes are met; tile periods
constexpr size_t kStream = 64;         // rays that Embree is handed at once
constexpr double kAside = 2e-6;     // of a ray that is tried again, tile periods; 20 times the float rounding
constexpr int kMaxSegments = 4096;  // of one ray; bounds nearly horizontal ones
constexpr size_t kMaxCopies = 2'000'000;  // triangles in the scene, if the tile itself has fewer

// Memory is what Embree is expected to lack at times; callers treat that as any other allocation. Null: what
// kept a device from being made.
void throwIfFailed(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE)
    throw std::runtime_error("Embree fails with error " + std::to_string(error) +
                             (error == RTC_ERROR_UNSUPPORTED_CPU ? ", a processor without AVX2" : ""));
}

struct Device {
  RTCDevice device = rtcNewDevice("threads=1,isa=avx2");
  Device() {
    if (!device) throwIfFailed(nullptr);
  }
  ~Device() { rtcReleaseDevice(device); }
};

RTCDevice sharedDevice() {
  static const Device device;
  LODEN_CHECK(device.device != nullptr);
  return device.device;
}

// How far beyond [0,1]^2 the scene repeats the tile: a full period where that is affordable, so that nearly
// all rays end in their first segment.
double marginFor(size_t triangles) {
  const double periods = std::sqrt(double(kMaxCopies) / double(triangles));
  return std::clamp((periods - 1) / 2, 0.1, 1.0);
}

RTCRay makeRay(const glm::vec3& origin, const glm::vec3& direction, float length) {
  RTCRay ray{};
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tfar = length;
  ray.mask = 0xFFFFFFFFu;
  return ray;
}

RTCRayHit makeRayHit(const glm::vec3& origin, const glm::vec3& direction, float length) {
  RTCRayHit ray{};
  ray.ray = makeRay(origin, direction, length);
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

RTCIntersectContext contextWith(RTCIntersectContextFlags flags) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

// Where the next segment of a long ray begins.
glm::dvec3 advance(const glm::dvec3& origin, const glm::dvec3& direction, double length) {
  return origin + direction * std::max(length - kOverlap, length / 2);
}

}  // namespace

struct TileTracer::Impl {
  struct Copy {
    uint32_t triangle;
    int16_t shift_x, shift_y;  // periods
  };
  Tile tile;
  glm::dvec3 per_length;  // of the tile
  RTCScene scene = nullptr;
  std::vector<Copy> copies;  // per primitive of the scene
  double margin = 1, z_min = 0;

  explicit Impl(const Tile& source) : tile(source), per_length(source.perLength()) { build(); }
  ~Impl() { rtcReleaseScene(scene); }

  void build();
  // The part of a ray inside the box that the scene covers.
  struct Segment {
    glm::dvec3 origin;  // x and y in [0, 1)
    glm::ivec2 period;  // taken off
    double length;      // tile periods
    bool last;          // the ray leaves the tile's slab within it
  };
  std::optional<Segment> segment(const glm::dvec3& origin, const glm::dvec3& direction) const;
  bool blocked(glm::dvec3 origin, const glm::dvec3& direction_of_lengths) const;
  std::optional<TileHit> firstHit(const glm::dvec3& origin, const glm::dvec3& direction) const;
  TileHit pointOn(uint32_t triangle, glm::dvec2 b) const;
  // What the whole ray from origin has met within one of its segments; `direction` is that of lengths.
  TileHit hitOf(const RTCHit& met, const Segment& part, const glm::dvec3& origin,
                const glm::dvec3& direction) const;
};

void TileTracer::Impl::build() {
  LODEN_CHECK(!tile.triangles.empty());
  glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
  for (const glm::dvec3& p : tile.positions) low = glm::min(low, p), high = glm::max(high, p);
  z_min = std::min(low.z, -1e-6);
  margin = marginFor(tile.triangles.size());

  std::vector<glm::vec3> vertices;
  std::vector<glm::uvec3> indices;
  const glm::ivec2 first(glm::floor(-margin - glm::dvec2(high))),
      last(glm::ceil(1 + margin - glm::dvec2(low)));
  constexpr uint32_t kUnused = 0xFFFFFFFFu;
  std::vector<uint32_t> vertex_of(tile.positions.size());
  for (int j = first.y; j <= last.y; ++j)
    for (int i = first.x; i <= last.x; ++i) {
      std::fill(vertex_of.begin(), vertex_of.end(), kUnused);
      const glm::dvec3 shift(i, j, 0);
      for (uint32_t t = 0; t < tile.triangles.size(); ++t) {
        const glm::uvec3& triangle = tile.triangles[t];
        glm::dvec2 box_low(1e30), box_high(-1e30);
        for (int k = 0; k < 3; ++k) {
          const glm::dvec2 corner(tile.positions[triangle[k]] + shift);
          box_low = glm::min(box_low, corner), box_high = glm::max(box_high, corner);
        }
        if (box_high.x < -margin || box_high.y < -margin || box_low.x > 1 + margin || box_low.y > 1 + margin)
          continue;
        glm::uvec3 corners;
        for (int k = 0; k < 3; ++k) {
          uint32_t& vertex = vertex_of[triangle[k]];
          if (vertex == kUnused) {
            vertex = static_cast<uint32_t>(vertices.size());
            vertices.emplace_back(tile.positions[triangle[k]] + shift);
          }
          corners[k] = vertex;
        }
        indices.push_back(corners);
        copies.push_back({t, static_cast<int16_t>(i), static_cast<int16_t>(j)});
      }
    }

  RTCGeometry geometry = rtcNewGeometry(sharedDevice(), RTC_GEOMETRY_TYPE_TRIANGLE);
  void* into = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                       sizeof(glm::vec3), vertices.size());
  throwIfFailed(sharedDevice());
  std::copy(vertices.begin(), vertices.end(), static_cast<glm::vec3*>(into));
  into = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3),
                                 indices.size());
  throwIfFailed(sharedDevice());
  std::copy(indices.begin(), indices.end(), static_cast<glm::uvec3*>(into));
  rtcCommitGeometry(geometry);
  scene = rtcNewScene(sharedDevice());
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  throwIfFailed(sharedDevice());
}

std::optional<TileTracer::Impl::Segment> TileTracer::Impl::segment(const glm::dvec3& origin,
                                                                   const glm::dvec3& direction) const {
  const double far = std::numeric_limits<double>::infinity();
  const double slab = direction.z > 0 ? (kSlack - origin.z) / direction.z
                                      : (direction.z < 0 ? (z_min - kSlack - origin.z) / direction.z : far);
  if (slab <= 0) return std::nullopt;
  const glm::dvec2 period = glm::floor(glm::dvec2(origin));
  const glm::dvec2 local = glm::dvec2(origin) - period;
  double exit = far;
  for (int axis = 0; axis < 2; ++axis)
    if (direction[axis] != 0)
      exit = std::min(exit, ((direction[axis] > 0 ? 1 + margin : -margin) - local[axis]) / direction[axis]);
  return Segment{{local, origin.z}, glm::ivec2(period), std::min(slab, exit), slab <= exit};
}

TileTracer::TileTracer(const Tile& tile) : impl_(std::make_unique<Impl>(tile)) {}
TileTracer::~TileTracer() = default;
TileTracer::TileTracer(TileTracer&&) noexcept = default;
const Tile& TileTracer::tile() const {
  return impl_->tile;
}
double TileTracer::zMin() const {
  return impl_->z_min;
}
TileHit TileTracer::pointOn(uint32_t triangle, glm::dvec2 b) const {
  return impl_->pointOn(triangle, b);
}

TileHit TileTracer::Impl::pointOn(uint32_t triangle, glm::dvec2 b) const {
  const glm::uvec3 v = tile.triangles[triangle];
  const double w[3] = {1 - b.x - b.y, b.x, b.y};
  TileHit hit;
  hit.triangle = triangle;
  hit.brdf = {glm::vec3(0), 0, 0};
  for (int k = 0; k < 3; ++k) {
    const LocalBrdf& brdf = tile.brdfs[v[k]];
    hit.position += w[k] * tile.positions[v[k]];
    hit.normal += w[k] * tile.normals[v[k]];
    hit.p += w[k] * tile.params[v[k]];
    hit.brdf.diffuse += float(w[k]) * brdf.diffuse;
    hit.brdf.specular += float(w[k]) * brdf.specular;
    hit.brdf.exponent += float(w[k]) * brdf.exponent;
    hit.brdf.f0 += float(w[k]) * brdf.f0;
    hit.brdf.alpha += float(w[k]) * brdf.alpha;
  }
  if (!tile.texture_points.empty()) [[unlikely]]
    readTextures(tile.materials, tile.texture_points, v, b, hit.brdf);
  hit.normal = glm::normalize(hit.normal);
  const glm::dvec3 face = per_length * glm::cross(tile.positions[v[1]] - tile.positions[v[0]],
                                                  tile.positions[v[2]] - tile.positions[v[0]]);
  hit.geometric_normal = glm::normalize(glm::dot(face, hit.normal) < 0 ? -face : face);
  hit.ray_origin = hit.position + kLift * (hit.geometric_normal * per_length);
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3& normal = tile.normals[v[k]];
    const double below = std::min(0.0, glm::dot((hit.position - tile.positions[v[k]]) / per_length, normal));
    hit.ray_origin -= w[k] * below * (normal * per_length);
  }
  return hit;
}

TileHit TileTracer::Impl::hitOf(const RTCHit& met, const Segment& part, const glm::dvec3& origin,
                                const glm::dvec3& direction) const {
  const Copy& copy = copies[met.primID];
  TileHit hit = pointOn(copy.triangle, {met.u, met.v});
  const glm::dvec2 shift(part.period + glm::ivec2(copy.shift_x, copy.shift_y));
  hit.position += glm::dvec3(shift, 0);
  hit.ray_origin += glm::dvec3(shift, 0);
  hit.p += shift;
  const glm::dvec3 along = direction * per_length;
  hit.t = glm::dot(hit.position - origin, along) / glm::dot(along, along);
  if (glm::dot(hit.geometric_normal, direction) > 0) {  // the back of the surface
    hit.ray_origin = hit.position - kLift * (hit.geometric_normal * per_length);
    hit.geometric_normal = -hit.geometric_normal;
  }
  return hit;
}

std::optional<TileHit> TileTracer::Impl::firstHit(const glm::dvec3& origin,
                                                  const glm::dvec3& direction) const {
  const glm::dvec3 along = direction * per_length;
  glm::dvec3 start = origin;
  for (int k = 0; k < kMaxSegments; ++k) {
    const auto part = segment(start, along);
    if (!part) return std::nullopt;
    RTCRayHit ray = makeRayHit(part->origin, along, float(part->length));
    RTCIntersectContext context = contextWith(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    rtcIntersect1(scene, &context, &ray);
    if (ray.hit.geomID != RTC_INVALID_GEOMETRY_ID) return hitOf(ray.hit, *part, origin, direction);
    if (part->last) return std::nullopt;
    start = advance(start, along, part->length);
  }
  return std::nullopt;
}

namespace {

// Embree's robust mode closes edges, but of rays through a vertex, which each of its triangles may say to
// pass beside it, some 1 in 2,000 go through a surface. Then they go down and meet nothing, or its back.
bool mayHaveLeaked(const std::optional<TileHit>& hit, const glm::dvec3& direction) {
  return hit ? glm::dot(hit->geometric_normal, hit->normal) < 0 : direction.z < 0;
}

}  // namespace

std::optional<TileHit> TileTracer::intersect(const glm::dvec3& origin, const glm::dvec3& direction) const {
  auto hit = impl_->firstHit(origin, direction);
  if (!mayHaveLeaked(hit, direction)) return hit;
  for (const glm::dvec2& aside : {glm::dvec2(1, 0.3), glm::dvec2(-0.3, 1), glm::dvec2(-0.7, -0.6)}) {
    auto again = impl_->firstHit(origin + glm::dvec3(kAside * aside, 0), direction);
    if (again && !mayHaveLeaked(again, direction) && (!hit || again->t < hit->t)) return again;
  }
  return hit;
}

bool TileTracer::Impl::blocked(glm::dvec3 origin, const glm::dvec3& direction_of_lengths) const {
  const glm::dvec3 direction = direction_of_lengths * per_length;
  for (int k = 0; k < kMaxSegments; ++k) {
    const auto part = segment(origin, direction);
    if (!part) return false;
    RTCRay ray = makeRay(part->origin, direction, float(part->length));
    RTCIntersectContext context = contextWith(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    rtcOccluded1(scene, &context, &ray);
    if (ray.tfar < 0) return true;
    if (part->last) return false;
    origin = advance(origin, direction, part->length);
  }
  return false;
}

bool TileTracer::occluded(const glm::dvec3& origin, const glm::dvec3& direction) const {
  return impl_->blocked(origin, direction);
}

// Rays that end inside the covered box go in streams. As incoherent ones, one direction or not: Embree then
// traverses ray by ray with vectors over boxes and triangles, which is 1.5 to 1.7 times as fast as packets of
// eight (`bench_bake`), with the same bits.
void TileTracer::occluded(std::span<const glm::vec3> origins, std::span<const uint8_t> wanted,
                          const glm::vec3& direction_of_lengths, std::span<uint8_t> blocked) const {
  const glm::vec3 direction = direction_of_lengths * glm::vec3(impl_->per_length);
  LODEN_CHECK_EQ(origins.size(), wanted.size());
  LODEN_CHECK_EQ(origins.size(), blocked.size());
  const float low = float(-impl_->margin), high = float(1 + impl_->margin);
  RTCRay rays[kStream];
  size_t index[kStream], count = 0;
  const auto trace = [&] {
    RTCIntersectContext context = contextWith(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
    rtcOccluded1M(impl_->scene, &context, rays, static_cast<unsigned>(count), sizeof(RTCRay));
    for (size_t k = 0; k < count; ++k) blocked[index[k]] = rays[k].tfar < 0;
    count = 0;
  };
  for (size_t i = 0; i < origins.size(); ++i) {
    blocked[i] = 1;
    if (!wanted[i]) continue;
    const glm::vec3 start = origins[i] - glm::vec3(glm::floor(glm::vec2(origins[i])), 0);
    const float length =
        std::max(0.0f, (float(kSlack) - start.z) / direction.z);  // negative would read as blocked
    const glm::vec2 end = glm::vec2(start) + length * glm::vec2(direction);
    if (direction.z <= 0 || std::min(end.x, end.y) < low || std::max(end.x, end.y) > high) {
      blocked[i] = impl_->blocked(glm::dvec3(origins[i]), glm::dvec3(direction_of_lengths));
      continue;
    }
    rays[count] = makeRay(start, direction, length);
    index[count++] = i;
    if (count == kStream) trace();
  }
  if (count > 0) trace();
}

namespace {

// `along` is wo in tile coordinates.
glm::dvec3 startOfView(glm::dvec2 x, const glm::dvec3& along) {
  return glm::dvec3(x, 0) + kStartHeight / along.z * along;
}

}  // namespace

std::optional<TileHit> TileTracer::intersectView(glm::dvec2 x, const glm::dvec3& wo) const {
  auto hit = intersect(startOfView(x, wo * impl_->per_length), -wo);
  if (hit) hit->t -= kStartHeight / wo.z;
  return hit;
}

// First segments in coherent streams, faster than ray by ray and with the same bits but where a ray meets an
// edge; what they leave goes ray by ray.
void TileTracer::intersectViews(std::span<const glm::dvec2> x, const glm::dvec3& wo,
                                std::span<std::optional<TileHit>> hits) const {
  LODEN_CHECK_EQ(x.size(), hits.size());
  const glm::dvec3 along = wo * impl_->per_length;
  RTCRayHit rays[kStream];
  std::optional<Impl::Segment> parts[kStream];
  for (size_t first = 0; first < x.size(); first += kStream) {
    const size_t count = std::min(kStream, x.size() - first);
    for (size_t k = 0; k < count; ++k) {
      parts[k] = impl_->segment(startOfView(x[first + k], along), -along);
      rays[k] = parts[k] ? makeRayHit(parts[k]->origin, -along, float(parts[k]->length))
                         : makeRayHit({}, -wo, -1.0f);  // never active
    }
    RTCIntersectContext context = contextWith(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
    rtcIntersect1M(impl_->scene, &context, rays, static_cast<unsigned>(count), sizeof(RTCRayHit));
    for (size_t k = 0; k < count; ++k) {
      auto& hit = hits[first + k];
      hit.reset();
      if (rays[k].hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        if (parts[k]) hit = intersectView(x[first + k], wo);
        continue;
      }
      hit = impl_->hitOf(rays[k].hit, *parts[k], startOfView(x[first + k], along), -wo);
      hit->t -= kStartHeight / wo.z;
      if (mayHaveLeaked(hit, -wo)) hit = intersectView(x[first + k], wo);
    }
  }
}

FlushDenormals::FlushDenormals() : saved_(_mm_getcsr()) {
  _mm_setcsr(saved_ | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON);
}
FlushDenormals::~FlushDenormals() {
  _mm_setcsr(saved_);
}

}  // namespace loden::importer
