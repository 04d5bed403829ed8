#include "importer/tile/tile_texture.h"

#include <algorithm>
#include <cmath>

#include "importer/tile/mesh_material.h"
#include "importer/tile/textured_brdf.h"

namespace loden::importer {
namespace {

// Texel that coordinate `at` (in texels, any whole number) reads.
int wrappedTexel(double at, int size, TileTexture::Wrap wrap) {
  if (wrap == TileTexture::Wrap::kClamp) return static_cast<int>(std::clamp(at, 0.0, double(size - 1)));
  const int period = wrap == TileTexture::Wrap::kMirror ? 2 * size : size;
  // Clamped: of large numbers the difference is rounded.
  const int texel =
      static_cast<int>(std::clamp(at - period * std::floor(at / period), 0.0, double(period - 1)));
  return texel < size ? texel : period - 1 - texel;
}

}  // namespace

glm::vec3 sampleTexture(const TileTexture& t, glm::dvec2 uv) {
  const glm::dvec2 at = uv * glm::dvec2(t.width, t.height) - (t.nearest ? 0.0 : 0.5), base = glm::floor(at);
  const auto texel = [&](int dx, int dy) {
    return t.texels[size_t(wrappedTexel(base.y + dy, t.height, t.wrap_v)) * size_t(t.width) +
                    size_t(wrappedTexel(base.x + dx, t.width, t.wrap_u))];
  };
  if (t.nearest) return texel(0, 0);
  const glm::vec2 f(at - base);
  return glm::mix(glm::mix(texel(0, 0), texel(1, 0), f.x), glm::mix(texel(0, 1), texel(1, 1), f.x), f.y);
}

LocalBrdf brdfAt(const TileMaterial& m, glm::dvec2 base_color, glm::dvec2 metallic_roughness) {
  const glm::vec3 tint =
      m.base_color_texture ? sampleTexture(*m.base_color_texture, base_color) : glm::vec3(1);
  const glm::vec3 surface = m.metallic_roughness_texture
                                ? sampleTexture(*m.metallic_roughness_texture, metallic_roughness)
                                : glm::vec3(1);
  return brdfFromMetallicRoughness(m.base_color * tint, m.metallic * surface.b, m.roughness * surface.g);
}

void readTextures(std::span<const TileMaterial> materials, std::span<const TexturePoint> points,
                  const glm::uvec3& corners, glm::dvec2 b, LocalBrdf& brdf) {
  const uint32_t material = points[corners.x].material;
  if (material == TexturePoint::kNone) return;
  const double weights[3] = {1 - b.x - b.y, b.x, b.y};
  glm::dvec2 base_color(0), metallic_roughness(0);
  for (int k = 0; k < 3; ++k) {
    base_color += weights[k] * points[corners[k]].base_color;
    metallic_roughness += weights[k] * points[corners[k]].metallic_roughness;
  }
  brdf = brdfAt(materials[material], base_color, metallic_roughness);
}

}  // namespace loden::importer
