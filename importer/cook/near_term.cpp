#include "importer/cook/near_term.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "importer/fit/surface_light.h"
#include "importer/tile/charts.h"
#include "importer/tile/mesh_material.h"
#include "material/asset/asset.h"
#include "material/eval/near_term.h"
#include "material/model/color.h"
#include "material/model/environment.h"

namespace loden::importer {
namespace {

constexpr float kDielectric = 0.04f;  // f0 of glTF's dielectrics
constexpr int kAmbientRows = 8;       // of lights: 8 x 16 directions
constexpr int kPointsAcross = 2;      // per side of a texel, that rays towards lights start from
static_assert(kShadowComponents % 4 == 0);

// What one texel averages.
struct Texel {
  glm::vec3 normal{0}, diffuse{0};
  glm::vec3 f0{0};     // GGX
  float strength = 0;  // Phong: value at the lobe's peak
  float width = 0;     // Phong: log2(exponent); GGX: alpha^2
};

std::vector<Texel> texelsOf(const BakedOutput::Surface& maps) {
  std::vector<Texel> texels;
  for (size_t t = 0; t < maps.normal.size(); ++t) {
    Texel texel{maps.normal[t], maps.diffuse[t]};
    if (maps.ggx.empty()) {
      texel.strength = maps.specular[t].x;
      texel.width = std::log2(std::max(maps.specular[t].y, 1.0f));
    } else {
      texel.f0 = glm::vec3(maps.ggx[t]);
      texel.width = maps.ggx[t].w * maps.ggx[t].w;
    }
    texels.push_back(texel);
  }
  return texels;
}

// 2 x 2 means of a map over p, each inside one chart.
std::vector<Texel> halved(const std::vector<Texel>& fine, int side, std::span<const uint16_t> owners,
                          std::span<const uint16_t> coarse_owners) {
  const int half = side / 2;
  std::vector<Texel> coarse(size_t(half) * size_t(half));
  for (int j = 0; j < half; ++j)
    for (int i = 0; i < half; ++i) {
      const unsigned children = childrenOf(side, owners, coarse_owners, i, j);
      const float share = 1 / float(std::popcount(children));
      Texel& sum = coarse[size_t(j) * size_t(half) + size_t(i)];
      for (int k = 0; k < 4; ++k) {
        if ((children >> k & 1) == 0) continue;
        const Texel& from = fine[size_t(2 * j + k / 2) * size_t(side) + size_t(2 * i + k % 2)];
        sum.normal += share * from.normal, sum.diffuse += share * from.diffuse, sum.f0 += share * from.f0;
        sum.strength += share * from.strength, sum.width += share * from.width;
      }
    }
  return coarse;
}

struct StoredLobe {
  float width, strength;  // as SurfaceMaps stores them, strength unscaled
};

// The lobe of the surface and of the normals that differ inside the texel.
StoredLobe widened(const Texel& texel, Lobe lobe) {
  const float length = std::clamp(glm::length(texel.normal), 1e-2f, 1.0f);
  if (lobe == Lobe::kGgx) {
    const float variance = 2 * (1 - length) / length;
    return {std::sqrt(std::sqrt(std::min(texel.width + variance, 1.0f))), 0};
  }
  const float sharp = std::exp2(texel.width);
  const float exponent = std::max(sharp * length / (length + sharp * (1 - length)), 1.0f);
  return {std::log2(exponent) / 12, texel.strength * lobePeak(exponent) / lobePeak(sharp)};
}

// Base colour and metalness that give a diffuse albedo and an f0 (glTF 2.0, appendix B), the channel of the
// largest sum deciding on the metalness m: diffuse = c (1 - m), f0 = .04 (1 - m) + c m.
glm::vec4 baseOf(const Texel& texel) {
  const glm::vec3 sum = texel.diffuse + texel.f0;
  const int k = sum.x >= sum.y && sum.x >= sum.z ? 0 : sum.y >= sum.z ? 1 : 2;
  // With s = diffuse + f0 = c + .04 (1 - m): c = s - .04 (1 - m), and diffuse = c (1 - m) is a quadratic in
  // u = 1 - m: .04 u^2 - s u + diffuse = 0.
  const float s = sum[k], root = std::sqrt(std::max(s * s - 4 * kDielectric * texel.diffuse[k], 0.0f));
  const float u = s > 0 ? std::clamp(2 * texel.diffuse[k] / std::max(s + root, 1e-6f), 0.0f, 1.0f) : 1.0f;
  const glm::vec3 base = glm::clamp(sum - kDielectric * u, glm::vec3(0), glm::vec3(1));
  return {base, 1 - u};
}

glm::vec4 rooted(const glm::vec4& color) {
  return {glm::sqrt(glm::max(glm::vec3(color), glm::vec3(0))), color.w};
}

int mipsOf(int surface_side, int side, bool with_bands) {
  const int all = fullMipCount(surface_side, surface_side);
  if (!with_bands) return all;
  const double first = std::log2(double(side) / surface_side);
  return std::clamp(static_cast<int>(std::ceil(double(kNearFadeEnd) - first)) + 1, 1, all);
}

// Midpoints equal in cos(theta) and phi; each stands for the same solid angle.
std::vector<glm::dvec3> ambientDirections() {
  std::vector<glm::dvec3> directions;
  for (int row = 0; row < kAmbientRows; ++row)
    for (int column = 0; column < 2 * kAmbientRows; ++column)
      directions.push_back(directionFromSpherical(
          {std::acos((row + 0.5) / kAmbientRows), kPi * (column + 0.5) / kAmbientRows}));
  return directions;
}

// T_k of every texel, in column k (SurfaceMaps::ambient).
Matrix ambientTransfer(const Matrix& lit, std::span<const glm::dvec3> directions) {
  const double measure = 2.0 / double(directions.size());  // dw / pi
  Matrix transfer(lit.rows, 2 * 4);
  for (int l = 0; l < lit.cols; ++l) {
    const glm::dvec3& w = directions[size_t(l)];
    const double basis[kEnvironmentBasis] = {1, w.z, w.x, w.y, w.x * w.y, w.x * w.x - w.y * w.y};
    for (int k = 0; k < kEnvironmentBasis; ++k)
      for (int t = 0; t < lit.rows; ++t) transfer(t, k) += measure * lit(t, l) * basis[k];
  }
  return transfer;
}

// Values within -1..1, four columns a layer.
glm::vec4 storedAsTheyAre(const Matrix& values, int texel, int layer) {
  glm::vec4 stored;
  for (int c = 0; c < 4; ++c) stored[c] = static_cast<float>(values(texel, 4 * layer + c));
  return stored;
}

// indirectLight as SurfaceMaps::indirect holds it: all channels depend on the direction as the luminance
// does, and keep their irradiance by a white sky.
glm::vec4 storedIndirect(const Matrix& values, int texel, int layer) {
  const auto rgb = [&](int k) {
    return glm::dvec3(values(texel, k), values(texel, kIndirectTerms + k),
                      values(texel, 2 * kIndirectTerms + k));
  };
  glm::dvec4 luma;
  for (int k = 0; k < kIndirectTerms; ++k) luma[k] = yccFromRgb(rgb(k)).x;
  const glm::dvec3 sky = glm::max(rgb(0) + 2.0 / 3 * rgb(1), glm::dvec3(0));
  const double sky_luma = yccFromRgb(sky).x;
  const double most = std::max({std::abs(luma.x), std::abs(luma.y), std::abs(luma.z), std::abs(luma.w)});
  if (!(sky_luma > 0)) return glm::vec4(0);
  return layer == 0 ? glm::vec4(glm::sqrt(sky * (most / sky_luma)), 0) : glm::vec4(luma / most);
}

// Mips are averages of the values inside one chart; stored(values, texel, layer) is what a texel holds.
template <class Stored>
Texture mapOf(Matrix values, int layers, const Stored& stored, int side, int mips,
              std::vector<uint16_t> owners) {
  Texture texture = Texture::make(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, side, side, layers, mips);
  for (int mip = 0; mip < mips; ++mip) {
    for (int t = 0; t < side * side; ++t)
      for (int layer = 0; layer < layers; ++layer)
        storeTexel(texture, mip, t % side, t / side, layer, stored(values, t, layer));
    if (mip + 1 == mips) break;
    const auto coarse_owners = owners.empty() ? owners : halvedOwners(side, owners);
    const int half = side / 2;
    Matrix coarse(half * half, values.cols);
    for (int t = 0; t < half * half; ++t) {
      const glm::ivec2 at(t % half, t / half);
      const unsigned children = childrenOf(side, owners, coarse_owners, at.x, at.y);
      for (int k = 0; k < 4; ++k)
        for (int c = 0; c < values.cols && (children >> k & 1) != 0; ++c)
          coarse(t, c) += values((2 * at.y + k / 2) * side + 2 * at.x + k % 2, c) / std::popcount(children);
    }
    values = std::move(coarse), owners = coarse_owners, side = half;
  }
  return texture;
}

// The shadow map and its table.
void addShadow(SurfaceMaps& maps, const GeometryImage& image, int mips, std::vector<uint16_t> owners,
               int threads) {
  const int side = maps.ambient.width;
  const SurfaceLight light =
      surfaceLight(image, side, shadowDirections(kShadowTable), kPointsAcross, threads);
  const Factors factors = fitShadow(light, kShadowComponents, threads);
  const int layers = kShadowComponents / 4;
  maps.shadow = mapOf(factors.weights, layers, storedAsTheyAre, side, mips, std::move(owners));
  maps.shadow_table =
      Texture::make(TexelFormat::kRGBA16Sfloat, TextureShape::kArray2D, kShadowTable, kShadowTable, layers);
  for (int d = 0; d < kShadowTable * kShadowTable; ++d)
    for (int layer = 0; layer < layers; ++layer) {
      glm::vec4 texel;
      for (int c = 0; c < 4; ++c) texel[c] = static_cast<float>(factors.basis(d, 4 * layer + c));
      storeTexel(maps.shadow_table, 0, d % kShadowTable, d / kShadowTable, layer, texel);
    }
}

// What each texel of a side x side map returns of diffuse light.
std::vector<glm::vec3> albedoOf(const SurfaceMaps& maps, int side) {
  std::vector<glm::vec3> albedo;
  for (int t = 0; t < side * side; ++t) {
    const glm::vec2 p = (glm::vec2(t % side, t / side) + 0.5f) / float(side);
    albedo.push_back(nearAlbedo(maps.lobe, nearPoint(maps, p, maps.ambient_first)));
  }
  return albedo;
}

}  // namespace

Result<BakedSurface> bakedSurface(const BakedOutput& input) {
  auto maps = input.surface();
  if (!maps) return maps.issue();
  return BakedSurface{std::move(*maps), input.manifest().surface_size, input.manifest().bounces};
}

SurfaceMaps nearMaps(const BakedSurface& baked, const GeometryImage& geometry, int side,
                     const NearOptions& options, int threads) {
  SurfaceMaps maps;
  maps.lobe = baked.maps.ggx.empty() ? Lobe::kPhong : Lobe::kGgx;
  maps.visibility = geometry.empty() ? Visibility::kNone : options.visibility;
  int surface_side = baked.side;
  std::vector<Texel> texels = texelsOf(baked.maps);
  std::vector<uint16_t> owners = chartOwners(surface_side, geometry);
  const auto halve = [&] {
    auto coarse_owners = owners.empty() ? owners : halvedOwners(surface_side, owners);
    texels = halved(texels, surface_side, owners, coarse_owners);
    owners = std::move(coarse_owners), surface_side /= 2;
  };
  for (int reduced = 1; reduced < options.reduced && surface_side > 1; reduced *= 2) halve();
  while (surface_side >= side << AssetLimits::kMaxFinerLevels) halve();
  maps.specular_scale = 0;
  for (const Texel& texel : texels) maps.specular_scale = std::max(maps.specular_scale, texel.strength);
  maps.lambda_first = std::log2(float(side) / float(surface_side)) + kNearFiner;
  const int mips = mipsOf(surface_side, side, options.with_bands);
  maps.normal =
      Texture::make(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, surface_side, surface_side, 1, mips);
  maps.color =
      Texture::make(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, surface_side, surface_side, 1, mips);
  const int ambient_side = std::min(side, surface_side);
  const std::vector<uint16_t> ambient_owners = chartOwners(ambient_side, geometry);
  for (int mip = 0; mip < mips; ++mip) {
    for (int t = 0; t < surface_side * surface_side; ++t) {
      const Texel& texel = texels[size_t(t)];
      const StoredLobe lobe = widened(texel, maps.lobe);
      const float strength = maps.specular_scale > 0 ? lobe.strength / maps.specular_scale : 0;
      storeTexel(maps.normal, mip, t % surface_side, t / surface_side, 0,
                 glm::vec4(texel.normal, lobe.width));
      storeTexel(maps.color, mip, t % surface_side, t / surface_side, 0,
                 rooted(maps.lobe == Lobe::kGgx ? baseOf(texel) : glm::vec4(texel.diffuse, strength)));
    }
    if (mip + 1 < mips) halve();
  }
  maps.ambient_first = std::log2(float(side) / float(ambient_side));
  const int ambient_mips = mipsOf(ambient_side, side, options.with_bands);
  const std::vector<glm::dvec3> directions = ambientDirections();
  const Matrix lit = surfaceLight(geometry, ambient_side, directions, kPointsAcross, threads).lit;
  maps.ambient =
      mapOf(ambientTransfer(lit, directions), 2, storedAsTheyAre, ambient_side, ambient_mips, ambient_owners);
  if (options.bounces > 0 && !geometry.empty())
    maps.indirect = mapOf(indirectLight(geometry, ambient_side, lit, directions, albedoOf(maps, ambient_side),
                                        options.bounces, kPointsAcross, threads),
                          2, storedIndirect, ambient_side, ambient_mips, ambient_owners);
  if (maps.visibility == Visibility::kMap) addShadow(maps, geometry, ambient_mips, ambient_owners, threads);
  if (options.with_bands) maps.fade_begin = kNearFadeBegin, maps.fade_end = kNearFadeEnd;
  return maps;
}

uint64_t nearBytes(int surface_side, int side, bool with_bands, bool shadow, bool indirect) {
  const int ambient_side = std::min(side, surface_side);
  const auto bytes = [&](int of, int layers) {
    return textureBytes(TexelFormat::kRGBA8Snorm, uint64_t(of), uint64_t(of), uint64_t(layers),
                        mipsOf(of, side, with_bands));
  };
  uint64_t sum = 2 * bytes(surface_side, 1) + bytes(ambient_side, indirect ? 4 : 2);
  if (shadow)
    sum += bytes(ambient_side, kShadowComponents / 4) +
           textureBytes(TexelFormat::kRGBA16Sfloat, kShadowTable, kShadowTable, kShadowComponents / 4, 1);
  return sum;
}

}  // namespace loden::importer
