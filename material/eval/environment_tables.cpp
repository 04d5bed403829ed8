// Integrals of the basis times what a material does with light.

#include <algorithm>
#include <cmath>

#include "material/eval/evaluate.h"
#include "material/model/environment.h"

namespace loden {
namespace {

constexpr int kTableRows = 64, kMeanRows = 32;  // of quadratures
constexpr int kFactorRows = 12,
              kFactorTexels =
                  16;  // of a light factor: quadrature, and texels along a side that it is fitted to

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

// A band with a light factor adds V (mu + B) - mu, a product of two sums of weights. What light from all
// around makes of it is given as a sum over the weights of its quads and of its ambient layer: the best one,
// by least squares over texels of the band itself.
class FactorIntegrals {
 public:
  FactorIntegrals(const Material& material, const Band& band)
      : m_(material), band_(band), lights_(lightQuadrature(material, kFactorRows)) {
    for (LightSample& light : lights_)
      light.direction = clampTheta(light.direction, double(material.theta_max));
    const int side = std::min(kFactorTexels, band.weights.width);
    for (int t = 0; t < side * side; ++t) addTexel((glm::vec2(t % side, t / side) + 0.5f) / float(side));
    for (std::vector<double>* gram : {&y_gram_, &cb_gram_, &cr_gram_}) factorise(*gram);
  }

  // T_k at one view; index quad * kEnvironmentBasis + k, the ambient layer last.
  std::vector<glm::dvec4> at(const glm::vec3& view) const {
    std::vector<glm::dvec4> result(size_t(kEnvironmentBasis) * size_t(band_.quads() + 1), glm::dvec4(0));
    const int y = 4 * band_.y_quads, all = y + 4, chroma = 2 * band_.chroma_quads;
    const std::vector<double> table = tableAt(view);
    std::array<std::vector<double>, kEnvironmentBasis> luma, cb, cr;
    for (int k = 0; k < kEnvironmentBasis; ++k)
      luma[k].assign(size_t(all), 0), cb[k].assign(size_t(chroma), 0), cr[k] = cb[k];
    for (const Texel& texel : texels_) {
      std::array<glm::dvec3, kEnvironmentBasis> target{};
      for (size_t l = 0; l < lights_.size(); ++l) {
        const glm::dvec3 value =
            valueAt(texel, &table[l * size_t(4 * band_.quads() + 1)], texel.factor[l]) * lights_[l].measure;
        for (int k = 0; k < kEnvironmentBasis; ++k) target[k] += lights_[l].basis[k] * value;
      }
      for (int k = 0; k < kEnvironmentBasis; ++k) {
        for (int c = 0; c < all; ++c) luma[k][c] += texel.luma[c] * target[k].x;
        for (int c = 0; c < chroma; ++c)
          cb[k][c] += texel.cb[c] * target[k].y, cr[k][c] += texel.cr[c] * target[k].z;
      }
    }
    for (int k = 0; k < kEnvironmentBasis; ++k) {
      solve(y_gram_, luma[k]), solve(cb_gram_, cb[k]), solve(cr_gram_, cr[k]);
      const auto quad = [&](int q) -> glm::dvec4& { return result[size_t(q) * kEnvironmentBasis + k]; };
      for (int c = 0; c < all; ++c) quad(c < y ? c / 4 : band_.quads())[c % 4] = luma[k][c];
      for (int c = 0; c < chroma; ++c)
        quad(band_.y_quads + c / 2)[c % 2] = cb[k][c], quad(band_.y_quads + c / 2)[2 + c % 2] = cr[k][c];
    }
    return result;
  }

 private:
  struct Texel {
    std::vector<double> luma, cb, cr;  // weights as stored: of Y, then of the ambient layer; of Cb; of Cr
    std::vector<double> factor;        // V per light
  };

  void addTexel(const glm::vec2& q) {
    Texel texel;
    const auto layer = [&](int l) { return glm::dvec4(sampleRepeatLod(band_.weights, 0.0f, l, q)); };
    for (int k = 0; k <= band_.y_quads; ++k)
      for (int c = 0; c < 4; ++c)
        texel.luma.push_back(layer(k < band_.y_quads ? k : band_.ambientLayer())[c]);
    for (int k = band_.y_quads; k < band_.quads(); ++k)
      for (int c = 0; c < 2; ++c) texel.cb.push_back(layer(k)[c]), texel.cr.push_back(layer(k)[2 + c]);
    for (const LightSample& light : lights_)
      texel.factor.push_back(double(lightFactorAt(m_, band_, q, glm::vec3(light.direction))));
    addOuter(y_gram_, texel.luma), addOuter(cb_gram_, texel.cb), addOuter(cr_gram_, texel.cr);
    texels_.push_back(std::move(texel));
  }

  // Per light the scaled table of all quads, and the mean's Y.
  std::vector<double> tableAt(const glm::vec3& view) const {
    std::vector<double> table;
    for (const LightSample& light : lights_) {
      for (int quad = 0; quad < band_.quads(); ++quad) {
        const glm::vec4 value =
            tableValue(m_, band_, quad, glm::vec3(light.direction), view) * band_.quad_scale[size_t(quad)];
        for (int c = 0; c < 4; ++c) table.push_back(double(value[c]));
      }
      table.push_back(evaluateMean(m_.mean, light.direction, glm::dvec3(view)).x);
    }
    return table;
  }

  // Y of V (mu + B) - mu, and what the chroma quads add; `table` of one light.
  glm::dvec3 valueAt(const Texel& texel, const double* table, double factor) const {
    glm::dvec3 sum(0);
    const int y = 4 * band_.y_quads;
    for (int c = 0; c < y; ++c) sum.x += texel.luma[size_t(c)] * table[c];
    for (int c = 0; c < 2 * band_.chroma_quads; ++c) {
      const double* quad = table + y + c / 2 * 4 + c % 2;
      sum.y += texel.cb[size_t(c)] * quad[0], sum.z += texel.cr[size_t(c)] * quad[2];
    }
    const double mean = table[4 * band_.quads()];
    return factor * glm::dvec3(std::max(sum.x + mean, 0.0), sum.y, sum.z) -
           glm::dvec3(mean, 0, 0);  // no light below zero
  }

  static void addOuter(std::vector<double>& gram, const std::vector<double>& v) {
    const size_t n = v.size();
    gram.resize(n * n);
    for (size_t i = 0; i < n; ++i)
      for (size_t j = 0; j < n; ++j) gram[i * n + j] += v[i] * v[j];
  }

  // Cholesky in place, of the slightly ridged matrix: components of no weight at all get none here either.
  static void factorise(std::vector<double>& a) {
    const auto n = static_cast<size_t>(std::lround(std::sqrt(double(a.size()))));
    double trace = 0;
    for (size_t i = 0; i < n; ++i) trace += a[i * n + i];
    for (size_t i = 0; i < n; ++i) a[i * n + i] += 1e-4 * trace / double(n) + 1e-30;
    for (size_t j = 0; j < n; ++j)
      for (size_t i = j; i < n; ++i) {
        double sum = a[i * n + j];
        for (size_t k = 0; k < j; ++k) sum -= a[i * n + k] * a[j * n + k];
        a[i * n + j] = i == j ? std::sqrt(sum) : sum / a[j * n + j];
      }
  }
  static void solve(const std::vector<double>& l, std::vector<double>& x) {
    const size_t n = x.size();
    for (size_t i = 0; i < n; ++i) {
      for (size_t k = 0; k < i; ++k) x[i] -= l[i * n + k] * x[k];
      x[i] /= l[i * n + i];
    }
    for (size_t i = n; i-- > 0;) {
      for (size_t k = i + 1; k < n; ++k) x[i] -= l[k * n + i] * x[k];
      x[i] /= l[i * n + i];
    }
  }

  const Material& m_;
  const Band& band_;
  std::vector<LightSample> lights_;
  std::vector<Texel> texels_;
  std::vector<double> y_gram_, cb_gram_, cr_gram_;
};

int environmentQuads(const Band& band) {
  return band.quads() + (band.light_quads > 0 ? 1 : 0);
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
                      uint64_t(kEnvironmentBasis) * uint64_t(environmentQuads(band)), 1);
}

Texture environmentTable(const Material& material, const Band& band) {
  const DirectionGrid lights = lightGrid(band, material.theta_max),
                      views = environmentGrid(band, material.theta_max);
  Texture table = Texture::make(TexelFormat::kRGBA16Sfloat, TextureShape::kVolume, views.phis, views.thetas,
                                kEnvironmentBasis * environmentQuads(band));
  if (band.light_quads > 0) {
    const FactorIntegrals factor(material, band);
    for (int theta = 0; theta < views.thetas; ++theta)
      for (int phi = 0; phi < views.phis; ++phi) {
        const std::vector<glm::dvec4> sums = factor.at(gridDirection(views, theta, phi));
        for (size_t z = 0; z < sums.size(); ++z) storeTexel(table, 0, phi, theta, int(z), glm::vec4(sums[z]));
      }
    return table;
  }
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
