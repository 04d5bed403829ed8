// The reference BTF: rays through every texel of the reference plane, from every view (FBTF 4).
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "importer/bake_scene.h"
#include "importer/local_brdf.h"
#include "importer/random.h"

namespace loden::importer {
namespace {

constexpr int kBlockSamples = 8;  // samples per side of the texel blocks that are traced together

// The first hits of one block of texels, and the light that leaves them.
class BtfBlock {
 public:
  BtfBlock(const BakeScene& scene, const LightTable& lights, const glm::dvec3& wo) : scene_(scene), lights_(lights), wo_(wo) {}

  void trace(glm::ivec2 first, glm::ivec2 last);
  void shade(Image& atlas, const AtlasLayout& layout);

 private:
  struct Sample {
    glm::ivec2 texel;
    glm::vec3 normal, diffuse, f0;
  };
  void add(glm::ivec2 texel, const TileHit& hit, uint64_t seed);
  void traceShadows();

  const BakeScene& scene_;
  const LightTable& lights_;
  const glm::dvec3 wo_;
  std::vector<Sample> samples_;          // texel by texel
  std::vector<glm::vec3> origins_;       // [sample]
  std::vector<float> cosines_, lobes_;   // [sample][light]
  std::vector<float> tinted_;            // [sample][light], empty without GGX lobes
  std::vector<float> lit_;               // [sample][light], 0 or 1
  std::vector<glm::vec3> indirect_;      // [sample][light], empty without bounces
};

void BtfBlock::add(glm::ivec2 texel, const TileHit& hit, uint64_t seed) {
  const size_t row = samples_.size() * lights_.size();
  samples_.push_back({texel, glm::vec3(hit.normal), hit.brdf.diffuse, hit.brdf.f0});
  origins_.emplace_back(hit.ray_origin);
  cosines_.resize(row + lights_.size());
  lobes_.resize(row + lights_.size());
  if (hit.brdf.alpha > 0 || !tinted_.empty()) tinted_.resize(row + lights_.size());
  lobesOfAllLights(lights_, glm::vec3(hit.normal), glm::vec3(wo_), hit.brdf, &cosines_[row], &lobes_[row], tinted_.empty() ? nullptr : &tinted_[row]);
  if (scene_.manifest.bounces == 0) return;
  indirect_.resize(row + lights_.size());
  addIndirect(scene_, hit, wo_, seed, &indirect_[row]);
}

void BtfBlock::trace(glm::ivec2 first, glm::ivec2 last) {
  const int size = scene_.manifest.size, per_side = scene_.manifest.supersample;
  uint64_t misses = 0;
  for (int j = first.y; j < last.y; ++j)
    for (int i = first.x; i < last.x; ++i)
      for (int k = 0; k < per_side * per_side; ++k) {
        const glm::dvec2 x = (glm::dvec2(i, j) + samplePosition(k, per_side)) / double(size);
        const auto hit = scene_.tracer.intersectView(x, wo_);
        if (hit) add({i, j}, *hit, mixSeed(uint64_t(j) * uint64_t(size) + uint64_t(i), uint64_t(k)));
        misses += !hit;
      }
  const uint64_t rays = uint64_t(last.x - first.x) * uint64_t(last.y - first.y) * uint64_t(per_side * per_side);
  scene_.counters.rays += rays;
  scene_.counters.hits_due += rays;
  scene_.counters.misses += misses;
}

void BtfBlock::traceShadows() {
  const size_t count = samples_.size(), lights = lights_.size();
  lit_.resize(count * lights);
  std::vector<uint8_t> wanted(count), blocked(count);
  uint64_t rays = 0;
  for (size_t l = 0; l < lights; ++l) {
    const glm::vec3 wi(lights_.x[l], lights_.y[l], lights_.z[l]);
    for (size_t s = 0; s < count; ++s) rays += wanted[s] = glm::dot(samples_[s].normal, wi) > 0;
    scene_.tracer.occluded(origins_, wanted, wi, blocked);
    for (size_t s = 0; s < count; ++s) lit_[s * lights + l] = blocked[s] ? 0.0f : 1.0f;
  }
  scene_.counters.rays += rays;
}

void BtfBlock::shade(Image& atlas, const AtlasLayout& layout) {
  traceShadows();
  const size_t lights = lights_.size();
  const float share = 1.0f / float(scene_.manifest.supersample * scene_.manifest.supersample);
  std::vector<float> sum(3 * lights);  // [channel][light] of one texel
  for (size_t first = 0, last = 0; first < samples_.size(); first = last) {
    std::fill(sum.begin(), sum.end(), 0.0f);
    for (; last < samples_.size() && samples_[last].texel == samples_[first].texel; ++last) {
      const float *cosine = &cosines_[last * lights], *lobe = &lobes_[last * lights], *lit = &lit_[last * lights];
      for (int c = 0; c < 3; ++c) {
        float* const channel = &sum[size_t(c) * lights];
        const float diffuse = samples_[last].diffuse[c];
        for (size_t l = 0; l < lights; ++l) channel[l] += lit[l] * (diffuse * cosine[l] + lobe[l]);
        if (last * lights >= tinted_.size()) continue;
        for (size_t l = 0; l < lights; ++l) channel[l] += lit[l] * samples_[last].f0[c] * tinted_[last * lights + l];
      }
      if (indirect_.empty()) continue;
      for (size_t l = 0; l < lights; ++l)
        for (int c = 0; c < 3; ++c) sum[size_t(c) * lights + l] += indirect_[last * lights + l][c];
    }
    const glm::ivec2 texel = samples_[first].texel;
    for (size_t l = 0; l < lights; ++l) {
      float* const pixel = &atlas.pixels[3 * layout.pixel(int(l), texel.x, texel.y)];
      for (size_t c = 0; c < 3; ++c) pixel[c] = share * sum[c * lights + l];
    }
  }
}

}  // namespace

Image bakeBtfView(const BakeScene& scene, int view) {
  const int size = scene.manifest.size, count = scene.manifest.directions.size();
  const AtlasLayout layout = AtlasLayout::forLights(size, count);
  Image atlas{layout.width(), layout.height(), 3, {}};
  atlas.pixels.resize(size_t(layout.width()) * size_t(layout.height()) * 3);

  const glm::dvec3 wo = scene.directions()[size_t(view)];
  LightTable lights(scene.manifest.directions);
  lights.setView(glm::vec3(wo));
  const int edge = std::max(1, kBlockSamples / scene.manifest.supersample);
  const int blocks = (size + edge - 1) / edge;
  tbb::parallel_for(tbb::blocked_range2d<int>(0, blocks, 0, blocks), [&](const tbb::blocked_range2d<int>& range) {
    const FlushDenormals flush;
    for (int j = range.rows().begin(); j < range.rows().end(); ++j)
      for (int i = range.cols().begin(); i < range.cols().end(); ++i) {
        BtfBlock block(scene, lights, wo);
        block.trace(glm::ivec2(i, j) * edge, glm::min(glm::ivec2(i + 1, j + 1) * edge, glm::ivec2(size)));
        block.shade(atlas, layout);
      }
  });
  return atlas;
}

}  // namespace loden::importer
