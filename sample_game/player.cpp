#include "sample_game/player.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "runtime/scene/gltf_scene.h"
#include "runtime/scene/image_write.h"
#include "sample_game/framing.h"
#include "sample_game/showcase.h"

namespace loden::walk {

using namespace runtime;

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kMessageSeconds = 4;

std::optional<MoveKey> moveKeyOf(int key) {
  switch (key) {
    case GLFW_KEY_W:
    case GLFW_KEY_UP:
      return MoveKey::kAhead;
    case GLFW_KEY_S:
    case GLFW_KEY_DOWN:
      return MoveKey::kBack;
    case GLFW_KEY_A:
    case GLFW_KEY_LEFT:
      return MoveKey::kLeft;
    case GLFW_KEY_D:
    case GLFW_KEY_RIGHT:
      return MoveKey::kRight;
    case GLFW_KEY_E:
      return MoveKey::kUp;
    case GLFW_KEY_Q:
      return MoveKey::kDown;
    case GLFW_KEY_LEFT_SHIFT:
    case GLFW_KEY_RIGHT_SHIFT:
      return MoveKey::kFaster;
    default:
      return {};
  }
}

DragKind dragOf(const ButtonEvent& event) {
  if (event.button == GLFW_MOUSE_BUTTON_RIGHT) return DragKind::kLook;
  if (event.button == GLFW_MOUSE_BUTTON_MIDDLE) return DragKind::kPan;
  const bool with_key = (event.modifiers & (GLFW_MOD_SHIFT | GLFW_MOD_CONTROL)) != 0;
  return with_key ? DragKind::kPan : DragKind::kOrbit;
}

std::string nameOf(const Lighting& lighting) {
  if (!lighting.panorama) return "the scene's own lights";
  return lighting.neutral ? "neutral studio" : lighting.file.filename().string();
}

}  // namespace

Player::Player(World& world, const Options& options)
    : world_(world),
      options_(options),
      window_(static_cast<GLFWwindow*>(world.device->nativeWindow())),
      input_(window_),
      hud_(window_),
      control_(world.path.at(0), 1),
      picture_(world),
      last_(Clock::now()) {
  state_.budget_mb = options.budget_mb;
  constexpr double kRoomForPanel = 560;
  state_.panel = windowSize().x >= kRoomForPanel;
  control_.setScale(sceneScale());
  environments_ = {Lighting{}, neutralLighting()};
  environment_ = !world.lighting.panorama ? 0 : world.lighting.neutral ? 1 : 2;
  if (environment_ == 2) environments_.push_back(world.lighting);
  for (Lighting& lighting : environments_) {
    lighting.y_up = world.lighting.y_up;
    environment_names_.push_back(nameOf(lighting));
  }
  const auto dressed =
      std::find_if(world.scene.materials.begin(), world.scene.materials.end(),
                   [](const SceneMaterial& material) { return material.flat_btf.has_value(); });
  if (dressed != world.scene.materials.end())
    state_.material = static_cast<int>(dressed - world.scene.materials.begin());
  if (world.truth) state_.wipe = {true, Look::kTruth, Look::kDefault};
  say("H shows what keys and mouse do");
}

double Player::sceneScale() const {
  const Bounds all = world_.renderer->bounds();
  return std::clamp(2 * double(all.radius()), 0.01, 20.0);
}

glm::dvec2 Player::windowSize() const {
  int width = 1, height = 1;
  glfwGetWindowSize(window_, &width, &height);
  return {std::max(width, 1), std::max(height, 1)};
}

double Player::aspect() const {
  const glm::dvec2 size = windowSize();
  return size.x / size.y;
}

bool Player::idle() const {
  const bool moves =
      (world_.animation >= 0 && animated_) || (!control_.taken() && world_.path.duration() > 0);
  return picture_.whole() && !control_.moving() && !moves && state_.message_seconds <= 0;
}

Result<bool> Player::step() {
  const auto now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - last_).count();
  last_ = now;
  hear(input_.take());
  if (leave_ || world_.device->closeRequested()) return false;
  hud_.beginFrame();
  control_.advance(seconds);
  if (!control_.taken() && world_.path.duration() > 0) {
    path_seconds_ = std::fmod(path_seconds_ + seconds, world_.path.duration());
    control_.set(world_.path.at(path_seconds_));
  }
  if (world_.animation >= 0 && animated_) {
    animation_seconds_ += seconds;
    const auto camera = world_.animate(animation_seconds_, options_.time);
    if (camera && !control_.taken()) control_.set(*camera);
    picture_.changed();
  }
  if (learnPeriod(); state_.wipe.on) state_.wipe.border = std::clamp(state_.wipe.border, 0.02f, 0.98f);
  if (picture_.size().x == 0) return showPreparing();
  if (Status status = picture_.advance(control_.camera(), world_.device->size(), state_.wipe, float(seconds));
      !status)
    return status.issue();
  picture_.show();
  follow(hud_.draw(world_, state_, picture_, environment_names_, environment_, seconds));
  world_.device->swap();
  return true;
}

// Drivers compile programs when they are first drawn with, which may take a while.
Result<bool> Player::showPreparing() {
  if (Status status = picture_.begin(world_.device->size()); !status) return status.issue();
  hud_.drawPreparing();
  world_.device->swap();
  return true;
}

void Player::hear(const InputEvents& events) {
  for (const KeyEvent& event : events.keys) hearKey(event);
  for (const ButtonEvent& event : events.buttons) hearButton(event);
  const glm::dvec2 window = windowSize();
  if (drags_wipe_)
    state_.wipe.border = static_cast<float>(std::clamp(input_.pointer().x / window.x, 0.02, 0.98));
  else
    control_.moved(events.motion, window.y);
  if (events.wheel != 0 && !hud_.wantsPointer()) control_.wheel(events.wheel);
  if (events.focus_lost) {
    control_.releaseAll();
    drags_wipe_ = false;
  }
  for (const std::filesystem::path& file : events.dropped) takeDropped(file);
}

void Player::hearKey(const KeyEvent& event) {
  if (event.down && event.key == GLFW_KEY_ESCAPE) leave_ = true;
  if (const auto move = moveKeyOf(event.key)) {
    if (!event.down)
      control_.release(*move);
    else if (!hud_.wantsKeyboard())
      control_.press(*move);
    return;
  }
  if (event.down && !hud_.wantsKeyboard()) command(event.key);
}

void Player::hearButton(const ButtonEvent& event) {
  if (!event.down) {
    control_.endDrag();
    drags_wipe_ = false;
    return;
  }
  if (hud_.wantsPointer()) return;
  constexpr double kReach = 8;  // of the wipe's line, window coordinates
  const double line = double(state_.wipe.border) * windowSize().x;
  if (state_.wipe.on && event.button == GLFW_MOUSE_BUTTON_LEFT && std::abs(event.at.x - line) < kReach) {
    drags_wipe_ = true;
    return;
  }
  if (event.twice && event.button == GLFW_MOUSE_BUTTON_LEFT) return focusAt(event.at);
  control_.beginDrag(dragOf(event));
}

void Player::command(int key) {
  FrameSettings& settings = world_.settings;
  switch (key) {
    case GLFW_KEY_F:
    case GLFW_KEY_HOME:
      return seeAll();
    case GLFW_KEY_P:
      control_.giveBack();
      control_.set(world_.path.at(path_seconds_));
      return;
    case GLFW_KEY_SPACE:
      animated_ = !animated_;
      return;
    case GLFW_KEY_B:
      settings.base_materials_only = !settings.base_materials_only;
      say(settings.base_materials_only ? "glTF's own materials" : "Loden materials");
      return picture_.changed();
    case GLFW_KEY_C:
      state_.wipe.on = !state_.wipe.on;
      return;
    case GLFW_KEY_X:
      settings.heat = static_cast<HeatMap>((static_cast<int>(settings.heat) + 1) % 4);
      return picture_.changed();
    case GLFW_KEY_TAB:
      state_.panel = !state_.panel;
      return;
    case GLFW_KEY_F12:
      return savePicture();
    case GLFW_KEY_H:
    case GLFW_KEY_F1:
      state_.help = !state_.help;
      return;
    default:
      return;
  }
}

void Player::focusAt(const glm::dvec2& at) {
  const Camera& camera = control_.camera();
  const glm::dvec2 window = windowSize();
  const auto point =
      firstHit(world_.scene, camera.position, rayThrough(camera, at / window, window.x / window.y));
  if (!point) return;
  control_.focus(*point, glm::distance(*point, camera.position) / 2);
}

void Player::seeAll() {
  Bounds all = world_.renderer->bounds();
  const glm::dvec3 away = control_.camera().position - control_.camera().target;
  const Camera camera = framedFrom(all, glm::normalize(away), aspect());
  control_.focus(camera.target, glm::distance(camera.position, camera.target));
}

void Player::say(const std::string& message) {
  state_.message = message;
  state_.message_seconds = kMessageSeconds;
}

void Player::say(const Status& status, const std::string& done) {
  if (status) return say(done);
  const Issue& issue = status.issue();
  std::fprintf(stderr, "loden_walk: %s: %s [%d]\n", issue.where.c_str(), issue.text.c_str(), issue.id);
  say(issue.text.substr(0, 110));
}

void Player::takeDropped(const std::filesystem::path& file) {
  const std::string extension = file.extension().string(), name = file.filename().string();
  if (extension == ".gltf" || extension == ".glb") return say(dropScene(file), name);
  if (extension == ".loden") return say(dropAsset(file), name);
  if (extension == ".hdr") return say(dropLight(file), name);
  say(name + " is no .gltf, .glb, .loden or .hdr file");
}

Status Player::dropScene(const std::filesystem::path& file) {
  auto scene = loadGltfScene(file);
  if (!scene) return scene.issue();
  return replaceScene(std::move(*scene));
}

Status Player::replaceScene(Scene scene) {
  if (Status status = world_.replaceScene(std::move(scene), aspect()); !status) return status;
  for (Look* look : {&state_.wipe.left, &state_.wipe.right})
    if (*look == Look::kTruth) *look = Look::kFallback;  // it was the other scene's
  state_.material = 0;
  state_.period = 0;
  animation_seconds_ = 0;
  control_.set(world_.path.at(0));
  control_.setScale(sceneScale());
  if (world_.scene.lights.empty() && environment_ == 0) chooseEnvironment(1);
  picture_.changed();
  return {};
}

Status Player::dropAsset(const std::filesystem::path& file) {
  const auto facts = readTileFacts(file);
  if (!facts) return facts.issue();
  if (world_.scene.materials.empty())
    return replaceScene(showcaseScene(file, *facts, facts->period > 0 ? facts->period : kUsualPeriod));
  return wear(assetIndex(world_.scene, std::filesystem::absolute(file)));
}

Status Player::dropLight(const std::filesystem::path& file) {
  auto lighting = panoramaLighting(file);
  if (!lighting) return lighting.issue();
  lighting->y_up = world_.lighting.y_up;
  environments_.push_back(std::move(*lighting));
  environment_names_.push_back(nameOf(environments_.back()));
  chooseEnvironment(static_cast<int>(environments_.size()) - 1);
  return {};
}

void Player::chooseEnvironment(int index) {
  environment_ = index;
  const double turn = world_.lighting.turn;
  world_.lighting = environments_[size_t(index)];
  world_.lighting.turn = turn;
  world_.lighting.apply(world_.settings);
  picture_.changed();
}

Status Player::wear(int asset) {
  SceneMaterial& material = world_.scene.materials[size_t(state_.material)];
  if (asset < 0) {
    material.flat_btf.reset();
    state_.period = 0;
    return showDress();
  }
  const auto facts = world_.scene.assets[size_t(asset)].path.empty()
                         ? Result<TileFacts>(TileFacts{})
                         : readTileFacts(world_.scene.assets[size_t(asset)].path);
  if (!facts) return facts.issue();
  const double period = facts->period > 0 ? facts->period : state_.period > 0 ? state_.period : kUsualPeriod;
  if (Status status = dress(world_.scene, state_.material, asset, period, facts->aspect, state_.rotation);
      !status)
    return status;
  state_.period = period;
  return showDress();
}

Status Player::dressAgain() {
  const auto& binding = world_.scene.materials[size_t(state_.material)].flat_btf;
  if (!binding) return {};
  const MaterialId id = world_.renderer->assets()[size_t(binding->asset)];
  if (Status status = dress(world_.scene, state_.material, binding->asset, state_.period,
                            double(world_.materials->material(id).aspect), state_.rotation);
      !status)
    return status;
  return showDress();
}

Status Player::showDress() {
  picture_.changed();
  return world_.renderer->dress(world_.scene, world_.pose());
}

// How long the chosen material's tile is, where nobody has asked yet.
void Player::learnPeriod() {
  if (state_.period > 0 || world_.scene.materials.empty()) return;
  const auto& binding = world_.scene.materials[size_t(state_.material)].flat_btf;
  if (!binding) return;
  const UvSurvey survey = surveyUvs(world_.scene, state_.material);
  if (survey.empty()) return;
  state_.rotation = double(binding->rotation);
  state_.period = periodOfScale(survey.metresPerUnit(), glm::dvec2(binding->scale), state_.rotation).x;
}

void Player::follow(const HudRequests& requests) {
  if (requests.redraw) picture_.changed();
  if (requests.wear) say(wear(*requests.wear), "dressed");
  if (requests.dress)
    if (Status status = dressAgain(); !status) say(status, "");
  if (requests.environment) chooseEnvironment(*requests.environment);
  if (requests.environment_turn) {
    world_.lighting.turn = *requests.environment_turn;
    world_.lighting.apply(world_.settings);
    picture_.changed();
  }
  if (requests.budget) world_.materials->setBudget(static_cast<uint64_t>(state_.budget_mb * (1 << 20)));
}

void Player::savePicture() {
  std::filesystem::path file;
  std::error_code error;
  do file = "loden_walk-" + std::to_string(++saved_) + ".png";
  while (std::filesystem::exists(file, error));
  const glm::ivec2 size = picture_.size();
  if (size.x > 0) say(writePng(file, picture_.codes(), size), "saved " + file.string());
}

}  // namespace loden::walk
