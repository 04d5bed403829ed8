#include "importer/fit/paper_vdim.h"

#include <algorithm>
#include <cmath>

namespace loden::importer {
namespace {

// Eqs. 2 and 3 of Hadim et al. for one texel of the packed map: direction and distance from R.
glm::vec4 packedTexel(glm::vec2 displacement, float range) {
  const float distance = glm::length(displacement);
  if (distance <= 0) return {0, 0, 0, 0};
  return {displacement / distance, distance / range, 0};
}

}  // namespace

PaperVdim packPaperVdim(const std::vector<glm::vec2>& vdim, int side, int zeniths, int azimuths) {
  const size_t texels = size_t(side) * size_t(side);
  const auto at = [&](int z, int a, size_t t) {
    return vdim[(size_t(z) * size_t(azimuths) + size_t(a)) * texels + t];
  };
  PaperVdim out;
  out.side = side;
  out.zeniths = zeniths;
  out.azimuths = azimuths;
  glm::vec2 range(1e-6f);
  for (size_t t = 0; t < texels; ++t) {
    const glm::vec2 reference = at(0, 0, t);
    range.x = std::max({range.x, std::abs(reference.x), std::abs(reference.y)});
    for (int z = 0; z < zeniths; ++z)
      for (int a = 0; a < azimuths; ++a) range.y = std::max(range.y, glm::length(at(z, a, t) - reference));
  }
  out.range = range;
  out.reference = Texture::make(TexelFormat::kRG16Snorm, TextureShape::kArray2D, side, side, 1);
  out.packed =
      Texture::make(TexelFormat::kRGBA16Snorm, TextureShape::kArray2D, side * azimuths, side * zeniths, 1);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const size_t t = size_t(j) * size_t(side) + size_t(i);
      const glm::vec2 reference = at(0, 0, t);
      storeTexel(out.reference, 0, i, j, 0, {reference / range.x, 0, 0});
      for (int z = 0; z < zeniths; ++z)
        for (int a = 0; a < azimuths; ++a)
          storeTexel(out.packed, 0, i * azimuths + a, j * zeniths + z, 0,
                     packedTexel(at(z, a, t) - reference, range.y));
    }
  return out;
}

}  // namespace loden::importer
