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

// Streams and draws one frame; times are wall-clock with the GPU drained on both sides.
Result<FrameRecord> drawFrame(World& world, const Camera& camera, const FrameTarget& target, bool wait,
                              float seconds) {
  FrameRecord record;
  const auto start = Clock::now();
  world.renderer->prepare(makeView(camera, target.size, depthRange(world.renderer->bounds(), camera)),
                          world.settings);
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
  recorder.report().gl = world.device->capabilities();
  recorder.report().start_ms = millisecondsSince(start);
  Player player(world, options);
  for (int i = 0; !interrupted && (options.frames == 0 || i < options.frames); ++i) {
    world.device->pollEvents();
    if (world.device->size().x < 1 || world.device->size().y < 1) {  // minimised
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (world.device->closeRequested()) break;
      continue;
    }
    const auto began = Clock::now();
    const Result<bool> stays = player.step();
    if (!stays) return fail(stays.issue());
    if (!*stays) break;
    FrameRecord record;
    record.t = millisecondsSince(start) / 1000;
    record.ms = player.picture().lastMs();
    record.stats = player.picture().stats();
    record.materials = world.materials->stats();
    recorder.addFrame(std::move(record));
    // At rest the panel alone is drawn, which need not be often.
    constexpr double kRestMs = 30;
    if (const double spent = millisecondsSince(began); player.idle() && spent < kRestMs)
      std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(kRestMs - spent));
  }
  recorder.report().camera = player.camera();
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
