#include "tests/unit/material_fixtures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace loden::test {
namespace {

constexpr int kSide = 8;

DirectionSet threeDirections() {
  DirectionSet set;
  set.samples = {{0, 0, 1}, {0.6, 0, 0.8}, {0, -0.6, 0.8}};
  return set;
}

Band nearestBand(int level, uint32_t seed) {
  Band band;
  band.filter = WeightFilter::kNearest;
  band.layout = TableLayout::kNearest;
  band.window = {-2, -1, static_cast<float>(level), static_cast<float>(level + 1)};
  band.lambda_first = static_cast<float>(level);
  band.y_quads = 2;
  band.chroma_quads = 1;
  band.quad_scale.assign(3, glm::vec4(1));
  band.quad_levels.assign(3, {});
  const int side = kSide >> level;
  const int layers = level == 2 ? 4 : 3;
  band.weights =
      noiseTexture(TexelFormat::kRGBA32Sfloat, TextureShape::kArray2D, side, side, layers, 1, seed);
  if (layers == 4) {
    const auto spare = static_cast<ptrdiff_t>(band.weights.data.size() / 4);
    std::fill(band.weights.data.end() - spare, band.weights.data.end(), std::byte{0});
  }
  band.table = noiseTexture(TexelFormat::kRGBA32Sfloat, TextureShape::kVolume, 3, 3, 3, 1, seed + 1);
  return band;
}

Band gridBand(Domain domain, int mips, const DirectionGrid& grid, uint32_t seed) {
  Band band;
  band.domain = domain;
  band.y_quads = 1;
  band.ratio = domain == Domain::kFlat;
  band.chroma_quads = band.ratio ? 0 : 1;
  band.lambda_first = domain == Domain::kFlat ? 0.0f : 1.0f;
  band.window = domain == Domain::kFlat ? Window{-2, -1, 1, 2} : Window{1, 2, 1e4f, 2e4f};
  for (int quad = 0; quad < band.quads(); ++quad) {
    band.quad_scale.push_back(glm::vec4(0.5f, 0.25f, 0.1f, 1e-3f));
    band.quad_levels.push_back({float(quad) - kNoEnd, kNoEnd - float(quad)});
  }
  band.ratio_scale = {0.3f, 0.4f, 1, 1};
  const int side = domain == Domain::kFlat ? kSide : kSide / 2;
  band.weights =
      noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, side, side, band.layers(), mips, seed);
  band.table = noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kVolume, grid.phis,
                            grid.thetas * grid.thetas, band.quads() * grid.phis, 1, seed + 1);
  return band;
}

GeometryImage smallGeometry() {
  GeometryImage geometry;
  geometry.texels = noiseTexture(TexelFormat::kRGBA16Unorm, TextureShape::kArray2D, kSide, kSide, 1, 1, 50);
  geometry.range = {0.1f, 0.2f, 0.3f};
  return geometry;
}

void expectSame(const Texture& a, const Texture& b) {
  EXPECT_EQ(a.format, b.format);
  EXPECT_EQ(a.shape, b.shape);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.mips, b.mips);
  EXPECT_TRUE(a.data == b.data);
}

void expectSame(const DirectionSet& a, const DirectionSet& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.side, b.side);
  EXPECT_TRUE(a.samples == b.samples);
}

void expectSame(const Band& a, const Band& b) {
  EXPECT_EQ(a.domain, b.domain);
  EXPECT_EQ(a.filter, b.filter);
  EXPECT_EQ(a.layout, b.layout);
  EXPECT_EQ(a.window.in_begin, b.window.in_begin);
  EXPECT_EQ(a.window.in_end, b.window.in_end);
  EXPECT_EQ(a.window.out_begin, b.window.out_begin);
  EXPECT_EQ(a.window.out_end, b.window.out_end);
  EXPECT_EQ(a.lambda_first, b.lambda_first);
  EXPECT_EQ(a.y_quads, b.y_quads);
  EXPECT_EQ(a.chroma_quads, b.chroma_quads);
  EXPECT_EQ(a.ratio, b.ratio);
  EXPECT_EQ(a.lead_quads, b.lead_quads);
  EXPECT_TRUE(a.quad_scale == b.quad_scale);
  EXPECT_TRUE(a.quad_levels == b.quad_levels);
  EXPECT_TRUE(a.ratio_scale == b.ratio_scale);
  expectSame(a.weights, b.weights);
  expectSame(a.table, b.table);
}

void expectSameMaps(const Material& a, const Material& b) {
  expectSame(a.geometry.texels, b.geometry.texels);
  EXPECT_TRUE(a.geometry.range == b.geometry.range);
  EXPECT_EQ(a.geometry.identity_parameterization, b.geometry.identity_parameterization);
  EXPECT_TRUE(a.geometry.empty() || a.atlas == b.atlas);
  ASSERT_EQ(a.stored_vdim.has_value(), b.stored_vdim.has_value());
  if (a.stored_vdim) {
    EXPECT_EQ(a.stored_vdim->side, b.stored_vdim->side);
    EXPECT_EQ(a.stored_vdim->zeniths, b.stored_vdim->zeniths);
    EXPECT_EQ(a.stored_vdim->azimuths, b.stored_vdim->azimuths);
    EXPECT_TRUE(a.stored_vdim->range == b.stored_vdim->range);
    expectSame(a.stored_vdim->reference, b.stored_vdim->reference);
    expectSame(a.stored_vdim->packed, b.stored_vdim->packed);
  }
  ASSERT_EQ(a.surface.has_value(), b.surface.has_value());
  if (!a.surface) return;
  EXPECT_EQ(a.surface->lobe, b.surface->lobe);
  EXPECT_EQ(a.surface->visibility, b.surface->visibility);
  EXPECT_EQ(a.surface->specular_scale, b.surface->specular_scale);
  EXPECT_EQ(a.surface->ambient_first, b.surface->ambient_first);
  EXPECT_EQ(a.surface->fade_begin, b.surface->fade_begin);
  EXPECT_EQ(a.surface->fade_end, b.surface->fade_end);
  EXPECT_EQ(a.surface->lambda_first, b.surface->lambda_first);
  EXPECT_EQ(a.surface->tail_mip, b.surface->tail_mip);
  for (const SurfaceMapRow& row : kSurfaceMapRows)
    expectSame((*a.surface).*row.texture, (*b.surface).*row.texture);
}

Material plainMaterial(Mode mode, const char* name) {
  Material material;
  material.mode = mode;
  material.name = name;
  material.side = kSide;
  material.mean = {0.01f, 0.5f, 0.2f, 12, 0.01f, -0.02f, MeanChroma::kRatio};
  material.meta_json = "{\"cooked\":\"for a test, \xC3\xA9\"}\n";
  return material;
}

}  // namespace

Texture noiseTexture(TexelFormat format, TextureShape shape, int width, int height, int depth, int mips,
                     uint32_t seed) {
  Texture texture = Texture::make(format, shape, width, height, depth, mips);
  uint32_t state = seed * 2654435761u + 1;
  for (int mip = 0; mip < mips; ++mip) {
    for (int z = 0; z < depth; ++z) {
      for (int y = 0; y < texture.mipHeight(mip); ++y) {
        for (int x = 0; x < texture.mipWidth(mip); ++x) {
          glm::vec4 value;
          for (int c = 0; c < 4; ++c) {
            state = state * 1664525u + 1013904223u;
            value[c] = static_cast<float>(state >> 8) / 16777216.0f;
          }
          storeTexel(texture, mip, x, y, z, value);
        }
      }
    }
  }
  return texture;
}

Material surfaceMaterial() {
  Material material = plainMaterial(Mode::kSurface, "surface");
  material.geometry = smallGeometry();
  material.aspect = material.geometry.aspect = 0.75f;
  material.period = 0.02f;
  material.atlas = {24, 18};
  PaperVdim vdim;
  vdim.side = kSide;
  vdim.zeniths = 2;
  vdim.azimuths = 5;
  vdim.range = {0.5f, 1.5f};
  vdim.reference = noiseTexture(TexelFormat::kRG16Snorm, TextureShape::kArray2D, kSide, kSide, 1, 1, 60);
  vdim.packed =
      noiseTexture(TexelFormat::kRGBA16Snorm, TextureShape::kArray2D, kSide * 5, kSide * 2, 1, 1, 61);
  material.stored_vdim = vdim;
  SurfaceMaps maps;
  maps.normal = noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, kSide, kSide, 1, 4, 62);
  maps.color = noiseTexture(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, kSide, kSide, 1, 4, 63);
  maps.ambient = noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, kSide, kSide, 2, 4, 64);
  maps.specular_scale = 2;
  material.surface = maps;
  return material;
}

namespace {

void addShadow(SurfaceMaps& maps, int layers, uint32_t seed) {
  maps.shadow = noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, kSide, kSide, layers, 4, seed);
  maps.shadow_table =
      noiseTexture(TexelFormat::kRGBA16Sfloat, TextureShape::kArray2D, 5, 5, layers, 1, seed + 1);
  for (int d = 0; d < 25 * layers; ++d) {
    const glm::ivec3 at(d % 5, d / 5 % 5, d / 25);
    storeTexel(maps.shadow_table, 0, at.x, at.y, at.z,
               0.25f * fetchTexel(maps.shadow_table, 0, at.x, at.y, at.z));
  }
}

}  // namespace

Material lodMaterial() {
  Material material = plainMaterial(Mode::kLod, "lod");
  material.lambda_max = 2;
  material.lights = material.views = threeDirections();
  for (int level = 0; level < 3; ++level) material.bands.push_back(nearestBand(level, 10 + 2 * level));
  return material;
}

Material fusedMaterial() {
  Material material = plainMaterial(Mode::kFused, "fused");
  material.lambda_max = 5;
  material.geometry = smallGeometry();
  material.atlas = {24, 18};
  material.bands.push_back(gridBand(Domain::kFlat, 1, {3, 5, material.theta_max}, 30));
  material.bands.push_back(gridBand(Domain::kReference, 3, {4, 7, material.theta_max}, 40));
  return material;
}

Material nearMaterial() {
  Material material = fusedMaterial();
  material.name = "near";
  material.bands.erase(material.bands.begin());
  material.bands[0].window = {};
  SurfaceMaps maps = *surfaceMaterial().surface;
  maps.lobe = Lobe::kGgx;
  maps.visibility = Visibility::kFast;
  maps.lambda_first = -1;
  maps.fade_begin = 0.5f, maps.fade_end = 2.5f;
  maps.normal =
      noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, 2 * kSide, 2 * kSide, 1, 4, 65);
  maps.color = noiseTexture(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, 2 * kSide, 2 * kSide, 1, 4, 66);
  addShadow(maps, 1, 67);
  maps.indirect = noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, kSide, kSide, 2, 4, 71);
  material.surface = maps;
  return material;
}

Material splitFusedMaterial() {
  Material material = fusedMaterial();
  material.name = "split fused";
  Band& band = material.bands[1];
  band.y_quads = 2;
  band.ratio = true;
  band.lead_quads = 2;
  band.quad_scale.push_back(glm::vec4(0.02f));
  band.quad_levels = {{}, {0.25f, 2.5f}, {0.5f, 2.25f}};
  band.weights =
      noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, kSide / 2, kSide / 2, 5, 3, 44);
  for (int mip = 0; mip < 3; ++mip)
    for (int t = 0; t < band.weights.mipWidth(mip) * band.weights.mipHeight(mip); ++t)
      storeTexel(band.weights, mip, t % band.weights.mipWidth(mip), t / band.weights.mipWidth(mip), 4,
                 glm::vec4(0));
  band.table = noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kVolume, 7, 16, 3 * 7, 1, 45);
  return material;
}

Material splitSurfaceMaterial() {
  Material material = surfaceMaterial();
  material.name = "split surface";
  material.surface->tail_mip = 2;
  addShadow(*material.surface, 2, 69);
  material.surface->visibility = Visibility::kMap;
  material.surface->indirect =
      noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, kSide, kSide, 2, 4, 72);
  return material;
}

void expectSame(const Material& a, const Material& b) {
  EXPECT_EQ(a.mode, b.mode);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.side, b.side);
  EXPECT_EQ(a.lambda_min, b.lambda_min);
  EXPECT_EQ(a.lambda_max, b.lambda_max);
  EXPECT_EQ(a.value_scale, b.value_scale);
  EXPECT_EQ(a.cosine_included, b.cosine_included);
  EXPECT_EQ(a.theta_max, b.theta_max);
  EXPECT_EQ(a.aspect, b.aspect);
  EXPECT_EQ(a.geometry.aspect, b.geometry.aspect);
  EXPECT_EQ(a.period, b.period);
  EXPECT_EQ(a.mean.ka, b.mean.ka);
  EXPECT_EQ(a.mean.kd, b.mean.kd);
  EXPECT_EQ(a.mean.ks, b.mean.ks);
  EXPECT_EQ(a.mean.alpha, b.mean.alpha);
  EXPECT_EQ(a.mean.cb, b.mean.cb);
  EXPECT_EQ(a.mean.cr, b.mean.cr);
  EXPECT_EQ(a.mean.chroma, b.mean.chroma);
  EXPECT_EQ(a.meta_json, b.meta_json);
  expectSame(a.lights, b.lights);
  expectSame(a.views, b.views);
  ASSERT_EQ(a.bands.size(), b.bands.size());
  for (size_t i = 0; i < a.bands.size(); ++i) expectSame(a.bands[i], b.bands[i]);
  expectSameMaps(a, b);
}

}  // namespace loden::test
