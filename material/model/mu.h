// The fitted mean mu of the equation (Ma et al. 2005, eqs. 5 and 6).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace loden {

enum class MeanChroma : uint32_t {
  kConstant = 0,  // Cb and Cr are constants (LBTF eq. 6)
  kRatio = 1,     // Cb and Cr are proportional to Y, as holds in linear light
};

// Y = ka + kd (N.L) + ks (N.H)^alpha with N = (0, 0, 1); white Lambert lit from above is 1.
struct PhongMean {
  float ka = 0, kd = 0, ks = 0, alpha = 1;  // unitless
  float cb = 0, cr = 0;                     // constants or ratios to Y, as `chroma` says
  MeanChroma chroma = MeanChroma::kConstant;
};

// (Y, Cb, Cr) of the mean. Both directions must be above the horizon.
template <class T>
glm::vec<3, T> evaluateMean(const PhongMean& mean, const glm::vec<3, T>& wi, const glm::vec<3, T>& wo);

}  // namespace loden
