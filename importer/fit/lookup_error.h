// Measures the distance of the shader's VDIM look-up from the exact first hit on the geometry image.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "material/model/vdim.h"

namespace loden::importer {

// The distance between points of a periodic tile, in tile periods.
inline double periodicDistance(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 d = a - b;
  return glm::length(d - glm::round(d));
}

struct LookupError {
  double mean_texels = 0;   // distance of the two points' (x, y), in reference texels
  double over_1_texel = 0;  // share of the look-ups that are off by more than a texel
  double fetches = 0;       // texture fetches per look-up, on average
};

// 65,536 random points and views, uniform in solid angle up to kThetaMax, with their exact hits. Rays that
// meet nothing are left out.
class LookupProbe {
 public:
  // `side`: reference texels per tile period. The image must outlive the probe.
  LookupProbe(const GeometryImage& geometry, int side, int threads);
  // The error of a look-up in an atlas of the same image.
  LookupError measure(const VdimAtlas& atlas, Lookup lookup) const;

 private:
  struct Ray {
    glm::dvec2 x{0};
    glm::dvec3 wo{0, 0, 1};
    glm::dvec2 truth{0};  // (x, y) of the first hit, tile periods
  };
  const GeometryImage& geometry_;
  int side_, threads_;
  std::vector<std::vector<Ray>> blocks_;
};

}  // namespace loden::importer
