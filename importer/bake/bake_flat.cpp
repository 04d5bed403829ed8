// The Flat-BTF: light that leaves points of the tile's own surface (FBTF 3.3).
#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>

#include "importer/bake/bake_scene.h"
#include "importer/bake/light_sum.h"
#include "importer/bake/linear_texels.h"
#include "importer/bake/surface_samples.h"
#include "importer/base/random.h"

namespace loden::importer {
namespace {

// One row of flat texels under one view.
class FlatRow {
 public:
  // linear: takes every sample that the view sees; none: only the texels' means are wanted.
  FlatRow(const BakeScene& scene, const SurfaceSamples& surface, const LightTable& lights,
          const glm::dvec3& wo, int row, LinearTexels* linear)
      : scene_(scene),
        surface_(surface),
        lights_(lights),
        wo_(wo),
        row_(row),
        linear_(linear),
        single_(lights),
        values_(lights.size()) {}

  void bake(FlatView& view);

 private:
  size_t texel(int i) const { return size_t(row_) * size_t(surface_.side()) + size_t(i); }
  void traceView();
  int addTexel(int i, LightSum& sum);  // the number of samples that the view sees
  void addSample(size_t sample, uint64_t seed, LightSum& sum) const;

  const BakeScene& scene_;
  const SurfaceSamples& surface_;
  const LightTable& lights_;
  const glm::dvec3 wo_;
  const int row_;
  LinearTexels* const linear_;
  LightSum single_;                // of one sample
  std::vector<glm::vec3> values_;  // [light], the same
  std::vector<uint8_t> hidden_;    // [sample of the row], from the first one
};

// Which samples the view sees: those that face it, and that no other part of the tile hides.
void FlatRow::traceView() {
  const size_t first = surface_.first(texel(0)), end = surface_.end(texel(surface_.side() - 1));
  std::vector<glm::vec3> origins;
  std::vector<uint8_t> facing;
  uint64_t rays = 0;
  for (size_t s = first; s < end; ++s) {
    origins.push_back(surface_[s].origin);
    facing.push_back(glm::dot(surface_[s].geometric_normal, glm::vec3(wo_)) > 0);
    rays += facing.back();
  }
  hidden_.resize(end - first);
  scene_.tracer.occluded(origins, facing, glm::vec3(wo_), hidden_);
  scene_.counters.rays += rays;
}

void FlatRow::addSample(size_t sample, uint64_t seed, LightSum& sum) const {
  const SurfaceSample& at = surface_[sample];
  sum.add(at.normal, glm::vec3(wo_), at.brdf, surface_.lit(sample));
  if (scene_.manifest.bounces == 0) return;
  std::vector<glm::vec3> indirect(lights_.size());
  addIndirect(scene_, scene_.tracer.pointOn(at.triangle, glm::dvec2(at.b)), wo_, seed, indirect.data());
  sum.add(indirect);
}

int FlatRow::addTexel(int i, LightSum& sum) {
  const size_t row_begin = surface_.first(texel(0)), t = texel(i);
  int seen = 0;
  for (size_t s = surface_.first(t); s < surface_.end(t); ++s) {
    if (hidden_[s - row_begin]) continue;
    ++seen;
    const uint64_t seed = mixSeed(~t, s - surface_.first(t));
    if (!linear_) {
      addSample(s, seed, sum);
      continue;
    }
    single_.clear();
    addSample(s, seed, single_);
    for (size_t l = 0; l < lights_.size(); ++l) values_[l] = single_[l];
    sum.add(values_);
    linear_->add({i, row_}, surface_[s].place, values_);
  }
  return seen;
}

void FlatRow::bake(FlatView& view) {
  const AtlasLayout layout = AtlasLayout::forLights(surface_.side(), scene_.manifest.directions.size());
  traceView();
  LightSum sum(lights_);
  for (int i = 0; i < surface_.side(); ++i) {
    sum.clear();
    const int seen = addTexel(i, sum);
    if (seen == 0) continue;
    view.visible[texel(i)] = float(seen) / float(surface_.end(texel(i)) - surface_.first(texel(i)));
    for (size_t l = 0; l < lights_.size(); ++l)
      for (int c = 0; c < 3; ++c)
        view.atlas.pixels[3 * layout.pixel(int(l), i, row_) + size_t(c)] = sum[l][c] / float(seen);
  }
}

// All rows, in turns whose rows are three apart, so that those of a turn touch no common neighbour.
template <class Body>
void forRowsApart(int side, const Body& body) {
  const int thirds = side / 3;
  for (int turn = 0; turn < 3; ++turn) tbb::parallel_for(0, thirds, [&](int k) { body(3 * k + turn); });
  for (int row = 3 * thirds; row < side; ++row) body(row);
}

}  // namespace

FlatView bakeFlatView(const BakeScene& scene, const SurfaceSamples& surface, int view) {
  const int side = surface.side();
  const AtlasLayout layout = AtlasLayout::forLights(side, scene.manifest.directions.size());
  FlatView result{{layout.width(), layout.height(), 3, {}}, std::vector<float>(size_t(side) * size_t(side))};
  result.atlas.pixels.resize(size_t(layout.width()) * size_t(layout.height()) * 3);
  const glm::dvec3 wo = scene.directions()[size_t(view)];
  LightTable lights(scene.manifest.directions);
  lights.setView(glm::vec3(wo));
  std::optional<LinearTexels> linear;
  if (scene.manifest.texels == TexelMethod::kLinear)
    linear.emplace(side, scene.manifest.supersample, lights.size());
  forRowsApart(side, [&](int row) {
    const FlushDenormals flush;
    FlatRow(scene, surface, lights, wo, row, linear ? &*linear : nullptr).bake(result);
  });
  const HoleFill fill(scene.manifest.fill, side, result.visible, surface.owners());
  tbb::parallel_for(0, layout.cells, [&](int light) {
    const FlushDenormals flush;
    std::vector<glm::vec3> texels(size_t(side) * size_t(side));
    glm::vec3* const pixels = reinterpret_cast<glm::vec3*>(result.atlas.pixels.data());
    for (int j = 0; j < side; ++j)
      std::copy_n(pixels + layout.pixel(light, 0, j), side, &texels[size_t(j) * size_t(side)]);
    fill.apply(texels);
    if (linear) linear->fit(size_t(light), texels);
    for (int j = 0; j < side; ++j)
      std::copy_n(&texels[size_t(j) * size_t(side)], side, pixels + layout.pixel(light, 0, j));
  });
  return result;
}

}  // namespace loden::importer
