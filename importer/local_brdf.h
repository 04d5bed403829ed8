// The local reflectance of a tile, for one direction pair and for all lights at once.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "importer/tile.h"
#include "material/directions.h"

namespace loden::importer {

// pi * f_r, unitless; all directions unit.
inline glm::dvec3 reflectance(const LocalBrdf& brdf, const glm::dvec3& normal, const glm::dvec3& wi, const glm::dvec3& wo) {
  const double cosine = std::max(0.0, glm::dot(normal, glm::normalize(wi + wo)));
  return glm::dvec3(brdf.diffuse) + double(brdf.specular) * std::pow(cosine, double(brdf.exponent));
}

// x^n for x in (0, 1], n >= 0; relative error below n * 2e-7 + 2e-6. No branch and no call: loops over it vectorize.
inline float fastPower(float x, float n) {
  // log2 by exponent and the arctanh series of the mantissa in [sqrt(.5), sqrt(2)).
  const int32_t bits = std::bit_cast<int32_t>(std::max(x, 1e-20f));
  const int32_t exponent = (bits - 0x3F3504F3) >> 23;
  const float mantissa = std::bit_cast<float>(bits - (exponent << 23));
  const float s = (mantissa - 1) / (mantissa + 1), s2 = s * s;
  const float log2 = float(exponent) + s * (2.88539008f + s2 * (0.961796694f + s2 * (0.577078016f + s2 * 0.412198583f)));
  // exp2 by exponent and a polynomial over [-.5, .5].
  const float y = std::max(n * log2, -120.0f);
  const float whole = float(int32_t(y - 0.5f));
  const float f = y - whole;
  const float e = 1 + f * (0.693147181f + f * (0.240226507f + f * (0.0555041087f + f * (0.00961812911f + f * (0.00133335581f + f * 0.000154035304f)))));
  return e * std::bit_cast<float>((int32_t(whole) + 127) << 23);
}

// Directions of all lights as separate coordinates, and what depends on one view besides.
struct LightTable {
  std::vector<float> x, y, z;      // per light
  std::vector<float> half_scale;   // per light: 1 / length(wi + wo)
  explicit LightTable(const DirectionSet& lights) {
    for (const glm::dvec3& wi : lights.samples) x.push_back(float(wi.x)), y.push_back(float(wi.y)), z.push_back(float(wi.z));
    half_scale.resize(x.size());
  }
  void setView(const glm::vec3& wo) {
    for (size_t l = 0; l < x.size(); ++l)
      half_scale[l] = 1 / std::sqrt(std::max(1e-12f, 2 + 2 * (x[l] * wo.x + y[l] * wo.y + z[l] * wo.z)));
  }
  size_t size() const { return x.size(); }
};

// cosine[l] = max(N.L, 0); lobe[l] = specular * (N.H)^exponent * cosine[l], both of lights.size() values.
inline void lobesOfAllLights(const LightTable& lights, const glm::vec3& normal, const glm::vec3& wo, float specular,
                             float exponent, float* cosine, float* lobe) {
  const float view_cosine = glm::dot(normal, wo);
  const size_t count = lights.size();
  for (size_t l = 0; l < count; ++l) {
    const float c = normal.x * lights.x[l] + normal.y * lights.y[l] + normal.z * lights.z[l];
    const float h = std::min(std::max(0.0f, (c + view_cosine) * lights.half_scale[l]), 1.0f);
    cosine[l] = std::max(c, 0.0f);
    lobe[l] = specular * fastPower(h, exponent) * cosine[l];
  }
}

}  // namespace loden::importer
