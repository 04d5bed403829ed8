// The interactive walk: takes input from keys, mouse, panel and dropped files, and does what it asks for.
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
  // World and options must outlive the player; the world must have a window.
  Player(World& world, const Options& options);

  // Takes the input, draws one step of the picture, and draws the panel. Returns false when the visitor
  // leaves. Issues: those of the renderer.
  Result<bool> step();

  const Camera& camera() const { return control_.camera(); }
  const Picture& picture() const { return picture_; }
  // True if nothing moves and nothing is left to draw, so that the window may wait for input.
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
  // Makes the chosen material show the scene's asset `asset`, or glTF's own material for -1.
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
  WindowInput input_;  // made before the panel, whose callbacks call those that it finds
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
  int saved_ = 0;  // number of pictures that were saved
};

}  // namespace loden::walk
