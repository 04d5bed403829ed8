// The visitor in the window: follows the camera path until a key or the mouse takes over; shows an overlay.
#pragma once

#include <chrono>
#include <memory>

#include "runtime/frame/frame.h"
#include "runtime/gl/device.h"
#include "runtime/gl/material/material_system.h"
#include "runtime/scene/camera.h"

namespace loden::walk {

// W A S D: move; Q E: down, up; Shift: faster; right mouse button and motion: look; P: back to the path; Esc:
// leave.
class Player {
 public:
  // Both must outlive the player.
  Player(runtime::Device& device, const runtime::CameraPath& path);
  ~Player();
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;

  // Reads the input and begins the overlay; seconds since the last call.
  float beginFrame();
  const Camera& camera() const { return camera_; }
  bool wantsToLeave() const { return leave_; }
  // Draws the overlay on top of the frame; `settings` change by its controls.
  void drawOverlay(double ms, const runtime::FrameStats& frame, const runtime::MaterialStats& materials,
                   runtime::FrameSettings& settings);

 private:
  void look();
  void move(float seconds);

  struct Ui;  // ImGui's context
  runtime::Device& device_;
  const runtime::CameraPath& path_;
  std::unique_ptr<Ui> ui_;
  Camera camera_;
  std::chrono::steady_clock::time_point last_;
  double path_seconds_ = 0;
  bool free_ = false;  // off the path
  bool leave_ = false;
  glm::dvec2 cursor_{0};
};

}  // namespace loden::walk
