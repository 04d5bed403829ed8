// All tiles on a cylinder or sphere as one ray-traced scene, in metres.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include "importer/tile/tile.h"
#include "material/model/analytic_surface.h"

namespace loden::importer {

struct BentHit {
  glm::dvec3 normal{0};            // unit, shading
  glm::dvec3 geometric_normal{0};  // unit, away from the surface, from the triangle's winding
  glm::dvec3 ray_origin{0};        // origin of rays that leave the surface (Hanika 2021)
  glm::dvec3 tile_position{0};     // position of the point before bending, in its own period: tile periods
  LocalBrdf brdf;
};

// A ray tracer of the bent tiles, by Embree. It stores one bent tile per row, since all tiles of a row are
// rotations of one another about z.
class BentTiles {
 public:
  BentTiles(const Tile& tile, const AnalyticSurface& surface);
  ~BentTiles();
  BentTiles(const BentTiles&) = delete;
  BentTiles& operator=(const BentTiles&) = delete;

  std::optional<BentHit> intersect(const glm::dvec3& origin, const glm::dvec3& direction) const;
  bool occluded(const glm::dvec3& origin, const glm::dvec3& direction) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loden::importer
