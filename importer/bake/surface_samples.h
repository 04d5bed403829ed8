// Samples of the tile's surface over p, and which lights reach each of them. They are computed once and
// shared by all views of the Flat-BTF and of the BTF. Not installed.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "importer/bake/bake_scene.h"

namespace loden::importer {

struct SurfaceSample {
  glm::vec3 origin, normal, geometric_normal;
  LocalBrdf brdf;
  uint32_t triangle;
  glm::vec2 b;
  glm::dvec2 place;  // position in its texel, in [0,1]^2
};

class SurfaceSamples {
 public:
  // Takes supersample^2 samples for each of flat_size^2 texels, at samplePosition, and one for a texel that
  // the surface overlaps only between them (locateTexels). Traces a ray to every light that the sample faces.
  explicit SurfaceSamples(const BakeScene& scene);

  int side() const { return side_; }  // texels
  // The chart that each texel belongs to (ownersOf); empty if there is one chart.
  const std::vector<uint16_t>& owners() const { return owners_; }
  // The range of samples of one texel, row-major: fewer than supersample^2 at the border of a chart, none
  // where there is no surface.
  size_t first(size_t texel) const { return first_[texel]; }
  size_t end(size_t texel) const { return first_[texel + 1]; }
  const SurfaceSample& operator[](size_t sample) const { return samples_[sample]; }

  // The number of words of a set of lights; light l is bit l % 64 of word l / 64.
  size_t words() const { return words_; }
  // The set of lights that reach a sample.
  const uint64_t* lit(size_t sample) const { return &lit_[sample * words_]; }
  // For a point that a ray has hit: `known` is the set of lights about which the four samples around the
  // point agree, `lit` those of them that reach it. No light is known on back sides, beside gaps, and where
  // the samples are not neighbours in space.
  void lightsAt(const TileHit& hit, uint64_t* known, uint64_t* lit) const;

 private:
  void traceLights(const BakeScene& scene);
  bool neighbours(const TileHit& hit, const uint32_t (&around)[4]) const;

  int side_ = 0, per_side_ = 0;
  glm::dvec2 offset_{0};          // of a sample, in its cell of the grid of all samples
  std::vector<uint16_t> owners_;  // [flat texel]
  std::vector<uint32_t> first_;   // [flat texel + 1]
  std::vector<SurfaceSample> samples_;
  std::vector<uint32_t> grid_;  // [side * per_side squared, row-major]: index of the sample, or kNone
  size_t words_ = 0;
  std::vector<uint64_t> faced_,
      // [sample][word]: the lights above the sample's tangent plane; the lights that reach it.
      lit_;
};

}  // namespace loden::importer
