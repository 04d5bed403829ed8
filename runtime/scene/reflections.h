// An environment as mirrors of all roughnesses see it, and how much such surfaces reflect: the two tables of
// image based lighting for glTF's own materials. No GL here.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "material/model/environment.h"

namespace loden::runtime {

// Cube maps, one per roughness: level k of kLevels has sides of kSide >> k pixels and the roughness
// (k / (kLevels - 1))^1.5; level 0 is the environment itself. Behind them, level kLevels is what a white
// Lambert surface sees: its irradiance over pi. Linear RGB radiance, world frame.
struct ReflectionMap {
  static constexpr int kSide = 256, kLevels = 6;
  std::vector<std::vector<glm::vec3>> levels;  // [level][face][row][column], faces and rows as in OpenGL
  EnvironmentLight light;                      // all of the environment, its suns too
};
// Each roughness averages the environment over its lobe around the mirror direction, seen head-on. Takes some
// half a second.
ReflectionMap makeReflectionMap(const Panorama& panorama, const glm::mat3& world_from_panorama);

// Unit direction through a point of a cube map's face, st in [0, 1]^2.
glm::vec3 cubeDirection(int face, glm::vec2 st);

// Reflectance under light from all around, [roughness][cosine], both from 0 to 1 at `side` values: f0 * x +
// f90 * y for the GGX lobe with Smith's masking and shadowing, z for sheen of colour 1. w: how far the middle
// of the lobe lies from the mirror direction towards the normal, because the horizon cuts rough lobes.
std::vector<glm::vec4> makeReflectanceTable(int side);

// A studio without colour: a bright ceiling light, two fainter ones at the sides, a grey floor. z up; a white
// Lambert surface that faces up is about 1.
Panorama neutralPanorama();

}  // namespace loden::runtime
