#include "material/model/analytic_surface.h"

#include <cmath>

#include "material/model/directions.h"
#include "material/model/geometry_image.h"

namespace loden {
namespace {

constexpr double kRadius = 24 * AnalyticSurface::kTilePeriod / (2 * kPi);  // metres; 24 tiles around

SurfaceFrame cylinderFrame(glm::dvec2 st) {
  const double phi = 2 * kPi * st.x;
  const glm::dvec3 normal(std::cos(phi), std::sin(phi), 0);
  return {kRadius * normal + glm::dvec3(0, 0, 2 * st.y - 1), normal, {-normal.y, normal.x, 0}, {0, 0, 1}};
}

SurfaceFrame sphereFrame(glm::dvec2 st) {
  const double phi = 2 * kPi * st.x, latitude = kPi * (st.y - 0.5);
  const glm::dvec3 normal(std::cos(latitude) * std::cos(phi), std::cos(latitude) * std::sin(phi),
                          std::sin(latitude));
  const glm::dvec3 tangent(-std::sin(phi), std::cos(phi), 0);
  return {kRadius * normal, normal, tangent, glm::cross(normal, tangent)};
}

}  // namespace

std::optional<SurfaceKind> surfaceKindByName(std::string_view name) {
  if (name == "plane") return SurfaceKind::kPlane;
  if (name == "cylinder") return SurfaceKind::kCylinder;
  if (name == "sphere") return SurfaceKind::kSphere;
  return std::nullopt;
}

AnalyticSurface analyticSurface(SurfaceKind kind, double aspect) {
  const glm::dvec2 scale = periodsPerLength(aspect);
  switch (kind) {
    case SurfaceKind::kCylinder:
      return {kind, glm::round(glm::dvec2(24, 16) * scale)};
    case SurfaceKind::kSphere:
      return {kind, glm::round(glm::dvec2(24, 12) * scale)};
    case SurfaceKind::kPlane:
      break;
  }
  return {SurfaceKind::kPlane, glm::dvec2(16, 16) * scale};
}

SurfaceFrame surfaceFrame(const AnalyticSurface& surface, glm::dvec2 st) {
  if (surface.kind == SurfaceKind::kCylinder) return cylinderFrame(st);
  if (surface.kind == SurfaceKind::kSphere) return sphereFrame(st);
  return {{2 * st.x - 1, 2 * st.y - 1, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
}

glm::dvec3 cameraRay(const Camera& camera, double px, double py, int width, int height) {
  const glm::dvec3 forward = glm::normalize(camera.target - camera.position);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
  const glm::dvec3 up = glm::cross(right, forward);
  const double tangent = std::tan(camera.fov_degrees * kPi / 360);
  const double u = (2 * px / width - 1) * tangent * width / height, v = (1 - 2 * py / height) * tangent;
  return glm::normalize(forward + u * right + v * up);
}

}  // namespace loden
