// Environment light: a panorama is reduced to a quadratic polynomial of the direction and a few directional
// lights, and materials get tables by which they are lit by the polynomial at the cost of one or two lights.
//
// Let L(w) = sum_k c_k h_k(w) be the radiance over the hemisphere of the tangent frame. The light that a band
// with weights D and table E scatters towards wo is
//   integral L(w) dot(D, E(w, wo)) dw = sum_k c_k dot(D, T_k(wo)),  T_k(wo) = integral h_k(w) E(w, wo) dw,
// so that the T_k take the table's place. shaders/loden_environment.glsl computes on the GPU what
// Evaluator::evaluateEnvironment does.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "material/model/material.h"

namespace loden {

// A radiance polynomial L(w) = constant + dot(linear, w) + dot(w, quadratic w) per colour channel, which
// spans spherical harmonics up to order 2 (Ramamoorthi and Hanrahan 2001). Linear RGB; a radiance of 1 all
// around gives white Lambert the value 1.
struct EnvironmentLight {
  glm::vec3 constant{0};
  std::array<glm::vec3, 3> linear{};                                             // per channel
  std::array<glm::mat3, 3> quadratic{glm::mat3(0), glm::mat3(0), glm::mat3(0)};  // per channel, symmetric
};
// The radiance from direction w; negative where the polynomial undershoots.
glm::vec3 radianceFrom(const EnvironmentLight& light, const glm::vec3& w);
// The light expressed in another frame; new_from_old maps directions of the old frame into the new one.
EnvironmentLight rotated(const EnvironmentLight& light, const glm::mat3& new_from_old);
// The light with irradiance `sky` on a surface that faces `up`, `ground` on one that faces down, and a blend
// by the cosine in between.
EnvironmentLight skyLight(const glm::vec3& sky, const glm::vec3& ground, const glm::vec3& up);

// A small bright part of the panorama, represented as a directional light.
struct EnvironmentSun {
  glm::vec3 direction{0, 0, 1};  // unit, towards it
  // Linear RGB irradiance on a surface that faces it, divided by pi: 1 gives white Lambert the value 1.
  glm::vec3 irradiance{0};
};

// A lat-long panorama: linear RGB, row 0 at the top, z up. The middle column is +x, a quarter to its left is
// +y: azimuth phi = pi (1 - 2 (column + .5) / width), theta = pi (row + .5) / height.
struct Panorama {
  int width = 0, height = 0;
  std::vector<glm::vec3> pixels;  // row-major; size width * height
};
// The direction of a position in the panorama, in columns and rows.
glm::dvec3 panoramaDirection(const Panorama& panorama, double column, double row);
// The radiance of the pixel in direction w.
glm::vec3 panoramaPixel(const Panorama& panorama, const glm::dvec3& w);

struct Environment {
  EnvironmentLight light;
  std::vector<EnvironmentSun> suns;  // brightest first
};
// The panorama as an Environment. At most `suns` lights are extracted first. Each is the light within 15
// degrees that exceeds twice the median, and is taken only if it is 3 % of all light or more. The rest is
// fitted by the polynomial. Non-finite and negative pixels count as black.
Environment projectPanorama(const Panorama& panorama, int suns);

// The light over one tangent frame's hemisphere, as coefficients c_k (linear RGB) in the basis h = {1, z, x,
// y, xy, x^2 - y^2}. z^2, xz and yz are replaced by 1.2 z - .3, 8/15 x and 8/15 y, their least-squares fits
// over the hemisphere under the weight z, which leave the irradiance exact.
inline constexpr int kEnvironmentBasis = 6;
struct HemisphereLight {
  std::array<glm::vec3, kEnvironmentBasis> c{};
};
// The light in a tangent frame, whose columns are tangent, bitangent and normal.
HemisphereLight hemisphereLight(const EnvironmentLight& light, const glm::mat3& frame);

// One light of a quadrature over the hemisphere.
struct LightSample {
  glm::dvec3 direction;
  // dw / pi times the factor by which values at this direction are multiplied: the fade of
  // Evaluator::evaluate, or the cosine for assets that leave it out.
  double measure;
  std::array<double, kEnvironmentBasis> basis;
};
// A quadrature over the hemisphere: the midpoints of `rows` x 2 `rows` cells of equal extent in cos(theta)
// and phi.
std::vector<LightSample> lightQuadrature(const Material& material, int rows);

// The views at which the T_k of a band are stored: those of the band's table grid, or 6 x 25 if it has no
// grid.
DirectionGrid environmentGrid(const Band& band, float theta_max);

// The T_k of one band as an RGBA16F volume of phis x thetas x (kEnvironmentBasis * quads); slice quad *
// kEnvironmentBasis + k holds T_k. Integrals are divided by pi, and include the band's scales, and the cosine
// for assets that leave it out. Takes about 1.5 ms for a cooked band, 90 ms for a TableLayout::kNearest
// table.
Texture environmentTable(const Material& material, const Band& band);
uint64_t environmentTableBytes(const Band& band);

// Rows of theta in EnvironmentMean, from the pole to the material's theta_max.
inline constexpr int kEnvironmentThetas = 6;

// The T_k of the mean mu, for views in the plane y = 0. `rows`: per theta those of Y, as the coefficients of
// 1, z, x and x^2 - y^2; the others are 0. `unit`: those of the constant 1, for chroma that does not follow
// Y, as the coefficients of 1 and z.
struct EnvironmentMean {
  std::array<glm::vec4, kEnvironmentThetas> rows{};
  glm::vec2 unit{0};
};
EnvironmentMean environmentMean(const Material& material);

}  // namespace loden
