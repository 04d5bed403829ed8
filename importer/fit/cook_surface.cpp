#include <algorithm>
#include <cmath>

#include "importer/fit/band_fit.h"
#include "importer/fit/meta.h"
#include "importer/fit/modes.h"

namespace loden::importer {
namespace {

// 2 x 2 means of a map over p.
std::vector<glm::vec4> halved(const std::vector<glm::vec4>& fine, int side) {
  const int half = side / 2;
  std::vector<glm::vec4> coarse(size_t(half) * size_t(half));
  const auto at = [&](int i, int j) { return fine[size_t(j) * size_t(side) + size_t(i)]; };
  for (int j = 0; j < half; ++j)
    for (int i = 0; i < half; ++i)
      coarse[size_t(j) * size_t(half) + size_t(i)] =
          (at(2 * i, 2 * j) + at(2 * i + 1, 2 * j) + at(2 * i, 2 * j + 1) + at(2 * i + 1, 2 * j + 1)) * 0.25f;
  return coarse;
}

Texture mipMapped(TexelFormat format, std::vector<glm::vec4> texels, int side) {
  Texture map = Texture::make(format, TextureShape::kArray2D, side, side, 1, fullMipCount(side, side));
  for (int mip = 0; mip < map.mips; ++mip, side /= 2) {
    for (int t = 0; t < side * side; ++t) storeTexel(map, mip, t % side, t / side, 0, texels[size_t(t)]);
    if (side > 1) texels = halved(texels, side);
  }
  return map;
}

SurfaceMaps surfaceMaps(const BakedOutput::Surface& baked, int side) {
  SurfaceMaps maps;
  for (const glm::vec2& s : baked.specular) maps.specular_scale = std::max(maps.specular_scale, s.x);
  std::vector<glm::vec4> normal, diffuse, specular;
  for (size_t t = 0; t < baked.normal.size(); ++t) {
    normal.emplace_back(baked.normal[t], 0);
    diffuse.emplace_back(baked.diffuse[t], 1);
    const float exponent = std::log2(std::max(baked.specular[t].y, 1.0f)) / 12;
    specular.emplace_back(baked.specular[t].x / maps.specular_scale, exponent, 0, 0);
  }
  maps.normal = mipMapped(TexelFormat::kRGBA8Snorm, std::move(normal), side);
  maps.diffuse = mipMapped(TexelFormat::kRGBA8Srgb, std::move(diffuse), side);
  maps.specular = mipMapped(TexelFormat::kRG8Unorm, std::move(specular), side);
  return maps;
}

// Eqs. 2 and 3 of Hadim et al. for one texel of the packed map: direction and distance from R.
glm::vec4 packedTexel(glm::vec2 displacement, float range) {
  const float distance = glm::length(displacement);
  if (distance <= 0) return {0, 0, 0, 0};
  return {displacement / distance, distance / range, 0};
}

PaperVdim packVdim(const std::vector<glm::vec2>& vdim, int side, int zeniths, int azimuths) {
  const size_t texels = size_t(side) * size_t(side);
  const auto at = [&](int z, int a, size_t t) { return vdim[(size_t(z) * size_t(azimuths) + size_t(a)) * texels + t]; };
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
  out.packed = Texture::make(TexelFormat::kRGBA16Snorm, TextureShape::kArray2D, side * azimuths, side * zeniths, 1);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const size_t t = size_t(j) * size_t(side) + size_t(i);
      const glm::vec2 reference = at(0, 0, t);
      storeTexel(out.reference, 0, i, j, 0, {reference / range.x, 0, 0});
      for (int z = 0; z < zeniths; ++z)
        for (int a = 0; a < azimuths; ++a)
          storeTexel(out.packed, 0, i * azimuths + a, j * zeniths + z, 0, packedTexel(at(z, a, t) - reference, range.y));
    }
  return out;
}

// Ma et al. eq. 5 fitted to the baked BTF's average where there is one: what far views fall back to.
Status fitMean(const BakedOutput& input, const CookOptions& options, Material& m) {
  if (!input.manifest().has_btf) return {};
  auto source = bakedSource(input);
  if (!source) return source.issue();
  auto btf = loadYcc(**source, options.threads);
  if (!btf) return btf.issue();
  m.mean = fitPhong(imageMeans(*btf, options.threads), (*source)->lights(), (*source)->views(), {true, MeanChroma::kRatio}).mean;
  return {};
}

}  // namespace

Result<Material> cookSurface(const BakedOutput& input, const CookOptions& options) {
  const BakeManifest& manifest = input.manifest();
  auto baked = input.surface();
  if (!baked) return baked.issue();
  Material m;
  m.mode = Mode::kSurface;
  m.name = manifest.tile;
  m.side = manifest.size;
  m.value_scale = static_cast<float>(1 / kPi);
  m.surface = surfaceMaps(*baked, manifest.flat_size);
  m.lambda_max = static_cast<float>(m.surface->diffuse.mips - 1);
  auto geometry = geometryOf(input, 0);
  if (!geometry) return geometry.issue();
  m.geometry = std::move(*geometry);
  // As published the indirection map itself is stored; it is also the only one where there is no geometry.
  if ((options.preset == Preset::kSeed || m.geometry.empty()) && !manifest.vdims.empty()) {
    const glm::ivec2 size = manifest.vdims.front();
    auto vdim = input.vdim(size.x, size.y);
    if (!vdim) return vdim.issue();
    m.stored_vdim = packVdim(*vdim, manifest.size, size.x, size.y);
  }
  if (const Status status = fitMean(input, options, m); !status.ok()) return status.issue();
  m.meta_json = cookMeta(m, manifest.tile, presetName(options.preset), nullptr);
  return m;
}

}  // namespace loden::importer
