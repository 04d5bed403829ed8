// Fills the holes of periodic images from their surroundings by push-pull (FBTF 3.3; Gortler et al. 1996, 6.1).
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace loden::importer {

// The weights of a side x side image are reduced once, and serve any number of images.
class PushPull {
 public:
  // weights: [texel], 0 where undefined, positive where defined.
  PushPull(int side, std::span<const float> weights);

  // Replaces undefined texels; defined ones stay as they are. texels: [texel], size side * side. Without any
  // defined texel all stay.
  void apply(std::span<glm::vec3> texels) const;

 private:
  struct Level {
    int side;
    std::vector<float> weight;
  };
  std::vector<Level> levels_;
};

}  // namespace loden::importer
