#include "sample_game/framing.h"

#include <algorithm>
#include <cmath>

#include "material/model/directions.h"

namespace loden::walk {

using namespace runtime;

Bounds boundsOfAll(const Scene& scene) {
  Bounds all;
  for (size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Bounds box = transformed(scene.meshes[size_t(instance.mesh)].bounds, instance.world_from_local);
    all = i == 0 ? box : Bounds{glm::min(all.min, box.min), glm::max(all.max, box.max)};
  }
  return all;
}

Camera framedFrom(const Bounds& box, const glm::dvec3& direction, double aspect) {
  constexpr double kMargin = 1.06;
  Camera camera;
  camera.up = {0, 1, 0};
  camera.target = glm::dvec3(box.centre());
  const double tangent = std::tan(camera.fov_degrees * kPi / 360) / kMargin;
  const glm::dvec3 right = glm::normalize(glm::cross(camera.up, direction)),
                   above = glm::cross(direction, right);
  double distance = 1e-3;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 arm =
        glm::dvec3((corner & 1) ? box.max.x : box.min.x, (corner & 2) ? box.max.y : box.min.y,
                   (corner & 4) ? box.max.z : box.min.z) -
        camera.target;
    const double wide = std::abs(glm::dot(arm, right)) / (tangent * aspect),
                 tall = std::abs(glm::dot(arm, above)) / tangent;
    distance = std::max(distance, glm::dot(arm, direction) + std::max(wide, tall));
  }
  camera.position = camera.target + direction * distance;
  return camera;
}

Camera framed(const Bounds& box, double aspect) {
  return framedFrom(box, glm::normalize(glm::dvec3(0.35, 0.3, 1)), aspect);
}

}  // namespace loden::walk
