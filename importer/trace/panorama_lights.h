// A panorama as a source of random directional lights.
#pragma once

#include <cstdint>
#include <vector>

#include "material/model/environment.h"

namespace loden::importer {

// A direction and the weight of its light: the mean of weight * f(direction) over many samples is the
// integral of radiance * f over the sphere, divided by pi.
struct LightSample {
  glm::dvec3 direction{0, 0, 1};
  glm::dvec3 weight{1};
};

class PanoramaLights {
 public:
  // The panorama must outlive it. Non-finite and negative pixels count as black.
  explicit PanoramaLights(const Panorama& panorama);
  // A random light, drawn with a probability proportional to luminance times solid angle; its weight is 0 if
  // the panorama is black. u, v, w are in [0, 1).
  LightSample sample(double u, double v, double w) const;

 private:
  const Panorama& panorama_;
  std::vector<double> cumulative_;  // cumulative probability up to and including each pixel
};

}  // namespace loden::importer
