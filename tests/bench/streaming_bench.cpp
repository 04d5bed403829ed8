// A walk past 100 materials under three budgets: what is resident, what is read against what an oracle would read,
// what a frame costs while parts stream in, and how soon the first picture stands. Then the cost of a frame against
// the number of objects and materials in the scene, of which one is seen.
#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include "runtime/frame.h"
#include "runtime/material_parts.h"
#include "runtime/mesh_analytic.h"
#include "runtime/shader_library.h"
#include "tests/bench/bench_support.h"

namespace {

using namespace loden;
using namespace loden::bench;
using namespace loden::runtime;

constexpr int kMaterials = 100;
constexpr int kFrames = 1500;
constexpr int kStanding = 180;  // frames before the walk begins
constexpr float kReach = 3;  // materials to either side that are seen

using Clock = std::chrono::steady_clock;
double milliseconds(Clock::time_point since) {
  return std::chrono::duration<double, std::milli>(Clock::now() - since).count();
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[size_t(q * double(values.size() - 1))];
}

struct Gallery {
  std::vector<std::shared_ptr<const ByteSource>> sources;
  std::vector<AssetFile> files;
};

Gallery makeGallery() {
  Gallery gallery;
  for (uint32_t i = 0; i < kMaterials; ++i) {
    gallery.sources.push_back(assetSource(i % 2 ? surfaceMaterial(i) : fusedMaterial(i)));
    gallery.files.push_back(require(AssetFile::open(gallery.sources.back(), "gallery")));
  }
  return gallery;
}

// Stored bytes of the parts that lambda needs.
uint64_t neededBytes(const AssetFile& file, const MaterialVariant& variant, float lambda) {
  uint64_t bytes = 0;
  for (const PartPlan& part : planParts(file.skeleton(), variant, {})) {
    if (part.desc.lambda_end <= lambda) continue;
    if (part.kind == PartKind::kBand) bytes += file.bandStoredBytes(part.band);
    if (part.kind == PartKind::kGeometry) bytes += file.geometryStoredBytes();
    if (part.kind == PartKind::kSurface) bytes += file.surfaceStoredBytes();
  }
  return bytes;
}

struct Walk {
  int frames_over_budget = 0, first_picture_frames = -1;
  uint64_t first_picture_bytes = 0, needed = 0;
  std::vector<double> steady_ms, streaming_ms;
};

// One walk from the first to the last material, at 60 frames a second; the nearest one is drawn.
Walk walkThrough(const Gallery& gallery, MaterialSystem& materials, const std::vector<MaterialId>& ids, uint64_t budget,
                 const std::function<void(MaterialId)>& draw) {
  Walk walk;
  std::vector<float> finest(ids.size(), 1e9f);
  const uint64_t headers = materials.stats().read_bytes;
  for (int frame = 0; frame < kFrames; ++frame) {
    const float walked = float(std::max(frame - kStanding, 0)) / float(kFrames - 1 - kStanding);
    const float at = walked * float(kMaterials - 1);
    const auto start = Clock::now();
    bool sharp = true;
    for (size_t i = 0; i < ids.size(); ++i) {
      const float distance = std::abs(float(i) - at);
      if (distance > kReach) continue;
      const float lambda = std::log2(1 + 3 * distance);
      finest[i] = std::min(finest[i], lambda);
      materials.demand(ids[i], lambda);
      sharp = sharp && materials.residentLambda(ids[i]) <= lambda + 1;
    }
    const uint64_t evicted = materials.stats().evicted_parts;
    materials.update(1.0f / 60);
    draw(ids[size_t(std::lround(at))]);
    glFinish();
    const MaterialStats& stats = materials.stats();
    const bool quiet = stats.uploaded_last_frame == 0 && stats.parts_in_flight == 0 && stats.evicted_parts == evicted;
    (quiet ? walk.steady_ms : walk.streaming_ms).push_back(milliseconds(start));
    walk.frames_over_budget += stats.resident_bytes > budget;
    std::this_thread::sleep_until(start + std::chrono::microseconds(16667));
    if (sharp && walk.first_picture_frames < 0) {
      walk.first_picture_frames = frame;
      walk.first_picture_bytes = stats.read_bytes - headers;
    }
  }
  for (size_t i = 0; i < ids.size(); ++i) walk.needed += neededBytes(gallery.files[i], materials.variant(ids[i]), finest[i]);
  return walk;
}

void reportWalk(const Device& device, const Gallery& gallery, uint64_t megabytes) {
  const uint64_t budget = megabytes << 20;
  MaterialSystemOptions options;
  options.budget_bytes = budget;
  const auto materials = require(MaterialSystem::create(device, options));
  std::vector<MaterialId> ids;
  for (const auto& source : gallery.sources) ids.push_back(require(materials->load(source, "gallery")));
  const uint64_t headers = materials->stats().read_bytes;

  const FullScreen screen({128, 128});
  const GlProgram program = screen.program(R"(
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;
layout(binding = 0) uniform sampler2DArray weights;
void main() { color = texture(weights, vec3(uv, 0.0)); })", {});
  const Walk walk = walkThrough(gallery, *materials, ids, budget, [&](MaterialId id) {
    materials->bind(id);
    screen.draw(program);
  });
  const MaterialStats& s = materials->stats();
  const double mb = 1.0 / (1 << 20);
  std::printf("%6llu %9.1f %9.1f %8.1f%% %6d %9.1f %9.1f %7.2f %8.2f %8.2f %8.2f %6d %9.2f\n",
              static_cast<unsigned long long>(megabytes), double(s.total_bytes) * mb, double(s.peak_bytes) * mb,
              100.0 * double(s.peak_bytes) / double(s.total_bytes), walk.frames_over_budget,
              double(s.read_bytes - headers) * mb, double(walk.needed) * mb,
              double(s.read_bytes - headers) / double(walk.needed), quantile(walk.steady_ms, 0.99),
              quantile(walk.streaming_ms, 0.5), quantile(walk.streaming_ms, 0.99), walk.first_picture_frames,
              double(walk.first_picture_bytes) * mb);
}

// `count` planes with a material each; all but the first stand behind the camera.
Scene sceneOf(int count) {
  Scene scene = analyticScene(SurfaceKind::kPlane, {}, glm::vec3(0, 0, 1));
  scene.assets[0].embedded = require(serializeAsset(surfaceMaterial(1)));
  for (int i = 1; i < count; ++i) {
    scene.assets.push_back(scene.assets[0]);
    scene.materials.push_back(scene.materials[0]);
    scene.materials.back().flat_btf->asset = i;
    Instance instance = scene.instances[0];
    instance.material = i;
    instance.world_from_local[3] = glm::vec4(0, -50 - 3 * i, 0, 1);
    scene.instances.push_back(instance);
  }
  return scene;
}

// One scene with its own materials and renderer, ready to be drawn again and again.
struct Stage {
  std::unique_ptr<MaterialSystem> materials;
  std::unique_ptr<ShaderLibrary> shaders;
  std::unique_ptr<FrameRenderer> renderer;
};

Stage makeStage(const Device& device, int count, const View& view) {
  Stage stage;
  stage.materials = require(MaterialSystem::create(device, {}));
  stage.shaders = std::make_unique<ShaderLibrary>(device, ShaderLibraryOptions{});
  stage.renderer = require(FrameRenderer::create(device, *stage.shaders, *stage.materials, sceneOf(count)));
  stage.renderer->prepare(view, {});
  stage.materials->finishLoading();
  return stage;
}

void reportScale(const Device& device) {
  const RenderTarget target = makeRenderTarget({400, 300}, ColorFormat::kSrgb8, "scale");
  const View view = makeView({}, target.size);
  const int counts[] = {1, 10, 100, 1000};
  std::vector<Stage> stages;
  std::vector<std::function<void()>> tasks;
  for (const int count : counts) stages.push_back(makeStage(device, count, view));
  for (const Stage& stage : stages)
    tasks.push_back([&] {
      stage.renderer->prepare(view, {});
      stage.materials->update(1.0f / 60);
      if (Status status = stage.renderer->draw({target.framebuffer.name(), target.size}); !status) fail(status.issue());
    });
  const std::vector<double> ms = interleavedMedians(tasks, 40);
  std::printf("\n# frame time against scene size, one plane in view at 400 x 300, interleaved\n%8s %9s %9s\n", "objects",
              "ms", "to one");
  for (size_t i = 0; i < ms.size(); ++i) std::printf("%8d %9.2f %9.2f\n", counts[i], ms[i], ms[i] / ms[0]);
}

}  // namespace

int main() {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const std::unique_ptr<Device> device = makeDevice();
  const Gallery gallery = makeGallery();
  std::printf("# bench_streaming: %d materials, %d frames at 1/60 s; MiB; read / needed: bytes read against the parts\n"
              "# that the finest lambda ever asked for needs; ms per frame; first: until all in view are within one level\n",
              kMaterials, kFrames);
  std::printf("%6s %9s %9s %9s %6s %9s %9s %7s %8s %8s %8s %6s %9s\n", "budget", "total", "peak", "share", "over", "read",
              "needed", "ratio", "steady99", "stream50", "stream99", "first", "first MiB");
  for (const uint64_t megabytes : {2, 8, 32}) reportWalk(*device, gallery, megabytes);

  reportScale(*device);
  return 0;
}
