// Colour spaces, the same in every part of Loden: BT.601 YCbCr of linear RGB, and CIE Lab of linear RGB with
// sRGB primaries and D65 white, without clipping. The value 1 is white Lambert lit from above.
#pragma once

#include <glm/glm.hpp>

namespace loden {

template <class T>
glm::vec<3, T> yccFromRgb(const glm::vec<3, T>& rgb) {
  const T y = T(0.299) * rgb.x + T(0.587) * rgb.y + T(0.114) * rgb.z;
  return {y, (rgb.z - y) * T(0.564334085778781), (rgb.x - y) * T(0.713266761768902)};
}

template <class T>
glm::vec<3, T> rgbFromYcc(const glm::vec<3, T>& ycc) {
  const T r = ycc.x + T(1.402) * ycc.z;
  const T b = ycc.x + T(1.772) * ycc.y;
  return {r, ycc.x - T(0.344136286201022) * ycc.y - T(0.714136286201022) * ycc.z, b};
}

glm::dvec3 labFromRgb(const glm::dvec3& linear_rgb);

// The sRGB transfer function and its inverse.
double srgbFromLinear(double linear);
double linearFromSrgb(double srgb);

}  // namespace loden
