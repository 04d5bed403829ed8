#include "material/model/maps.h"

namespace loden {
namespace {

// `MaterialType`: const or not, as the textures of the result are.
template <class TextureType, class MaterialType>
std::vector<NamedMap<TextureType>> listMaps(MaterialType& material, const MaterialPart& part) {
  std::vector<NamedMap<TextureType>> maps;
  switch (part.kind) {
    case PartKind::kBand: {
      auto& band = material.bands[size_t(part.band)];
      maps = {{"weights", &band.weights}, {"table", &band.table}};
      break;
    }
    case PartKind::kGeometry:
      maps = {{"geometry", &material.geometry.texels}};
      break;
    case PartKind::kStoredVdim:
      maps = {{"reference", &material.stored_vdim->reference}, {"packed", &material.stored_vdim->packed}};
      break;
    case PartKind::kSurface:
      for (const SurfaceMapRow& row : kSurfaceMapRows)
        if (auto& map = (*material.surface).*row.texture; map.width > 0) maps.push_back({row.name, &map});
      break;
  }
  return maps;
}

}  // namespace

std::vector<MaterialPart> materialParts(const Material& material) {
  std::vector<MaterialPart> parts;
  if (material.geometry.texels.width > 0) parts.push_back({PartKind::kGeometry});
  for (int band = static_cast<int>(material.bands.size()); band-- > 0;)
    parts.push_back({PartKind::kBand, band});
  if (material.stored_vdim) parts.push_back({PartKind::kStoredVdim});
  if (material.surface) parts.push_back({PartKind::kSurface});
  return parts;
}

std::vector<NamedMap<Texture>> mapsOf(Material& material, const MaterialPart& part) {
  return listMaps<Texture>(material, part);
}
std::vector<NamedMap<const Texture>> mapsOf(const Material& material, const MaterialPart& part) {
  return listMaps<const Texture>(material, part);
}

std::string mapName(const MaterialPart& part, const char* name) {
  if (part.kind == PartKind::kBand) return "band" + std::to_string(part.band) + "." + name;
  if (part.kind == PartKind::kStoredVdim) return std::string("vdim.") + name;
  return name;
}

uint64_t mapBytes(const Material& material, const MaterialPart& part) {
  uint64_t bytes = 0;
  for (const auto& map : mapsOf(material, part)) bytes += textureBytes(*map.texture);
  return bytes;
}

}  // namespace loden
