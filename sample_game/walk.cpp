#include "sample_game/walk.h"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include "material/base/exit_code.h"
#include "runtime/gl/gl_target.h"
#include "sample_game/player.h"
#include "sample_game/recorder.h"
#include "sample_game/world.h"

namespace loden::walk {
namespace {

using Clock = std::chrono::steady_clock;
using namespace runtime;

constexpr int kExitInterrupted = 130;
volatile std::sig_atomic_t interrupted = 0;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

int fail(const Issue& issue) {
  std::fprintf(stderr, "loden_walk: %s: %s [%d]\n", issue.where.c_str(), issue.text.c_str(), issue.id);
  return exitCodeOf(issue);
}

// Pictures are complete, if coarser, where a part of an asset could not be read: say so.
int failIfDamaged(const World& world) {
  const uint64_t failed = world.materials->stats().failed_parts,
                 memory = world.materials->stats().failed_memory;
  if (failed == 0) return 0;
  if (memory > 0)
    return fail({issue_id::kMemory, Severity::kError, "materials",
                 "there is no memory for " + std::to_string(memory) +
                     " parts of the assets, and coarser ones were drawn: try a smaller --budget-mb"});
  return fail(
      {issue_id::kTruncated, Severity::kError, "materials",
       std::to_string(failed) +
           " parts of the assets are damaged or missing and coarser ones were drawn: see loden validate"});
}

// One line on a terminal, rewritten in place.
void showProgress(const Options& options, int frame, int frames) {
  if (options.quiet || !isatty(STDERR_FILENO)) return;
  std::fprintf(stderr, "\rframe %d of %d%s", frame + 1, frames, frame + 1 == frames ? "\n" : "");
}

// To the far side of the scene; near enough planes for a room, in proportion for what is larger, nearer
// before what is closer.
DepthRange depthRange(const World& world, const Camera& camera) {
  const Bounds all = world.renderer->bounds();
  DepthRange range;
  const glm::dvec3 nearest = glm::clamp(camera.position, glm::dvec3(all.min), glm::dvec3(all.max));
  if (const double distance = glm::distance(camera.position, nearest); distance > 0)
    range.near_plane = std::min(range.near_plane, distance / 2);
  const double reach = glm::distance(camera.position, glm::dvec3(all.centre())) + double(all.radius());
  if (reach <= range.far_plane) return range;
  return {range.near_plane * reach / range.far_plane, reach};
}

// Streams and draws one frame; times are wall-clock with the GPU drained on both sides.
Result<FrameRecord> drawFrame(World& world, const Camera& camera, const FrameTarget& target, bool wait,
                              float seconds) {
  FrameRecord record;
  const auto start = Clock::now();
  world.renderer->prepare(makeView(camera, target.size, depthRange(world, camera)), world.settings);
  const auto before_wait = Clock::now();
  if (wait) world.materials->finishLoading();
  record.wait_ms = wait ? millisecondsSince(before_wait) : 0;
  if (!wait) world.materials->update(seconds);
  if (Status status = world.renderer->draw(target); !status) return status.issue();
  world.renderer->finish();
  record.ms = millisecondsSince(start) - record.wait_ms;
  record.stats = world.renderer->stats();
  record.materials = world.materials->stats();
  return record;
}

int framesOf(const Options& options, double path_seconds) {
  if (options.frames > 0) return options.frames;
  if (options.turntable > 0) return options.turntable;
  return options.film.empty() ? 1 : std::max(1, static_cast<int>(path_seconds * kFramesPerSecond));
}

int walkHeadless(const Options& options, World& world, Clock::time_point start) {
  const int frames = framesOf(options, world.path.duration());
  constexpr float kFrameSeconds = 1.0f / kFramesPerSecond;
  Recorder recorder(options, frames);
  if (Status status = recorder.begin(); !status) return fail(status.issue());
  const auto target = makeRenderTarget(options.size, ColorFormat::kSrgb8, "walk");
  if (!target) return fail(target.issue());
  recorder.report().gl = world.device->capabilities();
  recorder.report().start_ms = millisecondsSince(start);
  for (int i = 0; i < frames && !interrupted; ++i) {
    // A turn ends one step before it begins again.
    const int steps = options.turntable > 0 ? frames : frames - 1;
    const double t = steps > 0 ? world.path.duration() * i / steps : 0;
    // A walk takes its own time; a camera that stands still watches at 30 frames a second.
    const double moving = world.path.duration() > 0 ? t : double(kFrameSeconds) * i;
    const Camera camera = world.animate(moving, options.time).value_or(world.path.at(t));
    auto record =
        drawFrame(world, camera, {target->framebuffer.name(), options.size}, !options.stream, kFrameSeconds);
    if (!record) return fail(record.issue());
    record->t = t;
    recorder.addFrame(*std::move(record));
    if (recorder.wantsPixels(i))
      if (Status status = recorder.addPixels(i, readCodes(*target)); !status) return fail(status.issue());
    showProgress(options, i, frames);
  }
  if (interrupted) return kExitInterrupted;
  recorder.report().shaders = world.shaders->stats();
  if (Status status = recorder.finish(); !status) return fail(status.issue());
  return failIfDamaged(world);
}

int walkInWindow(const Options& options, World& world, Clock::time_point start) {
  Recorder recorder(options, options.frames);
  if (Status status = recorder.begin(); !status) return fail(status.issue());
  Player player(*world.device, world.path);
  recorder.report().gl = world.device->capabilities();
  recorder.report().start_ms = millisecondsSince(start);
  const auto shown = Clock::now();
  for (int i = 0; !world.device->closeRequested() && !player.wantsToLeave() && !interrupted; ++i) {
    if (options.frames > 0 && i == options.frames) break;
    world.device->pollEvents();
    if (world.device->size().x < 1 || world.device->size().y < 1) {  // minimised
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      continue;
    }
    const float seconds = player.beginFrame();
    world.animate(millisecondsSince(shown) / 1000, options.time);
    auto record = drawFrame(world, player.camera(), {0, world.device->size()}, false, seconds);
    if (!record) return fail(record.issue());
    player.drawOverlay(record->ms, record->stats, record->materials, world.settings);
    world.device->swap();
    recorder.addFrame(*std::move(record));
  }
  if (interrupted) return kExitInterrupted;
  recorder.report().shaders = world.shaders->stats();
  if (Status status = recorder.finish(); !status) return fail(status.issue());
  return failIfDamaged(world);
}

}  // namespace

int runWalk(const Options& options) {
  const auto start = Clock::now();
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::signal(SIGTERM, [](int) { interrupted = 1; });
  Result<World> world = makeWorld(options);
  if (!world) return fail(world.issue());
  return options.headless ? walkHeadless(options, *world, start) : walkInWindow(options, *world, start);
}

}  // namespace loden::walk
