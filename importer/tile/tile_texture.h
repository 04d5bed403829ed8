// Textures from which a tile's reflectance is read at the point that a ray hits.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

namespace loden::importer {

// A texture and its sampler (glTF 2.0, sections 3.8 and 5.26).
struct TileTexture {
  enum class Wrap : uint8_t { kRepeat, kClamp, kMirror };
  int width = 0, height = 0;      // texels, at least 1
  std::vector<glm::vec3> texels;  // row-major, row 0 at v = 0; linear values, 0 to 1
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  bool nearest = false;  // nearest-texel filter; otherwise bilinear
};

// A metallic-roughness material (glTF 2.0, section 5.22): each factor is multiplied by its texture, or counts
// alone if that is null.
struct TileMaterial {
  std::string name;
  glm::vec3 base_color{1};  // linear RGB
  float metallic = 1, roughness = 1;
  std::shared_ptr<const TileTexture> base_color_texture;
  std::shared_ptr<const TileTexture> metallic_roughness_texture;  // roughness in G, metallic in B
};

// The texture coordinates of a vertex in its material's textures; the three vertices of a triangle have one
// material.
struct TexturePoint {
  static constexpr uint32_t kNone = 0xFFFFFFFFu;
  uint32_t material = kNone;  // index into the tile's materials; kNone: not textured
  glm::dvec2 base_color{0};   // texture coordinates, v downwards, with transforms applied
  glm::dvec2 metallic_roughness{0};
  bool operator==(const TexturePoint&) const = default;
};

// The linear value at the texture coordinate uv, which must be finite.
glm::vec3 sampleTexture(const TileTexture& texture, glm::dvec2 uv);

}  // namespace loden::importer
