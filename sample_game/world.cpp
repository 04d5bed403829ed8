#include "sample_game/world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>

#include "material/base/issues.h"
#include "material/model/directions.h"
#include "runtime/scene/gltf_scene.h"
#include "runtime/scene/mesh_analytic.h"
#include "sample_game/camera_file.h"
#include "sample_game/dress.h"
#include "sample_game/framing.h"
#include "sample_game/showcase.h"

namespace loden::walk {
namespace {

using namespace runtime;

void printIssue(const Issue& issue) {
  if (issue.severity == Severity::kNote) return;
  std::fprintf(stderr, "loden_walk: %s: %s [%d]\n", issue.where.c_str(), issue.text.c_str(), issue.id);
}

// Scenes have y up, surfaces z up.
glm::dvec3 upOf(const Options& options) {
  return options.onSurface() ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
}

Result<Scene> makeSurface(const Options& options) {
  const glm::dvec2 light = options.light.value_or(glm::dvec2(30, 0));
  const Spherical direction{light.x * kPi / 180, light.y * kPi / 180};
  const auto facts = readTileFacts(options.asset);  // what cannot be opened, its loading will say
  Scene scene = analyticScene(options.surface, options.asset, glm::vec3(directionFromSpherical(direction)),
                              facts ? facts->aspect : 1);
  if (!options.light && !options.environment.empty()) scene.lights.clear();
  return scene;
}

// The length of a tile that nobody has asked for, with a word about it where the asset says nothing either.
double periodOf(const Options& options, const TileFacts& facts) {
  if (options.period > 0) return options.period;
  if (facts.period > 0) return facts.period;
  if (!options.quiet)
    std::fprintf(stderr,
                 "loden_walk: %s does not say how long its tile is, and 4 cm are taken; --period chooses\n",
                 facts.name.c_str());
  return kUsualPeriod;
}

Result<Scene> makeShowcase(const Options& options) {
  const auto facts = readTileFacts(options.scene);
  if (!facts) return facts.issue();
  Scene scene = showcaseScene(options.scene, *facts, periodOf(options, *facts));
  if (options.rotation != 0) scene.materials[0].flat_btf->rotation = static_cast<float>(options.rotation);
  return scene;
}

void warnOfStretch(const Scene& scene, int material) {
  const UvSurvey survey = surveyUvs(scene, material);
  const UvSurvey::Stretch stretch = survey.stretch(survey.metresPerUnit());
  if (stretch.most <= UvSurvey::kStrong) return;
  std::fprintf(
      stderr,
      "loden_walk: texture coordinates of '%s' stretch the pattern up to %.2g times, and on %.0f %% of "
      "the area more than twice\n",
      scene.materials[size_t(material)].name.c_str(), stretch.most, 100 * stretch.share);
}

Result<Scene> makeScene(const Options& options) {
  if (options.onSurface()) return makeSurface(options);
  if (isAsset(options.scene)) return makeShowcase(options);
  Result<Scene> scene = loadGltfScene(options.scene, {options.variant});
  if (!scene || options.asset.empty()) return scene;
  const auto facts = readTileFacts(options.asset);
  if (!facts) return facts.issue();
  const Result<int> material = findMaterial(*scene, options.material);
  if (!material) return material.issue();
  const Status dressed = dress(*scene, *material, assetIndex(*scene, options.asset),
                               periodOf(options, *facts), facts->aspect, options.rotation);
  if (!dressed) return dressed.issue();
  if (!options.quiet) warnOfStretch(*scene, *material);
  return scene;
}

// What is asked for; for scenes without any light a neutral studio.
Result<Lighting> makeLighting(const Options& options, const Scene& scene) {
  Lighting lighting;
  if (!options.environment.empty()) {
    auto read = panoramaLighting(options.environment);
    if (!read) return read.issue();
    lighting = std::move(*read);
  } else if (!options.onSurface() && scene.lights.empty()) {
    lighting = neutralLighting();
  }
  lighting.y_up = !options.onSurface();
  return lighting;
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

// As far away as it takes on a way around.
Camera seenFromAllSides(const Bounds& box, double aspect) {
  Camera farthest;
  double most = 0;
  for (int k = 0; k < 12; ++k) {
    const double angle = 2 * kPi * k / 12;
    const glm::dvec3 direction = glm::normalize(glm::dvec3(std::sin(angle), 0.28, std::cos(angle)));
    const Camera camera = framedFrom(box, direction, aspect);
    const double distance = glm::distance(camera.position, camera.target);
    if (distance > most) farthest = camera, most = distance;
  }
  const glm::dvec3 ahead = glm::normalize(glm::dvec3(0, 0.28, 1));
  farthest.position = farthest.target + ahead * most;
  return farthest;
}

// Once around the camera's target, at 30 frames a second.
CameraPath turningAround(const Camera& camera, int frames) {
  constexpr int kKeys = 48;
  const glm::dvec3 arm = camera.position - camera.target;
  std::vector<CameraPath::Key> keys;
  for (int k = 0; k <= kKeys; ++k) {
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1), 2 * kPi * k / kKeys, camera.up);
    keys.push_back({double(k) / kKeys * frames / 30, camera.target + glm::dvec3(turn * glm::dvec4(arm, 0)),
                    camera.target});
  }
  return CameraPath(std::move(keys), camera);
}

Result<CameraPath> makePath(const Options& options, const Scene& scene) {
  if (!options.script.empty()) return readCameraPath(options.script, upOf(options));
  const double aspect = double(options.size.x) / options.size.y;
  if (options.turntable > 0)
    return turningAround(options.onSurface() ? Camera{} : seenFromAllSides(boundsOfAll(scene), aspect),
                         options.turntable);
  if (options.camera.empty() && options.onSurface()) return standingAt(Camera{});
  if (options.camera.empty())
    return standingAt(scene.cameras.empty() ? framed(boundsOfAll(scene), aspect)
                                            : cameraFromScene(scene.cameras[0]));
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
  materials.fade_levels_per_frame = 32;  // by time alone, however long a frame takes
  if (options.mode == Mode::kPaper) materials.lookup = Lookup::kPaper;
  if (options.mode == Mode::kNormalMap) materials.lookup = Lookup::kNone;
  return materials;
}

// On a surface: what `loden trace` draws, nothing else. In a scene: a picture.
FrameSettings frameSettings(const Options& options, const Scene& scene) {
  FrameSettings settings;
  // By day something is bright behind the windows.
  if (std::any_of(scene.lights.begin(), scene.lights.end(),
                  [](const Light& light) { return light.kind == LightKind::kSun; }))
    settings.background = {0.36f, 0.52f, 0.78f};
  settings.lambda_rule = options.lambda_rule;
  settings.lambda = options.lambda;
  settings.parallax_depth = options.parallax_depth || options.shell;
  settings.shell = options.shell;
  if (options.mode == Mode::kNoLod) settings.lambda = 0.0f;
  settings.base_materials_only = options.mode == Mode::kFallback;
  settings.parallax_occlusion = options.mode == Mode::kParallax;
  settings.tone = ToneCurve::kNeutral;
  settings.samples = 4;
  if (!options.onSurface()) return settings;
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
  animated_to = moving.duration > 0 ? std::fmod(first + seconds, moving.duration) : 0;
  const ScenePose now = pose();
  renderer->pose(scene, now);
  if (scene_camera < 0) return {};
  return cameraFromScene(cameraAt(scene.cameras[size_t(scene_camera)], now));
}

bool World::hasHeightField() const {
  const std::vector<MaterialId> ids = renderer->assets();
  return std::any_of(ids.begin(), ids.end(),
                     [&](MaterialId id) { return marchVariant(materials->variant(id)).has_value(); });
}

ScenePose World::pose() const {
  return poseAt(scene, animation < 0 ? nullptr : &scene.animations[size_t(animation)], animated_to);
}

Status World::replaceScene(Scene next, double aspect) {
  auto made = FrameRenderer::create(*device, *shaders, *materials, next);
  if (!made) return made.issue();
  renderer = std::move(*made);
  scene = std::move(next);
  for (SceneImage& image : scene.images) image.pixels = {};
  animation = scene.animations.empty() ? -1 : 0;
  animated_to = 0;
  scene_camera = -1;
  truth.reset();
  path = standingAt(framed(boundsOfAll(scene), aspect));
  return {};
}

Result<World> makeWorld(const Options& options) {
  Result<Scene> scene = makeScene(options);
  if (!scene) return scene.issue();
  for (const Issue& note : scene->notes) printIssue(note);
  if (scene->assets.empty() && !options.quiet)
    std::fprintf(stderr,
                 "loden_walk: %s has no Loden material, its own are drawn; --material NAME --asset X.loden "
                 "puts one on\n",
                 options.scene.c_str());
  FrameSettings settings = frameSettings(options, *scene);
  Result<Lighting> lighting = makeLighting(options, *scene);
  if (!lighting) return lighting.issue();
  lighting->apply(settings);
  const Result<int> animation = chooseAnimation(options, *scene);
  if (!animation) return animation.issue();
  const bool own_camera =
      options.script.empty() && options.camera.empty() && options.turntable == 0 && !scene->cameras.empty();
  Result<CameraPath> path = makePath(options, *scene);
  if (!path) return path.issue();
  std::optional<Truth> truth;
  if (!options.truth.empty()) {
    Result<Truth> read = readTruth(options.truth, path->at(0), options.size);
    if (!read) return read.issue();
    truth = std::move(*read);
  }

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
  World world{std::move(device).value(),
              std::move(shaders),
              std::move(materials).value(),
              std::move(renderer).value(),
              std::move(settings),
              std::move(path.value()),
              std::move(scene.value()),
              std::move(*lighting),
              *animation,
              own_camera ? 0 : -1,
              0,
              std::move(truth)};
  if (options.mode == Mode::kParallax && !world.hasHeightField())
    return Issue{issue_id::kOption, Severity::kError,
                 (options.scene.empty() ? options.asset : options.scene).string(),
                 "has no material of a height field with a near term, as --mode parallax needs"};
  return world;
}

}  // namespace loden::walk
