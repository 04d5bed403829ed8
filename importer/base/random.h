// Counter-based random numbers: a value depends on its seed and index only, never on the order of calls.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "material/model/directions.h"

namespace loden::importer {

// A random 64-bit number: splitmix64 of the seed advanced `index` + 1 times.
inline uint64_t mixSeed(uint64_t seed, uint64_t index) {
  uint64_t z = seed + (index + 1) * 0x9E3779B97F4A7C15ull;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

// A random number in [0, 1).
inline double uniform(uint64_t seed, uint64_t index) {
  return double(mixSeed(seed, index) >> 11) * 0x1p-53;
}

// A unit direction with density cosine / pi around the unit normal, for u and v uniform in [0, 1).
inline glm::dvec3 cosineDirection(const glm::dvec3& normal, double u, double v) {
  const double radius = std::sqrt(u), phi = 2 * kPi * v;
  const glm::dvec3 side = std::abs(normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 tangent = glm::normalize(glm::cross(side, normal));
  const glm::dvec3 bitangent = glm::cross(normal, tangent);
  return radius * std::cos(phi) * tangent + radius * std::sin(phi) * bitangent + std::sqrt(1 - u) * normal;
}

}  // namespace loden::importer
