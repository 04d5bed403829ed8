// A cone map for height fields (Dummer 2006, "Cone step mapping"), to compare the VDIM look-up with.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "material/model/geometry_image.h"

namespace loden::importer {

// A cone map: per texel the surface's z and the width of the widest empty cone above it. A shader would read
// both by one fetch of a filtered 3-byte texel (16 bits of z, 8 of the cone); here they are not even rounded.
struct ConeMap {
  int side = 0;
  double aspect = 1;               // aspect of the tile
  std::vector<glm::dvec2> texels;  // z in tile periods, <= 0; the cone's radius over its height

  size_t bytes() const { return texels.size() * 3; }
};

// The cone map of a height field (geometry.identity_parameterization).
ConeMap buildConeMap(const GeometryImage& geometry, int threads);

struct ConeHit {
  glm::dvec2 p{0};
  int fetches = 0;
};

// The hit of the view ray through x: it steps from cone to cone, and, once below the surface, continues by
// false position; the last two fetches are joined by a secant. It takes at most `taps` fetches, and fewer if
// the ray is within .02 texels of the surface earlier.
ConeHit coneLookup(const ConeMap& map, int taps, glm::dvec2 x, const glm::dvec3& wo);

}  // namespace loden::importer
