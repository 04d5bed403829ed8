// How steady a moving picture is: each way to draw a tile against the traced tile, without temporal
// antialiasing. The eye walks away, pans, or goes round, 60 frames each, slowly enough that no pixel's
// content moves by more than .4 pixels a frame. What the picture does from frame to frame is its difference
// energy, the mean square of the differences of two frames that follow each other, over pixels and R, G, B:
//
// energy_ratio    that of the renderer to that of the truth. Above 1 it flickers, below 1 it smears.
// temporal_error  energy of the renderer's differences less the truth's, to the truth's: 0 if it changes as
//                 the truth does, 1 for a picture that never changes.
//
// The truth has 256 samples a pixel, beyond lambda 2 1024. Rows of 1 sample and of a quarter of the truth's
// tell what sampling alone does: what the latter has in excess of 1 falls at least as 1 / samples, so that at
// most a third of it is left in the truth.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "importer/base/metrics.h"
#include "importer/base/picture.h"
#include "tests/bench/tile_assets.h"

namespace {

using namespace loden;
using namespace loden::bench;
using importer::BakedOutput;
using importer::Picture;

constexpr int kPixels = 48, kFrames = 60;

int truthSamples(double lambda) {  // per pixel side
  return lambda > 2 ? 32 : 16;
}

using Frames = std::vector<std::vector<glm::vec3>>;

struct Motion {
  const char* name;
  void (*move)(PlaneView& view, int frame);
};
const Motion kMotions[] = {
    // By half a level of detail.
    {"zoom",
     [](PlaneView& view, int frame) {
       const glm::dvec2 centre = onPlane(view, glm::dvec2(0.5));
       view.lambda += 0.5 * frame / (kFrames - 1);
       view.shift += centre - onPlane(view, glm::dvec2(0.5));
     }},
    // By .3 pixels a frame.
    {"pan",
     [](PlaneView& view, int frame) {
       view.shift += periodsOf(view) * (0.3 * frame / kPixels * glm::dvec2(0.894, 0.447));
     }},
    // By half a degree a frame, 45 degrees off the normal.
    {"orbit",
     [](PlaneView& view, int frame) {
       view.degrees = 45;
       view.turn = glm::radians(0.5 * frame);
     }},
};

std::vector<PlaneView> viewsOf(const Motion& motion, const PlaneView& from) {
  std::vector<PlaneView> views;
  for (int frame = 0; frame < kFrames; ++frame) {
    views.push_back(from);
    motion.move(views.back(), frame);
  }
  return views;
}

Frames traced(const importer::TileTracer& tracer, const std::vector<PlaneView>& views, int samples) {
  Frames frames;
  for (const PlaneView& view : views) frames.push_back(tracedPicture(tracer, view, samples, 1));
  return frames;
}

Frames drawn(const FullScreen& screen, const TileRenderer& renderer, const runtime::GlProgram& program,
             const std::vector<PlaneView>& views) {
  Frames frames;
  for (const PlaneView& view : views) {
    drawRenderer(screen, renderer, program, view);
    const std::vector<glm::vec4> pixels = screen.read();
    frames.emplace_back(pixels.begin(), pixels.end());
  }
  return frames;
}

// Mean square of what changes from frame to frame, less what changes in `other` (none: nothing).
double differenceEnergy(const Frames& frames, const Frames* other = nullptr) {
  double sum = 0;
  for (size_t f = 1; f < frames.size(); ++f)
    for (size_t k = 0; k < frames[f].size(); ++k) {
      glm::dvec3 change = glm::dvec3(frames[f][k]) - glm::dvec3(frames[f - 1][k]);
      if (other) change -= glm::dvec3((*other)[f][k]) - glm::dvec3((*other)[f - 1][k]);
      sum += glm::dot(change, change) / 3;
    }
  return sum / double((frames.size() - 1) * frames.front().size());
}

importer::StudyRow compared(const std::string& tile, const Motion& motion, double lambda,
                            const std::string& renderer, const std::string& setting, const Frames& frames,
                            const Frames& truth) {
  const double energy = differenceEnergy(truth);
  importer::ErrorSums error;
  for (size_t f = 0; f < frames.size(); ++f) error.add(truth[f], frames[f]);
  importer::StudyRow row;
  row.set("tile", tile).set("motion", motion.name).set("lambda", lambda);
  row.set("renderer", renderer).set("setting", setting);
  row.set("energy_ratio", differenceEnergy(frames) / energy)
      .set("temporal_error", differenceEnergy(frames, &truth) / energy)
      .set("psnr_db", error.psnr())
      .set("truth_difference", std::sqrt(energy));
  return row;
}

// A row for the truth, then one per renderer: four frames, the middle line of the frames, each below that of
// the one before, and the root mean square of what changes otherwise than in the truth, five times as bright.
// Every pixel is 2 x 2.
class Strip {
 public:
  void add(const Frames& frames, const Frames& truth) {
    constexpr int kColumns = 6, kGap = 2;
    const int top = strip_.height ? strip_.height + kGap : 0;
    strip_.width = kColumns * (kPixels + kGap) - kGap;
    strip_.height = top + kPixels;
    strip_.pixels.resize(size_t(strip_.width) * size_t(strip_.height), glm::vec4(1));
    const auto put = [&](int column, auto&& at) {
      for (int y = 0; y < kPixels; ++y)
        for (int x = 0; x < kPixels; ++x)
          strip_.at(column * (kPixels + kGap) + x, top + y) = glm::vec4(at(x, y), 1);
    };
    const auto pixel = [](int x, int y) { return size_t(kPixels - 1 - y) * kPixels + size_t(x); };
    for (int column = 0; column < 4; ++column)
      put(column, [&](int x, int y) { return frames[size_t(column * (kFrames - 1) / 3)][pixel(x, y)]; });
    put(4, [&](int x, int y) { return frames[size_t(y)][pixel(x, kPixels / 2)]; });
    put(5, [&](int x, int y) {
      glm::vec3 sum(0);
      for (size_t f = 1; f < frames.size(); ++f) {
        const size_t k = pixel(x, y);
        const glm::vec3 off = frames[f][k] - frames[f - 1][k] - (truth[f][k] - truth[f - 1][k]);
        sum += off * off;
      }
      return 5.0f * glm::sqrt(sum / float(kFrames - 1));
    });
  }
  void write(const std::filesystem::path& path) const {
    Picture doubled{2 * strip_.width, 2 * strip_.height, {}};
    for (int y = 0; y < doubled.height; ++y)
      for (int x = 0; x < doubled.width; ++x) doubled.pixels.push_back(strip_.at(x / 2, y / 2));
    if (const Status status = importer::writePicture(doubled, path); !status) fail(status.issue());
  }

 private:
  Picture strip_;
};

struct Arguments {
  TileArguments tile;
  std::vector<std::string> motions{"zoom", "pan", "orbit"};
};

// One setting of each renderer: its default lookup, or its last.
bool isShown(const TileRenderer& renderer, const std::vector<TileRenderer>& all) {
  const TileRenderer* shown = nullptr;
  for (const TileRenderer& other : all)
    if (other.name == renderer.name && (!shown || shown->setting != "default lookup")) shown = &other;
  return shown == &renderer;
}

void measureMotion(const FullScreen& screen, const std::vector<TileRenderer>& renderers,
                   const Arguments& arguments, const std::string& tile, const Motion& motion,
                   const PlaneView& from, const importer::TileTracer& tracer, importer::StudyRows& rows) {
  const std::vector<PlaneView> views = viewsOf(motion, from);
  const int samples = truthSamples(from.lambda), fewer = samples / 2;
  const Frames truth = traced(tracer, views, samples);
  Strip strip;
  strip.add(truth, truth);
  const auto add = [&](const std::string& renderer, const std::string& setting, const Frames& frames) {
    rows.push_back(compared(tile, motion, from.lambda, renderer, setting, frames, truth));
  };
  add("traced", "1 sample a pixel", traced(tracer, views, 1));
  add("traced", std::to_string(fewer * fewer) + " samples a pixel", traced(tracer, views, fewer));
  for (const TileRenderer& renderer : renderers) {
    const RendererPrograms programs = compileRenderer(screen, renderer, views, 1);
    const Frames frames = drawn(screen, renderer, programs.plain, views);
    add(renderer.name, renderer.setting, frames);
    if (isShown(renderer, renderers)) strip.add(frames, truth);
  }
  if (arguments.tile.pictures.empty()) return;
  std::filesystem::create_directories(arguments.tile.pictures);
  char name[128];
  std::snprintf(name, sizeof name, "motion-%s-%s-%g.png", std::filesystem::path(tile).stem().string().c_str(),
                motion.name, from.lambda);
  strip.write(arguments.tile.pictures / name);
}

void measureTile(const runtime::Device& device, const FullScreen& screen, const Arguments& arguments,
                 const std::string& tile, importer::StudyRows& rows) {
  const BakedOutput baked = require(importer::studyBake(arguments.tile.study, tile));
  const importer::Tile mesh = require(importer::loadTile(importer::studyTileName(tile)));
  const importer::TileTracer tracer(mesh);
  const std::vector<TileRenderer> renderers =
      tileRenderers(device, arguments.tile, tile, baked, tracer, std::make_shared<const glm::vec3>(0));
  for (const Motion& motion : kMotions) {
    if (std::find(arguments.motions.begin(), arguments.motions.end(), motion.name) == arguments.motions.end())
      continue;
    for (const double lambda : arguments.tile.lambdas) {
      PlaneView view{kPixels, baked.manifest().size, mesh.aspect};
      view.lambda = lambda;
      measureMotion(screen, renderers, arguments, tile, motion, view, tracer, rows);
      if (!arguments.tile.study.quiet)
        std::fprintf(stderr, "%s, %s at %g\n", tile.c_str(), motion.name, lambda);
    }
  }
}

const std::string kUsage = std::string("bench_motion [--motion zoom,pan,orbit] ") + kTileUsage +
                           kTileUsageNotes + "\n--pictures writes a strip of each motion";

Arguments parseArguments(int argc, char** argv) {
  Arguments all;
  all.tile =
      parseTileArguments(argc, argv, "bench_motion", kUsage,
                         {{"--motion", [&](const auto& value) { all.motions = splitAtCommas(value); }}});
  if (all.tile.only.empty()) all.tile.only = {"parallax", "as published", "Loden, surface", "Loden, fused"};
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  answerHelp(argc, argv, kUsage.c_str());
  const Arguments arguments = parseArguments(argc, argv);
  const std::unique_ptr<runtime::Device> device = makeDevice();
  const FullScreen screen({kPixels, kPixels});
  importer::StudyRows rows;
  for (const std::string& tile : arguments.tile.study.tiles)
    measureTile(*device, screen, arguments, tile, rows);
  char heading[256];
  std::snprintf(
      heading, sizeof heading,
      "bench_motion: %d frames of %d x %d pixels, truth of %d samples a pixel, beyond lambda 2 %d, %s",
      kFrames, kPixels, kPixels, truthSamples(0) * truthSamples(0), truthSamples(4) * truthSamples(4),
      device->capabilities().renderer.c_str());
  return reportRows(arguments.tile, {"motion", "difference energy of moving pictures", nullptr}, heading,
                    rows);
}
