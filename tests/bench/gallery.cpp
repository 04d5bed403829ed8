#include "tests/bench/gallery.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <glm/gtc/constants.hpp>

#include "importer/cook/cook.h"
#include "importer/study/study.h"
#include "material/asset/asset.h"
#include "material/system/asset_io.h"
#include "runtime/scene/mesh_analytic.h"
#include "tests/bench/bench_support.h"

namespace loden::bench {
namespace {

using namespace runtime;

constexpr float kSpacing = 1.2f;              // metres
constexpr float kPeriodsPerLine = 1.0f / 80;  // of a tile across a panel, per pixel of the picture's height

std::vector<Material> readAll(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".loden") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<Material> materials;
  for (const auto& path : paths) {
    materials.push_back(require(readAsset(path)));
    materials.back().name = path.stem().string();
  }
  return materials;
}

std::vector<Material> cookAll() {
  importer::StudyOptions options;
  options.bakes = "out/studies/bakes";
  options.quiet = true;
  std::vector<Material> materials;
  for (const std::string& tile : options.tiles)
    for (const Mode mode : {Mode::kFused, Mode::kSurface}) {
      importer::CookOptions cook;
      cook.mode = mode;
      cook.quiet = true;
      materials.push_back(require(importer::cook(require(importer::studyBake(options, tile)), cook)));
      materials.back().name = tile + " " + modeName(mode);
    }
  return materials;
}

// One square metre, facing +z.
Mesh panelMesh() {
  Mesh mesh;
  mesh.name = "panel";
  for (const glm::vec2 uv : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)})
    mesh.vertices.push_back({glm::vec3(uv - 0.5f, 0), {0, 0, 1}, {1, 0, 0, 1}, uv});
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.bounds = boundsOf(mesh);
  return mesh;
}

Light sunFrom(const glm::vec3& to_light) {
  Light sun;
  sun.kind = LightKind::kSun;
  sun.direction = -glm::normalize(to_light);
  sun.intensity = glm::vec3(glm::pi<float>());
  return sun;
}

// Of this thread alone: other work on the machine does not count.
double threadMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
}

}  // namespace

std::vector<Material> galleryMaterials(const std::filesystem::path& folder) {
  std::vector<Material> materials = folder.empty() ? cookAll() : readAll(folder);
  if (materials.empty()) {
    std::fprintf(stderr, "no .loden file in %s\n", folder.c_str());
    std::exit(2);
  }
  return materials;
}

Scene galleryScene(const std::vector<Material>& materials, int count, int height) {
  Scene scene;
  scene.meshes.push_back(panelMesh());
  for (int i = 0; i < count; ++i) {
    Material variation = materials[size_t(i) % materials.size()];
    variation.name.append(" ").append(std::to_string(i));
    variation.mean.cb += 0.002f * float(i % 10);
    SceneMaterial material;
    material.name = variation.name;
    material.flat_btf = FlatBtfBinding{i, 0, glm::vec2(kPeriodsPerLine * float(height)), 0};
    scene.assets.push_back({{}, require(serializeAsset(variation)), variation.name});
    scene.materials.push_back(material);
    Instance panel{variation.name, 0, i, glm::mat4(1)};
    panel.world_from_local[3] = glm::vec4(kSpacing * float(i), 0, 0, 1);
    scene.instances.push_back(panel);
  }
  scene.lights.push_back(sunFrom({-0.4f, 0.5f, 0.8f}));
  return scene;
}

View galleryView(float at, glm::ivec2 size) {
  Camera camera;
  camera.position = {kSpacing * at, 0, 1.5};
  camera.target = camera.position + glm::dvec3(0.75, 0, -1);
  camera.up = {0, 1, 0};
  camera.fov_degrees = 55;
  return makeView(camera, size);
}

Scene planeScene(const Material& material, int count) {
  Scene scene = analyticScene(SurfaceKind::kPlane, {}, glm::vec3(0, 0, 1));
  scene.assets[0].embedded = require(serializeAsset(material));
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

double Stage::frame(const View& view, float seconds, const RenderTarget& target) const {
  renderer->prepare(view, {});
  const double start = threadMilliseconds();
  materials->update(seconds);
  const double spent = threadMilliseconds() - start;
  if (Status status = renderer->draw({target.framebuffer.name(), target.size}); !status) fail(status.issue());
  renderer->finish();
  return spent;
}

Stage makeStage(const Device& device, const Scene& scene, const MaterialSystemOptions& options,
                std::shared_ptr<ShaderLibrary> shaders) {
  Stage stage;
  stage.materials = require(MaterialSystem::create(device, options));
  stage.shaders =
      shaders ? std::move(shaders) : std::make_shared<ShaderLibrary>(device, ShaderLibraryOptions{});
  stage.renderer = require(FrameRenderer::create(device, *stage.shaders, *stage.materials, scene));
  return stage;
}

}  // namespace loden::bench
