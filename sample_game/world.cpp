#include "sample_game/world.h"

#include <cmath>
#include <cstdio>

#include "material/base/issues.h"
#include "material/model/directions.h"
#include "material/system/asset_io.h"
#include "runtime/scene/gltf_scene.h"
#include "runtime/scene/image_read.h"
#include "runtime/scene/mesh_analytic.h"
#include "sample_game/camera_file.h"

namespace loden::walk {
namespace {

using namespace runtime;

constexpr int kEnvironmentSuns = 2;  // each costs as much as a light

void printIssue(const Issue& issue) {
  if (issue.severity == Severity::kNote) return;
  std::fprintf(stderr, "loden_walk: %s: %s [%d]\n", issue.where.c_str(), issue.text.c_str(), issue.id);
}

// Scenes have y up, surfaces z up.
glm::dvec3 upOf(const Options& options) {
  return options.asset.empty() ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
}

// Of the asset's tile; 1 of one that cannot be opened, which its loading will say.
double aspectOf(const std::filesystem::path& asset) {
  auto source = openFileSource(asset);
  if (!source) return 1;
  const auto file = AssetFile::open(std::move(*source), asset.string());
  return file ? double(file->skeleton().aspect) : 1.0;
}

Result<Scene> makeScene(const Options& options) {
  if (options.asset.empty()) return loadGltfScene(options.scene, {options.variant});
  const glm::dvec2 light = options.light.value_or(glm::dvec2(30, 0));
  const Spherical direction{light.x * kPi / 180, light.y * kPi / 180};
  Scene scene = analyticScene(options.surface, options.asset, glm::vec3(directionFromSpherical(direction)),
                              aspectOf(options.asset));
  if (!options.light && !options.environment.empty()) scene.lights.clear();
  return scene;
}

// What is asked for; for scenes without any light a neutral studio. Panoramas have z up, as surfaces have.
Status setEnvironment(const Options& options, const Scene& scene, FrameSettings& settings) {
  const bool neutral = options.asset.empty() && options.environment.empty() && scene.lights.empty();
  if (options.environment.empty() && !neutral) return {};
  const Result<Panorama> panorama =
      neutral ? Result<Panorama>(neutralPanorama()) : readPanorama(options.environment);
  if (!panorama) return panorama.issue();
  const glm::mat3 y_up(glm::vec3(1, 0, 0), glm::vec3(0, 0, -1), glm::vec3(0, 1, 0));
  const glm::mat3 world_from_panorama = options.asset.empty() ? y_up : glm::mat3(1);
  Environment environment = projectPanorama(*panorama, kEnvironmentSuns);
  environment.light = rotated(environment.light, world_from_panorama);
  for (EnvironmentSun& sun : environment.suns) sun.direction = world_from_panorama * sun.direction;
  settings.environment = std::move(environment);
  if (options.asset.empty())
    settings.reflections =
        std::make_shared<const ReflectionMap>(makeReflectionMap(*panorama, world_from_panorama));
  return {};
}

// In front of everything, looking at its middle.
Camera overview(const Scene& scene) {
  Bounds all;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Bounds box = transformed(scene.meshes[instance.mesh].bounds, instance.world_from_local);
    all = i == 0 ? box : Bounds{glm::min(all.min, box.min), glm::max(all.max, box.max)};
  }
  Camera camera;
  camera.up = {0, 1, 0};
  camera.target = glm::dvec3(all.centre());
  // As far away as makes the sphere around everything fit into a picture that is not upright.
  const double distance = double(all.radius()) / std::sin(camera.fov_degrees * kPi / 360);
  camera.position = camera.target + glm::normalize(glm::dvec3(0.35, 0.3, 1)) * std::max(distance, 1e-3);
  return camera;
}

// Index of the animation that is asked for; -1: none.
Result<int> chooseAnimation(const Options& options, const Scene& scene) {
  const int count = static_cast<int>(scene.animations.size());
  if (options.animation == "none") return -1;
  if (options.animation.empty()) return count > 0 ? 0 : -1;
  std::string names;
  for (int i = 0; i < count; ++i) {
    if (options.animation == scene.animations[size_t(i)].name || options.animation == std::to_string(i))
      return i;
    names += (i > 0 ? ", " : "") + scene.animations[size_t(i)].name;
  }
  return Issue{issue_id::kOption, Severity::kError, options.scene.string(),
               "has no animation " + options.animation + "; there are: " + (count > 0 ? names : "none")};
}

CameraPath standingAt(const Camera& camera) {
  return CameraPath({{0, camera.position, camera.target}}, camera);
}

Result<CameraPath> makePath(const Options& options, const Scene& scene) {
  if (!options.script.empty()) return readCameraPath(options.script, upOf(options));
  if (options.camera.empty() && !options.asset.empty()) return standingAt(Camera{});
  if (options.camera.empty())
    return standingAt(scene.cameras.empty() ? overview(scene) : cameraFromScene(scene.cameras[0]));
  const Result<Camera> camera = readCamera(options.camera, upOf(options));
  if (!camera) return camera.issue();
  return standingAt(*camera);
}

DeviceOptions deviceOptions(const Options& options) {
  DeviceOptions device;
  device.kind = options.headless ? DeviceKind::kHeadless : DeviceKind::kWindow;
  device.size = options.size;
  device.title = "loden_walk";
  device.debug = options.gl_debug;
  device.log = printIssue;
  return device;
}

MaterialSystemOptions materialOptions(const Options& options) {
  MaterialSystemOptions materials;
  materials.budget_bytes = static_cast<uint64_t>(options.budget_mb * (1 << 20));
  materials.upload_bytes_per_frame = static_cast<uint64_t>(options.upload_kb * (1 << 10));
  if (options.mode == Mode::kPaper) materials.lookup = Lookup::kPaper;
  if (options.mode == Mode::kNormalMap) materials.lookup = Lookup::kNone;
  return materials;
}

// On a surface: what `loden trace` draws, nothing else. In a scene: a picture.
FrameSettings frameSettings(const Options& options) {
  FrameSettings settings;
  settings.lambda_rule = options.lambda_rule;
  settings.lambda = options.lambda;
  settings.parallax_depth = options.parallax_depth;
  if (options.mode == Mode::kNoLod) settings.lambda = 0.0f;
  settings.base_materials_only = options.mode == Mode::kFallback;
  settings.exposure = 0.8f;
  settings.samples = 4;
  if (options.asset.empty()) return settings;
  settings.exposure = 1;
  settings.samples = 1;
  settings.shadows = false;
  settings.tone = ToneCurve::kClip;
  settings.sky_ambient = settings.ground_ambient = settings.background = glm::vec3(0);
  return settings;
}

}  // namespace

std::optional<Camera> World::animate(double seconds, double first) {
  if (animation < 0) return {};
  const SceneAnimation& moving = scene.animations[size_t(animation)];
  const double at = moving.duration > 0 ? std::fmod(first + seconds, moving.duration) : 0;
  const ScenePose pose = poseAt(scene, &moving, at);
  renderer->pose(scene, pose);
  if (scene_camera < 0) return {};
  return cameraFromScene(cameraAt(scene.cameras[size_t(scene_camera)], pose));
}

Result<World> makeWorld(const Options& options) {
  Result<Scene> scene = makeScene(options);
  if (!scene) return scene.issue();
  for (const Issue& note : scene->notes) printIssue(note);
  if (scene->assets.empty() && !options.quiet)
    std::fprintf(stderr, "loden_walk: %s has no Loden material, its own are drawn; loden pack adds one\n",
                 options.scene.c_str());
  FrameSettings settings = frameSettings(options);
  if (Status status = setEnvironment(options, *scene, settings); !status) return status.issue();
  const Result<int> animation = chooseAnimation(options, *scene);
  if (!animation) return animation.issue();
  const bool own_camera = options.script.empty() && options.camera.empty() && !scene->cameras.empty();
  Result<CameraPath> path = makePath(options, *scene);
  if (!path) return path.issue();

  auto device = Device::create(deviceOptions(options));
  if (!device) {
    Issue issue = device.issue();
    if (!options.headless) issue.text += "; without a display, draw with --headless";
    return issue;
  }
  auto shaders = std::make_unique<ShaderLibrary>(**device, ShaderLibraryOptions{options.shader_cache});
  auto materials = MaterialSystem::create(**device, materialOptions(options));
  if (!materials) return materials.issue();
  auto renderer = FrameRenderer::create(**device, *shaders, **materials, *scene);
  if (!renderer) return renderer.issue();
  for (SceneImage& image : scene->images) image.pixels = {};
  return World{std::move(device).value(),   std::move(shaders),  std::move(materials).value(),
               std::move(renderer).value(), std::move(settings), std::move(path.value()),
               std::move(scene.value()),    *animation,          own_camera ? 0 : -1};
}

}  // namespace loden::walk
