#include <cmath>

#include "importer/base/random.h"
#include "importer/tile/local_brdf.h"
#include "importer/tile/tile_tracer.h"

namespace loden::importer {

glm::dvec3 shadeHit(const TileTracer& tracer, const TileHit& hit, const glm::dvec3& wi, const glm::dvec3& wo,
                    int bounces, uint64_t seed) {
  glm::dvec3 value(0);
  const double cosine = glm::dot(hit.normal, wi);
  if (cosine > 0 && !tracer.occluded(hit.ray_origin, wi))
    value = reflectance(hit.brdf, hit.normal, wi, wo) * cosine;
  if (bounces <= 0) return value;

  // One path: cosine-weighted, so the estimator is the reflectance times what comes along the sampled
  // direction.
  const glm::dvec3 direction = cosineDirection(hit.normal, uniform(seed, 0), uniform(seed, 1));
  if (glm::dot(direction, hit.geometric_normal) <= 0) return value;
  const auto next = tracer.intersect(hit.ray_origin, direction);
  if (!next) return value;
  const glm::dvec3 incoming = shadeHit(tracer, *next, wi, -direction, bounces - 1, mixSeed(seed, 2));
  return value + reflectance(hit.brdf, hit.normal, direction, wo) * incoming;
}

}  // namespace loden::importer
