// Integrals of the basis times what a material does with light.

#include <algorithm>
#include <cmath>

#include "material/eval/evaluate.h"
#include "material/model/environment.h"

namespace loden {
namespace {

constexpr int kTableRows = 64, kMeanRows = 32;  // of quadratures

using Basis = std::array<double, kEnvironmentBasis>;

// The lights at which tables are read: their own, or those of a grid that is finer than any measured set.
DirectionGrid lightGrid(const Band& band, float theta_max) {
  return band.layout == TableLayout::kGrid ? tableGrid(band, theta_max) : DirectionGrid{11, 37, theta_max};
}

glm::vec3 gridDirection(const DirectionGrid& grid, int theta, int phi) {
  const double step = double(grid.theta_max) / (grid.thetas - 1);
  return glm::vec3(directionFromSpherical({step * theta, 2 * kPi * phi / (grid.phis - 1)}));
}

// Per light of the grid (theta * phis + phi) the integral of the basis times the light's share in a linear
// interpolation, so that tables which are linear between the lights are integrated exactly.
std::vector<Basis> nodeWeights(const Material& material, const DirectionGrid& grid) {
  std::vector<Basis> weights(size_t(grid.thetas) * grid.phis, Basis{});
  for (const LightSample& light : lightQuadrature(material, kTableRows)) {
    const double theta_max = grid.theta_max;
    const glm::dvec2 at = gridPosition(clampTheta(light.direction, theta_max), theta_max) *
                          glm::dvec2(grid.phis - 1, grid.thetas - 1);
    const int phi = std::min(int(at.x), grid.phis - 2), theta = std::min(int(at.y), grid.thetas - 2);
    for (int corner = 0; corner < 4; ++corner) {
      const int right = corner & 1, up = corner >> 1;
      const double share = (right ? at.x - phi : 1 - (at.x - phi)) * (up ? at.y - theta : 1 - (at.y - theta));
      Basis& node = weights[size_t(theta + up) * grid.phis + phi + right];
      for (int k = 0; k < kEnvironmentBasis; ++k) node[k] += light.measure * share * light.basis[k];
    }
  }
  return weights;
}

// The table's value at lights of one grid and views of another. A grid's own pairs are texels.
glm::vec4 valueAt(const Material& material, const Band& band, int quad, const DirectionGrid& lights,
                  glm::ivec2 light, const DirectionGrid& views, glm::ivec2 view) {
  if (band.layout == TableLayout::kGrid)
    return fetchTexel(band.table, 0, light.x, view.y * views.thetas + light.y, quad * views.phis + view.x);
  return tableValue(material, band, quad, gridDirection(lights, light.y, light.x),
                    gridDirection(views, view.y, view.x));
}

// T_k of all quads at one view, without their scales; index quad * kEnvironmentBasis + k.
std::vector<glm::dvec4> integrals(const Material& material, const Band& band, const DirectionGrid& lights,
                                  const std::vector<Basis>& weights, const DirectionGrid& views,
                                  glm::ivec2 view) {
  std::vector<glm::dvec4> sums(size_t(kEnvironmentBasis) * band.quads(), glm::dvec4(0));
  for (int node = 0; node < int(weights.size()); ++node) {
    const glm::ivec2 light(node % lights.phis, node / lights.phis);
    for (int quad = 0; quad < band.quads(); ++quad) {
      const glm::dvec4 value(valueAt(material, band, quad, lights, light, views, view));
      for (int k = 0; k < kEnvironmentBasis; ++k)
        sums[size_t(quad) * kEnvironmentBasis + k] += weights[node][k] * value;
    }
  }
  return sums;
}

}  // namespace

std::vector<LightSample> lightQuadrature(const Material& material, int rows) {
  std::vector<LightSample> samples;
  samples.reserve(size_t(2) * size_t(rows) * size_t(rows));
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < 2 * rows; ++i) {
      const glm::dvec3 w = directionFromSpherical({std::acos((j + 0.5) / rows), kPi * (i + 0.5) / rows});
      const double faded =
          material.cosine_included ? std::min(w.z / std::cos(double(material.theta_max)), 1.0) : w.z;
      samples.push_back({w, faded / (rows * rows), {1, w.z, w.x, w.y, w.x * w.y, w.x * w.x - w.y * w.y}});
    }
  return samples;
}

DirectionGrid environmentGrid(const Band& band, float theta_max) {
  return band.layout == TableLayout::kGrid ? tableGrid(band, theta_max) : DirectionGrid{6, 25, theta_max};
}

uint64_t environmentTableBytes(const Band& band) {
  const DirectionGrid views = environmentGrid(band, 0);
  return textureBytes(TexelFormat::kRGBA16Sfloat, uint64_t(views.phis), uint64_t(views.thetas),
                      uint64_t(kEnvironmentBasis) * uint64_t(band.quads()), 1);
}

Texture environmentTable(const Material& material, const Band& band) {
  const DirectionGrid lights = lightGrid(band, material.theta_max),
                      views = environmentGrid(band, material.theta_max);
  Texture table = Texture::make(TexelFormat::kRGBA16Sfloat, TextureShape::kVolume, views.phis, views.thetas,
                                kEnvironmentBasis * band.quads());
  const std::vector<Basis> weights = nodeWeights(material, lights);
  for (int theta = 0; theta < views.thetas; ++theta)
    for (int phi = 0; phi < views.phis; ++phi) {
      const std::vector<glm::dvec4> sums = integrals(material, band, lights, weights, views, {phi, theta});
      for (size_t z = 0; z < sums.size(); ++z)
        storeTexel(table, 0, phi, theta, int(z), glm::vec4(sums[z]) * band.quad_scale[z / kEnvironmentBasis]);
    }
  return table;
}

EnvironmentMean environmentMean(const Material& material) {
  EnvironmentMean result;
  std::array<glm::dvec4, kEnvironmentThetas> rows{};
  glm::dvec2 unit(0);
  const DirectionGrid views{kEnvironmentThetas, 2, material.theta_max};
  for (const auto& [w, measure, basis] : lightQuadrature(material, kMeanRows)) {
    const glm::dvec3 light = clampTheta(w, double(material.theta_max));
    unit += measure * glm::dvec2(basis[0], basis[1]);
    for (int row = 0; row < kEnvironmentThetas; ++row) {
      const double y = evaluateMean(material.mean, light, glm::dvec3(gridDirection(views, row, 0))).x;
      rows[row] += measure * y * glm::dvec4(basis[0], basis[1], basis[2], basis[5]);
    }
  }
  for (int row = 0; row < kEnvironmentThetas; ++row) result.rows[row] = glm::vec4(rows[row]);
  result.unit = glm::vec2(unit);
  return result;
}

}  // namespace loden
