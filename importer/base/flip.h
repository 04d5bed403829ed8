// FLIP, a perceptual difference between low dynamic range pictures (Andersson et al. 2020, "FLIP: A
// Difference Evaluator for Alternating Images").
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace loden::importer {

// Pixels per degree of visual angle: a 0.7 m wide, 3840 pixels wide monitor at 0.7 m, as in the paper.
inline constexpr double kFlipPixelsPerDegree = 67.0206;

struct FlipError {
  double mean = 0, max = 0;   // 0: equal .. 1: as different as possible
  std::vector<float> pixels;  // width * height
};

// The difference of two pictures of width * height linear RGB pixels, x fastest; values are clamped to [0,
// 1].
FlipError flip(std::span<const glm::vec3> reference, std::span<const glm::vec3> test, int width, int height,
               double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace loden::importer
