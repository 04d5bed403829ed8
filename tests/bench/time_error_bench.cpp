// Run time against error: every way to draw a tile, in one interleaved run, on the same pixels, against the
// traced tile. A plane fills the picture; at lambda 0 a pixel covers a texel, at 2 it covers 4 a side. Peers
// that need a height field are drawn on tiles that are one. They have no cast shadows, as such shaders
// usually have not.
//
// `loden study time-error` runs it with the options of a study.
//
// Time is processor time of this process with the picture drawn by the calling thread (LP_NUM_THREADS=0,
// unless the environment says otherwise), which other programs on the machine disturb least.
//
// fetches_per_pixel counts texture instructions, fetches_slowest those of the pixel that issues most in each
// block of 8 x 4, as a GPU's wave waits for it; bytes_per_pixel the bytes of the texels that their filters
// read: 1 texel for a fetch, 4 for a gather or a bilinear filter, 8 with mip levels or in a volume. No cache
// is assumed: a texel that neighbouring pixels share counts for each of them.
//
// What it draws with: tile_renderers.h and peer_renderers.h; which renderers there are: tile_assets.h.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "importer/base/flip.h"
#include "importer/base/metrics.h"
#include "importer/base/picture.h"
#include "tests/bench/tile_assets.h"

namespace {

using namespace loden;
using namespace loden::bench;
using importer::BakedOutput;

constexpr int kPixels = 192, kRounds = 11, kTruthSamples = 8;  // samples per pixel side
constexpr int kBlockWidth = 8, kBlockHeight = 4;               // pixels that a wave of 32 draws

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

struct Fetches {
  double mean = 0;     // per pixel
  double slowest = 0;  // of the pixel that issues most in each block, mean over the blocks
};
Fetches countFetches(const std::vector<glm::vec4>& pixels) {
  static_assert(kPixels % kBlockWidth == 0 && kPixels % kBlockHeight == 0);
  constexpr int kAcross = kPixels / kBlockWidth, kBlocks = kAcross * (kPixels / kBlockHeight);
  std::vector<float> most(kBlocks);
  Fetches fetches;
  for (int j = 0; j < kPixels; ++j)
    for (int i = 0; i < kPixels; ++i) {
      const float count = pixels[size_t(j) * kPixels + size_t(i)].w;
      float& block = most[size_t(j / kBlockHeight * kAcross + i / kBlockWidth)];
      block = std::max(block, count);
      fetches.mean += double(count) / double(pixels.size());
    }
  for (const float count : most) fetches.slowest += double(count) / kBlocks;
  return fetches;
}

// As a PNG; `name` may be any text.
void writePicture(const std::filesystem::path& folder, std::string name, const std::vector<glm::vec3>& rows) {
  if (folder.empty()) return;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '.') c = '_';
  importer::Picture picture{kPixels, kPixels, {}};
  for (int y = kPixels - 1; y >= 0; --y)
    for (int x = 0; x < kPixels; ++x) picture.pixels.emplace_back(rows[size_t(y * kPixels + x)], 1);
  std::filesystem::create_directories(folder);
  if (const Status status = importer::writePicture(picture, folder / (name + ".png")); !status)
    fail(status.issue());
}

// What one renderer costs and how far it is off.
importer::StudyRow measured(const FullScreen& screen, const TileRenderer& renderer,
                            const runtime::GlProgram& counting, const PlaneView& view,
                            const std::vector<glm::vec3>& expected, const std::filesystem::path& pictures,
                            const std::string& scene) {
  double bytes = 0;
  drawRenderer(screen, renderer, counting, view, Counted::kBytes);
  for (const glm::vec4& pixel : screen.read()) bytes += double(pixel.w);
  drawRenderer(screen, renderer, counting, view);
  const std::vector<glm::vec4> counted = screen.read();
  const std::vector<glm::vec3> got(counted.begin(), counted.end());
  writePicture(pictures, scene + "-" + renderer.name + "-" + renderer.setting, got);
  const Fetches fetches = countFetches(counted);
  importer::ErrorSums error;
  error.add(expected, got);
  importer::StudyRow row;
  row.set("fetches_per_pixel", fetches.mean).set("fetches_slowest", fetches.slowest);
  row.set("bytes_per_pixel", bytes / double(expected.size())).set("gpu_bytes", renderer.bytes());
  row.set("flip", importer::flip(expected, got, kPixels, kPixels).mean);
  row.set("rmse", error.y().rmse).set("psnr_db", error.psnr());
  return row;
}

// One picture by all renderers, by turns.
void measureView(const FullScreen& screen, const std::vector<TileRenderer>& renderers,
                 const std::string& tile, const PlaneView& view, int lights,
                 const std::vector<glm::vec3>& expected, const std::filesystem::path& pictures,
                 importer::StudyRows& rows) {
  const std::string scene =
      std::filesystem::path(tile).stem().string() + "-" + number(view.lambda) + "-" + number(view.degrees);
  writePicture(pictures, scene + "-truth", expected);
  std::vector<RendererPrograms> programs;
  for (const TileRenderer& renderer : renderers)
    programs.push_back(compileRenderer(screen, renderer, std::span(&view, 1), lights));
  const auto draw = [&](size_t i) { drawRenderer(screen, renderers[i], programs[i].plain, view); };
  std::vector<std::function<void()>> tasks;
  std::vector<size_t> task_of;
  for (size_t i = 0; i < renderers.size(); ++i) {
    task_of.push_back(tasks.size());
    tasks.push_back([&draw, i] { draw(i); });
    // Geometry leaves nothing of others in the caches, for which the next picture would pay; so the next one
    // is drawn once without being counted.
    if (renderers[i].draw) tasks.push_back([&draw, next = (i + 1) % renderers.size()] { draw(next); });
  }
  const std::vector<double> ms = interleavedMedians(tasks, kRounds);
  double base_ms = 0;
  for (size_t i = 0; i < renderers.size(); ++i)
    if (renderers[i].name == kBaseRenderer) base_ms = ms[task_of[i]];
  for (size_t i = 0; i < renderers.size(); ++i) {
    importer::StudyRow row;
    row.set("scene", tile + " at " + number(view.lambda) + ", " + number(view.degrees) + " degrees");
    row.set("tile", tile).set("lambda", view.lambda).set("degrees", view.degrees);
    row.set("renderer", renderers[i].name).set("setting", renderers[i].setting);
    row.set("ms_median", ms[task_of[i]]).set("ratio_to_normal_map", ms[task_of[i]] / base_ms);
    const importer::StudyRow of_picture =
        measured(screen, renderers[i], programs[i].counting, view, expected, pictures, scene);
    for (const auto& [key, value] : of_picture.cells())
      std::visit([&, &key = key](const auto& v) { row.set(key, v); }, value);
    rows.push_back(std::move(row));
  }
}

struct Arguments {
  TileArguments tile;
  std::vector<double> degrees{0};
  int lights = 1;
};

void measureTile(const runtime::Device& device, const FullScreen& screen, const Arguments& arguments,
                 const std::string& tile, importer::StudyRows& rows) {
  const BakedOutput baked = require(importer::studyBake(arguments.tile.study, tile));
  const importer::Tile mesh = require(importer::loadTile(importer::studyTileName(tile)));
  const importer::TileTracer tracer(mesh);
  const auto mean = std::make_shared<glm::vec3>(0);
  const std::vector<TileRenderer> renderers =
      tileRenderers(device, arguments.tile, tile, baked, tracer, mean);
  for (const double degrees : arguments.degrees)
    for (const double lambda : arguments.tile.lambdas) {
      PlaneView view{kPixels, baked.manifest().size, mesh.aspect};
      view.lambda = lambda, view.degrees = degrees;
      const std::vector<glm::vec3> expected = tracedPicture(tracer, view, kTruthSamples, arguments.lights);
      glm::dvec3 sum(0);
      for (const glm::vec3& pixel : expected) sum += glm::dvec3(pixel);
      *mean = glm::vec3(sum / double(expected.size()));
      measureView(screen, renderers, tile, view, arguments.lights, expected, arguments.tile.pictures, rows);
    }
}

const std::string kUsage = std::string("bench_time_error [--degrees D,...] [--lights 1..4] ") + kTileUsage +
                           kTileUsageNotes + "\n--pictures writes the truth and what each renderer draws";

Arguments parseArguments(int argc, char** argv) {
  Arguments all;
  all.tile = parseTileArguments(
      argc, argv, "bench_time_error", kUsage,
      {{"--degrees", [&](const auto& value) { all.degrees = numbersOf("--degrees", value, 0, 80); }},
       {"--lights",
        [&](const auto& value) { all.lights = wholeNumberOf("--lights", value, 1, kMostLights); }}});
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
  std::snprintf(heading, sizeof heading,
                "bench_time_error: %d x %d pixels, %d light(s), median of %d interleaved frames, %s", kPixels,
                kPixels, arguments.lights, kRounds, device->capabilities().renderer.c_str());
  return reportRows(arguments.tile, {"time-error", "run time against error", nullptr}, heading, rows);
}
