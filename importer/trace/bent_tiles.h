// All tiles of a cylinder or sphere as one ray-traced scene. Units: metres.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include "importer/tile/tile.h"
#include "material/model/analytic_surface.h"

namespace loden::importer {

struct BentHit {
  glm::dvec3 normal{0};            // unit, shading
  glm::dvec3 geometric_normal{0};  // unit, by the triangle's winding: away from the surface
  glm::dvec3 ray_origin{0};        // where rays that leave the surface start (Hanika 2021)
  glm::dvec3 tile_position{0};     // of the point before bending, in its own period: tile periods
  LocalBrdf brdf;
};

// Embree behind it: one bent tile per row, because all tiles of a row are rotations of one another about z.
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
