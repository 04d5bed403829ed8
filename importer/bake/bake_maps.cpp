// VDIM, geometry image and surface maps of a bake, and what is common to its parts.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "importer/bake/bake_scene.h"
#include "importer/bake/geometry_fit.h"
#include "importer/base/random.h"
#include "importer/tile/charts.h"
#include "importer/tile/local_brdf.h"
#include "importer/tile/mesh_material.h"
#include "material/model/vdim.h"

namespace loden::importer {

glm::dvec2 samplePosition(int k, int supersample) {
  constexpr glm::dvec2 kBeside{0.0131, -0.0217};  // of a sample's cell
  return (glm::dvec2(k % supersample, k / supersample) + 0.5 + kBeside) / double(supersample);
}

void addIndirect(const BakeScene& scene, const TileHit& hit, const glm::dvec3& wo, uint64_t seed,
                 glm::vec3* values) {
  const auto& lights = scene.directions();
  TileHit at = hit;
  glm::dvec3 towards = wo, weight(1);
  uint64_t rays = 0;
  for (int bounce = 0; bounce < scene.manifest.bounces; ++bounce) {
    seed = mixSeed(seed, 2);
    const glm::dvec3 direction = cosineDirection(at.normal, uniform(seed, 0), uniform(seed, 1));
    if (glm::dot(direction, at.geometric_normal) <= 0) break;
    weight *= reflectance(at.brdf, at.normal, direction, towards);
    ++rays;
    const auto next = scene.tracer.intersect(at.ray_origin, direction);
    if (!next) break;
    at = *next, towards = -direction;
    for (size_t l = 0; l < lights.size(); ++l) {
      const double cosine = glm::dot(at.normal, lights[l]);
      if (cosine <= 0) continue;
      ++rays;
      if (!scene.tracer.occluded(at.ray_origin, lights[l]))
        values[l] += glm::vec3(weight * reflectance(at.brdf, at.normal, lights[l], towards) * cosine);
    }
  }
  scene.counters.rays += rays;
}

namespace {

// An image with a cell of size x size for each view, rows of `columns` cells: store(pixel, x, hit) for every
// texel centre x; hit is empty where the ray meets no surface, which is counted.
template <class Store>
Image traceCells(const BakeScene& scene, const std::vector<glm::dvec3>& views, int columns, int channels,
                 const Store& store) {
  constexpr glm::dvec2 kBeside{1.31e-3, -2.17e-3};  // of a texel: off the edges of regular meshes
  const int side = scene.manifest.size;
  const AtlasLayout layout{side, static_cast<int>(views.size()), columns};
  Image image{layout.width(), layout.height(), channels, {}};
  image.pixels.resize(size_t(layout.width()) * size_t(layout.height()) * size_t(channels));
  tbb::parallel_for(0, layout.cells, [&](int cell) {
    const FlushDenormals flush;
    uint64_t misses = 0;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const glm::dvec2 x = (glm::dvec2(i, j) + 0.5 + kBeside) / double(side);
        const auto hit = scene.tracer.intersectView(x, views[size_t(cell)]);
        misses += !hit;
        store(&image.pixels[size_t(channels) * layout.pixel(cell, i, j)], x, hit);
      }
    scene.counters.rays += uint64_t(side) * uint64_t(side);
    scene.counters.misses += misses;
  });
  return image;
}

}  // namespace

Image bakeVdim(const BakeScene& scene, glm::ivec2 size) {
  std::vector<glm::dvec3> views;
  for (int z = 0; z < size.x; ++z)
    for (int a = 0; a < size.y; ++a)
      views.push_back(directionFromSpherical({kThetaMax * z / (size.x - 1), 2 * kPi * a / (size.y - 1)}));
  return traceCells(scene, views, size.y, 2,
                    [](float* pixel, const glm::dvec2& x, const std::optional<TileHit>& hit) {
                      const glm::dvec2 displacement = hit ? hit->p - x : glm::dvec2(0);
                      pixel[0] = float(displacement.x), pixel[1] = float(displacement.y);
                    });
}

Image bakeConcentricVdim(const BakeScene& scene, int directions) {
  std::vector<glm::dvec3> views;
  for (int v = 0; v < directions; ++v)
    for (int u = 0; u < directions; ++u)
      views.push_back(vdimViewFromSquare((glm::dvec2(u, v) + 0.5) / double(directions)));
  return traceCells(scene, views, directions, 1,
                    [&](float* pixel, const glm::dvec2&, const std::optional<TileHit>& hit) {
                      pixel[0] = float(hit ? hit->position.z : scene.tracer.zMin());
                    });
}

TexelPoints locateTexels(const Tile& tile, int side, int supersample) {
  TexelPoints points{{}, coverParams(tile, side, glm::dvec2(0.5))};
  for (int k = 0; k < supersample * supersample; ++k) {
    points.located.push_back(locateParams(tile, side, samplePosition(k, supersample)));
    for (size_t t = 0; t < points.between.size(); ++t)
      if (points.located.back()[t].covered()) points.between[t] = {};
  }
  return points;
}

std::vector<uint16_t> ownersOf(const Tile& tile, int side, const TexelPoints& points) {
  if (std::all_of(tile.charts.begin(), tile.charts.end(), [](uint16_t chart) { return chart == 1; }))
    return {};
  std::vector<uint16_t> labels(size_t(side) * size_t(side), 0);
  const auto label = [&](const std::vector<ParamSample>& samples) {
    for (size_t t = 0; t < labels.size(); ++t)
      if (labels[t] == 0 && samples[t].covered()) labels[t] = tile.charts[samples[t].triangle];
  };
  for (const auto& samples : points.located) label(samples);
  label(points.between);
  return chartOwners(side, labels);
}

namespace {

// Texels beside a chart continue it: within kMargin of its border they count as its surface, so that patches
// reach the border; further on they only lead searches back. A patch passes through the surface only if the
// texel holds what lies under its centre, which the nearest point of a chart that merely overlaps it would
// not be. All that do overlap it are nearer than kMargin, so the image is conservative as it is.
constexpr double kMargin = 1.4143, kContinuation = 8;  // texels
constexpr double kFilterReach = 2;  // texels of a surface map beyond a border that filters read

// Where the surface would be beyond its border, no further off than it would be on a map that stretches by
// kMaxStretch.
glm::dvec3 continuedPosition(const TileTracer& tracer, const ParamExtension& beyond, int side) {
  constexpr double kMaxStretch = 8;
  const glm::dvec3 border = tracer.pointOn(beyond.triangle, beyond.edge).position;
  const glm::dvec3 off = tracer.pointOn(beyond.triangle, beyond.b).position - border;
  const double longest = kMaxStretch * beyond.distance / side;
  glm::dvec3 position = border + off * std::min(1.0, longest / std::max(glm::length(off), 1e-12));
  position.z = std::clamp(position.z, tracer.zMin(), 0.0);
  return position;
}

Image bakeGeometry(const BakeScene& scene) {
  const int side = scene.manifest.geometry_size;
  const Tile& tile = scene.tracer.tile();
  const auto located = locateParams(tile, side, glm::dvec2(0.5));
  const auto beyond = extendParams(tile, side, kContinuation);
  const size_t texels = located.size();
  std::vector<glm::dvec3> displacements(texels);
  std::vector<uint16_t> charts(texels, 0);
  for (size_t t = 0; t < texels; ++t) {
    if (located[t].covered()) {
      const TileHit hit = scene.tracer.pointOn(located[t].triangle, glm::dvec2(located[t].b));
      displacements[t] = hit.position - glm::dvec3(hit.p, 0);
      charts[t] = tile.charts[located[t].triangle];
    } else if (beyond[t].exists()) {
      const uint32_t triangle = beyond[t].triangle;
      const glm::dvec2 p = scene.tracer.pointOn(triangle, beyond[t].b).p;
      displacements[t] = continuedPosition(scene.tracer, beyond[t], side) - glm::dvec3(p, 0);
      if (beyond[t].distance <= kMargin) charts[t] = tile.charts[triangle];
    }
  }
  fitPatches(tile, side, -scene.tracer.zMin(), charts, displacements);
  Image image{side, side, 4, std::vector<float>(texels * 4)};
  for (size_t t = 0; t < texels; ++t) {
    for (int c = 0; c < 3; ++c) image.pixels[4 * t + size_t(c)] = float(displacements[t][c]);
    image.pixels[4 * t + 3] = float(charts[t]);
  }
  return image;
}

// One map of `channels` values (1..3), its uncovered texels filled.
Image filledMap(int side, int channels, const HoleFill& fill, std::vector<glm::vec3> texels) {
  fill.apply(texels);
  Image image{side, side, channels, {}};
  for (const glm::vec3& texel : texels)
    for (int c = 0; c < channels; ++c) image.pixels.push_back(texel[c]);
  return image;
}

// The same of f0 and alpha.
Image filledLobes(int side, const HoleFill& fill, const std::vector<glm::vec4>& lobes) {
  std::vector<glm::vec3> f0, alpha;
  for (const glm::vec4& lobe : lobes) f0.emplace_back(lobe), alpha.emplace_back(lobe.w);
  fill.apply(f0), fill.apply(alpha);
  Image image{side, side, 4, {}};
  for (size_t t = 0; t < lobes.size(); ++t)
    for (const float value : {f0[t].x, f0[t].y, f0[t].z, alpha[t].x}) image.pixels.push_back(value);
  return image;
}

// The surface beside a chart's border: the normal goes on turning as it does there, the reflectance stays.
// Filters that reach over the border then see no step.
TileHit continuedPoint(const TileTracer& tracer, const ParamExtension& beyond) {
  constexpr double kMostTurn = 0.7;  // cosine; needles would turn it anywhere
  TileHit hit = tracer.pointOn(beyond.triangle, beyond.edge);
  const glm::dvec3 normal = tracer.pointOn(beyond.triangle, beyond.b).normal;
  if (glm::dot(normal, hit.normal) > kMostTurn) hit.normal = normal;
  return hit;
}

}  // namespace

SurfaceImages bakeSurface(const BakeScene& scene) {
  const int side = scene.manifest.surface_size, per_side = scene.manifest.supersample;
  const size_t texels = size_t(side) * size_t(side);
  std::vector<float> coverage(texels);
  std::vector<glm::vec3> normal(texels), diffuse(texels), specular(texels);
  std::vector<glm::vec4> ggx(scene.manifest.has_ggx ? texels : 0);
  const TexelPoints points = locateTexels(scene.tracer.tile(), side, per_side);
  const auto add = [&](size_t t, const TileHit& hit) {
    coverage[t] += 1;
    normal[t] += glm::vec3(hit.normal);
    diffuse[t] += hit.brdf.diffuse;
    specular[t] += glm::vec3(phongLobe(hit.brdf), 0);
    if (!ggx.empty()) ggx[t] += ggxLobeOf(hit.brdf);
  };
  for (const auto& located : points.located)
    for (size_t t = 0; t < texels; ++t)
      if (const ParamSample& at = located[t]; at.covered())
        add(t, scene.tracer.pointOn(at.triangle, glm::dvec2(at.b)));
  // Also where the surface overlaps a texel between the samples: a border is near, and the reflectance is of
  // its nearest point, the normal continued from there.
  const auto beyond = extendParams(scene.tracer.tile(), side, kFilterReach);
  for (size_t t = 0; t < texels; ++t)
    if (coverage[t] == 0 && beyond[t].exists()) add(t, continuedPoint(scene.tracer, beyond[t]));
  for (size_t t = 0; t < texels; ++t)
    if (coverage[t] > 0) normal[t] /= coverage[t], diffuse[t] /= coverage[t], specular[t] /= coverage[t];
  for (size_t t = 0; t < ggx.size(); ++t)
    if (coverage[t] > 0) ggx[t] /= coverage[t];
  const HoleFill fill(scene.manifest.fill, side, coverage, ownersOf(scene.tracer.tile(), side, points));
  return {bakeGeometry(scene), filledMap(side, 3, fill, std::move(normal)),
          filledMap(side, 3, fill, std::move(diffuse)), filledMap(side, 2, fill, std::move(specular)),
          ggx.empty() ? Image{} : filledLobes(side, fill, ggx)};
}

}  // namespace loden::importer
