// Rays against a tile repeated without end (FBTF 3.3: "a periodic repetition of the meso-geometry").
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include "importer/tile.h"

namespace loden::importer {

struct TileHit {
  double t = 0;          // along the ray, tile periods
  glm::dvec3 position{0};  // tile periods, unwrapped
  glm::dvec3 normal{0};    // unit, shading, as interpolated (not flipped)
  glm::dvec3 geometric_normal{0};  // unit, towards the ray's origin
  glm::dvec2 p{0};         // parameter, unwrapped, of the copy that was hit
  LocalBrdf brdf;
  uint32_t triangle = 0;
};

// Embree behind it. Thread safe after construction.
class TileTracer {
 public:
  explicit TileTracer(const Tile& tile);
  ~TileTracer();
  TileTracer(TileTracer&&) noexcept;

  std::optional<TileHit> intersect(const glm::dvec3& origin, const glm::dvec3& direction) const;
  // True if something stands between origin and the open sky (z = 0 plane) along direction, direction.z > 0.
  bool occluded(const glm::dvec3& origin, const glm::dvec3& direction) const;
  // First hit of the view ray through x on the reference plane, coming from wo.
  std::optional<TileHit> intersectView(glm::dvec2 x, const glm::dvec3& wo) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Radiance in white units that leaves `hit` towards wo under unit perpendicular irradiance from wi, with the
// cast shadow; `bounces` > 0 adds indirect light by Monte Carlo, seeded by `seed`.
glm::dvec3 shadeHit(const TileTracer& tracer, const TileHit& hit, const glm::dvec3& wi, const glm::dvec3& wo,
                    int bounces, uint64_t seed);

}  // namespace loden::importer
