// The gallery's shapes, as cages of quads and as flat patches. Positions are in metres with y up. Texture
// coordinates are in tile periods, one of which is about 5 cm, and right-handed: dP/du x dP/dv points
// outwards.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

namespace gallery {

inline constexpr float kPeriod = 0.05f;  // metres per tile period

struct Shape {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec2> uvs;
  std::vector<std::array<uint16_t, 4>> quads;  // counter-clockwise from outside
  bool is_cage = false;                        // the quads are a cage that is to be subdivided
};

// One quad: a rectangle from `corner` along two edges.
Shape rectangle(glm::vec3 corner, glm::vec3 along_u, glm::vec3 along_v);
// A closed box.
Shape box(glm::vec3 min, glm::vec3 max);
// Cloth hanging from y = height down to 0, x from -width / 2 to width / 2, facing +z, in folds that open
// downwards.
Shape drapedCloth(float width, float height, int folds);
// A pullover as on a tailor's dummy, open below, with its hem at y = 0.86 and its collar at 1.55.
Shape pullover();
// A skirt in folds, from y = 0.3 to 0.98.
Shape skirt();
// A square cushion `side` wide that lies on y = 0.
Shape cushion(float side);
// Pots as cages, around the y axis, standing on y = 0.
Shape bottle();
Shape teapot();
Shape vase();
Shape jar();

}  // namespace gallery
