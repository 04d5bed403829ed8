// How keys and mouse move the camera: orbit, pan, zoom, fly, focus. This file knows no window, so that tests
// can drive the camera without one.
#pragma once

#include <bitset>
#include <glm/glm.hpp>
#include <optional>

#include "material/model/analytic_surface.h"
#include "runtime/scene/scene.h"

namespace loden::walk {

// The keys that move the camera while they are held, and what dragging the pointer does. A window reports
// when keys go down and up, and releases all of them when it loses the focus.
enum class MoveKey { kAhead, kBack, kLeft, kRight, kUp, kDown, kFaster, kCount };
enum class DragKind { kNone, kOrbit, kPan, kLook };

class CameraControl {
 public:
  // `scale`: the size of the scene in metres; steps and limits of the motion are proportional to it.
  CameraControl(const Camera& camera, double scale);

  const Camera& camera() const { return camera_; }
  void set(const Camera& camera);
  void setScale(double scale);

  // A key goes down or up. A key that was down for a moment only still moves the camera for kLeastHold.
  void press(MoveKey key);
  void release(MoveKey key);
  // Releases all keys, for a window that has lost the focus and will not hear when they go up.
  void releaseAll();

  void beginDrag(DragKind kind) { drag_ = kind; }
  void endDrag() { drag_ = DragKind::kNone; }
  DragKind drag() const { return drag_; }
  // Tells how far the pointer has moved, in pixels to the right and down, in a window window_height high.
  void moved(const glm::dvec2& pixels, double window_height);
  // Tells by how many clicks the mouse wheel has turned; positive ones move the camera nearer.
  void wheel(double clicks);
  // Starts to move the camera to where it looks at `point` from a distance of `distance`, in the direction in
  // which it looks now.
  void focus(const glm::dvec3& point, double distance);

  // Moves the camera by the keys that are held, and towards a focus. True if the camera has changed since the
  // last call.
  bool advance(double seconds);
  // True while keys or the pointer move the camera, or it is under way to a focus.
  bool moving() const;
  // True once the visitor has moved the camera, which then follows no camera path any more.
  bool taken() const { return taken_; }
  void giveBack() { taken_ = false; }

  static constexpr double kLeastHold = 0.05;  // seconds for which a short press moves the camera

 private:
  struct Way {
    glm::dvec3 from_position, from_target, to_position, to_target;
    double seconds = 0;
  };
  static constexpr size_t kKeys = static_cast<size_t>(MoveKey::kCount);

  void orbit(double yaw, double pitch);
  void look(double yaw, double pitch);
  void shift(const glm::dvec3& step);
  glm::dvec3 heldDirection() const;

  Camera camera_, last_;
  double scale_;
  std::bitset<kKeys> held_, tapped_;  // tapped: went down since the last advance
  DragKind drag_ = DragKind::kNone;
  std::optional<Way> way_;
  bool taken_ = false;
};

// The point of the scene's meshes that a ray meets first; none if it meets nothing. `direction` need not be
// unit.
std::optional<glm::dvec3> firstHit(const runtime::Scene& scene, const glm::dvec3& origin,
                                   const glm::dvec3& direction);
// The ray through a point of the picture, from 0 to 1 rightwards and downwards; unit.
glm::dvec3 rayThrough(const Camera& camera, const glm::dvec2& point, double aspect);

}  // namespace loden::walk
