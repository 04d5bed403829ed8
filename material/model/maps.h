// The list of everything that a material stores as textures. Code that stores, loads, lists, measures or
// counts maps iterates over it.
#pragma once

#include <string>
#include <vector>

#include "material/model/material.h"

namespace loden {

// A part of a material: maps that are stored one after the other and loaded together.
enum class PartKind : uint8_t { kBand, kGeometry, kStoredVdim, kSurface };
struct MaterialPart {
  PartKind kind = PartKind::kBand;
  int band = -1;  // index in Material::bands for PartKind::kBand, else -1
  friend bool operator==(const MaterialPart&, const MaterialPart&) = default;
};

// The parts that the material has: geometry, bands from the coarsest on, stored VDIM, surface maps.
std::vector<MaterialPart> materialParts(const Material& material);

// One map of a part, and its name within the part.
template <class TextureType>
struct NamedMap {
  const char* name;
  TextureType* texture;
};
// The maps of a part of the material, in the order in which they are stored. Maps that are absent are left
// out.
std::vector<NamedMap<Texture>> mapsOf(Material& material, const MaterialPart& part);
std::vector<NamedMap<const Texture>> mapsOf(const Material& material, const MaterialPart& part);

// The map's name within the material: "geometry", "band0.weights", "vdim.packed", "normal" ...
std::string mapName(const MaterialPart& part, const char* name);

// The number of bytes that the part's texels take.
uint64_t mapBytes(const Material& material, const MaterialPart& part);

}  // namespace loden
