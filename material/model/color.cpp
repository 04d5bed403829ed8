#include "material/model/color.h"

#include <cmath>

namespace loden {
namespace {

// Linear sRGB to CIE XYZ at D65 (IEC 61966-2-1); its rows sum to the white point.
constexpr double kXyzFromRgb[3][3] = {
    {0.4124564, 0.3575761, 0.1804375}, {0.2126729, 0.7151522, 0.0721750}, {0.0193339, 0.1191920, 0.9503041}};

// CIE 15: the cube root with its linear foot, which also carries negative arguments.
double labCurve(double t) {
  constexpr double kFoot = 6.0 / 29.0;
  return t > kFoot * kFoot * kFoot ? std::cbrt(t) : t / (3 * kFoot * kFoot) + 4.0 / 29.0;
}

}  // namespace

glm::dvec3 labFromRgb(const glm::dvec3& linear_rgb) {
  glm::dvec3 curve;
  for (int row = 0; row < 3; ++row) {
    const double* m = kXyzFromRgb[row];
    const double white = m[0] + m[1] + m[2];
    curve[row] = labCurve((m[0] * linear_rgb.x + m[1] * linear_rgb.y + m[2] * linear_rgb.z) / white);
  }
  return {116 * curve.y - 16, 500 * (curve.x - curve.y), 200 * (curve.y - curve.z)};
}

double srgbFromLinear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double linearFromSrgb(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

}  // namespace loden
