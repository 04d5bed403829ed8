// The Flat-BTF: light that leaves points of the tile's own surface (FBTF 3.3).
#include <tbb/parallel_for.h>

#include <algorithm>

#include "importer/bake_scene.h"
#include "importer/local_brdf.h"
#include "importer/random.h"

namespace loden::importer {

FlatBaker::FlatBaker(const BakeScene& scene) : scene_(scene), side_(scene.manifest.flat_size) {
  const int per_side = scene.manifest.supersample;
  per_texel_ = per_side * per_side;
  std::vector<std::vector<ParamSample>> located;
  for (int k = 0; k < per_texel_; ++k)
    located.push_back(locateParams(scene.tracer.tile(), side_, samplePosition(k, per_side)));
  owners_ = ownersOf(scene.tracer.tile(), side_, located);
  const size_t texels = size_t(side_) * size_t(side_);
  first_.assign(1, 0);
  for (size_t t = 0; t < texels; ++t) {
    for (int k = 0; k < per_texel_; ++k) {
      const ParamSample& at = located[size_t(k)][t];
      if (!at.covered()) continue;
      const TileHit hit = scene.tracer.pointOn(at.triangle, glm::dvec2(at.b));
      samples_.push_back({glm::vec3(hit.ray_origin), glm::vec3(hit.normal), glm::vec3(hit.geometric_normal), hit.brdf, at.triangle, at.b});
    }
    first_.push_back(static_cast<uint32_t>(samples_.size()));
  }
  traceShadows();
}

void FlatBaker::traceShadows() {
  constexpr size_t kBlock = 256;  // samples
  const auto& directions = scene_.directions();
  words_ = (directions.size() + 63) / 64;
  light_bits_.assign(samples_.size() * words_, 0);
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
      scene_.tracer.occluded(origins, wanted, wi, blocked);
      for (size_t s = 0; s < count; ++s) light_bits_[(first + s) * words_ + l / 64] |= uint64_t(!blocked[s]) << (l % 64);
    }
    scene_.counters.rays += rays;
  });
}

FlatBaker::View FlatBaker::bakeView(int view) const {
  const AtlasLayout layout = AtlasLayout::forLights(side_, scene_.manifest.directions.size());
  View result{{layout.width(), layout.height(), 3, {}}, std::vector<float>(size_t(side_) * size_t(side_))};
  result.atlas.pixels.resize(size_t(layout.width()) * size_t(layout.height()) * 3);
  tbb::parallel_for(0, side_, [&](int row) {
    const FlushDenormals flush;
    bakeRow(row, view, result.atlas, result.visible);
  });
  const HoleFill fill(scene_.manifest.fill, side_, result.visible, owners_);
  tbb::parallel_for(0, layout.cells, [&](int light) {
    const FlushDenormals flush;
    std::vector<glm::vec3> texels(size_t(side_) * size_t(side_));
    glm::vec3* const pixels = reinterpret_cast<glm::vec3*>(result.atlas.pixels.data());
    for (int j = 0; j < side_; ++j) std::copy_n(pixels + layout.pixel(light, 0, j), side_, &texels[size_t(j) * size_t(side_)]);
    fill.apply(texels);
    for (int j = 0; j < side_; ++j) std::copy_n(&texels[size_t(j) * size_t(side_)], side_, pixels + layout.pixel(light, 0, j));
  });
  return result;
}

void FlatBaker::bakeRow(int row, int view, Image& atlas, std::vector<float>& visible) const {
  const AtlasLayout layout = AtlasLayout::forLights(side_, scene_.manifest.directions.size());
  const glm::dvec3 wo = scene_.directions()[size_t(view)];
  LightTable lights(scene_.manifest.directions);
  lights.setView(glm::vec3(wo));
  const size_t count = lights.size();
  std::vector<float> cosines(count), lobes(count), tinted(count);
  std::vector<glm::vec3> sum(count);
  uint64_t rays = 0;
  for (int i = 0; i < side_; ++i) {
    const size_t texel = size_t(row) * size_t(side_) + size_t(i);
    std::fill(sum.begin(), sum.end(), glm::vec3(0));
    int seen = 0;
    for (size_t s = first_[texel]; s < first_[texel + 1]; ++s) {
      const Sample& sample = samples_[s];
      if (glm::dot(sample.geometric_normal, glm::vec3(wo)) <= 0) continue;
      ++rays;
      if (scene_.tracer.occluded(glm::dvec3(sample.origin), wo)) continue;
      ++seen;
      lobesOfAllLights(lights, sample.normal, glm::vec3(wo), sample.brdf, cosines.data(), lobes.data(), tinted.data());
      for (size_t l = 0; l < count; ++l)
        if (lit(s, int(l))) sum[l] += sample.brdf.diffuse * cosines[l] + lobes[l];
      for (size_t l = 0; sample.brdf.alpha > 0 && l < count; ++l)
        if (lit(s, int(l))) sum[l] += sample.brdf.f0 * tinted[l];
      if (scene_.manifest.bounces > 0)
        addIndirect(scene_, scene_.tracer.pointOn(sample.triangle, glm::dvec2(sample.b)), wo, mixSeed(~texel, s - first_[texel]), sum.data());
    }
    if (seen == 0) continue;
    visible[texel] = float(seen) / float(first_[texel + 1] - first_[texel]);
    for (size_t l = 0; l < count; ++l) {
      float* pixel = &atlas.pixels[3 * layout.pixel(int(l), i, row)];
      for (int c = 0; c < 3; ++c) pixel[c] = sum[l][c] / float(seen);
    }
  }
  scene_.counters.rays += rays;
}

}  // namespace loden::importer
