// The GGX microfacet lobe of metallic-roughness materials, and the diffuse light that it leaves. Not
// installed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

namespace loden::importer {

// Smallest alpha; narrower lobes would fall between sampled directions.
inline constexpr float kLeastAlpha = 0.03f;

// The lobe pi * D * V, unitless: GGX distribution, and height-correlated Smith masking and shadowing over 4
// (N.L) (N.V) (Walter et al. 2007, eq. 33; Heitz 2014, eq. 99). All cosines must be positive.
template <class T>
T ggxLobe(T alpha, T cos_light, T cos_view, T cos_half) {
  const T a2 = alpha * alpha;
  const T d = cos_half * cos_half * (a2 - 1) + 1;
  const T masking = cos_light * std::sqrt(cos_view * cos_view * (1 - a2) + a2) +
                    cos_view * std::sqrt(cos_light * cos_light * (1 - a2) + a2);
  return a2 / (d * d) * T(0.5) / masking;
}

// The weight of Schlick's Fresnel term (Schlick 1994), F = f0 + (1 - f0) * weight, for the cosine between
// light (or view) and half vector.
template <class T>
T schlickWeight(T cosine) {
  const T x = std::max(T(0), 1 - cosine), x2 = x * x;
  return x2 * x2 * x;
}

// The share of the diffuse term that the lobe leaves: (1 - E(light)) (1 - E(view)) / (1 - mean E), where E is
// the share of light that the lobe reflects (Kelemen and Szirmay-Kalos 2001). It is reciprocal, and lobe and
// diffuse term together never reflect more than all light; glTF's own (1 - F) does at grazing angles.
class DiffuseCoupling {
 public:
  // f0: the largest of the three channels.
  DiffuseCoupling(float alpha, float f0);
  // One of the two factors, for the light's or the view's cosine; their product is the coupling.
  float factor(float cosine) const {
    const float at = std::clamp(cosine, 0.0f, 1.0f) * float(kNodes - 1);
    const int k = std::min(static_cast<int>(at), kNodes - 2);
    return factor_[size_t(k)] + (at - float(k)) * (factor_[size_t(k) + 1] - factor_[size_t(k)]);
  }
  static constexpr int kNodes = 33;

 private:
  std::array<float, kNodes> factor_;  // over the cosine
};

}  // namespace loden::importer
