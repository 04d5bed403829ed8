// What each skip of the runtime saves, switched off alone: time in one interleaved run, texture instructions
// per pixel, bytes read. llvmpipe runs both sides of every `if`, so that a skip inside a shader shows in the
// time here only where it ends a loop; its fetches are what a GPU saves.
#include <epoxy/gl.h>

#include <cstdio>

#include "runtime/frame/frame.h"
#include "runtime/scene/mesh_analytic.h"
#include "runtime/shader/shader_library.h"
#include "tests/bench/bench_support.h"

namespace {

using namespace loden;
using namespace loden::bench;
using namespace loden::runtime;

constexpr glm::ivec2 kSize{400, 400};
constexpr int kRounds = 15;

void printRow(const char* skip, const char* unit, double with, double without, double ms_with,
              double ms_without) {
  std::printf("%-34s %-14s %12.1f %12.1f %8.2f %8.2f %8.2f\n", skip, unit, with, without, ms_with, ms_without,
              ms_with > 0 ? ms_without / ms_with : 0.0);
}

// --- inside the shader
// ---------------------------------------------------------------------------------------

struct ShaderSkip {
  const char* name;
  Material material;
  float lambda;
  const char* off;  // the define that switches it off
};

void reportShaderSkip(MaterialSystem& materials, const FullScreen& screen, const ShaderSkip& skip) {
  const MaterialId id = require(materials.load(assetSource(skip.material), skip.name));
  materials.demand(id, 0);
  materials.finishLoading();
  const auto program = [&](bool off, bool count) {
    std::vector<std::string> defines = variantDefines(materials.variant(id));
    if (count) defines.push_back("LODEN_COUNT_FETCHES 1");
    if (off) defines.push_back(std::string(skip.off) + " 1");
    return screen.program(kMaterialFragment, defines);
  };
  materials.bind(id);
  const GlProgram on = program(false, false), off = program(true, false);
  const double with = meanFetches(screen, program(false, true), glm::vec2(skip.lambda));
  const double without = meanFetches(screen, program(true, true), glm::vec2(skip.lambda));
  std::vector<std::function<void()>> tasks;
  for (const GlProgram* p : {&on, &off})
    tasks.push_back([&, p] { drawAt(screen, *p, glm::vec2(skip.lambda)); });
  const std::vector<double> ms = interleavedMedians(tasks, kRounds);
  printRow(skip.name, "fetches", with, without, ms[0], ms[1]);
  glUseProgram(0);
}

// --- in the frame loop
// ---------------------------------------------------------------------------------------

struct Stage {
  std::unique_ptr<MaterialSystem> materials;
  std::unique_ptr<ShaderLibrary> shaders;
  std::unique_ptr<FrameRenderer> renderer;
  FrameSettings settings;
  View view;
};

// Planes with a material each, placed by `position`.
Scene planes(int count, const std::function<glm::vec3(int)>& position) {
  Scene scene = analyticScene(SurfaceKind::kPlane, {}, glm::vec3(0, 0, 1));
  scene.assets[0].embedded = require(serializeAsset(fusedMaterial(1)));
  for (int i = 1; i < count; ++i) {
    scene.assets.push_back(scene.assets[0]);
    scene.materials.push_back(scene.materials[0]);
    scene.materials.back().flat_btf->asset = i;
    scene.instances.push_back(scene.instances[0]);
    scene.instances.back().material = i;
  }
  for (int i = 0; i < count; ++i) scene.instances[size_t(i)].world_from_local[3] = glm::vec4(position(i), 1);
  return scene;
}

Stage makeStage(const Device& device, const Scene& scene, const FrameSettings& settings, glm::ivec2 size) {
  Stage stage;
  stage.settings = settings;
  stage.view = makeView({}, size);
  stage.materials = require(MaterialSystem::create(device, {.budget_bytes = 256u << 20}));
  stage.shaders = std::make_unique<ShaderLibrary>(device, ShaderLibraryOptions{});
  stage.renderer = require(FrameRenderer::create(device, *stage.shaders, *stage.materials, scene));
  stage.renderer->prepare(stage.view, settings);
  stage.materials->finishLoading();
  return stage;
}

void reportFrameSkip(const Device& device, const char* name, const Scene& scene, const FrameSettings& on,
                     const FrameSettings& off) {
  const RenderTarget target = require(makeRenderTarget({400, 300}, ColorFormat::kSrgb8, "skips"));
  Stage stages[] = {makeStage(device, scene, on, target.size), makeStage(device, scene, off, target.size)};
  std::vector<std::function<void()>> tasks;
  for (const Stage& stage : stages)
    tasks.push_back([&] {
      stage.renderer->prepare(stage.view, stage.settings);
      stage.materials->update(1.0f / 60);
      if (Status status = stage.renderer->draw({target.framebuffer.name(), target.size}); !status)
        fail(status.issue());
    });
  const std::vector<double> ms = interleavedMedians(tasks, kRounds);
  const auto kib = [](const Stage& stage) { return double(stage.materials->stats().read_bytes) / 1024; };
  printRow(name, "KiB read", kib(stages[0]), kib(stages[1]), ms[0], ms[1]);
}

void reportFrameSkips(const Device& device) {
  FrameSettings plain;
  const auto with = [&](auto change) {
    FrameSettings settings = plain;
    change(settings);
    return settings;
  };
  const Scene behind = planes(50, [](int i) { return glm::vec3(0, i ? -50.0f - 3.0f * float(i) : 0.0f, 0); });
  reportFrameSkip(device, "invisible objects (1 of 50)", behind, plain,
                  with([](FrameSettings& s) { s.cull = false; }));
  // Materials are drawn in the order of their assets: here the farthest plane first.
  const Scene stack = planes(4, [](int i) { return glm::vec3(0, 0, -0.3f + 0.1f * float(i)); });
  reportFrameSkip(device, "depth pre-pass (4 planes deep)", stack, plain,
                  with([](FrameSettings& s) { s.depth_prepass = false; }));
  const FrameSettings relief = with([](FrameSettings& s) { s.parallax_depth = true; });
  reportFrameSkip(device, "relief's pre-pass (4 planes deep)", stack, relief, with([](FrameSettings& s) {
                    s.parallax_depth = true;
                    s.depth_prepass = false;
                  }));
  const FrameSettings dark = with([](FrameSettings& s) { s.sky_ambient = s.ground_ambient = glm::vec3(0); });
  const FrameSettings dim =
      with([](FrameSettings& s) { s.sky_ambient = s.ground_ambient = glm::vec3(1e-6f); });
  reportFrameSkip(device, "environment without light", planes(1, [](int) { return glm::vec3(0); }), dark,
                  dim);
}

// --- what is read and compiled
// ---------------------------------------------------------------------------------

// Twenty materials seen from where lambda is 3, against all of each.
void reportLevels(const Device& device) {
  double kib[2], resident[2];
  for (const bool all : {false, true}) {
    const auto materials = require(MaterialSystem::create(device, {}));
    for (uint32_t i = 0; i < 20; ++i)
      materials->demand(require(materials->load(assetSource(fusedMaterial(i)), "levels")), all ? 0.0f : 3.0f);
    materials->finishLoading();
    kib[all] = double(materials->stats().read_bytes) / 1024;
    resident[all] = double(materials->stats().resident_bytes) / 1024;
  }
  printRow("levels nobody asks for", "KiB read", kib[0], kib[1], 0, 0);
  printRow("", "KiB resident", resident[0], resident[1], 0, 0);
}

void reportVariants(const Device& device) {
  Stage stage = makeStage(device, planes(1, [](int) { return glm::vec3(0); }), {}, {64, 48});
  const RenderTarget target = require(makeRenderTarget({64, 48}, ColorFormat::kSrgb8, "variants"));
  if (Status status = stage.renderer->draw({target.framebuffer.name(), target.size}); !status)
    fail(status.issue());
  int listed = 0;
  for (const ProgramRow& row : kProgramRows) listed += static_cast<int>(rowVariants(row).size());
  const ShaderStats& stats = stage.shaders->stats();
  printRow("shader variants nobody uses", "programs", stats.compiled, listed, 1000 * stats.seconds,
           1000 * stats.seconds / stats.compiled * listed);
}

}  // namespace

int main(int argc, char** argv) {
  answerHelp(argc, argv, "bench_skips");
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const std::unique_ptr<Device> device = makeDevice();
  std::printf("# bench_skips: median of %d interleaved frames, %s; each skip on, and off alone\n", kRounds,
              device->capabilities().renderer.c_str());
  std::printf("# the time of unused variants is that of the used ones, times their number\n");
  std::printf("%-34s %-14s %12s %12s %8s %8s %8s\n", "skip", "count", "on", "off", "ms on", "ms off",
              "off/on");
  {
    const auto materials = require(MaterialSystem::create(*device, {}));
    const FullScreen screen(kSize);
    for (const ShaderSkip& skip :
         {ShaderSkip{"closed band windows (lambda 3)", fusedMaterial(1), 3, "LODEN_NO_BRANCH"},
          ShaderSkip{"lookup for no band (lambda 3)", fusedMaterial(1), 3, "LODEN_ALWAYS_LOOKUP"},
          ShaderSkip{"sub-pixel parallax (lambda 5)", surfaceMaterial(1), 5, "FULL_PARALLAX"}})
      reportShaderSkip(*materials, screen, skip);
  }
  reportFrameSkips(*device);
  reportLevels(*device);
  reportVariants(*device);
  return 0;
}
