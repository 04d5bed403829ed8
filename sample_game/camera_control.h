// How keys and mouse move the camera: orbit, pan, zoom, fly, focus. No window here, so that tests can drive
// it.
#pragma once

#include <bitset>
#include <glm/glm.hpp>
#include <optional>

#include "material/model/analytic_surface.h"
#include "runtime/scene/scene.h"

namespace loden::walk {

// What a visitor can hold down or do. Keys that move are held; a window says when they go down and up, and
// releases all when it loses the focus.
enum class MoveKey { kAhead, kBack, kLeft, kRight, kUp, kDown, kFaster, kCount };
enum class DragKind { kNone, kOrbit, kPan, kLook };

class CameraControl {
 public:
  // `scale`: metres that matter here, of which steps and limits are shares.
  CameraControl(const Camera& camera, double scale);

  const Camera& camera() const { return camera_; }
  void set(const Camera& camera);
  void setScale(double scale);

  // A key goes down or up. Down for a moment only, it still moves for kLeastHold.
  void press(MoveKey key);
  void release(MoveKey key);
  // The window has lost the focus: whoever lets go elsewhere is not heard.
  void releaseAll();

  void beginDrag(DragKind kind) { drag_ = kind; }
  void endDrag() { drag_ = DragKind::kNone; }
  DragKind drag() const { return drag_; }
  // Motion of the pointer in pixels, right and down, in a window of that height.
  void moved(const glm::dvec2& pixels, double window_height);
  // Clicks of the wheel; positive comes nearer.
  void wheel(double clicks);
  // Looks at a point from the same side, as far away as makes what is around it fill a third of the height.
  void focus(const glm::dvec3& point, double distance);

  // Moves by what is held, and along the way to a focus. True if the camera is another than before the last
  // call.
  bool advance(double seconds);
  // Someone moves the camera, or it is under way.
  bool moving() const;
  // The visitor has taken over from whatever path there was.
  bool taken() const { return taken_; }
  void giveBack() { taken_ = false; }

  static constexpr double kLeastHold = 0.05;  // seconds that a tap counts for

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
