// The reference BTF: rays through every texel of the reference plane, from every view (FBTF 4).
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "importer/bake/bake_scene.h"
#include "importer/bake/light_sum.h"
#include "importer/bake/surface_samples.h"
#include "importer/base/random.h"

namespace loden::importer {
namespace {

constexpr int kBlockSamples = 32;  // samples per side of the texel blocks that are traced together

// The first hits of one block of texels, and the light that leaves them.
class BtfBlock {
 public:
  BtfBlock(const BakeScene& scene, const SurfaceSamples& surface, const LightTable& lights,
           const glm::dvec3& wo)
      : scene_(scene), surface_(surface), lights_(lights), wo_(wo), unknown_(lights.size()) {}

  void trace(glm::ivec2 first, glm::ivec2 last);
  void traceUnknownLights();
  void shade(Image& atlas, const AtlasLayout& layout) const;

 private:
  struct Sample {
    glm::ivec2 texel;
    glm::vec3 normal;
    LocalBrdf brdf;
  };
  void add(glm::ivec2 texel, const TileHit& hit, uint64_t seed);
  void findLights(const TileHit& hit, size_t sample);

  const BakeScene& scene_;
  const SurfaceSamples& surface_;
  const LightTable& lights_;
  const glm::dvec3 wo_;
  std::vector<Sample> samples_;                 // texel by texel
  std::vector<glm::vec3> origins_;              // [sample]
  std::vector<uint64_t> lit_;                   // [sample][word]: lights that reach the sample
  std::vector<uint64_t> known_;                 // [word], of one sample
  std::vector<std::vector<uint32_t>> unknown_;  // [light]: samples that face it, but may lie in a shadow
  std::vector<glm::vec3> indirect_;             // [sample][light], empty without bounces
};

void BtfBlock::add(glm::ivec2 texel, const TileHit& hit, uint64_t seed) {
  const size_t sample = samples_.size();
  samples_.push_back({texel, glm::vec3(hit.normal), hit.brdf});
  origins_.emplace_back(hit.ray_origin);
  findLights(hit, sample);
  if (scene_.manifest.bounces == 0) return;
  indirect_.resize((sample + 1) * lights_.size());
  addIndirect(scene_, hit, wo_, seed, &indirect_[sample * lights_.size()]);
}

// What the samples around the hit do not agree on is left to rays.
void BtfBlock::findLights(const TileHit& hit, size_t sample) {
  const size_t words = surface_.words();
  lit_.resize((sample + 1) * words);
  known_.resize(words);
  surface_.lightsAt(hit, known_.data(), &lit_[sample * words]);
  const glm::vec3& n = samples_[sample].normal;
  for (size_t w = 0; w < words; ++w)
    for (uint64_t left = ~known_[w]; left != 0; left &= left - 1) {
      const size_t l = 64 * w + size_t(std::countr_zero(left));
      if (l >= lights_.size()) break;
      if (n.x * lights_.x[l] + n.y * lights_.y[l] + n.z * lights_.z[l] > 0)
        unknown_[l].push_back(uint32_t(sample));
    }
}

void BtfBlock::trace(glm::ivec2 first, glm::ivec2 last) {
  const int size = scene_.manifest.size, per_side = scene_.manifest.supersample,
            per_texel = per_side * per_side;
  std::vector<glm::dvec2> x;
  for (int j = first.y; j < last.y; ++j)
    for (int i = first.x; i < last.x; ++i)
      for (int k = 0; k < per_texel; ++k)
        x.push_back((glm::dvec2(i, j) + samplePosition(k, per_side)) / double(size));
  std::vector<std::optional<TileHit>> hits(x.size());
  scene_.tracer.intersectViews(x, wo_, hits);
  scene_.counters.rays += x.size();
  for (size_t k = 0; k < hits.size(); ++k) {
    const int t = int(k) / per_texel;
    const glm::ivec2 texel = first + glm::ivec2(t % (last.x - first.x), t / (last.x - first.x));
    if (hits[k])
      add(texel, *hits[k],
          mixSeed(uint64_t(texel.y) * uint64_t(size) + uint64_t(texel.x), k % size_t(per_texel)));
    else
      ++scene_.counters.misses;
  }
}

void BtfBlock::traceUnknownLights() {
  std::vector<glm::vec3> origins;
  std::vector<uint8_t> wanted, blocked;
  uint64_t rays = 0;
  for (size_t l = 0; l < lights_.size(); ++l) {
    origins.clear();
    for (const uint32_t s : unknown_[l]) origins.push_back(origins_[s]);
    wanted.assign(origins.size(), 1);
    blocked.resize(origins.size());
    scene_.tracer.occluded(origins, wanted, {lights_.x[l], lights_.y[l], lights_.z[l]}, blocked);
    for (size_t k = 0; k < origins.size(); ++k)
      lit_[unknown_[l][k] * surface_.words() + l / 64] |= uint64_t(!blocked[k]) << (l % 64);
    rays += origins.size();
  }
  scene_.counters.rays += rays;
}

void BtfBlock::shade(Image& atlas, const AtlasLayout& layout) const {
  const size_t lights = lights_.size();
  const float share = 1.0f / float(scene_.manifest.supersample * scene_.manifest.supersample);
  LightSum sum(lights_);
  for (size_t first = 0, last = 0; first < samples_.size(); first = last) {
    sum.clear();
    for (; last < samples_.size() && samples_[last].texel == samples_[first].texel; ++last) {
      sum.add(samples_[last].normal, glm::vec3(wo_), samples_[last].brdf, &lit_[last * surface_.words()]);
      if (!indirect_.empty()) sum.add({&indirect_[last * lights], lights});
    }
    const glm::ivec2 texel = samples_[first].texel;
    for (size_t l = 0; l < lights; ++l)
      for (int c = 0; c < 3; ++c)
        atlas.pixels[3 * layout.pixel(int(l), texel.x, texel.y) + size_t(c)] = share * sum[l][c];
  }
}

}  // namespace

Image bakeBtfView(const BakeScene& scene, const SurfaceSamples& surface, int view) {
  const int size = scene.manifest.size, count = scene.manifest.directions.size();
  const AtlasLayout layout = AtlasLayout::forLights(size, count);
  Image atlas{layout.width(), layout.height(), 3, {}};
  atlas.pixels.resize(size_t(layout.width()) * size_t(layout.height()) * 3);

  const glm::dvec3 wo = scene.directions()[size_t(view)];
  LightTable lights(scene.manifest.directions);
  lights.setView(glm::vec3(wo));
  const int edge = std::max(1, kBlockSamples / scene.manifest.supersample);
  const int blocks = (size + edge - 1) / edge;
  tbb::parallel_for(
      tbb::blocked_range2d<int>(0, blocks, 0, blocks), [&](const tbb::blocked_range2d<int>& range) {
        const FlushDenormals flush;
        for (int j = range.rows().begin(); j < range.rows().end(); ++j)
          for (int i = range.cols().begin(); i < range.cols().end(); ++i) {
            BtfBlock block(scene, surface, lights, wo);
            block.trace(glm::ivec2(i, j) * edge, glm::min(glm::ivec2(i + 1, j + 1) * edge, glm::ivec2(size)));
            block.traceUnknownLights();
            block.shade(atlas, layout);
          }
      });
  return atlas;
}

}  // namespace loden::importer
