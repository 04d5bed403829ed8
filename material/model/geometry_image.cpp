#include "material/model/geometry_image.h"

#include <algorithm>
#include <cmath>

#include "material/base/check.h"

namespace loden {
namespace {

constexpr double kCodeMax = 65535.0;

uint16_t encode(double unit) {
  return static_cast<uint16_t>(std::lround(std::clamp(unit, 0.0, 1.0) * kCodeMax));
}

}  // namespace

GeometryImage encodeGeometryImage(int side, std::span<const glm::dvec3> positions,
                                  std::span<const uint16_t> charts, bool identity_parameterization) {
  const size_t count = static_cast<size_t>(side) * side;
  LODEN_CHECK_EQ(positions.size(), count);
  LODEN_CHECK_EQ(charts.size(), count);
  GeometryImage image;
  image.texels = Texture::make(TexelFormat::kRGBA16Unorm, TextureShape::kArray2D, side, side, 1);
  image.identity_parameterization = identity_parameterization;

  const auto displacement = [&](size_t k) {
    const glm::dvec2 p((k % side + 0.5) / side, (k / side + 0.5) / side);
    return identity_parameterization ? glm::dvec2(0) : glm::dvec2(positions[k]) - p;
  };
  glm::dvec3 range(0);
  for (size_t k = 0; k < count; ++k) {
    if (charts[k] == 0) continue;
    LODEN_CHECK_LE(positions[k].z, 1e-9);
    const glm::dvec2 d = glm::abs(displacement(k));
    range = glm::max(range, glm::dvec3(2 * d.x, 2 * d.y, -positions[k].z));
  }
  image.range = glm::vec3(range);  // where that rounds down, encode() clamps what is a 200th of a code
  const glm::dvec3 unit = 1.0 / glm::max(glm::dvec3(image.range), glm::dvec3(1e-30));
  auto* codes = reinterpret_cast<uint16_t*>(image.texels.data.data());
  for (size_t k = 0; k < count; ++k, codes += 4) {
    const glm::dvec2 d = displacement(k);
    codes[0] = encode(d.x * unit.x + 0.5);
    codes[1] = encode(d.y * unit.y + 0.5);
    codes[2] = encode(positions[k].z * unit.z + 1);
    codes[3] = charts[k];
  }
  return image;
}

template <class T>
Patch<T> fetchPatch(const GeometryImage& image, int i, int j) {
  const int n = image.side();
  const auto* texels = reinterpret_cast<const uint16_t*>(image.texels.data.data());
  uint32_t charts[4];
  const auto corner = [&](int ci, int cj, uint32_t& chart) {
    const uint16_t* c = texels + 4 * (static_cast<size_t>(wrapIndex(cj, n)) * n + wrapIndex(ci, n));
    chart = c[3];
    const T unit = T(1) / T(kCodeMax);
    return glm::vec<3, T>((T(ci) + T(0.5)) / T(n) + (T(c[0]) * unit - T(0.5)) * T(image.range.x),
                          (T(cj) + T(0.5)) / T(n) + (T(c[1]) * unit - T(0.5)) * T(image.range.y),
                          (T(c[2]) * unit - T(1)) * T(image.range.z));
  };
  Patch<T> patch;
  patch.p00 = corner(i, j, charts[0]);
  patch.p10 = corner(i + 1, j, charts[1]);
  patch.p01 = corner(i, j + 1, charts[2]);
  patch.p11 = corner(i + 1, j + 1, charts[3]);
  const bool one_chart = charts[0] == charts[1] && charts[0] == charts[2] && charts[0] == charts[3];
  patch.chart = one_chart ? charts[0] : 0;
  return patch;
}

template <class T>
SurfacePoint<T> surfaceAt(const GeometryImage& image, glm::vec<2, T> p) {
  const glm::vec<2, T> texel = p * T(image.side()) - T(0.5);
  const glm::vec<2, T> base = glm::floor(texel), f = texel - base;
  const Patch<T> patch = fetchPatch<T>(image, static_cast<int>(base.x), static_cast<int>(base.y));
  SurfacePoint<T> point;
  point.chart = patch.chart;
  point.position = glm::mix(glm::mix(patch.p00, patch.p10, f.x), glm::mix(patch.p01, patch.p11, f.x), f.y);
  const auto du = glm::mix(patch.p10 - patch.p00, patch.p11 - patch.p01, f.y);
  const auto dv = glm::mix(patch.p01 - patch.p00, patch.p11 - patch.p10, f.x);
  const auto normal =
      glm::cross(du, dv) * glm::vec<3, T>(glm::vec<2, T>(periodsPerLength(image.aspect)), T(1));
  const T length = glm::length(normal);
  point.normal = length > 0 ? normal / length : glm::vec<3, T>(0, 0, 1);
  return point;
}

template Patch<float> fetchPatch(const GeometryImage&, int, int);
template Patch<double> fetchPatch(const GeometryImage&, int, int);
template SurfacePoint<float> surfaceAt(const GeometryImage&, glm::vec<2, float>);
template SurfacePoint<double> surfaceAt(const GeometryImage&, glm::vec<2, double>);

}  // namespace loden
