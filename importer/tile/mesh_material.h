// Materials of mesh files as local reflectance; not installed.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>

#include "importer/tile/ggx.h"
#include "importer/tile/tile.h"

namespace loden::importer {

inline float luminance(const glm::vec3& rgb) {
  return glm::dot(rgb, glm::vec3(0.299f, 0.587f, 0.114f));
}

// Normalisation of a Blinn-Phong lobe: pi * f_r at its peak for a mirror reflectance of 1 (Akenine-Moeller et
// al., Real-Time Rendering, 3rd ed., 7.6).
inline float lobePeak(float exponent) {
  return (exponent + 8) / 8;
}

// glTF 2.0, appendix B.
inline LocalBrdf brdfFromMetallicRoughness(const glm::vec3& base, float metallic, float roughness) {
  LocalBrdf brdf;
  brdf.diffuse = base * (1 - metallic);
  brdf.f0 = glm::mix(glm::vec3(0.04f), base, metallic);
  brdf.alpha = std::clamp(roughness * roughness, kLeastAlpha, 1.0f);
  brdf.exponent = 1;
  return brdf;
}

// (strength, exponent) of the Phong lobe that stands for the whole of it where only one is stored: for GGX
// the exponent is 2 / alpha^2 - 2, so that the lobe has the distribution's width; grey.
inline glm::vec2 phongLobe(const LocalBrdf& brdf) {
  if (brdf.alpha <= 0) return {brdf.specular, brdf.exponent};
  const float exponent = std::max(1.0f, 2 / (brdf.alpha * brdf.alpha) - 2);
  return {brdf.specular + luminance(brdf.f0) * lobePeak(exponent), exponent};
}

}  // namespace loden::importer
