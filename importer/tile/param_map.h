// Which point of the tile lies under a parameter p: the tile's triangles rasterized over the parameter torus
// (FBTF 3.3, "rendering the meso-geometry, using the parameterization as vertex coordinates"), at points, or
// conservatively: whatever a triangle overlaps (Hasselgren, Akenine-Moeller, Ohlsson 2005, "Conservative
// Rasterization", GPU Gems 2, chapter 42). Triangles without area in p overlap nothing.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "importer/tile/tile.h"

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

// The same for whole cells: covered is each that has area in common with a triangle (to 1e-9 of a cell's
// side; those that only touch it do not count). A cell whose sample lies in no triangle has the point of the
// surface inside the cell that is nearest to the sample, of equals the first triangle's.
std::vector<ParamSample> coverParams(const Tile& tile, int side, glm::dvec2 position);

// The nearest border of a chart, for a cell outside: where the surface would go on if the triangle at the
// border did.
struct ParamExtension {
  uint32_t triangle = ParamSample::kNone;
  glm::dvec2 b{0};          // weights beyond the triangle
  glm::dvec2 edge{0};       // weights of the nearest point, on the border
  double distance = 1e300;  // of the nearest point, cells
  bool exists() const { return triangle != ParamSample::kNone; }
};

// One per cell centre of a side x side grid over p; those exist that are within `radius` cells of a border.
// Borders are edges of one triangle only; a chart that meets itself one period on has none there.
std::vector<ParamExtension> extendParams(const Tile& tile, int side, double radius);

}  // namespace loden::importer
