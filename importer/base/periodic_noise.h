// Smooth pseudo-random functions on the torus, for the builtin tiles. They have the same values on every
// machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "material/model/geometry_image.h"

namespace loden::importer {

// A pseudo-random value of a lattice point, uniform in [0, 1); integer arithmetic only (Wang's hash).
inline double latticeRandom(int x, int y, uint32_t seed) {
  uint32_t h =
      static_cast<uint32_t>(x) * 0x9E3779B1u ^ static_cast<uint32_t>(y) * 0x85EBCA77u ^ seed * 0xC2B2AE3Du;
  h = (h ^ 61u) ^ (h >> 16);
  h *= 9u;
  h ^= h >> 4;
  h *= 0x27D4EB2Du;
  h ^= h >> 15;
  return h / 4294967296.0;
}

// Value noise in [-1, 1], twice differentiable, with period 1 in both coordinates and cells.x by cells.y
// lattice points.
inline double periodicNoise(glm::dvec2 p, glm::ivec2 cells, uint32_t seed) {
  const glm::dvec2 q = p * glm::dvec2(cells);
  const glm::dvec2 base = glm::floor(q), f = q - base;
  const glm::dvec2 s = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
  const glm::ivec2 i(base);
  const auto at = [&](int dx, int dy) {
    return latticeRandom(wrapIndex(i.x + dx, cells.x), wrapIndex(i.y + dy, cells.y), seed);
  };
  const double low = glm::mix(at(0, 0), at(1, 0), s.x), high = glm::mix(at(0, 1), at(1, 1), s.x);
  return 2 * glm::mix(low, high, s.y) - 1;
}

// A sum of octaves of periodicNoise, each twice as fine and half as strong as the one before; in (-2, 2).
inline double periodicFractal(glm::dvec2 p, glm::ivec2 cells, int octaves, uint32_t seed) {
  double sum = 0, strength = 1;
  for (int o = 0; o < octaves; ++o, cells *= 2, strength *= 0.5)
    sum += strength * periodicNoise(p, cells, seed + o);
  return sum;
}

}  // namespace loden::importer
