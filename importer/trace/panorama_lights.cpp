#include "importer/trace/panorama_lights.h"

#include <algorithm>
#include <cmath>

namespace loden::importer {
namespace {

glm::dvec3 usable(const glm::vec3& pixel) {
  glm::dvec3 c(pixel);
  for (int k = 0; k < 3; ++k) c[k] = std::isfinite(c[k]) ? std::max(c[k], 0.0) : 0.0;
  return c;
}

double luminance(const glm::dvec3& c) {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

// Of one pixel of the row.
double solidAngle(const Panorama& panorama, int row) {
  return 2 * kPi / panorama.width *
         (std::cos(kPi * row / panorama.height) - std::cos(kPi * (row + 1) / panorama.height));
}

}  // namespace

PanoramaLights::PanoramaLights(const Panorama& panorama) : panorama_(panorama) {
  double sum = 0;
  cumulative_.reserve(panorama.pixels.size());
  for (size_t i = 0; i < panorama.pixels.size(); ++i) {
    sum += luminance(usable(panorama.pixels[i])) * solidAngle(panorama, int(i / panorama.width));
    cumulative_.push_back(sum);
  }
}

LightSample PanoramaLights::sample(double u, double v, double w) const {
  if (cumulative_.empty() || !(cumulative_.back() > 0)) return {{0, 0, 1}, glm::dvec3(0)};
  const size_t i = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u * cumulative_.back()) -
                   cumulative_.begin();
  const int row = int(i / panorama_.width), column = int(i % panorama_.width);
  const glm::dvec3 c = usable(panorama_.pixels[i]);
  // Density: luminance / total, per solid angle.
  return {panoramaDirection(panorama_, column + v, row + w), c * (cumulative_.back() / (luminance(c) * kPi))};
}

}  // namespace loden::importer
