#include "importer/tile/ggx.h"

#include <vector>

#include "material/model/directions.h"

namespace loden::importer {
namespace {

constexpr int kNodes = DiffuseCoupling::kNodes;
constexpr int kRoughnesses = 32;
constexpr double kLeastRoughness = 0.17;  // sqrt of the least alpha

// Shares of light reflected at each cosine: by the lobe without Fresnel, and weighted with Schlick's weight.
struct Albedo {
  double whole = 0, weighted = 0;
};

// By sampling the normals that the view sees (Heitz 2018): every sample's weight is G2 / G1, so few are
// enough.
Albedo albedo(double alpha, double cosine) {
  constexpr int kGrid = 24;
  const glm::dvec3 view(std::sqrt(1 - cosine * cosine), 0, cosine);
  const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha * view.x, 0, view.z));
  const glm::dvec3 t1 =
      stretched.z < 0.9999 ? glm::normalize(glm::cross(glm::dvec3(0, 0, 1), stretched)) : glm::dvec3(1, 0, 0);
  const glm::dvec3 t2 = glm::cross(stretched, t1);
  const auto lambda = [&](double c) { return (std::sqrt(1 + alpha * alpha * (1 / (c * c) - 1)) - 1) / 2; };
  Albedo sum;
  for (int k = 0; k < kGrid * kGrid; ++k) {
    const double r = std::sqrt((k % kGrid + 0.5) / kGrid), phi = 2 * kPi * (k / kGrid + 0.5) / kGrid;
    const double p1 = r * std::cos(phi), s = (1 + stretched.z) / 2;
    const double p2 = (1 - s) * std::sqrt(1 - p1 * p1) + s * r * std::sin(phi);
    const glm::dvec3 n = p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0, 1 - p1 * p1 - p2 * p2)) * stretched;
    const glm::dvec3 half = glm::normalize(glm::dvec3(alpha * n.x, alpha * n.y, std::max(1e-9, n.z)));
    const double towards = glm::dot(view, half), light = 2 * towards * half.z - view.z;
    if (light <= 0) continue;
    const double weight = (1 + lambda(view.z)) / (1 + lambda(view.z) + lambda(light)) / (kGrid * kGrid);
    sum.whole += weight, sum.weighted += weight * schlickWeight(towards);
  }
  return sum;
}

double roughnessAt(int row) {
  return kLeastRoughness + (1 - kLeastRoughness) * row / (kRoughnesses - 1);
}

// [roughness][cosine].
const std::vector<Albedo>& albedoTable() {
  static const std::vector<Albedo> table = [] {
    std::vector<Albedo> all;
    for (int row = 0; row < kRoughnesses; ++row)
      for (int k = 0; k < kNodes; ++k)
        all.push_back(albedo(roughnessAt(row) * roughnessAt(row), std::max(1e-3, double(k) / (kNodes - 1))));
    return all;
  }();
  return table;
}

}  // namespace

DiffuseCoupling::DiffuseCoupling(float alpha, float f0) {
  const double at =
      std::clamp((std::sqrt(double(alpha)) - kLeastRoughness) / (1 - kLeastRoughness), 0.0, 1.0) *
      (kRoughnesses - 1);
  const int row = std::min(static_cast<int>(at), kRoughnesses - 2);
  const Albedo* low = &albedoTable()[size_t(row) * kNodes];
  const auto left = [&](int k) {
    const double whole = glm::mix(low[k].whole, low[k + kNodes].whole, at - row),
                 weighted = glm::mix(low[k].weighted, low[k + kNodes].weighted, at - row);
    return std::max(0.0, 1 - (double(f0) * (whole - weighted) + weighted));
  };
  // 1 - mean E: twice the integral of (1 - E) times the cosine, exact for a piecewise linear E.
  double mean = 0;
  for (int k = 0; k + 1 < kNodes; ++k) {
    const double x0 = double(k) / (kNodes - 1), x1 = double(k + 1) / (kNodes - 1), y0 = left(k),
                 y1 = left(k + 1);
    mean += 2 * (x1 - x0) / 6 * (x0 * y0 + (x0 + x1) * (y0 + y1) + x1 * y1);
  }
  for (int k = 0; k < kNodes; ++k) factor_[size_t(k)] = float(left(k) / std::sqrt(std::max(mean, 1e-6)));
}

}  // namespace loden::importer
