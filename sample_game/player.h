// The visitor in the window: hears keys, mouse, panel and dropped files, and does what they ask for.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "sample_game/camera_control.h"
#include "sample_game/hud.h"
#include "sample_game/options.h"
#include "sample_game/picture.h"
#include "sample_game/window_input.h"
#include "sample_game/world.h"

namespace loden::walk {

class Player {
 public:
  // Both must outlive the player; the world has a window.
  Player(World& world, const Options& options);

  // One round: input, one step of the picture, the panel. False when the visitor leaves. Issues of the
  // renderer.
  Result<bool> step();

  const Camera& camera() const { return control_.camera(); }
  const Picture& picture() const { return picture_; }
  // Nothing moves and nothing is left to draw: the window may wait for input.
  bool idle() const;

 private:
  Result<bool> showPreparing();
  void hear(const InputEvents& events);
  void hearKey(const KeyEvent& event);
  void hearButton(const ButtonEvent& event);
  void command(int key);
  void focusAt(const glm::dvec2& at);
  void seeAll();
  void takeDropped(const std::filesystem::path& file);
  Status replaceScene(runtime::Scene scene);
  Status dropScene(const std::filesystem::path& file);
  Status dropAsset(const std::filesystem::path& file);
  Status dropLight(const std::filesystem::path& file);
  void follow(const HudRequests& requests);
  void chooseEnvironment(int index);
  // The chosen material wears asset `asset` of the scene, or its own look for -1.
  Status wear(int asset);
  Status dressAgain();
  void learnPeriod();
  Status showDress();
  void savePicture();
  void say(const std::string& message);
  void say(const Status& status, const std::string& done);
  double sceneScale() const;
  double aspect() const;
  glm::dvec2 windowSize() const;

  World& world_;
  const Options& options_;
  GLFWwindow* window_;
  WindowInput input_;  // before the panel, which calls what it finds
  Hud hud_;
  CameraControl control_;
  Picture picture_;
  HudState state_;
  std::vector<Lighting> environments_;
  std::vector<std::string> environment_names_;
  int environment_ = 0;
  std::chrono::steady_clock::time_point last_;
  double path_seconds_ = 0, animation_seconds_ = 0;
  bool animated_ = true, leave_ = false, drags_wipe_ = false;
  int saved_ = 0;  // pictures
};

}  // namespace loden::walk
