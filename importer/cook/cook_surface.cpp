#include <algorithm>
#include <bit>
#include <cmath>

#include "importer/cook/atlas_choice.h"
#include "importer/cook/meta.h"
#include "importer/cook/modes.h"
#include "importer/fit/band_fit.h"
#include "importer/fit/paper_vdim.h"
#include "importer/tile/charts.h"
#include "material/model/leading_part.h"

namespace loden::importer {
namespace {

// 2 x 2 means of a map over p, each inside one chart.
std::vector<glm::vec4> halved(const std::vector<glm::vec4>& fine, int side, std::span<const uint16_t> owners,
                              std::span<const uint16_t> coarse_owners) {
  const int half = side / 2;
  std::vector<glm::vec4> coarse(size_t(half) * size_t(half));
  for (int j = 0; j < half; ++j)
    for (int i = 0; i < half; ++i) {
      const unsigned children = childrenOf(side, owners, coarse_owners, i, j);
      glm::vec4 sum(0);
      for (int k = 0; k < 4; ++k)
        if (children >> k & 1) sum += fine[size_t(2 * j + k / 2) * size_t(side) + size_t(2 * i + k % 2)];
      coarse[size_t(j) * size_t(half) + size_t(i)] = sum / float(std::popcount(children));
    }
  return coarse;
}

Texture mipMapped(TexelFormat format, std::vector<glm::vec4> texels, int side, std::vector<uint16_t> owners) {
  Texture map = Texture::make(format, TextureShape::kArray2D, side, side, 1, fullMipCount(side, side));
  for (int mip = 0; mip < map.mips; ++mip, side /= 2) {
    for (int t = 0; t < side * side; ++t) storeTexel(map, mip, t % side, t / side, 0, texels[size_t(t)]);
    if (side <= 1) continue;
    auto coarse_owners = owners.empty() ? owners : halvedOwners(side, owners);
    texels = halved(texels, side, owners, coarse_owners);
    owners = std::move(coarse_owners);
  }
  return map;
}

SurfaceMaps surfaceMaps(const BakedOutput::Surface& baked, int side, const std::vector<uint16_t>& owners) {
  SurfaceMaps maps;
  maps.specular_scale = 0;
  for (const glm::vec2& s : baked.specular) maps.specular_scale = std::max(maps.specular_scale, s.x);
  std::vector<glm::vec4> normal, diffuse, specular;
  for (size_t t = 0; t < baked.normal.size(); ++t) {
    normal.emplace_back(baked.normal[t], 0);
    diffuse.emplace_back(baked.diffuse[t], 1);
    const float exponent = std::log2(std::max(baked.specular[t].y, 1.0f)) / 12;
    specular.emplace_back(maps.specular_scale > 0 ? baked.specular[t].x / maps.specular_scale : 0.0f,
                          exponent, 0, 0);
  }
  maps.normal = mipMapped(TexelFormat::kRGBA8Snorm, std::move(normal), side, owners);
  maps.diffuse = mipMapped(TexelFormat::kRGBA16Unorm, std::move(diffuse), side, owners);
  maps.specular = mipMapped(TexelFormat::kRG8Unorm, std::move(specular), side, owners);
  return maps;
}

// Ma et al. eq. 5 fitted to the baked BTF's average where there is one: what far views fall back to.
Status fitMean(const BakedOutput& input, const CookOptions& options, Material& m) {
  if (!input.manifest().has_btf) return {};
  auto source = bakedSource(input);
  if (!source) return source.issue();
  auto btf = loadYcc(**source, options.threads);
  if (!btf) return btf.issue();
  m.mean = fitPhong(imageMeans(*btf, options.threads), (*source)->lights(), (*source)->views(),
                    {true, MeanChroma::kRatio})
               .mean;
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
  auto geometry = geometryOf(input, 0);
  if (!geometry) return geometry.issue();
  m.geometry = std::move(*geometry);
  AtlasChoice atlas;
  if (!m.geometry.empty()) atlas = chooseAtlas(m.geometry, m.side, options.threads);
  m.atlas = atlas.size;
  m.surface = surfaceMaps(*baked, manifest.flat_size, chartOwners(manifest.flat_size, m.geometry));
  m.lambda_max = static_cast<float>(m.surface->diffuse.mips - 1);
  // As published the indirection map itself is stored; it is also the only one where there is no geometry.
  if ((options.preset == Preset::kSeed || m.geometry.empty()) && !manifest.vdims.empty()) {
    const glm::ivec2 size = manifest.vdims.front();
    auto vdim = input.vdim(size.x, size.y);
    if (!vdim) return vdim.issue();
    m.stored_vdim = packPaperVdim(*vdim, manifest.size, size.x, size.y);
  }
  if (const Status status = fitMean(input, options, m); !status.ok()) return status.issue();
  splitLeadingParts(m);
  m.meta_json = cookMeta(m, manifest.tile, presetName(options.preset), nullptr, {}, atlas.trials);
  return m;
}

}  // namespace loden::importer
