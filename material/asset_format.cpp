#include "material/asset_format.h"

namespace loden {

std::string chunkName(uint32_t type) {
  std::string name;
  for (int i = 0; i < 4; ++i) {
    const char c = static_cast<char>(type >> 8 * i & 0xff);
    name += c >= ' ' && c <= '~' ? c : '?';
  }
  return name;
}

namespace asset {
namespace {

bool described(const Texture& texture) {
  return texture.width > 0;
}

template <class MaterialType>
auto texturesOf(MaterialType& material, const Part& part) {
  using TextureType = std::remove_reference_t<decltype((material.geometry.texels))>;
  std::vector<TextureType*> textures;
  if (part.type == kBand) {
    auto& band = material.bands[part.band];
    textures = {&band.weights, &band.table};
    if (band.light_quads > 0) textures.push_back(&band.light_table);
  } else if (part.type == kGeom) {
    textures = {&material.geometry.texels};
  } else if (part.type == kVdim) {
    textures = {&material.stored_vdim->reference, &material.stored_vdim->packed};
  } else if (part.type == kSurf) {
    textures = {&material.surface->normal, &material.surface->diffuse, &material.surface->specular};
  }
  return textures;
}

}  // namespace

std::vector<Part> partsOf(const Material& material) {
  std::vector<Part> parts = {{kHead}};
  int next_band = static_cast<int>(material.bands.size()) - 1;
  if (next_band >= 0 && material.bands[next_band].domain == Domain::kReference)
    parts.push_back({kBand, next_band--});
  if (described(material.geometry.texels)) parts.push_back({kGeom});
  if (material.stored_vdim) parts.push_back({kVdim});
  while (next_band >= 0) parts.push_back({kBand, next_band--});
  if (material.surface) parts.push_back({kSurf});
  if (!material.meta_json.empty()) parts.push_back({kMeta});
  return parts;
}

std::vector<Texture*> partTextures(Material& material, const Part& part) {
  return texturesOf(material, part);
}
std::vector<const Texture*> partTextures(const Material& material, const Part& part) {
  return texturesOf(material, part);
}

uint64_t partBytes(const Material& material, const Part& part) {
  uint64_t bytes = 0;
  for (const Texture* t : partTextures(material, part)) {
    bytes += textureBytes(t->format, t->width, t->height, t->depth, t->mips);
  }
  return bytes;
}

}  // namespace asset
}  // namespace loden
