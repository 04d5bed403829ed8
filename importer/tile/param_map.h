// Finds the point of the tile with a given parameter p. The tile's triangles are rasterized over the
// parameter torus (FBTF 3.3, "rendering the meso-geometry, using the parameterization as vertex
// coordinates"), either at points, or conservatively, which means everything that a triangle overlaps
// (Hasselgren, Akenine-Moeller, Ohlsson 2005, "Conservative Rasterization", GPU Gems 2, chapter 42).
// Triangles without area in p overlap nothing.
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
// triangles overlap, the first one counts.
std::vector<ParamSample> locateParams(const Tile& tile, int side, glm::dvec2 position);

// One sample per cell of a side x side grid over p, for whole cells: a cell is covered if it has area in
// common with a triangle (to 1e-9 of a cell's side; triangles that only touch it do not count). If the point
// at (cell + position) / side lies in no triangle, the sample is the point of the surface inside the cell
// that is nearest to it, and of equally near ones that of the first triangle.
std::vector<ParamSample> coverParams(const Tile& tile, int side, glm::dvec2 position);

// The nearest border of a chart for a cell outside of it: where the surface would continue if the triangle at
// the border did.
struct ParamExtension {
  uint32_t triangle = ParamSample::kNone;
  glm::dvec2 b{0};          // weights beyond the triangle
  glm::dvec2 edge{0};       // weights of the nearest point, on the border
  double distance = 1e300;  // distance of that point from the cell's centre, in cells
  bool exists() const { return triangle != ParamSample::kNone; }
};

// One extension per cell centre of a side x side grid over p; it exists for cells within `radius` cells of a
// border. A border is an edge of only one triangle; a chart that meets itself one period further on has no
// border there.
std::vector<ParamExtension> extendParams(const Tile& tile, int side, double radius);

}  // namespace loden::importer
