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

// The GGX lobe that stands for the whole of a surface, f0 and alpha: its own, or as wide as its Phong lobe
// and as bright at the peak; grey then.
inline glm::vec4 ggxLobeOf(const LocalBrdf& brdf) {
  if (brdf.alpha > 0) return {brdf.f0, brdf.alpha};
  return {glm::vec3(std::min(brdf.specular / lobePeak(brdf.exponent), 1.0f)),
          std::clamp(std::sqrt(2 / (brdf.exponent + 2)), kLeastAlpha, 1.0f)};
}

// Whether any of a tile's surface has a GGX lobe; then all of it is described by one.
inline bool hasGgx(const Tile& tile) {
  return !tile.materials.empty() || std::any_of(tile.brdfs.begin(), tile.brdfs.end(),
                                                [](const LocalBrdf& brdf) { return brdf.alpha > 0; });
}

}  // namespace loden::importer
