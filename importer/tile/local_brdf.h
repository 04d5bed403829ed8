// Evaluates the local reflectance of a tile, for one pair of directions and for all lights at once.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "importer/tile/ggx.h"
#include "importer/tile/tile.h"
#include "material/model/directions.h"

namespace loden::importer {

// The reflectance pi * f_r, unitless; all directions are unit.
inline glm::dvec3 reflectance(const LocalBrdf& brdf, const glm::dvec3& normal, const glm::dvec3& wi,
                              const glm::dvec3& wo) {
  const glm::dvec3 half = glm::normalize(wi + wo);
  const double cosine = std::max(0.0, glm::dot(normal, half));
  const double phong = double(brdf.specular) * std::pow(cosine, double(brdf.exponent));
  if (brdf.alpha <= 0) return glm::dvec3(brdf.diffuse) + phong;
  const double light = glm::dot(normal, wi), view = glm::dot(normal, wo);
  const DiffuseCoupling coupling(brdf.alpha, std::max({brdf.f0.x, brdf.f0.y, brdf.f0.z}));
  glm::dvec3 sum =
      glm::dvec3(brdf.diffuse) * double(coupling.factor(float(light)) * coupling.factor(float(view))) + phong;
  if (light > 0 && view > 0)
    sum += glm::mix(glm::dvec3(brdf.f0), glm::dvec3(1), schlickWeight(glm::dot(wi, half))) *
           ggxLobe(double(brdf.alpha), light, view, cosine);
  return sum;
}

// x^n for x in (0, 1] and n >= 0, with a relative error below n * 2e-7 + 2e-6. It has no branch and no call,
// so that loops over it are vectorized.
inline float fastPower(float x, float n) {
  // log2 by exponent and the arctanh series of the mantissa in [sqrt(.5), sqrt(2)).
  const int32_t bits = std::bit_cast<int32_t>(std::max(x, 1e-20f));
  const int32_t exponent = (bits - 0x3F3504F3) >> 23;
  const float mantissa = std::bit_cast<float>(bits - (exponent << 23));
  const float s = (mantissa - 1) / (mantissa + 1), s2 = s * s;
  const float log2 =
      float(exponent) + s * (2.88539008f + s2 * (0.961796694f + s2 * (0.577078016f + s2 * 0.412198583f)));
  // exp2 by exponent and a polynomial over [-.5, .5].
  const float y = std::max(n * log2, -120.0f);
  const float whole = float(int32_t(y - 0.5f));
  const float f = y - whole;
  const float e =
      1 + f * (0.693147181f +
               f * (0.240226507f +
                    f * (0.0555041087f + f * (0.00961812911f + f * (0.00133335581f + f * 0.000154035304f)))));
  return e * std::bit_cast<float>((int32_t(whole) + 127) << 23);
}

// The directions of all lights as separate coordinates, and the values that depend on one view as well.
struct LightTable {
  std::vector<float> x, y, z;     // per light
  std::vector<float> half_scale;  // per light: 1 / length(wi + wo)
  explicit LightTable(const DirectionSet& lights) {
    for (const glm::dvec3& wi : lights.samples)
      x.push_back(float(wi.x)), y.push_back(float(wi.y)), z.push_back(float(wi.z));
    half_scale.resize(x.size());
  }
  void setView(const glm::vec3& wo) {
    for (size_t l = 0; l < x.size(); ++l)
      half_scale[l] = 1 / std::sqrt(std::max(1e-12f, 2 + 2 * (x[l] * wo.x + y[l] * wo.y + z[l] * wo.z)));
  }
  size_t size() const { return x.size(); }
};

// The GGX part of lobesOfAllLights.
inline void addGgxOfAllLights(const LightTable& lights, const glm::vec3& normal, const glm::vec3& wo,
                              const LocalBrdf& brdf, float* cosine, float* lobe, float* tinted) {
  const float view_cosine = glm::dot(normal, wo);
  const DiffuseCoupling coupling(brdf.alpha, std::max({brdf.f0.x, brdf.f0.y, brdf.f0.z}));
  const float view_factor = coupling.factor(view_cosine);
  for (size_t l = 0; l < lights.size(); ++l) {
    const float c = cosine[l];
    cosine[l] = c * view_factor * coupling.factor(c);
    tinted[l] = 0;
    if (c <= 0 || view_cosine <= 0) continue;
    const float half = std::min((c + view_cosine) * lights.half_scale[l], 1.0f);
    // H.L = |L + V| / 2, for unit L and V.
    const float weight = schlickWeight(0.5f / lights.half_scale[l]),
                whole = ggxLobe(brdf.alpha, c, view_cosine, half) * c;
    lobe[l] += whole * weight;
    tinted[l] = whole * (1 - weight);
  }
}

// Evaluates the reflectance under all lights. The value under light l is diffuse * cosine[l] + lobe[l] + f0 *
// tinted[l]: `cosine` is max(N.L, 0), less what a GGX lobe takes; `lobe` is specular * (N.H)^exponent and the
// white part of the GGX lobe. Each array has lights.size() values; `tinted` is written for brdf.alpha > 0
// only.
inline void lobesOfAllLights(const LightTable& lights, const glm::vec3& normal, const glm::vec3& wo,
                             const LocalBrdf& brdf, float* cosine, float* lobe, float* tinted) {
  const float view_cosine = glm::dot(normal, wo);
  const size_t count = lights.size();
  for (size_t l = 0; l < count; ++l) {
    const float c = normal.x * lights.x[l] + normal.y * lights.y[l] + normal.z * lights.z[l];
    const float h = std::min(std::max(0.0f, (c + view_cosine) * lights.half_scale[l]), 1.0f);
    cosine[l] = std::max(c, 0.0f);
    lobe[l] = brdf.specular * fastPower(h, brdf.exponent) * cosine[l];
  }
  if (brdf.alpha > 0) addGgxOfAllLights(lights, normal, wo, brdf, cosine, lobe, tinted);
}

}  // namespace loden::importer
