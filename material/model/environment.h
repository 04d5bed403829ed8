// Light from all around: a panorama reduced to a quadratic polynomial of the direction and a few directional
// lights, and the tables through which a material answers to the polynomial at the cost of a light or two.
//
// With L(w) = sum_k c_k h_k(w) over the hemisphere of the tangent frame, the light that a band scatters
// towards wo is
//   integral L(w) dot(D, E(w, wo)) dw = sum_k c_k dot(D, T_k(wo)),  T_k(wo) = integral h_k(w) E(w, wo) dw,
// so that T_k takes the table's place. shaders/loden_environment.glsl mirrors this file and
// evaluateEnvironment.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "material/model/material.h"

namespace loden {

// L(w) = constant + dot(linear, w) + dot(w, quadratic w) per colour channel: what spherical harmonics up to
// order 2 span (Ramamoorthi and Hanrahan 2001). Linear RGB; 1 all around makes white Lambert 1.
struct EnvironmentLight {
  glm::vec3 constant{0};
  std::array<glm::vec3, 3> linear{};                                             // per channel
  std::array<glm::mat3, 3> quadratic{glm::mat3(0), glm::mat3(0), glm::mat3(0)};  // per channel, symmetric
};
// Radiance from direction w; may be negative where the polynomial undershoots.
glm::vec3 radianceFrom(const EnvironmentLight& light, const glm::vec3& w);
// The same light seen from another frame: new_from_old maps directions of the old frame into the new one.
EnvironmentLight rotated(const EnvironmentLight& light, const glm::mat3& new_from_old);
// Irradiance `sky` on a surface that faces `up`, `ground` on one that faces down, and between them by the
// cosine.
EnvironmentLight skyLight(const glm::vec3& sky, const glm::vec3& ground, const glm::vec3& up);

// A part of the panorama that is bright and small.
struct EnvironmentSun {
  glm::vec3 direction{0, 0, 1};  // unit, towards it
  glm::vec3 irradiance{0};       // linear RGB on a surface that faces it, over pi: 1 makes white Lambert 1
};

// A lat-long panorama: linear RGB, row 0 at the top, z up. The middle column is +x, a quarter to its left is
// +y: azimuth phi = pi (1 - 2 (column + .5) / width), theta = pi (row + .5) / height.
struct Panorama {
  int width = 0, height = 0;
  std::vector<glm::vec3> pixels;  // row-major; size width * height
};
glm::dvec3 panoramaDirection(const Panorama& panorama, double column, double row);
// Radiance of the pixel that w falls into.
glm::vec3 panoramaPixel(const Panorama& panorama, const glm::dvec3& w);

struct Environment {
  EnvironmentLight light;
  std::vector<EnvironmentSun> suns;  // brightest first
};
// Takes out at most `suns` lights, each what shines within 15 degrees above twice the median, if that is 3 %
// of all light or more; the rest becomes the polynomial. Non-finite and negative pixels count as black.
Environment projectPanorama(const Panorama& panorama, int suns);

// The light over one tangent frame's hemisphere in the basis h = {1, z, x, y, xy, x^2 - y^2}: z^2, xz and yz
// are replaced by 1.2 z - .3, 8/15 x and 8/15 y, their least-squares fits there under the weight z, which
// leave the irradiance exact. c_k is linear RGB.
inline constexpr int kEnvironmentBasis = 6;
struct HemisphereLight {
  std::array<glm::vec3, kEnvironmentBasis> c{};
};
// Columns of the frame: tangent, bitangent, normal.
HemisphereLight hemisphereLight(const EnvironmentLight& light, const glm::mat3& frame);

// Lights over the hemisphere, midpoints of `rows` x 2 `rows`, equal in cos(theta) and phi.
struct LightSample {
  glm::dvec3 direction;
  double measure;  // dw / pi, times what values there are multiplied by: Evaluator::evaluate's fade, or the
                   // cosine that assets leave out
  std::array<double, kEnvironmentBasis> basis;
};
std::vector<LightSample> lightQuadrature(const Material& material, int rows);

// Views at which T_k of a band is stored: those of its table's grid, or 6 x 25 where that has none.
DirectionGrid environmentGrid(const Band& band, float theta_max);

// T_k of one band: RGBA16F volume of phis x thetas x (kEnvironmentBasis * quads), slice quad *
// kEnvironmentBasis + k. Integrals are over pi, and contain the band's scales and the cosine of assets that
// leave it out. Takes some 1.5 ms for a cooked band, 90 ms for a nearest table.
Texture environmentTable(const Material& material, const Band& band);
uint64_t environmentTableBytes(const Band& band);

// Rows of theta from the pole to the material's theta_max.
inline constexpr int kEnvironmentThetas = 6;

// T_k of the mean's Y for a view in the plane y = 0, per row of theta: coefficients of 1, z, x and x^2 - y^2,
// the others are 0. `unit` is the same of the constant 1, for chroma that does not follow Y: of 1 and z.
struct EnvironmentMean {
  std::array<glm::vec4, kEnvironmentThetas> rows{};
  glm::vec2 unit{0};
};
EnvironmentMean environmentMean(const Material& material);

}  // namespace loden
