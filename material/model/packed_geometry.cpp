#include "material/model/packed_geometry.h"

#include <algorithm>
#include <cmath>

namespace loden {
namespace {

constexpr uint32_t kExists = 1u << 31;
constexpr uint32_t kMaskXy = 1023, kMaskZ = 2047;
constexpr float kMiddleXy = 511, kStepsXy = 1022, kStepsZ = 2047, kStepsImage = 65535;

uint32_t code(double value) {
  return static_cast<uint32_t>(std::lround(value));
}

// Of P.xy - p along one axis. Charts may lie periods away from their surface; lookups do not care which copy
// they find.
uint32_t packOffset(uint16_t image_code, double image_range, double range) {
  double offset = (image_code / double(kStepsImage) - 0.5) * image_range;
  if (image_range > range) offset -= std::nearbyint(offset);
  return code(offset / std::max(range, 1e-9) * kStepsXy + kMiddleXy);
}

// `texel` holds the image's codes of P.xy - p, of P.z, and the chart.
uint32_t packTexel(const uint16_t* texel, const GeometryImage& image, const glm::vec3& range) {
  return packOffset(texel[0], image.range.x, range.x) | packOffset(texel[1], image.range.y, range.y) << 10 |
         code(texel[2] / double(kStepsImage) * kStepsZ) << 20;
}

}  // namespace

glm::vec3 packedRange(const GeometryImage& image) {
  return {std::min(image.range.x, 1.0f), std::min(image.range.y, 1.0f), std::max(image.range.z, 1e-9f)};
}

PackedGeometry packGeometry(const GeometryImage& image) {
  const int n = image.side();
  PackedGeometry packed;
  const TexelFormat format =
      image.identity_parameterization ? TexelFormat::kRG8Unorm : TexelFormat::kRGBA8Unorm;
  packed.texels = Texture::make(format, TextureShape::kArray2D, n, n, 1);
  packed.range = packedRange(image);
  packed.identity_parameterization = image.identity_parameterization;
  packed.aspect = image.aspect;
  const auto* texels = reinterpret_cast<const uint16_t*>(image.texels.data.data());
  if (image.identity_parameterization) {
    auto* heights = reinterpret_cast<uint16_t*>(packed.texels.data.data());
    for (size_t k = 0; k < static_cast<size_t>(n) * n; ++k) heights[k] = texels[4 * k + 2];
    return packed;
  }
  auto* codes = reinterpret_cast<uint32_t*>(packed.texels.data.data());
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const size_t k = static_cast<size_t>(j) * n + i;
      const bool exists = fetchPatch<float>(image, i, j).chart != 0;
      codes[k] = packTexel(texels + 4 * k, image, packed.range) | (exists ? kExists : 0);
    }
  return packed;
}

template <class T>
Patch<T> fetchPatch(const PackedGeometry& geometry, int i, int j) {
  const int n = geometry.side();
  if (geometry.identity_parameterization) {
    const auto* heights = reinterpret_cast<const uint16_t*>(geometry.texels.data.data());
    const auto corner = [&](int ci, int cj) {
      const uint16_t height = heights[static_cast<size_t>(wrapIndex(cj, n)) * n + wrapIndex(ci, n)];
      return glm::vec<3, T>((T(ci) + T(0.5)) / T(n), (T(cj) + T(0.5)) / T(n),
                            (T(height) * (T(1) / T(kStepsImage)) - T(1)) * T(geometry.range.z));
    };
    return {corner(i, j), corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1), 1};
  }
  const auto* codes = reinterpret_cast<const uint32_t*>(geometry.texels.data.data());
  const glm::vec<3, T> range(geometry.range);
  const auto codeAt = [&](int ci, int cj) {
    return codes[static_cast<size_t>(wrapIndex(cj, n)) * n + wrapIndex(ci, n)];
  };
  using V2 = glm::vec<2, T>;
  const auto offset = [&](uint32_t c) {
    return (V2(T(c & kMaskXy), T(c >> 10 & kMaskXy)) - T(kMiddleXy)) * (T(1) / T(kStepsXy)) * V2(range);
  };
  const V2 first = offset(codeAt(i, j));
  const auto corner = [&](int ci, int cj) {
    const uint32_t c = codeAt(ci, cj);
    const V2 p((T(ci) + T(0.5)) / T(n), (T(cj) + T(0.5)) / T(n));
    V2 beside = offset(c);
    beside -= glm::floor(beside - first + T(0.5));  // all corners in the period of the first
    return glm::vec<3, T>(p + beside, (T(c >> 20 & kMaskZ) * (T(1) / T(kStepsZ)) - T(1)) * range.z);
  };
  return {corner(i, j), corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1),
          codeAt(i, j) & kExists ? 1u : 0u};
}

template Patch<float> fetchPatch(const PackedGeometry&, int, int);
template Patch<double> fetchPatch(const PackedGeometry&, int, int);

}  // namespace loden
