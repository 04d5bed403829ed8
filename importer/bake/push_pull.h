// Fills the holes of images over p from their surroundings: by push-pull, as published (FBTF 3.3; Gortler et
// al. 1996, 6.1), or harmonically.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "importer/btf/fill_method.h"

namespace loden::importer {

// Push-pull. The weights of an image are reduced once, and can then be applied to any number of images.
class PushPull {
 public:
  // `weights`: [texel] of a size.x x size.y image, 0 where undefined, positive where defined. The image is
  // periodic along each axis for which `wraps` is true.
  PushPull(glm::ivec2 size, glm::bvec2 wraps, std::span<const float> weights);
  // For a square image that is periodic along both axes.
  PushPull(int side, std::span<const float> weights)
      : PushPull(glm::ivec2(side), glm::bvec2(true), weights) {}

  // Replaces the undefined texels; defined ones are not changed. `texels` has the size of the weights. If no
  // texel is defined, none is changed.
  void apply(std::span<glm::vec3> texels) const;

 private:
  struct Level {
    glm::ivec2 size;
    std::vector<float> weight;
  };
  glm::bvec2 wraps_;
  std::vector<Level> levels_;
};

// Fills a periodic side x side map over p that holds several charts; each chart's holes and gutter are filled
// from that chart alone. A chart without any defined texel gets the mean of all defined texels.
class HoleFill {
 public:
  // `weights` are as in PushPull. `owners`: the chart of each texel (chartOwners of importer/tile/charts.h);
  // empty: one chart everywhere.
  HoleFill(FillMethod method, int side, std::span<const float> weights, std::span<const uint16_t> owners);
  ~HoleFill();
  HoleFill(HoleFill&&) noexcept;

  void apply(std::span<glm::vec3> texels) const;

 private:
  struct Part;  // the part of the map that belongs to one chart
  std::vector<std::unique_ptr<Part>> parts_;
  // Lists of texels; orphans are those of charts without a defined texel.
  std::vector<uint32_t> defined_, orphans_;
};

}  // namespace loden::importer
