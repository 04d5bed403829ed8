// The light that leaves one texel towards one view, summed over the texel's samples, for all lights at once.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "importer/tile/local_brdf.h"

namespace loden::importer {

class LightSum {
 public:
  explicit LightSum(const LightTable& lights);

  void clear();
  // Adds one sample, lit by the lights whose bit is set in `lit` (light l is bit l % 64 of word l / 64). All
  // directions are unit.
  void add(const glm::vec3& normal, const glm::vec3& wo, const LocalBrdf& brdf, const uint64_t* lit);
  // Adds further light, in white units, one value per light.
  void add(std::span<const glm::vec3> values);
  glm::vec3 operator[](size_t light) const { return {sum_[0][light], sum_[1][light], sum_[2][light]}; }

 private:
  void addGgx(const glm::vec3& normal, const glm::vec3& wo, const LocalBrdf& brdf, const uint64_t* lit);

  const LightTable& lights_;
  size_t groups_ = 0;  // groups of eight lights; all arrays are padded to whole groups
  std::vector<float> x_, y_, z_, half_scale_;
  std::vector<float> sum_[3];
  std::vector<float> cosine_, lobe_, tinted_;  // temporary values of one sample with a GGX lobe
};

}  // namespace loden::importer
