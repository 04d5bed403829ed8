// Rays against a tile repeated without end (FBTF 3.3: "a periodic repetition of the meso-geometry").
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>

#include "importer/tile/tile.h"

namespace loden::importer {

// Places are tile coordinates, directions and normals those of lengths (material/model/geometry_image.h).
struct TileHit {
  double t = 0;                    // along the ray, of the direction's length, in tile lengths
  glm::dvec3 position{0};          // unwrapped
  glm::dvec3 normal{0};            // unit, shading, as interpolated (not flipped)
  glm::dvec3 geometric_normal{0};  // unit, towards the ray's origin
  glm::dvec2 p{0};                 // parameter, unwrapped, of the copy that was hit
  // Where rays that leave the surface start: lifted off the facets towards the smooth surface that the
  // shading normals describe (Hanika 2021), so that coarse meshes do not shadow themselves.
  glm::dvec3 ray_origin{0};
  LocalBrdf brdf;
  uint32_t triangle = 0;
};

// Embree behind it. Thread safe after construction.
class TileTracer {
 public:
  explicit TileTracer(const Tile& tile);
  ~TileTracer();
  TileTracer(TileTracer&&) noexcept;

  const Tile& tile() const;
  double zMin() const;  // tile periods, <= 0
  // The point of a triangle at the weights (1 - b.x - b.y, b.x, b.y) of its vertices; t = 0, geometric normal
  // on the side of the shading normals.
  TileHit pointOn(uint32_t triangle, glm::dvec2 b) const;

  std::optional<TileHit> intersect(const glm::dvec3& origin, const glm::dvec3& direction) const;
  // True if something stands between origin and the open sky (z = 0 plane) along direction, direction.z > 0.
  bool occluded(const glm::dvec3& origin, const glm::dvec3& direction) const;
  // The same for many origins and one direction, in streams; blocked[i] = 1 where occluded, else 0. Only
  // origins with wanted[i] != 0 are traced, the others get 1.
  void occluded(std::span<const glm::vec3> origins, std::span<const uint8_t> wanted,
                const glm::vec3& direction, std::span<uint8_t> blocked) const;
  // First hit of the view ray through x on the reference plane, coming from wo.
  std::optional<TileHit> intersectView(glm::dvec2 x, const glm::dvec3& wo) const;
  // The same for many x, in streams: hits[i] of x[i].
  void intersectViews(std::span<const glm::dvec2> x, const glm::dvec3& wo,
                      std::span<std::optional<TileHit>> hits) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// While it lives, the calling thread's floating-point unit treats denormals as zero, as Embree asks for.
class FlushDenormals {
 public:
  FlushDenormals();
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

// Radiance in white units that leaves `hit` towards wo under unit perpendicular irradiance from wi, with the
// cast shadow; `bounces` > 0 adds indirect light by Monte Carlo, seeded by `seed`.
glm::dvec3 shadeHit(const TileTracer& tracer, const TileHit& hit, const glm::dvec3& wi, const glm::dvec3& wo,
                    int bounces, uint64_t seed);

}  // namespace loden::importer
