#include "sample_game/camera_control.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "material/model/directions.h"

namespace loden::walk {
namespace {

constexpr double kRadiansPerHeight = 2.4;  // a drag across the window's height
constexpr double kSteepest = 1.5;          // radians over or below the horizon
constexpr double kWaySeconds = 0.35;       // to a focus
constexpr double kFasterFactor = 4;

// Turns a direction by angles around `up` and around the axis to the right; stops short of straight up or
// down.
glm::dvec3 turned(const glm::dvec3& direction, const glm::dvec3& up, double yaw, double pitch) {
  const glm::dvec3 right = glm::normalize(glm::cross(direction, up)), ahead = glm::cross(up, right);
  const double height =
      std::clamp(std::asin(std::clamp(glm::dot(direction, up), -1.0, 1.0)) + pitch, -kSteepest, kSteepest);
  const glm::dvec3 level = std::cos(yaw) * ahead + std::sin(yaw) * right;
  return std::cos(height) * level + std::sin(height) * up;
}

double smooth(double x) {
  return x * x * (3 - 2 * x);
}

bool same(const Camera& a, const Camera& b) {
  return a.position == b.position && a.target == b.target && a.up == b.up && a.fov_degrees == b.fov_degrees;
}

}  // namespace

CameraControl::CameraControl(const Camera& camera, double scale)
    : camera_(camera), last_(camera), scale_(scale) {}

void CameraControl::set(const Camera& camera) {
  camera_ = camera;
  way_.reset();
}

void CameraControl::setScale(double scale) {
  scale_ = std::max(scale, 1e-3);
}

void CameraControl::press(MoveKey key) {
  held_.set(static_cast<size_t>(key));
  tapped_.set(static_cast<size_t>(key));
}

void CameraControl::release(MoveKey key) {
  held_.reset(static_cast<size_t>(key));
}

void CameraControl::releaseAll() {
  held_.reset();
  tapped_.reset();
  endDrag();
}

void CameraControl::moved(const glm::dvec2& pixels, double window_height) {
  if (drag_ == DragKind::kNone || pixels == glm::dvec2(0)) return;
  const glm::dvec2 share = pixels / std::max(window_height, 1.0);
  if (drag_ == DragKind::kOrbit) orbit(share.x * kRadiansPerHeight, share.y * kRadiansPerHeight);
  if (drag_ == DragKind::kLook) look(share.x * kRadiansPerHeight / 2, -share.y * kRadiansPerHeight / 2);
  if (drag_ != DragKind::kPan) return;
  // What lies under the pointer at the target's distance stays under it.
  const glm::dvec3 ahead = camera_.target - camera_.position;
  const double height = 2 * glm::length(ahead) * std::tan(camera_.fov_degrees * kPi / 360);
  const glm::dvec3 right = glm::normalize(glm::cross(ahead, camera_.up));
  const glm::dvec3 above = glm::normalize(glm::cross(right, ahead));
  shift(height * (share.y * above - share.x * right));
}

void CameraControl::orbit(double yaw, double pitch) {
  taken_ = true;
  way_.reset();
  const glm::dvec3 arm = camera_.target - camera_.position;
  const glm::dvec3 direction = turned(glm::normalize(arm), camera_.up, yaw, -pitch);
  camera_.position = camera_.target - glm::length(arm) * direction;
}

void CameraControl::look(double yaw, double pitch) {
  taken_ = true;
  way_.reset();
  const glm::dvec3 arm = camera_.target - camera_.position;
  camera_.target = camera_.position + glm::length(arm) * turned(glm::normalize(arm), camera_.up, yaw, pitch);
}

void CameraControl::shift(const glm::dvec3& step) {
  taken_ = true;
  way_.reset();
  camera_.position += step;
  camera_.target += step;
}

void CameraControl::wheel(double clicks) {
  taken_ = true;
  way_.reset();
  const glm::dvec3 arm = camera_.target - camera_.position;
  const double length = glm::length(arm);
  const double nearer = std::clamp(length * std::pow(0.86, clicks), scale_ * 1e-3, scale_ * 100);
  camera_.position = camera_.target - arm * (nearer / length);
}

void CameraControl::focus(const glm::dvec3& point, double distance) {
  taken_ = true;
  const glm::dvec3 direction = glm::normalize(camera_.target - camera_.position);
  way_ = Way{camera_.position, camera_.target, point - direction * distance, point, 0};
}

glm::dvec3 CameraControl::heldDirection() const {
  const auto down = [&](MoveKey key) { return double((held_ | tapped_)[static_cast<size_t>(key)]); };
  const glm::dvec3 ahead = glm::normalize(camera_.target - camera_.position);
  const glm::dvec3 right = glm::normalize(glm::cross(ahead, camera_.up));
  return (down(MoveKey::kAhead) - down(MoveKey::kBack)) * ahead +
         (down(MoveKey::kRight) - down(MoveKey::kLeft)) * right +
         (down(MoveKey::kUp) - down(MoveKey::kDown)) * camera_.up;
}

bool CameraControl::advance(double seconds) {
  if (const glm::dvec3 direction = heldDirection(); glm::length(direction) > 0) {
    const bool faster = (held_ | tapped_)[static_cast<size_t>(MoveKey::kFaster)];
    // A walking pace in rooms, and in proportion in what is smaller.
    const double speed = std::clamp(scale_ * 0.5, 0.01, 1.5) * (faster ? kFasterFactor : 1);
    shift(direction * speed * std::max(seconds, (held_ & tapped_).none() ? kLeastHold : 0.0));
  }
  tapped_.reset();
  if (way_) {
    way_->seconds += seconds;
    const double share = smooth(std::min(way_->seconds / kWaySeconds, 1.0));
    camera_.position = glm::mix(way_->from_position, way_->to_position, share);
    camera_.target = glm::mix(way_->from_target, way_->to_target, share);
    if (way_->seconds >= kWaySeconds) way_.reset();
  }
  const bool changed = !same(camera_, last_);
  last_ = camera_;
  return changed;
}

bool CameraControl::moving() const {
  auto keys = held_;
  keys.reset(static_cast<size_t>(MoveKey::kFaster));
  return keys.any() || tapped_.any() || way_.has_value();
}

glm::dvec3 rayThrough(const Camera& camera, const glm::dvec2& point, double aspect) {
  const glm::dvec3 ahead = glm::normalize(camera.target - camera.position);
  const glm::dvec3 right = glm::normalize(glm::cross(ahead, camera.up)), above = glm::cross(right, ahead);
  const double tangent = std::tan(camera.fov_degrees * kPi / 360);
  return glm::normalize(ahead + (2 * point.x - 1) * tangent * aspect * right +
                        (1 - 2 * point.y) * tangent * above);
}

std::optional<glm::dvec3> firstHit(const runtime::Scene& scene, const glm::dvec3& origin,
                                   const glm::dvec3& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const runtime::Instance& instance : scene.instances) {
    const runtime::Mesh& mesh = scene.meshes[size_t(instance.mesh)];
    const glm::dmat4 local_from_world = glm::inverse(glm::dmat4(instance.world_from_local));
    const glm::dvec3 o(local_from_world * glm::dvec4(origin, 1)),
        d(local_from_world * glm::dvec4(direction, 0));
    // Slabs of the box; a division by zero gives the infinity that belongs there.
    const glm::dvec3 a = (glm::dvec3(mesh.bounds.min) - o) / d, b = (glm::dvec3(mesh.bounds.max) - o) / d;
    const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
    const double enter = std::max({low.x, low.y, low.z, 0.0}), leave = std::min({high.x, high.y, high.z});
    if (enter > leave * (1 + 1e-6) + 1e-9 || enter > nearest) continue;
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const glm::dvec3 p(mesh.vertices[mesh.indices[i]].position);
      const glm::dvec3 e1 = glm::dvec3(mesh.vertices[mesh.indices[i + 1]].position) - p,
                       e2 = glm::dvec3(mesh.vertices[mesh.indices[i + 2]].position) - p;
      const glm::dvec3 q = glm::cross(d, e2);  // Moeller and Trumbore 1997
      const double det = glm::dot(e1, q);
      if (!(std::abs(det) > 1e-30)) continue;
      const glm::dvec3 s = o - p, r = glm::cross(s, e1);
      const double u = glm::dot(s, q) / det, v = glm::dot(d, r) / det, t = glm::dot(e2, r) / det;
      if (u >= 0 && v >= 0 && u + v <= 1 && t > 1e-6 && t < nearest) nearest = t;
    }
  }
  if (!std::isfinite(nearest)) return {};
  return origin + nearest * direction;
}

}  // namespace loden::walk
