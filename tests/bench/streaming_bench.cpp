// Streaming: a walk past 100 materials under three budgets; what its frames cost beside the same frames with
// everything resident; a still camera while levels arrive; the cost of a frame against the size of the scene.
//
//   bench_streaming [--assets DIR] [--only walk|times|still|scale] [--rounds N]
//     assets: .loden files to make the gallery of; default: the four tiles as fused and as surface, baked and
//     cooked
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <thread>

#include "importer/base/flip.h"
#include "material/asset/asset.h"
#include "runtime/scene/mesh_analytic.h"
#include "runtime/stream/material_data.h"
#include "runtime/stream/material_parts.h"
#include "tests/bench/bench_support.h"
#include "tests/bench/gallery.h"

namespace {

using namespace loden;
using namespace loden::bench;
using namespace loden::runtime;

constexpr int kMaterials = 100;
constexpr float kSeconds = 1.0f / 60;
constexpr double kMib = 1.0 / (1 << 20);

using Clock = std::chrono::steady_clock;
double milliseconds(Clock::time_point since) {
  return std::chrono::duration<double, std::milli>(Clock::now() - since).count();
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[size_t(q * double(values.size() - 1))];
}
std::vector<double> negated(std::vector<double> values) {
  for (double& value : values) value = -value;
  return values;
}
double median(const std::vector<double>& values) {
  return 0.5 *
         (quantile(values, 0.5) - quantile(negated(values), 0.5));  // of an even number the middle of the two
}

// --- the walk
// --------------------------------------------------------------------------------------------------

// Bytes on disk of the parts that lambda needs.
uint64_t neededBytes(const SceneAsset& asset, float lambda) {
  const AssetFile file = require(AssetFile::open(memorySource(asset.embedded, asset.name), asset.name));
  const MaterialVariant variant = require(materialVariant(file.skeleton(), Lookup::kDefault));
  uint64_t bytes = 0;
  for (const PartPlan& part : planParts(file.skeleton(), variant, {})) {
    if (part.desc.lambda_end <= lambda) continue;
    const MaterialPart maps{part.kind, part.band};
    if (part.kind == PartKind::kGeometry && !part.desc.refines) bytes += file.storedBytes(maps);
    // A band's leading part is needed where the whole is, which counts it; of split maps both are.
    if (part.kind == PartKind::kBand && part.share == Share::kWhole) bytes += file.storedBytes(maps);
    if (part.kind == PartKind::kSurface)
      bytes += file.storedBytes(maps, part.share) -
               (part.desc.takes_over ? file.storedBytes(maps, Share::kLead) : 0);
  }
  return bytes;
}

// A visitor who stands before the first panel, then walks past the others.
struct Path {
  int standing, frames;  // of these frames
  float last;            // panel
  glm::ivec2 size;
  View view(int frame) const {
    return galleryView(float(std::max(frame - standing, 0)) / float(frames - 1 - standing) * last, size);
  }
};

double timedFrame(const Stage& stage, const Path& path, int frame, const RenderTarget& target) {
  const auto start = Clock::now();
  stage.frame(path.view(frame), kSeconds, target);
  const double ms = milliseconds(start);
  std::this_thread::sleep_until(start + std::chrono::microseconds(16667));
  return ms;
}

struct Walk {
  int frames_over_budget = 0;
  int first_frames = -1,
      arrived_frames = -1;  // until what is in view is shown within a level, and is all there
  uint64_t first_bytes = 0;
  std::map<std::string, float> finest;  // lambda ever asked for
};

void countFrame(Walk& walk, const Stage& stage, int frame, uint64_t budget, uint64_t headers) {
  const MaterialStats& stats = stage.materials->stats();
  walk.frames_over_budget += stats.resident_bytes > budget;
  bool sharp = true;
  for (const MaterialDemand& demand : stage.renderer->stats().demands) {
    const float lambda = std::max(demand.lambda, 0.0f);
    sharp = sharp && demand.resident <= lambda + 1;
    const auto [it, first] = walk.finest.emplace(demand.name, lambda);
    it->second = std::min(it->second, lambda);
  }
  if (stats.parts_in_flight == 0 && stats.parts_resident > 0 && walk.arrived_frames < 0)
    walk.arrived_frames = frame;
  if (!sharp || walk.first_frames >= 0) return;
  walk.first_frames = frame;
  walk.first_bytes = stats.read_bytes - headers;
}

void reportWalk(const Device& device, const Scene& scene, const Path& path, uint64_t megabytes) {
  MaterialSystemOptions options;
  options.budget_bytes = megabytes << 20;
  const Stage stage = makeStage(device, scene, options);
  const RenderTarget target =
      require(makeRenderTarget({16, 9}, ColorFormat::kSrgb8, "walk"));  // what is drawn does not count here
  const uint64_t headers = stage.materials->stats().read_bytes;
  Walk walk;
  std::vector<double> update_ms;
  for (int frame = 0; frame < path.frames; ++frame) {
    const auto start = Clock::now();
    update_ms.push_back(stage.frame(path.view(frame), kSeconds, target));
    std::this_thread::sleep_until(start + std::chrono::microseconds(16667));
    countFrame(walk, stage, frame, options.budget_bytes, headers);
  }
  uint64_t needed = 0;
  for (const SceneAsset& asset : scene.assets)
    if (const auto it = walk.finest.find(asset.name); it != walk.finest.end())
      needed += neededBytes(asset, it->second);
  const MaterialStats& s = stage.materials->stats();
  const uint64_t read = s.read_bytes - headers;
  std::printf("%6llu %8.1f %8.1f %7.1f%% %6d %8.1f %8.1f %7.2f %8d %8d %9.2f %8.3f %8.3f\n",
              static_cast<unsigned long long>(megabytes), double(s.total_bytes) * kMib,
              double(s.peak_bytes) * kMib, 100.0 * double(s.peak_bytes) / double(s.total_bytes),
              walk.frames_over_budget, double(read) * kMib, double(needed) * kMib,
              double(read) / double(needed), walk.arrived_frames, walk.first_frames,
              double(walk.first_bytes) * kMib, quantile(update_ms, 0.5), quantile(update_ms, 0.99));
}

void reportWalks(const Device& device, const std::vector<Material>& materials) {
  const Path path{180, 1500, kMaterials - 1, {640, 360}};
  const Scene scene = galleryScene(materials, kMaterials, path.size.y);
  std::printf(
      "# walk: %d materials, %d frames at 60 Hz, for pictures of %d x %d; MiB. needed: what the finest "
      "lambda ever asked\n"
      "# for needs. Frames until all that is wanted first has arrived, and until all in view is shown within "
      "a level. CPU ms of\n"
      "# update() on the drawing thread, median and 99th percentile\n",
      kMaterials, path.frames, path.size.x, path.size.y);
  std::printf("%6s %8s %8s %8s %6s %8s %8s %7s %8s %8s %9s %8s %8s\n", "budget", "total", "peak", "share",
              "over", "read", "needed", "ratio", "arrived", "first", "first MiB", "update50", "update99");
  for (const uint64_t megabytes : {2, 8, 32}) reportWalk(device, scene, path, megabytes);
}

// --- what a frame costs while parts stream in
// --------------------------------------------------------------------

constexpr int kSections = 4;  // of the walk, each drawn by both stages in turn

struct Times {
  std::vector<double> streaming,
      still;  // ms of frames in which anything streams, and of the same with all resident
};

// Until the loading thread has nothing left to do, so that it does not run beside the other stage's frames.
void drain(const Stage& stage, const View& view) {
  while (stage.materials->stats().parts_in_flight > 0) {
    stage.renderer->prepare(view, {});
    stage.materials->update(0);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

Times walkTwice(const Stage& still, const Stage& stage, const Path& path, const RenderTarget& target) {
  Times times;
  for (int section = 0; section < kSections; ++section) {
    const int begin = section * path.frames / kSections, end = (section + 1) * path.frames / kSections;
    std::vector<double> still_ms, streaming_ms;
    std::vector<bool> streams;
    for (const bool streaming : {section % 2 == 0, section % 2 == 1})
      for (int frame = begin; frame < end; ++frame) {
        if (!streaming) {
          still_ms.push_back(timedFrame(still, path, frame, target));
          continue;
        }
        const uint64_t evicted = stage.materials->stats().evicted_parts;
        streaming_ms.push_back(timedFrame(stage, path, frame, target));
        const MaterialStats& stats = stage.materials->stats();
        streams.push_back(stats.uploaded_last_frame > 0 || stats.parts_in_flight > 0 ||
                          stats.evicted_parts > evicted);
        if (frame == end - 1) drain(stage, path.view(frame));
      }
    for (size_t i = 0; i < streams.size(); ++i) {
      if (!streams[i]) continue;
      times.streaming.push_back(streaming_ms[i]);
      times.still.push_back(still_ms[i]);
    }
  }
  return times;
}

void reportTimes(const Device& device, const std::vector<Material>& materials, int rounds) {
  const Path path{60, 660, 45, {256, 144}};
  const Scene scene = galleryScene(materials, kMaterials, path.size.y);
  const RenderTarget target = require(makeRenderTarget(path.size, ColorFormat::kSrgb8, "times"));
  MaterialSystemOptions all;
  all.budget_bytes = uint64_t{4} << 30;
  all.release_seconds = 1e9f;
  const Stage still = makeStage(device, scene, all);
  FrameSettings everything;
  everything.lambda = 0;
  everything.cull = false;
  still.renderer->prepare(path.view(0), everything);
  still.materials->finishLoading();
  {
    MaterialSystemOptions tight;
    tight.budget_bytes = 8 << 20;
    // llvmpipe compiles a shader anew for every combination of texture formats: with each part absent, and
    // there.
    const Stage warm = makeStage(device, scene, tight, still.shaders);
    for (int frame = 0; frame < path.frames / 2; ++frame) {
      still.frame(path.view(frame), kSeconds, target);
      timedFrame(warm, path, frame, target);
    }
  }
  std::printf(
      "\n# times: %d frames of the walk, drawn at %d x %d, with parts streaming and with everything "
      "resident, in sections by\n"
      "# turns; ms of the frames in which anything streams; streaming / still at the median and at the 99th "
      "percentile;\n"
      "# medians of %d walks each\n",
      path.frames, path.size.x, path.size.y, rounds);
  std::printf("%6s %7s %8s %8s %8s %8s %7s %7s\n", "budget", "frames", "still50", "still99", "stream50",
              "stream99", "x50", "x99");
  for (const uint64_t megabytes : {2, 8, 32}) {
    std::vector<double> ms[4], x50, x99;
    size_t frames = 0;
    for (int round = 0; round < rounds; ++round) {
      MaterialSystemOptions options;
      options.budget_bytes = megabytes << 20;
      const Stage stage = makeStage(device, scene, options, still.shaders);
      const Times times = walkTwice(still, stage, path, target);
      const double values[] = {quantile(times.still, 0.5), quantile(times.still, 0.99),
                               quantile(times.streaming, 0.5), quantile(times.streaming, 0.99)};
      for (int i = 0; i < 4; ++i) ms[i].push_back(values[i]);
      x50.push_back(values[2] / values[0]);
      x99.push_back(values[3] / values[1]);
      frames = times.still.size();
    }
    std::printf("%6llu %7zu %8.2f %8.2f %8.2f %8.2f %7.2f %7.2f\n",
                static_cast<unsigned long long>(megabytes), frames, median(ms[0]), median(ms[1]),
                median(ms[2]), median(ms[3]), median(x50), median(x99));
  }
}

// --- a still camera
// --------------------------------------------------------------------------------------------

struct StillRow {
  double largest = 0, at_lambda = 0;  // mean FLIP between consecutive frames, and the level shown then
  double whole = 0;                   // between the first and the last
  int frames = 0;                     // until nothing changes any more
};

std::vector<glm::vec3> picture(const RenderTarget& target) {
  std::vector<glm::vec3> pixels;
  for (const glm::vec4& pixel : readLinear(target)) pixels.emplace_back(pixel);
  return pixels;
}

// The default camera before a plane from an empty GPU on, until nothing is under way and nothing fades.
StillRow watch(const Device& device, const Material& material, int rate) {
  constexpr glm::ivec2 kStillSize{160, 120};
  constexpr int kMostFrames = 2000;
  const RenderTarget target = require(makeRenderTarget(kStillSize, ColorFormat::kSrgb8, "still"));
  const View view = makeView({}, kStillSize);
  MaterialSystemOptions options;
  options.upload_bytes_per_frame = 64 << 10;
  const Stage stage = makeStage(device, planeScene(material, 1), options);
  StillRow row;
  std::vector<glm::vec3> first, last;
  float shown = -1;
  for (int quiet = 0; quiet < 3 && row.frames < kMostFrames; ++row.frames) {
    const auto start = Clock::now();
    stage.frame(view, 1.0f / float(rate), target);
    std::vector<glm::vec3> now = picture(target);
    if (last.empty()) first = now;
    const double change = last.empty() ? 0 : importer::flip(last, now, kStillSize.x, kStillSize.y).mean;
    const float lambda = stage.renderer->stats().demands.front().resident;
    if (change > row.largest) row.largest = change, row.at_lambda = double(lambda);
    quiet = stage.materials->stats().parts_in_flight == 0 && lambda == shown ? quiet + 1 : 0;
    shown = lambda;
    last = std::move(now);
    std::this_thread::sleep_until(start + std::chrono::microseconds(1000000 / rate));
  }
  row.whole = importer::flip(first, last, kStillSize.x, kStillSize.y).mean;
  return row;
}

void reportStill(const Device& device, const std::vector<Material>& materials) {
  std::printf(
      "\n# still camera from an empty GPU on, 160 x 120, uploads of 64 KiB: largest mean FLIP between "
      "consecutive frames,\n"
      "# the level shown then, FLIP between the first and the last frame, and frames until nothing "
      "changes\n");
  std::printf("%-16s %5s %8s %8s %8s %7s\n", "material", "Hz", "largest", "lambda", "whole", "frames");
  for (const Material& material : materials)
    for (const int rate : {30, 60}) {
      const StillRow row = watch(device, material, rate);
      std::printf("%-16s %5d %8.4f %8.2f %8.3f %7d\n", material.name.c_str(), rate, row.largest,
                  row.at_lambda, row.whole, row.frames);
    }
}

// --- the size of the scene
// -------------------------------------------------------------------------------------

void reportScale(const Device& device) {
  const RenderTarget target = require(makeRenderTarget({400, 300}, ColorFormat::kSrgb8, "scale"));
  const View view = makeView({}, target.size);
  const int counts[] = {1, 10, 100, 1000, 10000};
  std::vector<Stage> stages;
  std::vector<std::function<void()>> tasks, updates;
  for (const int count : counts) {
    stages.push_back(makeStage(device, planeScene(surfaceMaterial(1), count), {}));
    stages.back().renderer->prepare(view, {});
    stages.back().materials->finishLoading();
  }
  for (const Stage& stage : stages) {
    tasks.push_back([&] { stage.frame(view, kSeconds, target); });
    updates.push_back([&] {
      for (int i = 0; i < 100; ++i) stage.materials->update(0);
    });
  }
  const std::vector<double> ms = interleavedMedians(tasks, 40), update_ms = interleavedMedians(updates, 40);
  std::printf(
      "\n# frame time against scene size, one plane in view at 400 x 300, interleaved; update: "
      "MaterialSystem::update alone\n"
      "%8s %9s %9s %12s\n",
      "objects", "ms", "to one", "update, us");
  for (size_t i = 0; i < ms.size(); ++i)
    std::printf("%8d %9.2f %9.2f %12.2f\n", counts[i], ms[i], ms[i] / ms[0], 10 * update_ms[i]);
}

}  // namespace

int main(int argc, char** argv) {
  answerHelp(argc, argv, "bench_streaming [--assets FOLDER] [--only REPORT] [--rounds N]");
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  std::string assets, only;
  int rounds = 3;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (!std::strcmp(argv[i], "--assets")) assets = argv[i + 1];
    if (!std::strcmp(argv[i], "--only")) only = argv[i + 1];
    if (!std::strcmp(argv[i], "--rounds")) rounds = std::max(std::atoi(argv[i + 1]), 1);
  }
  const auto wanted = [&](const char* report) { return only.empty() || only == report; };
  const std::unique_ptr<Device> device = makeDevice();
  if (wanted("walk") || wanted("times") || wanted("still")) {
    const std::vector<Material> materials = galleryMaterials(assets);
    if (wanted("walk")) reportWalks(*device, materials);
    if (wanted("times")) reportTimes(*device, materials, rounds);
    if (wanted("still")) reportStill(*device, materials);
  }
  if (wanted("scale")) reportScale(*device);
  return 0;
}
