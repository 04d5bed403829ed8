// Run time (the least of 15 rounds) against error for each precision of a band's tables and each quality of
// the look-up and of cast shadows, in one interleaved run: a table on the standard output, as rows of
// RESULTS.md, and one plot.
//   stress_time_error PLOT.svg
#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "importer/base/parallel.h"
#include "importer/cook/cook.h"
#include "importer/study/plot.h"
#include "importer/tile/tile_tracer.h"
#include "material/eval/evaluate.h"
#include "runtime/stream/shader_variants.h"
#include "tests/bench/bench_support.h"
#include "tests/stress/stress_materials.h"

namespace {

using namespace loden;
using namespace loden::runtime;
using bench::FullScreen, bench::require;

constexpr int kPixels = 160, kRounds = 15, kTruthSamples = 4;  // samples per pixel side
constexpr double kPeriods = 3;
constexpr float kLambda = 0.3f;
const glm::dvec3 kLight = glm::normalize(glm::dvec3(0.5, 0.3, 0.8));

const char kFragment[] = R"(
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;
#include "loden_material.glsl"
void main() {
  vec3 wi = normalize(vec3(0.5, 0.3, 0.8)), wo = normalize(vec3(uv - 0.5, 0.4));
  LodenPoint m = loden_point_default();
  LodenHit h = loden_find_hit_at(m, uv * 3.0, LAMBDA, wo);
  color = vec4(loden_evaluate(h, wi, wo), 0.0);
})";

glm::dvec2 uvOf(size_t pixel, glm::dvec2 inside = glm::dvec2(0.5)) {
  return (glm::dvec2(double(pixel % kPixels), double(pixel / kPixels)) + inside) / double(kPixels);
}
glm::dvec3 towardsEye(glm::dvec2 uv) {
  return glm::normalize(glm::dvec3(uv - 0.5, 0.4));
}

// One way to compute the picture.
struct Setting {
  std::string panel, series, name, base;  // `base`: the setting whose time is 1
  std::function<void()> run;
  std::function<std::vector<glm::dvec3>()> picture;
  double psnr = 0, ms = 0;
};

double psnr(const std::vector<glm::dvec3>& got, const std::vector<glm::dvec3>& expected) {
  double squares = 0;
  for (size_t k = 0; k < got.size(); ++k) {
    const glm::dvec3 off = got[k] - expected[k];
    squares += glm::dot(off, off) / 3;
  }
  return -10 * std::log10(std::max(squares / double(got.size()), 1e-20));
}

class Run {
 public:
  Run() : device_(bench::makeDevice()), screen_({kPixels, kPixels}) {}

  void addGpu(const Setting& as, const Material& material, float lambda, Lookup lookup) {
    Setting setting = as;
    MaterialSystemOptions options;
    options.lookup = lookup;
    systems_.push_back(require(MaterialSystem::create(*device_, options)));
    MaterialSystem* system = systems_.back().get();
    const MaterialId id = require(system->load(bench::assetSource(material), as.name));
    system->demand(id, -4);
    system->finishLoading();
    std::vector<std::string> defines = variantDefines(system->variant(id));
    defines.push_back("LAMBDA " + std::to_string(lambda));
    programs_.push_back(std::make_unique<GlProgram>(screen_.program(kFragment, defines)));
    const GlProgram* program = programs_.back().get();
    setting.run = [this, system, id, program] {
      system->bind(id);
      screen_.draw(*program);
      glFinish();
    };
    setting.picture = [this, run = setting.run] {
      run();
      std::vector<glm::dvec3> picture;
      for (const glm::vec4& pixel : screen_.read()) picture.emplace_back(pixel);
      return picture;
    };
    settings_.push_back(std::move(setting));
  }

  // On the CPU, one thread.
  template <class T>
  void addCpu(const Setting& as, const Evaluator& evaluator, float lambda, Lookup lookup) {
    Setting setting = as;
    setting.picture = [&evaluator, lambda, lookup] {
      std::vector<glm::dvec3> picture(size_t(kPixels) * kPixels);
      for (size_t k = 0; k < picture.size(); ++k) {
        const glm::vec<3, T> wo(towardsEye(uvOf(k)));
        const auto hit = evaluator.findHit(glm::vec<2, T>(uvOf(k) * kPeriods), T(lambda), wo, lookup);
        picture[k] = glm::dvec3(evaluator.evaluate(hit, glm::vec<3, T>(kLight), wo));
      }
      return picture;
    };
    setting.run = [picture = setting.picture] { picture(); };
    settings_.push_back(std::move(setting));
  }

  // Since the last call: their errors against `truth`.
  void compare(const std::vector<glm::dvec3>& truth) {
    for (; compared_ < settings_.size(); ++compared_)
      settings_[compared_].psnr = psnr(settings_[compared_].picture(), truth);
  }

  std::vector<Setting> measure() {
    for (Setting& setting : settings_) setting.run();  // to warm up
    for (int round = 0; round < kRounds; ++round)
      for (Setting& setting : settings_) {
        const auto start = std::chrono::steady_clock::now();
        setting.run();
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
        if (round == 0 || took.count() < setting.ms) setting.ms = took.count();
      }
    return settings_;
  }

 private:
  std::unique_ptr<Device> device_;
  FullScreen screen_;
  std::vector<std::unique_ptr<MaterialSystem>> systems_;
  std::vector<std::unique_ptr<GlProgram>> programs_;
  std::vector<Setting> settings_;
  size_t compared_ = 0;
};

std::vector<glm::dvec3> tracedTruth(const importer::Tile& tile) {
  const importer::TileTracer tracer(tile);
  std::vector<glm::dvec3> pixels(size_t(kPixels) * kPixels);
  importer::parallelFor(pixels.size(), 0, [&](size_t k) {
    const importer::FlushDenormals flush;
    const glm::dvec3 wo = towardsEye(uvOf(k));
    for (int s = 0; s < kTruthSamples * kTruthSamples; ++s) {
      const glm::dvec2 inside =
          (glm::dvec2(s % kTruthSamples, s / kTruthSamples) + 0.4871) / double(kTruthSamples);
      const auto hit = tracer.intersectView(uvOf(k, inside) * kPeriods, wo);
      if (hit)
        pixels[k] +=
            importer::shadeHit(tracer, *hit, kLight, wo, 0, 0) / double(kTruthSamples * kTruthSamples);
    }
  });
  return pixels;
}

Material cookedSurface(const importer::Tile& tile, const std::filesystem::path& folder) {
  importer::BakeOptions bake;
  bake.size = 64;
  bake.directions = concentricDirections(3);
  bake.maps.vdim = bake.maps.btf = bake.maps.flat = false;
  bake.quiet = true;
  require(importer::bake(tile, "builtin:pulli", folder, bake));
  importer::CookOptions cook;
  cook.mode = Mode::kSurface;
  cook.quiet = true;
  return require(importer::cook(require(importer::BakedOutput::open(folder)), cook));
}

}  // namespace

int main(int argc, char** argv) {
  bench::answerHelp(argc == 2 ? 1 : argc, argv, "stress_time_error PLOT.svg");
  const std::string folder = (std::filesystem::temp_directory_path() / "loden_time_error").string();
  Run run;
  // Precisions of a smooth band of 12 components, against its definition.
  const Material floats = stress::smoothMaterial(16),
                 halves = stress::stored(floats, TexelFormat::kRGBA16Sfloat),
                 shorts = stress::stored(floats, TexelFormat::kRGBA16Snorm),
                 bytes = stress::stored(floats, TexelFormat::kRGBA8Snorm);
  const Evaluator of_floats(floats), of_halves(halves), of_bytes(bytes);
  const std::string band = "band of 12 components";
  const Setting gpu{band, "shader", "", "shader, 8 bit", {}, {}},
      cpu{band, "evaluator", "", "evaluator, float, 8 bit", {}, {}};
  const auto named = [](Setting setting, const std::string& name) {
    setting.name = name;
    return setting;
  };
  run.addGpu(named(gpu, "shader, 8 bit"), bytes, kLambda, Lookup::kNone);
  run.addGpu(named(gpu, "shader, halves"), halves, kLambda, Lookup::kNone);
  run.addGpu(named(gpu, "shader, 16 bit"), shorts, kLambda, Lookup::kNone);
  run.addGpu(named(gpu, "shader, floats"), floats, kLambda, Lookup::kNone);
  run.addCpu<float>(named(cpu, "evaluator, float, 8 bit"), of_bytes, kLambda, Lookup::kNone);
  run.addCpu<float>(named(cpu, "evaluator, float, halves"), of_halves, kLambda, Lookup::kNone);
  run.addCpu<float>(named(cpu, "evaluator, float, floats"), of_floats, kLambda, Lookup::kNone);
  run.addCpu<double>(named(cpu, "evaluator, double, floats"), of_floats, kLambda, Lookup::kNone);
  std::vector<glm::dvec3> defined;
  for (size_t k = 0; k < size_t(kPixels) * kPixels; ++k)
    defined.push_back(
        stress::smoothValue(16, uvOf(k) * kPeriods, double(kLambda), kLight, towardsEye(uvOf(k))));
  run.compare(defined);
  // Qualities of look-up and shadows on a knitted tile, against rays.
  const importer::Tile tile = require(importer::builtinTile("pulli"));
  const Material surface = cookedSurface(tile, folder);
  std::filesystem::remove_all(folder);
  std::vector<std::unique_ptr<Material>> materials;
  std::vector<std::unique_ptr<Evaluator>> evaluators;
  const std::string relief = "look-up and shadows, pulli";
  for (const Visibility visibility : {Visibility::kNone, Visibility::kFast, Visibility::kDefault}) {
    materials.push_back(std::make_unique<Material>(surface));
    materials.back()->surface->visibility = visibility;
    const std::string shadows = std::string("shadows ") + visibilityName(visibility);
    const Setting as{relief, shadows, "", "shadows none, look-up none", {}, {}};
    for (const Lookup lookup : {Lookup::kNone, Lookup::kFast, Lookup::kDefault})
      if (lookup != Lookup::kNone || visibility == Visibility::kNone)
        run.addGpu(named(as, shadows + ", look-up " + std::string(lookupName(lookup))), *materials.back(), 0,
                   lookup);
  }
  run.compare(tracedTruth(tile));

  const std::vector<Setting> settings = run.measure();
  std::vector<importer::PlotPanel> panels;
  for (const Setting& setting : settings) {
    double base = setting.ms;
    for (const Setting& other : settings)
      if (other.name == setting.base) base = other.ms;
    std::printf("| %s | %s | %.2f | %.1f |\n", setting.panel.c_str(), setting.name.c_str(), setting.ms / base,
                setting.psnr);
    if (panels.empty() || panels.back().title != setting.panel) panels.push_back({setting.panel, {}});
    auto& all = panels.back().series;
    if (all.empty() || all.back().name != setting.series) all.push_back({setting.series, {}});
    all.back().points.emplace_back(setting.ms / base, setting.psnr);
  }
  // A plot's panels have the same series.
  std::vector<importer::PlotSeries> series;
  for (const importer::PlotPanel& panel : panels)
    for (const importer::PlotSeries& s : panel.series) series.push_back({s.name, {}});
  for (importer::PlotPanel& panel : panels) {
    std::vector<importer::PlotSeries> all = series;
    for (importer::PlotSeries& s : all) {
      for (const importer::PlotSeries& own : panel.series)
        if (own.name == s.name) s.points = own.points;
      std::sort(s.points.begin(), s.points.end());
    }
    panel.series = std::move(all);
  }
  const Status written =
      importer::writePlot({"Time against error", "time, ratio", "PSNR, dB", true, panels}, argv[1]);
  if (!written) std::fprintf(stderr, "%s: %s\n", written.issue().where.c_str(), written.issue().text.c_str());
  return written ? 0 : 2;
}
