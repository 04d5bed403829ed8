// The gallery's shapes as quad cages and flat patches. y is up, metres; UVs in tile periods, so that one
// period is about 5 cm, and right-handed: dP/du x dP/dv points outwards.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

namespace gallery {

inline constexpr float kPeriod = 0.05f;  // metres per tile period where nothing else is said

struct Shape {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec2> uvs;
  std::vector<std::array<uint16_t, 4>> quads;  // counter-clockwise from outside
  bool is_cage = false;                        // to be subdivided
};

// A rectangle from `corner` along two edges, one quad.
Shape rectangle(glm::vec3 corner, glm::vec3 along_u, glm::vec3 along_v);
// A closed box.
Shape box(glm::vec3 min, glm::vec3 max);
// Cloth hanging from y = height down to 0, x from -width / 2 to width / 2, facing +z, in folds that open
// downwards.
Shape drapedCloth(float width, float height, int folds);
// A pullover as on a tailor's dummy, its hem at y = 0.86 and its collar at 1.55, open below; and a skirt from
// y = 0.3 to 0.98, in folds.
Shape pullover();
Shape skirt();
// A square cushion of that side, lying on y = 0.
Shape cushion(float side);
// Cages of pots that stand on y = 0 around the y axis.
Shape bottle();
Shape teapot();
Shape vase();
Shape jar();

}  // namespace gallery
