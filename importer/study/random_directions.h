// Random directions between the samples, for errors at directions that the fits never saw.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <random>

#include "material/model/directions.h"

namespace loden::importer {

// A random direction, uniform over the solid angle up to theta_max (radians).
inline glm::dvec3 randomDirection(std::mt19937_64& random, double theta_max) {
  std::uniform_real_distribution<double> uniform;
  const double cosine = 1 - uniform(random) * (1 - std::cos(theta_max)), phi = 2 * kPi * uniform(random);
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

}  // namespace loden::importer
