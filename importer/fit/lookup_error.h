// How far the shader's lookup is from the exact first hit on the geometry image.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "material/model/vdim.h"

namespace loden::importer {

// Between points of a tile that repeats, tile periods.
inline double periodicDistance(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 d = a - b;
  return glm::length(d - glm::round(d));
}

struct LookupError {
  double mean_texels = 0;   // distance of the two points' (x, y), in reference texels
  double over_1_texel = 0;  // share of the views that are further off than a texel
  double fetches = 0;       // per lookup, on average
};

// 65,536 random points and views, uniform in solid angle up to kThetaMax, and what they meet; rays that meet
// nothing are left out.
class LookupProbe {
 public:
  // `side`: reference texels per tile period. The image must outlive the probe.
  LookupProbe(const GeometryImage& geometry, int side, int threads);
  // Of an atlas of the same image.
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
