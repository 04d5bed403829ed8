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

// The weights of an image are reduced once, and serve any number of images.
class PushPull {
 public:
  // weights: [texel] of a size.x x size.y image, 0 where undefined, positive where defined. An axis that
  // wraps is periodic.
  PushPull(glm::ivec2 size, glm::bvec2 wraps, std::span<const float> weights);
  // Square and periodic.
  PushPull(int side, std::span<const float> weights)
      : PushPull(glm::ivec2(side), glm::bvec2(true), weights) {}

  // Replaces undefined texels; defined ones stay as they are. texels: [texel], size as weights. Without any
  // defined texel all stay.
  void apply(std::span<glm::vec3> texels) const;

 private:
  struct Level {
    glm::ivec2 size;
    std::vector<float> weight;
  };
  glm::bvec2 wraps_;
  std::vector<Level> levels_;
};

// Fills a periodic side x side map over p that holds several charts, each chart's holes and gutter from that
// chart alone. A chart without any defined texel gets the mean of all defined ones.
class HoleFill {
 public:
  // weights as in PushPull; owners: [texel] chart (charts.h: chartOwners); empty: one chart everywhere.
  HoleFill(FillMethod method, int side, std::span<const float> weights, std::span<const uint16_t> owners);
  ~HoleFill();
  HoleFill(HoleFill&&) noexcept;

  void apply(std::span<glm::vec3> texels) const;

 private:
  struct Part;  // of one chart
  std::vector<std::unique_ptr<Part>> parts_;
  std::vector<uint32_t> defined_, orphans_;  // texels; orphans are of charts without a defined one
};

}  // namespace loden::importer
