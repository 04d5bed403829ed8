#include "material/asset/asset_format.h"

#include <algorithm>
#include <iterator>

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

// One per PartKind.
constexpr uint32_t kPartTypes[] = {kBand, kGeom, kVdim, kSurf};

template <class TextureType, class MaterialType>
std::vector<TextureType*> texturesOf(MaterialType& material, const Part& part) {
  std::vector<TextureType*> textures;
  const auto* const type = std::find(std::begin(kPartTypes), std::end(kPartTypes), part.type);
  if (type == std::end(kPartTypes)) return textures;
  const auto kind = static_cast<PartKind>(type - kPartTypes);
  for (const auto& map : mapsOf(material, {kind, part.band})) textures.push_back(map.texture);
  return textures;
}

// What the part holds, in the order of its raw bytes: the leading part's runs, or what they leave over.
std::vector<TexelRun> runsOf(const Material& material, const Part& part) {
  std::vector<TexelRun> lead, rest;
  if (part.type == kBand) lead = leadRuns(material.bands[part.band]);
  if (part.type == kSurf) lead = leadRuns(*material.surface);
  if (!part.rest && !lead.empty()) return lead;
  const std::vector<const Texture*> textures = partTextures(material, part);
  for (size_t i = 0, next = 0; i < textures.size(); ++i) {
    uint64_t at = 0;
    for (; next < lead.size() && lead[next].texture == i; ++next) {
      rest.push_back({i, at, lead[next].offset - at});
      at = lead[next].offset + lead[next].bytes;
    }
    rest.push_back({i, at, textureBytes(*textures[i]) - at});
  }
  return rest;
}

}  // namespace

std::vector<Part> partsOf(const Material& material, uint32_t type, int band, Share share) {
  const bool split = type == kBand   ? material.bands[band].lead_quads > 0
                     : type == kSurf ? material.surface && material.surface->tail_mip > 0
                                     : false;
  std::vector<Part> parts = {{type, band}};
  if (split && share == Share::kWhole) parts.push_back({type, band, true});
  return parts;
}

std::vector<Part> partsOf(const Material& material) {
  std::vector<Part> parts = {{kHead}};
  const auto add = [&](uint32_t type, int band = -1) {
    for (const Part& part : partsOf(material, type, band)) parts.push_back(part);
  };
  int next_band = static_cast<int>(material.bands.size()) - 1;
  if (next_band >= 0 && material.bands[next_band].domain == Domain::kReference) add(kBand, next_band--);
  if (described(material.geometry.texels)) add(kGeom);
  if (material.stored_vdim) add(kVdim);
  while (next_band >= 0) add(kBand, next_band--);
  if (material.surface) add(kSurf);
  if (!material.meta_json.empty()) add(kMeta);
  return parts;
}

uint32_t chunkTypeOf(PartKind kind) {
  return kPartTypes[static_cast<size_t>(kind)];
}

std::vector<Texture*> partTextures(Material& material, const Part& part) {
  return texturesOf<Texture>(material, part);
}
std::vector<const Texture*> partTextures(const Material& material, const Part& part) {
  return texturesOf<const Texture>(material, part);
}

uint64_t partBytes(const Material& material, const Part& part) {
  uint64_t bytes = 0;
  for (const TexelRun& run : runsOf(material, part)) bytes += run.bytes;
  return bytes;
}

std::vector<std::byte> gatherTexels(const Material& material, const Part& part) {
  const std::vector<const Texture*> textures = partTextures(material, part);
  std::vector<std::byte> raw;
  raw.reserve(partBytes(material, part));
  for (const TexelRun& run : runsOf(material, part)) {
    const auto from = textures[run.texture]->data.begin() + static_cast<ptrdiff_t>(run.offset);
    raw.insert(raw.end(), from, from + static_cast<ptrdiff_t>(run.bytes));
  }
  return raw;
}

void scatterTexels(std::span<const std::byte> raw, const Part& part, Material& material) {
  const std::vector<Texture*> textures = partTextures(material, part);
  for (Texture* t : textures) t->data.resize(textureBytes(*t));
  for (const TexelRun& run : runsOf(material, part)) {
    std::copy_n(raw.begin(), run.bytes,
                textures[run.texture]->data.begin() + static_cast<ptrdiff_t>(run.offset));
    raw = raw.subspan(run.bytes);
  }
}

}  // namespace asset
}  // namespace loden
