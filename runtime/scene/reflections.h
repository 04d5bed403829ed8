// The two tables of image based lighting for glTF's own materials: an environment prefiltered for each
// roughness, and how much a surface of each roughness reflects. No GL.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "material/model/environment.h"

namespace loden::runtime {

// Prefiltered cube maps of an environment: linear RGB radiance, world frame. Level k < kLevels has sides of
// kSide >> k pixels and the roughness (k / (kLevels - 1))^1.5; level 0 is the environment itself. Level
// kLevels, the last, is the radiance of a white Lambert surface, which is its irradiance over pi.
struct ReflectionMap {
  static constexpr int kSide = 256, kLevels = 6;
  std::vector<std::vector<glm::vec3>> levels;  // [level][face][row][column], faces and rows as in OpenGL
  EnvironmentLight light;                      // the whole environment, its suns included, as a polynomial
};
// Prefilters the panorama. For each roughness it is averaged over the lobe around the mirror direction for a
// view along the normal. Takes about half a second.
ReflectionMap makeReflectionMap(const Panorama& panorama, const glm::mat3& world_from_panorama);

// The unit direction through a point of a cube map's face; st in [0, 1]^2.
glm::vec3 cubeDirection(int face, glm::vec2 st);

// Reflectance under uniform light from all around, as a table [roughness][cosine of the view], `side` values
// of each from 0 to 1. x and y: the GGX lobe with Smith's masking and shadowing reflects f0 * x + f90 * y. z:
// what sheen of colour 1 reflects. w: how far the middle of the lobe is turned from the mirror direction
// towards the normal, because the horizon cuts rough lobes off.
std::vector<glm::vec4> makeReflectanceTable(int side);

// A panorama of a colourless studio: a bright ceiling light, two fainter ones at the sides, and a grey floor.
// z is up. A white Lambert surface that faces up has a radiance of about 1.
Panorama neutralPanorama();

}  // namespace loden::runtime
