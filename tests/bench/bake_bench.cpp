// How much of Embree's own throughput a bake reaches, in processor time on one thread.
//
//   asked    the rays that BTF and Flat-BTF are defined by: one view ray per sample and view, and from every
//   sample that
//            a view sees one shadow ray to each light that it faces; for the Flat-BTF the latter once, for
//            all views
//   traced   the very rays that the bake casts: view rays of BTF and VDIM, shadow rays of the surface samples
//   once, from BTF
//            samples where neighbouring ones disagree, and rays from the surface towards the views
//   bare     a loop of nothing but Embree over these rays, taken from every ninth view and written into
//   arrays before the clock
//            started, in the same order of blocks; on a scene of its own, 3 x 3 copies of the tile, with the
//            bake's flags:
//     streams   rtcIntersect1M for view rays, rtcOccluded1M for shadow rays, 64 at once: what the bake calls,
//     but for VDIM packets   rtcIntersect1 and rtcOccluded8
//   share    bare seconds for the rays / seconds of the whole bake, images included
//
// Usage: bench_bake [TILE [SIZE [SUPERSAMPLE]]]; default builtin:button 32 4, 81 x 81 directions.
#include <embree3/rtcore.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <vector>

#include "importer/bake/bake.h"
#include "importer/bake/bake_scene.h"
#include "importer/bake/surface_samples.h"
#include "material/model/vdim.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;

double cpuSeconds() {
  return double(std::clock()) / CLOCKS_PER_SEC;
}

[[noreturn]] void fail(const Issue& issue) {
  std::fprintf(stderr, "%s: %s\n", issue.where.c_str(), issue.text.c_str());
  std::exit(4);
}

class BareScene {
 public:
  explicit BareScene(const Tile& tile);
  ~BareScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  RTCScene get() const { return scene_; }

 private:
  RTCDevice device_ = rtcNewDevice("threads=1,isa=avx2");
  RTCScene scene_ = rtcNewScene(device_);
};

BareScene::BareScene(const Tile& tile) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  const size_t vertices = tile.positions.size(), triangles = tile.triangles.size();
  auto* at = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), 9 * vertices));
  auto* corners = static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), 9 * triangles));
  for (uint32_t copy = 0; copy < 9; ++copy) {
    const glm::dvec3 shift(int(copy % 3) - 1, int(copy / 3) - 1, 0);
    for (const glm::dvec3& p : tile.positions) *at++ = glm::vec3(p + shift);
    for (const glm::uvec3& t : tile.triangles) *corners++ = t + glm::uvec3(uint32_t(copy * vertices));
  }
  rtcCommitGeometry(geometry);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
}

struct Rays {
  std::vector<RTCRayHit> views;
  std::vector<RTCRay> shadows;
  uint64_t count() const { return views.size() + shadows.size(); }
};

RTCRay rayOf(const glm::dvec3& origin, const glm::dvec3& direction, double length) {
  const glm::vec3 o(origin - glm::dvec3(glm::floor(glm::dvec2(origin)), 0)), d(direction);
  RTCRay ray{};
  ray.org_x = o.x, ray.org_y = o.y, ray.org_z = o.z;
  ray.dir_x = d.x, ray.dir_y = d.y, ray.dir_z = d.z;
  ray.tfar = float(length);
  ray.mask = 0xFFFFFFFFu;
  return ray;
}

RTCRay shadowRay(const glm::dvec3& origin, const glm::dvec3& direction) {
  return rayOf(origin, direction, std::max(0.0, (1e-4 - origin.z) / direction.z));
}

RTCRayHit viewRay(const TileTracer& tracer, const glm::dvec2& x, const glm::dvec3& wo) {
  RTCRayHit ray{};
  ray.ray = rayOf(glm::dvec3(x, 0) + wo * (1e-3 / wo.z), -wo, (-tracer.zMin() + 2e-3) / wo.z);
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

// Of one view; shadow rays light by light within each block of samples.
struct ViewRays {
  Rays asked, traced;
};

ViewRays raysOf(const BakeScene& scene, const SurfaceSamples& surface, int view) {
  constexpr int kBlock = 8;  // texels per side
  const BakeManifest& m = scene.manifest;
  const glm::dvec3 wo = scene.directions()[size_t(view)];
  ViewRays rays;
  std::vector<TileHit> hits;
  std::vector<uint64_t> known, lit(surface.words());  // known: [hit][word]
  for (int block = 0; block < m.size * m.size / (kBlock * kBlock); ++block) {
    hits.clear(), known.clear();
    const glm::ivec2 first = kBlock * glm::ivec2(block % (m.size / kBlock), block / (m.size / kBlock));
    for (int t = 0; t < kBlock * kBlock; ++t)
      for (int k = 0; k < m.supersample * m.supersample; ++k) {
        const glm::dvec2 x =
            (glm::dvec2(first + glm::ivec2(t % kBlock, t / kBlock)) + samplePosition(k, m.supersample)) /
            double(m.size);
        rays.asked.views.push_back(viewRay(scene.tracer, x, wo));
        const auto hit = scene.tracer.intersectView(x, wo);
        if (!hit) continue;
        hits.push_back(*hit);
        known.resize(known.size() + surface.words());
        surface.lightsAt(*hit, &known[known.size() - surface.words()], lit.data());
      }
    for (size_t l = 0; l < scene.directions().size(); ++l)
      for (size_t h = 0; h < hits.size(); ++h) {
        if (glm::dot(hits[h].normal, scene.directions()[l]) <= 0) continue;
        const RTCRay ray = shadowRay(hits[h].ray_origin, scene.directions()[l]);
        rays.asked.shadows.push_back(ray);
        if (!(known[h * surface.words() + l / 64] >> (l % 64) & 1)) rays.traced.shadows.push_back(ray);
      }
  }
  rays.traced.views = rays.asked.views;
  for (size_t s = 0; s < surface.end(size_t(m.flat_size * m.flat_size - 1)); ++s)
    if (glm::dot(surface[s].geometric_normal, glm::vec3(wo)) > 0)
      rays.traced.shadows.push_back(shadowRay(surface[s].origin, wo));
  return rays;
}

// What the bake traces once, for all views.
Rays commonRays(const BakeScene& scene, const SurfaceSamples& surface) {
  const BakeManifest& m = scene.manifest;
  Rays rays;
  for (const glm::dvec3& wi : scene.directions())
    for (size_t s = 0; s < surface.end(size_t(m.flat_size * m.flat_size - 1)); ++s)
      if (glm::dot(surface[s].normal, glm::vec3(wi)) > 0)
        rays.shadows.push_back(shadowRay(surface[s].origin, wi));
  for (const glm::ivec2& size : m.vdims)
    for (int v = 0; v < size.x * size.y; ++v) {
      const glm::dvec3 wo = directionFromSpherical(
          {kThetaMax * (v / size.y) / (size.x - 1), 2 * kPi * (v % size.y) / (size.y - 1)});
      for (int t = 0; t < m.size * m.size; ++t)
        rays.views.push_back(
            viewRay(scene.tracer, (glm::dvec2(t % m.size, t / m.size) + 0.5) / double(m.size), wo));
    }
  return rays;
}

double streamSeconds(const BareScene& scene, Rays rays) {
  constexpr size_t kStream = 64;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const double start = cpuSeconds();
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (size_t k = 0; k < rays.views.size(); k += kStream)
    rtcIntersect1M(scene.get(), &context, &rays.views[k], unsigned(std::min(kStream, rays.views.size() - k)),
                   sizeof(RTCRayHit));
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  for (size_t k = 0; k < rays.shadows.size(); k += kStream)
    rtcOccluded1M(scene.get(), &context, &rays.shadows[k],
                  unsigned(std::min(kStream, rays.shadows.size() - k)), sizeof(RTCRay));
  return cpuSeconds() - start;
}

std::vector<RTCRay8> packetsOf(const std::vector<RTCRay>& rays) {
  std::vector<RTCRay8> packets((rays.size() + 7) / 8);
  for (size_t k = 0; k < 8 * packets.size(); ++k) {
    const RTCRay& ray = rays[std::min(k, rays.size() - 1)];
    RTCRay8& packet = packets[k / 8];
    const size_t lane = k % 8;
    packet.org_x[lane] = ray.org_x, packet.org_y[lane] = ray.org_y, packet.org_z[lane] = ray.org_z;
    packet.dir_x[lane] = ray.dir_x, packet.dir_y[lane] = ray.dir_y, packet.dir_z[lane] = ray.dir_z;
    packet.tfar[lane] = ray.tfar, packet.mask[lane] = ray.mask;
  }
  return packets;
}

double packetSeconds(const BareScene& scene, Rays rays) {
  alignas(32) const int valid[8] = {-1, -1, -1, -1, -1, -1, -1, -1};
  std::vector<RTCRay8> packets = packetsOf(rays.shadows);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  const double start = cpuSeconds();
  for (RTCRayHit& ray : rays.views) rtcIntersect1(scene.get(), &context, &ray);
  for (RTCRay8& packet : packets) rtcOccluded8(valid, scene.get(), &context, &packet);
  return cpuSeconds() - start;
}

// Rays, and what the two loops take for them.
struct Bare {
  double rays = 0, streams = 0, packets = 0;  // the latter in seconds
  void add(const BareScene& scene, const Rays& more, double times) {
    const FlushDenormals flush;
    rays += times * double(more.count());
    streams += times * streamSeconds(scene, more), packets += times * packetSeconds(scene, more);
  }
  void print(const char* name, double bake_seconds) const {
    std::printf(
        "%-7s %8.1f M rays; streams %6.2f Mray/s, share %5.1f %%; packets %6.2f Mray/s, share %5.1f %%\n",
        name, rays / 1e6, rays / streams / 1e6, 100 * streams / bake_seconds, rays / packets / 1e6,
        100 * packets / bake_seconds);
  }
};

int run(const std::string& name, int size, int supersample) {
  constexpr int kEvery = 9;
  const auto tile = loadTile(name);
  if (!tile) fail(tile.issue());
  BakeOptions options;
  options.size = size, options.supersample = supersample, options.directions = bonn81Directions();
  options.threads = 1, options.quiet = true;
  BakeManifest m;
  m.size = m.flat_size = size, m.supersample = supersample, m.directions = options.directions,
  m.vdims = options.vdims;
  Bare asked, traced;
  {
    const TileTracer tracer(*tile);
    BakeCounters counters;
    const BakeScene scene{tracer, m, counters};
    const SurfaceSamples surface(scene);
    const BareScene bare(*tile);
    for (int view = 0; view < m.directions.size(); view += kEvery) {
      const ViewRays rays = raysOf(scene, surface, view);
      asked.add(bare, rays.asked, kEvery), traced.add(bare, rays.traced, kEvery);
    }
    traced.add(bare, commonRays(scene, surface), 1);
  }
  const fs::path folder = fs::temp_directory_path() / "loden_bench_bake";
  fs::remove_all(folder);
  const double start = cpuSeconds();
  const auto report = bake(*tile, name, folder, options);
  const double seconds = cpuSeconds() - start;
  fs::remove_all(folder);
  if (!report) fail(report.issue());
  std::printf(
      "# bench_bake: %s, %d x %d texels, %d x %d samples, 81 x 81 directions; definitions in "
      "bake_bench.cpp\n",
      name.c_str(), size, size, supersample, supersample);
  std::printf("bake    %8.1f M rays; all maps and files %6.2f s of processor time\n",
              double(report->rays) / 1e6, seconds);
  asked.print("asked", seconds);
  traced.print("traced", seconds);
  return 0;
}

}  // namespace
}  // namespace loden::importer

int main(int argc, char** argv) {
  constexpr const char* kUsage = "usage: bench_bake [TILE [SIZE [SUPERSAMPLE]]], SIZE a multiple of 8\n";
  if (argc > 1 && (!std::strcmp(argv[1], "--help") || !std::strcmp(argv[1], "-h")))
    return std::fputs(kUsage, stdout), 0;
  const int size = argc > 2 ? std::atoi(argv[2]) : 32, supersample = argc > 3 ? std::atoi(argv[3]) : 4;
  if (size < 8 || size % 8 != 0 || supersample < 1) {
    std::fputs(kUsage, stderr);
    return 1;
  }
  return loden::importer::run(argc > 1 ? argv[1] : "builtin:button", size, supersample);
}
