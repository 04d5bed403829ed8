#include "sample_game/lighting.h"

#include <glm/gtc/matrix_transform.hpp>

#include "runtime/scene/image_read.h"

namespace loden::walk {

using namespace runtime;

namespace {

constexpr int kEnvironmentSuns = 2;           // each costs as much as a light
constexpr float kSharpSky = 0, kSoftSky = 4;  // levels of the reflection map: a picture, and a studio's glow
constexpr float kSoftShadow = 7, kSunShadow = 1.5f;  // half widths of borders, texels

}  // namespace

void Lighting::apply(FrameSettings& settings) const {
  settings.environment.reset();
  settings.reflections.reset();
  settings.sky_level.reset();
  settings.shadow_width = kSunShadow;
  if (!panorama) return;
  const glm::mat3 y_from_z(glm::vec3(1, 0, 0), glm::vec3(0, 0, -1), glm::vec3(0, 1, 0));
  const glm::vec3 up = y_up ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
  const glm::mat3 turned(glm::rotate(glm::mat4(1), static_cast<float>(turn), up));
  const glm::mat3 world_from_panorama = turned * (y_up ? y_from_z : glm::mat3(1));
  Environment environment = projectPanorama(*panorama, kEnvironmentSuns);
  environment.light = rotated(environment.light, world_from_panorama);
  for (EnvironmentSun& sun : environment.suns) sun.direction = world_from_panorama * sun.direction;
  settings.environment = std::move(environment);
  if (!y_up) return;  // analytic surfaces show Loden materials alone
  settings.environment_shadows = true;
  settings.shadow_width = kSoftShadow;  // what an environment has of suns is rather lamps and windows
  settings.sky_level = neutral ? kSoftSky : kSharpSky;
  settings.reflections =
      std::make_shared<const ReflectionMap>(makeReflectionMap(*panorama, world_from_panorama));
}

Result<Lighting> panoramaLighting(const std::filesystem::path& file) {
  Result<Panorama> panorama = readPanorama(file);
  if (!panorama) return panorama.issue();
  Lighting lighting;
  lighting.panorama = std::move(*panorama);
  lighting.file = file;
  return lighting;
}

Lighting neutralLighting() {
  Lighting lighting;
  lighting.panorama = neutralPanorama();
  lighting.neutral = true;
  return lighting;
}

}  // namespace loden::walk
