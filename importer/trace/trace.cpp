#include "importer/trace/trace.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "importer/base/parallel.h"
#include "importer/base/progress.h"
#include "importer/base/random.h"
#include "importer/tile/local_brdf.h"
#include "importer/tile/tile_tracer.h"
#include "importer/trace/bent_tiles.h"
#include "importer/trace/panorama_lights.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

// What a camera ray brings back: premultiplied colour and coverage.
class World {
 public:
  virtual ~World() = default;
  virtual glm::dvec4 radiance(const glm::dvec3& origin, const glm::dvec3& direction,
                              std::span<const LightSample> lights, uint64_t seed) const = 0;
};

// The plane's tangent frame is the world's, so directions need no change.
class PlaneWorld : public World {
 public:
  PlaneWorld(const Tile& tile, const TraceOptions& options)
      : tracer_(tile),
        surface_(analyticSurface(SurfaceKind::kPlane, tile.aspect)),
        bounces_(options.bounces) {
    corner_ = surfaceFrame(surface_, {0, 0}).position;
    extent_ = surfaceFrame(surface_, {1, 1}).position - corner_;
  }

  glm::dvec4 radiance(const glm::dvec3& origin, const glm::dvec3& direction,
                      std::span<const LightSample> lights, uint64_t seed) const override {
    if (!(direction.z < 0) || origin.z <= 0) return glm::dvec4(0);
    const glm::dvec3 point = origin - direction * (origin.z / direction.z);
    const glm::dvec2 st = (glm::dvec2(point) - glm::dvec2(corner_)) / glm::dvec2(extent_);
    if (st.x < 0 || st.x > 1 || st.y < 0 || st.y > 1) return glm::dvec4(0);
    const auto hit = tracer_.intersectView(st * surface_.tiles, -direction);
    glm::dvec3 sum(0);
    for (const LightSample& light : lights)
      if (hit && light.direction.z > 0)
        sum += light.weight * shadeHit(tracer_, *hit, light.direction, -direction, bounces_, seed);
    return {sum, 1};
  }

 private:
  TileTracer tracer_;
  AnalyticSurface surface_;
  glm::dvec3 corner_{0}, extent_{0};
  int bounces_;
};

class BentWorld : public World {
 public:
  BentWorld(const Tile& tile, const TraceOptions& options)
      : tiles_(tile, analyticSurface(options.surface, tile.aspect)), bounces_(options.bounces) {}

  glm::dvec4 radiance(const glm::dvec3& origin, const glm::dvec3& direction,
                      std::span<const LightSample> lights, uint64_t seed) const override {
    const auto hit = tiles_.intersect(origin, direction);
    if (!hit || glm::dot(hit->geometric_normal, direction) >= 0)
      return glm::dvec4(0);  // nothing is seen from inside
    glm::dvec3 sum(0);
    for (const LightSample& light : lights)
      sum += light.weight * shade(*hit, light.direction, -direction, bounces_, seed);
    return {sum, 1};
  }

 private:
  // As shadeHit, for the plane.
  glm::dvec3 shade(const BentHit& hit, const glm::dvec3& wi, const glm::dvec3& wo, int bounces,
                   uint64_t seed) const {
    glm::dvec3 value(0);
    const double cosine = glm::dot(hit.normal, wi);
    if (cosine > 0 && !tiles_.occluded(hit.ray_origin, wi))
      value = reflectance(hit.brdf, hit.normal, wi, wo) * cosine;
    if (bounces <= 0) return value;
    const glm::dvec3 direction = cosineDirection(hit.normal, uniform(seed, 0), uniform(seed, 1));
    const auto next = tiles_.intersect(hit.ray_origin, direction);
    if (!next || glm::dot(next->geometric_normal, direction) >= 0) return value;
    const glm::dvec3 incoming = shade(*next, wi, -direction, bounces - 1, mixSeed(seed, 2));
    return value + reflectance(hit.brdf, hit.normal, direction, wo) * incoming;
  }

  BentTiles tiles_;
  int bounces_;
};

// The lights of one sample: the directional one, and one of the environment's.
struct Lights {
  explicit Lights(const TraceOptions& options) : light(options.light) {
    if (options.environment) panorama.emplace(*options.environment);
  }
  std::vector<LightSample> draw(uint64_t seed) const {
    std::vector<LightSample> lights;
    if (light) lights.push_back({*light, glm::dvec3(1)});
    if (panorama) lights.push_back(panorama->sample(uniform(seed, 0), uniform(seed, 1), uniform(seed, 2)));
    return lights;
  }
  std::optional<glm::dvec3> light;
  std::optional<PanoramaLights> panorama;
};

// A pixel's area in `count` cells of equal area: rows as high as they have cells.
class Strata {
 public:
  explicit Strata(int count)
      : count_(std::max(1, count)), rows_(static_cast<int>(std::lround(std::sqrt(count_)))) {}
  int count() const { return count_; }
  // The point (u, v) of cell s, both in [0, 1), as a point of the pixel.
  glm::dvec2 at(int s, double u, double v) const {
    const int row = s * rows_ / count_, first = firstOf(row), cells = firstOf(row + 1) - first;
    return {(s - first + u) / cells, (first + v * cells) / count_};
  }

 private:
  int firstOf(int row) const { return (row * count_ + rows_ - 1) / rows_; }
  int count_, rows_;
};

glm::vec4 pixelAverage(const World& world, const Lights& lights, const TraceOptions& options, int x, int y) {
  const Strata strata(options.samples);
  const uint64_t pixel_seed = mixSeed(0x10DE, uint64_t(y) * options.width + x);
  glm::dvec4 sum(0);
  for (int s = 0; s < strata.count(); ++s) {
    const uint64_t seed = mixSeed(pixel_seed, s);
    const glm::dvec2 p = glm::dvec2(x, y) + strata.at(s, uniform(seed, 0), uniform(seed, 1));
    const glm::dvec3 direction = cameraRay(options.camera, p.x, p.y, options.width, options.height);
    sum +=
        world.radiance(options.camera.position, direction, lights.draw(mixSeed(seed, 3)), mixSeed(seed, 2));
  }
  return sum / double(strata.count());
}

}  // namespace

Result<Picture> trace(const Tile& tile, const TraceOptions& options) {
  const glm::dvec3 forward = options.camera.target - options.camera.position;
  if (!(glm::length(forward) >= 1e-9))
    return Issue{issue_id::kOption, Severity::kError, "camera", "position and target are the same point"};
  if (!(glm::length(glm::cross(forward, options.camera.up)) > 1e-9 * glm::length(forward)))
    return Issue{issue_id::kOption, Severity::kError, "camera",
                 "up lies along the direction of view, and gives no picture its top; name another \"up\""};
  std::unique_ptr<World> world;
  if (options.surface == SurfaceKind::kPlane)
    world = std::make_unique<PlaneWorld>(tile, options);
  else
    world = std::make_unique<BentWorld>(tile, options);
  const Lights lights(options);
  Picture picture{options.width, options.height,
                  std::vector<glm::vec4>(size_t(options.width) * options.height)};
  Progress progress("trace", options.height, options.quiet);
  parallelFor(options.height, options.threads, [&](size_t y) {
    const FlushDenormals flush;
    for (int x = 0; x < options.width; ++x)
      picture.at(x, static_cast<int>(y)) = pixelAverage(*world, lights, options, x, static_cast<int>(y));
    progress.advance();
  });
  return picture;
}

}  // namespace loden::importer
