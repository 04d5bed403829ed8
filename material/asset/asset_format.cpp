#include "material/asset/asset_format.h"

#include <algorithm>

#include "material/model/leading_part.h"

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
  } else if (part.type == kGeom) {
    textures = {&material.geometry.texels};
  } else if (part.type == kVdim) {
    textures = {&material.stored_vdim->reference, &material.stored_vdim->packed};
  } else if (part.type == kSurf) {
    for (const SurfaceMapRow& row : kSurfaceMapRows)
      if (auto& map = (*material.surface).*row.texture; described(map)) textures.push_back(&map);
  }
  return textures;
}

// Bytes of a part that stand together in one texture's data.
struct TexelRun {
  size_t texture = 0;  // index into partTextures
  uint64_t offset = 0, bytes = 0;
};

// Layers or slices [first, end) of one mip.
TexelRun layersOf(size_t texture, const Texture& t, int mip, uint64_t first, uint64_t end) {
  const uint64_t layer = textureBytes(t.format, t.mipWidth(mip), t.mipHeight(mip), 1, 1);
  return {texture, t.mipOffset(mip) + first * layer, (end - first) * layer};
}

TexelRun mipsOf(size_t texture, const Texture& t, int first, int end) {
  return {texture, t.mipOffset(first), t.mipOffset(end) - t.mipOffset(first)};
}

std::vector<TexelRun> splitBandRuns(const Band& band, bool lead) {
  const Texture &weights = band.weights, &table = band.table;
  const uint64_t first = band.lead_quads, quads = band.quads(), layers = band.layers(), depth = weights.depth;
  const uint64_t slices = table.depth / quads;
  std::vector<TexelRun> runs;
  for (int mip = 0; mip < weights.mips; ++mip) {
    runs.push_back(layersOf(0, weights, mip, lead ? 0 : first, lead ? first : quads));
    runs.push_back(
        layersOf(0, weights, mip, lead ? quads : layers, lead ? layers : depth));  // ratio; spare layers
  }
  runs.push_back(layersOf(1, table, 0, lead ? 0 : first * slices, (lead ? first : quads) * slices));
  return runs;
}

// In the order of a part's raw bytes.
std::vector<TexelRun> runsOf(const Material& material, const Part& part) {
  using enum Part::Share;
  if (part.type == kBand && part.share != kWhole)
    return splitBandRuns(material.bands[part.band], part.share == kLead);
  const std::vector<const Texture*> textures = partTextures(material, part);
  std::vector<TexelRun> runs;
  if (part.share == kWhole) {
    for (size_t i = 0; i < textures.size(); ++i)
      runs.push_back(mipsOf(i, *textures[i], 0, textures[i]->mips));
    return runs;
  }
  for (const SurfaceMapRow& row : kSurfaceMapRows) {
    const Texture& map = (*material.surface).*row.texture;
    if (!described(map)) continue;
    const int tail = tailMip(*material.surface, row);
    const bool rest = part.share == kRest;
    runs.push_back(mipsOf(runs.size(), map, rest ? 0 : tail, rest ? tail : map.mips));
  }
  return runs;
}

void addParts(std::vector<Part>& parts, const Material& material, uint32_t type, int band = -1) {
  parts.push_back(firstPart(material, type, band));
  if (parts.back().share == Part::Share::kLead) parts.push_back({type, band, Part::Share::kRest});
}

}  // namespace

Part firstPart(const Material& material, uint32_t type, int band) {
  const bool split = type == kBand   ? material.bands[band].lead_quads > 0
                     : type == kSurf ? material.surface && material.surface->tail_mip > 0
                                     : false;
  return {type, band, split ? Part::Share::kLead : Part::Share::kWhole};
}

std::vector<Part> partsOf(const Material& material) {
  std::vector<Part> parts = {{kHead}};
  int next_band = static_cast<int>(material.bands.size()) - 1;
  if (next_band >= 0 && material.bands[next_band].domain == Domain::kReference)
    addParts(parts, material, kBand, next_band--);
  if (described(material.geometry.texels)) parts.push_back({kGeom});
  if (material.stored_vdim) parts.push_back({kVdim});
  while (next_band >= 0) addParts(parts, material, kBand, next_band--);
  if (material.surface) addParts(parts, material, kSurf);
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
