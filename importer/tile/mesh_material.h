// Converts the materials of mesh files to local reflectance. Not installed.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>

#include "importer/tile/ggx.h"
#include "importer/tile/tile.h"

namespace loden::importer {

inline float luminance(const glm::vec3& rgb) {
  return glm::dot(rgb, glm::vec3(0.299f, 0.587f, 0.114f));
}

// The normalisation of a Blinn-Phong lobe: pi * f_r at its peak for a mirror reflectance of 1
// (Akenine-Moeller et al., Real-Time Rendering, 3rd ed., 7.6).
inline float lobePeak(float exponent) {
  return (exponent + 8) / 8;
}

// The local reflectance of glTF's metallic-roughness material (glTF 2.0, appendix B).
inline LocalBrdf brdfFromMetallicRoughness(const glm::vec3& base, float metallic, float roughness) {
  LocalBrdf brdf;
  brdf.diffuse = base * (1 - metallic);
  brdf.f0 = glm::mix(glm::vec3(0.04f), base, metallic);
  brdf.alpha = std::clamp(roughness * roughness, kLeastAlpha, 1.0f);
  brdf.exponent = 1;
  return brdf;
}

// (strength, exponent) of a Phong lobe that stands for the whole specular part where only one lobe is stored.
// For GGX the exponent is 2 / alpha^2 - 2, so that the lobe has the distribution's width; the lobe is grey.
inline glm::vec2 phongLobe(const LocalBrdf& brdf) {
  if (brdf.alpha <= 0) return {brdf.specular, brdf.exponent};
  const float exponent = std::max(1.0f, 2 / (brdf.alpha * brdf.alpha) - 2);
  return {brdf.specular + luminance(brdf.f0) * lobePeak(exponent), exponent};
}

// The GGX lobe, as f0 and alpha, that stands for the whole specular part: the surface's own, or, for a Phong
// lobe, a grey one as wide and as bright at the peak.
inline glm::vec4 ggxLobeOf(const LocalBrdf& brdf) {
  if (brdf.alpha > 0) return {brdf.f0, brdf.alpha};
  return {glm::vec3(std::min(brdf.specular / lobePeak(brdf.exponent), 1.0f)),
          std::clamp(std::sqrt(2 / (brdf.exponent + 2)), kLeastAlpha, 1.0f)};
}

// Whether any part of the tile's surface has a GGX lobe; if so, the whole surface is described by one.
inline bool hasGgx(const Tile& tile) {
  return !tile.materials.empty() || std::any_of(tile.brdfs.begin(), tile.brdfs.end(),
                                                [](const LocalBrdf& brdf) { return brdf.alpha > 0; });
}

}  // namespace loden::importer
