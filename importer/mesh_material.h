// Materials of mesh files as local reflectance; not installed.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>

#include "importer/tile.h"

namespace loden::importer {

inline float luminance(const glm::vec3& rgb) { return glm::dot(rgb, glm::vec3(0.299f, 0.587f, 0.114f)); }

// Normalisation of a Blinn-Phong lobe: pi * f_r at its peak for a mirror reflectance of 1 (Akenine-Moeller et
// al., Real-Time Rendering, 3rd ed., 7.6).
inline float lobePeak(float exponent) { return (exponent + 8) / 8; }

// glTF metallic-roughness as diffuse + Phong: alpha = roughness^2, exponent = 2 / alpha^2 - 2, so that the lobe
// has the width of the microfacet distribution; grey specular.
inline LocalBrdf brdfFromMetallicRoughness(const glm::vec3& base, float metallic, float roughness) {
  const float alpha = std::max(roughness * roughness, 0.03f);
  LocalBrdf brdf;
  brdf.diffuse = base * (1 - metallic);
  brdf.exponent = std::max(1.0f, 2 / (alpha * alpha) - 2);
  brdf.specular = luminance(glm::mix(glm::vec3(0.04f), base, metallic)) * lobePeak(brdf.exponent);
  return brdf;
}

}  // namespace loden::importer
