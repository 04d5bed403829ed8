// Which point of the tile lies under a parameter p: the tile's triangles rasterized over the parameter torus
// (FBTF 3.3, "rendering the meso-geometry, using the parameterization as vertex coordinates").
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "importer/tile.h"

namespace loden::importer {

struct ParamSample {
  static constexpr uint32_t kNone = 0xFFFFFFFFu;
  uint32_t triangle = kNone;
  glm::vec2 b{0};  // weights of the triangle's second and third vertex
  bool covered() const { return triangle != kNone; }
};

// One sample per cell of a side x side grid over p, at (cell + position) / side; row-major, x fastest. Where
// triangles overlap the first counts.
std::vector<ParamSample> locateParams(const Tile& tile, int side, glm::dvec2 position);

}  // namespace loden::importer
