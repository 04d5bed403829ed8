#include "importer/bake/surface_samples.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "importer/base/periodic_noise.h"

namespace loden::importer {
namespace {

constexpr uint32_t kNone = 0xFFFFFFFFu;
constexpr double kNear = 8;  // sample spacings between a point and the samples that speak for it, at most

}  // namespace

SurfaceSamples::SurfaceSamples(const BakeScene& scene)
    : side_(scene.manifest.flat_size),
      per_side_(scene.manifest.supersample),
      offset_(samplePosition(0, per_side_) * double(per_side_)) {
  const int per_texel = per_side_ * per_side_, grid_side = side_ * per_side_;
  const TexelPoints points = locateTexels(scene.tracer.tile(), side_, per_side_);
  owners_ = ownersOf(scene.tracer.tile(), side_, points);
  grid_.assign(size_t(grid_side) * size_t(grid_side), kNone);
  first_.assign(1, 0);
  const auto add = [&](const ParamSample& at, const TileHit& hit, const glm::dvec2& place) {
    samples_.push_back({glm::vec3(hit.ray_origin), glm::vec3(hit.normal), glm::vec3(hit.geometric_normal),
                        hit.brdf, at.triangle, at.b, place});
  };
  for (size_t t = 0; t < size_t(side_) * size_t(side_); ++t) {
    const glm::ivec2 texel(int(t) % side_, int(t) / side_);
    for (int k = 0; k < per_texel; ++k) {
      const ParamSample& at = points.located[size_t(k)][t];
      if (!at.covered()) continue;
      const glm::ivec2 cell = texel * per_side_ + glm::ivec2(k % per_side_, k / per_side_);
      grid_[size_t(cell.y) * size_t(grid_side) + size_t(cell.x)] = static_cast<uint32_t>(samples_.size());
      add(at, scene.tracer.pointOn(at.triangle, glm::dvec2(at.b)), samplePosition(k, per_side_));
    }
    // Not in the grid: it does not lie where the grid's samples do.
    if (const ParamSample& at = points.between[t]; at.covered()) {
      const TileHit hit = scene.tracer.pointOn(at.triangle, glm::dvec2(at.b));
      const glm::dvec2 off = hit.p * double(side_) - glm::dvec2(texel) - 0.5;
      add(at, hit, glm::clamp(off - glm::round(off / double(side_)) * double(side_) + 0.5, 0.0, 1.0));
    }
    first_.push_back(static_cast<uint32_t>(samples_.size()));
  }
  traceLights(scene);
}

void SurfaceSamples::traceLights(const BakeScene& scene) {
  constexpr size_t kBlock = 256;  // samples
  const auto& directions = scene.directions();
  words_ = (directions.size() + 63) / 64;
  lit_.assign(samples_.size() * words_, 0);
  faced_ = lit_;
  const size_t blocks = (samples_.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(size_t(0), blocks, [&](size_t block) {
    const FlushDenormals flush;
    const size_t first = block * kBlock, count = std::min(samples_.size() - first, kBlock);
    std::vector<glm::vec3> origins(count);
    std::vector<uint8_t> wanted(count), blocked(count);
    for (size_t s = 0; s < count; ++s) origins[s] = samples_[first + s].origin;
    uint64_t rays = 0;
    for (size_t l = 0; l < directions.size(); ++l) {
      const glm::vec3 wi(directions[l]);
      for (size_t s = 0; s < count; ++s) rays += wanted[s] = glm::dot(samples_[first + s].normal, wi) > 0;
      scene.tracer.occluded(origins, wanted, wi, blocked);
      for (size_t s = 0; s < count; ++s) {
        const size_t word = (first + s) * words_ + l / 64;
        faced_[word] |= uint64_t(wanted[s]) << (l % 64);
        lit_[word] |= uint64_t(!blocked[s]) << (l % 64);
      }
    }
    scene.counters.rays += rays;
  });
}

bool SurfaceSamples::neighbours(const TileHit& hit, const uint32_t (&around)[4]) const {
  const double near = kNear / double(side_ * per_side_);
  for (const uint32_t s : around) {
    if (s == kNone) return false;
    glm::dvec3 off = hit.ray_origin - glm::dvec3(samples_[s].origin);
    off -= glm::dvec3(glm::round(glm::dvec2(off)), 0);
    if (glm::dot(off, off) > near * near) return false;
  }
  return true;
}

void SurfaceSamples::lightsAt(const TileHit& hit, uint64_t* known, uint64_t* lit) const {
  std::fill_n(known, words_, uint64_t{0});
  std::fill_n(lit, words_, uint64_t{0});
  if (glm::dot(hit.geometric_normal, hit.normal) < 0) return;  // the back
  const int n = side_ * per_side_;
  const glm::ivec2 base(glm::floor(hit.p * double(n) - offset_));
  const auto at = [&](int i, int j) {
    return grid_[size_t(wrapIndex(base.y + j, n)) * size_t(n) + size_t(wrapIndex(base.x + i, n))];
  };
  const uint32_t around[4] = {at(0, 0), at(1, 0), at(0, 1), at(1, 1)};
  if (!neighbours(hit, around)) return;
  for (size_t w = 0; w < words_; ++w) {
    uint64_t faced = ~uint64_t{0}, all = ~uint64_t{0}, any = 0;
    for (const uint32_t s : around) {
      faced &= faced_[s * words_ + w];
      all &= lit_[s * words_ + w];
      any |= lit_[s * words_ + w];
    }
    known[w] = faced & (all | ~any);
    lit[w] = faced & all;
  }
}

}  // namespace loden::importer
