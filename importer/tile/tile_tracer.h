// Ray traces a tile that repeats without end (FBTF 3.3: "a periodic repetition of the meso-geometry").
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>

#include "importer/tile/tile.h"

namespace loden::importer {

// A hit of a ray on the tile. Positions are tile coordinates, directions and normals are in lengths
// (material/model/geometry_image.h).
struct TileHit {
  double t = 0;            // distance along the ray in units of the direction's length, in tile lengths
  glm::dvec3 position{0};  // unwrapped
  glm::dvec3 normal{0};    // interpolated unit shading normal (not flipped)
  glm::dvec3 geometric_normal{0};  // unit, towards the ray's origin
  glm::dvec2 p{0};                 // unwrapped parameter of the copy of the tile that was hit
  // The origin of rays that leave the surface: moved off the facets towards the smooth surface that the
  // shading normals describe (Hanika 2021), so that coarse meshes do not shadow themselves.
  glm::dvec3 ray_origin{0};
  LocalBrdf brdf;
  uint32_t triangle = 0;
};

// A ray tracer of a tile, by Embree. Thread safe after construction.
class TileTracer {
 public:
  explicit TileTracer(const Tile& tile);
  ~TileTracer();
  TileTracer(TileTracer&&) noexcept;

  const Tile& tile() const;
  double zMin() const;  // tile periods, <= 0
  // The point of a triangle at the weights (1 - b.x - b.y, b.x, b.y) of its vertices, as a hit with t = 0;
  // its geometric normal is on the side of the shading normals.
  TileHit pointOn(uint32_t triangle, glm::dvec2 b) const;

  std::optional<TileHit> intersect(const glm::dvec3& origin, const glm::dvec3& direction) const;
  // Whether anything lies between origin and the open sky (the plane z = 0) along direction, direction.z > 0.
  bool occluded(const glm::dvec3& origin, const glm::dvec3& direction) const;
  // Occlusion for many origins and one direction, in streams: blocked[i] = 1 if origin i is occluded, else 0.
  // Only origins with wanted[i] != 0 are traced; the others get 1.
  void occluded(std::span<const glm::vec3> origins, std::span<const uint8_t> wanted,
                const glm::vec3& direction, std::span<uint8_t> blocked) const;
  // The first hit of the view ray through x on the reference plane, coming from wo.
  std::optional<TileHit> intersectView(glm::dvec2 x, const glm::dvec3& wo) const;
  // The first hits of the view rays through many x, in streams: hits[i] is that of x[i].
  void intersectViews(std::span<const glm::dvec2> x, const glm::dvec3& wo,
                      std::span<std::optional<TileHit>> hits) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// While an object of this class lives, the calling thread's floating-point unit treats denormals as zero, as
// Embree recommends.
class FlushDenormals {
 public:
  FlushDenormals();
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

// The radiance in white units that leaves `hit` towards wo under unit perpendicular irradiance from wi, with
// the cast shadow. `bounces` > 0 adds indirect light by Monte Carlo, seeded by `seed`.
glm::dvec3 shadeHit(const TileTracer& tracer, const TileHit& hit, const glm::dvec3& wi, const glm::dvec3& wo,
                    int bounces, uint64_t seed);

}  // namespace loden::importer
