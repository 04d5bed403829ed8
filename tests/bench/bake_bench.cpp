// How much of Embree's own throughput a bake reaches, in processor time on one thread.
//
//   asked    the rays that BTF and Flat-BTF are defined by: one view ray per sample and view, and from every sample that
//            a view sees one shadow ray to each light that it faces; for the Flat-BTF the latter once, for all views
//   traced   the rays that the bake casts: shadows are found once per surface sample where neighbours agree
//   bare     a loop of nothing but rtcIntersect1 (view rays) and rtcOccluded8 (shadow rays, packets of one light) over the
//            asked rays of every ninth view, which were written into arrays before the clock started, in the same order
//            of blocks; on a scene of its own, 3 x 3 copies of the tile, with the bake's flags
//   share    bare seconds for as many rays / seconds of the whole bake, images included
//
// Usage: bench_bake [TILE [SIZE [SUPERSAMPLE]]]; default builtin:button 32 4, 81 x 81 directions.
#include <embree3/rtcore.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <vector>

#include "importer/bake.h"
#include "importer/bake_scene.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;

double cpuSeconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

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
  auto* at = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), 9 * vertices));
  auto* corners = static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), 9 * triangles));
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

struct Ray {
  glm::vec3 origin, direction;
  float length;
};

// The asked rays of one view: first hits, then, light by light within each block of samples, shadows.
struct AskedRays {
  std::vector<Ray> views;
  std::vector<RTCRay8> shadows;
  std::vector<int> lanes;  // of each packet
  uint64_t count() const {
    uint64_t n = views.size();
    for (const int l : lanes) n += uint64_t(l);
    return n;
  }
};

void addShadows(AskedRays& rays, const std::vector<TileHit>& hits, const glm::dvec3& wi) {
  int lane = 8;
  for (const TileHit& hit : hits) {
    if (glm::dot(hit.normal, wi) <= 0) continue;
    if (lane == 8) rays.shadows.push_back({}), rays.lanes.push_back(0), lane = 0;
    RTCRay8& packet = rays.shadows.back();
    const glm::vec3 origin = glm::vec3(hit.ray_origin - glm::dvec3(glm::floor(glm::dvec2(hit.ray_origin)), 0)), d(wi);
    packet.org_x[lane] = origin.x, packet.org_y[lane] = origin.y, packet.org_z[lane] = origin.z;
    packet.dir_x[lane] = d.x, packet.dir_y[lane] = d.y, packet.dir_z[lane] = d.z;
    packet.tfar[lane] = std::max(0.0f, (1e-4f - origin.z) / d.z);
    packet.mask[lane] = 0xFFFFFFFFu;
    rays.lanes.back() = ++lane;
  }
}

AskedRays askedRays(const TileTracer& tracer, const BakeManifest& m, int view) {
  constexpr int kBlock = 8;  // texels per side
  const glm::dvec3 wo = m.directions.samples[size_t(view)];
  AskedRays rays;
  std::vector<TileHit> hits;
  for (int block = 0; block < m.size * m.size / (kBlock * kBlock); ++block) {
    hits.clear();
    const glm::ivec2 first = kBlock * glm::ivec2(block % (m.size / kBlock), block / (m.size / kBlock));
    for (int t = 0; t < kBlock * kBlock; ++t)
      for (int k = 0; k < m.supersample * m.supersample; ++k) {
        const glm::dvec2 x = (glm::dvec2(first + glm::ivec2(t % kBlock, t / kBlock)) + samplePosition(k, m.supersample)) / double(m.size);
        const glm::dvec3 origin = glm::dvec3(x, 0) + wo * (1e-3 / wo.z);
        rays.views.push_back({glm::vec3(origin), glm::vec3(-wo), float((-tracer.zMin() + 2e-3) / wo.z)});
        if (const auto hit = tracer.intersectView(x, wo)) hits.push_back(*hit);
      }
    for (const glm::dvec3& wi : m.directions.samples) addShadows(rays, hits, wi);
  }
  return rays;
}

double bareSeconds(const BareScene& scene, AskedRays& rays) {
  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  const double start = cpuSeconds();
  for (const Ray& ray : rays.views) {
    RTCRayHit hit{};
    hit.ray.org_x = ray.origin.x, hit.ray.org_y = ray.origin.y, hit.ray.org_z = ray.origin.z;
    hit.ray.dir_x = ray.direction.x, hit.ray.dir_y = ray.direction.y, hit.ray.dir_z = ray.direction.z;
    hit.ray.tfar = ray.length, hit.ray.mask = 0xFFFFFFFFu;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene.get(), &context, &hit);
  }
  for (size_t p = 0; p < rays.shadows.size(); ++p) {
    alignas(32) int valid[8];
    for (int lane = 0; lane < 8; ++lane) valid[lane] = lane < rays.lanes[p] ? -1 : 0;
    rtcOccluded8(valid, scene.get(), &context, &rays.shadows[p]);
  }
  return cpuSeconds() - start;
}

int run(const std::string& name, int size, int supersample) {
  constexpr int kEvery = 9;
  const auto tile = loadTile(name);
  if (!tile) fail(tile.issue());
  BakeManifest m;
  m.size = size, m.supersample = supersample, m.directions = bonn81Directions();
  const TileTracer tracer(*tile);
  const BareScene scene(*tile);
  double bare = 0;
  uint64_t bare_rays = 0;
  for (int view = 0; view < m.directions.size(); view += kEvery) {
    AskedRays rays = askedRays(tracer, m, view);
    bare_rays += rays.count();
    bare += bareSeconds(scene, rays);
  }
  const double rate = double(bare_rays) / bare;
  BakeOptions options;
  options.size = size, options.supersample = supersample, options.directions = m.directions;
  options.threads = 1, options.quiet = true;
  const fs::path folder = fs::temp_directory_path() / "loden_bench_bake";
  fs::remove_all(folder);
  const double start = cpuSeconds();
  const auto report = bake(*tile, name, folder, options);
  const double seconds = cpuSeconds() - start;
  fs::remove_all(folder);
  if (!report) fail(report.issue());
  const double asked = double(bare_rays) * kEvery;  // of the BTF alone
  std::printf("# bench_bake: %s, %d x %d texels, %d x %d samples, 81 x 81 directions; definitions in bake_bench.cpp\n", name.c_str(), size, size, supersample, supersample);
  std::printf("bare Embree loop         %10.2f Mray/s\n", rate / 1e6);
  std::printf("bake, all maps           %10.2f s of processor time\n", seconds);
  std::printf("rays asked by the BTF    %10.1f M, share %5.1f %%\n", asked / 1e6, 100 * asked / rate / seconds);
  std::printf("rays traced              %10.1f M, share %5.1f %%\n", double(report->rays) / 1e6, 100 * double(report->rays) / rate / seconds);
  return 0;
}

}  // namespace
}  // namespace loden::importer

int main(int argc, char** argv) {
  const int size = argc > 2 ? std::atoi(argv[2]) : 32, supersample = argc > 3 ? std::atoi(argv[3]) : 4;
  if (size < 8 || size % 8 != 0 || supersample < 1) {
    std::fprintf(stderr, "usage: bench_bake [TILE [SIZE [SUPERSAMPLE]]], SIZE a multiple of 8\n");
    return 1;
  }
  return loden::importer::run(argc > 1 ? argv[1] : "builtin:button", size, supersample);
}
