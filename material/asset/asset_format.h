// The fixed numbers of the container and the order of its parts (material/FORMAT.md). Internal.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "material/asset/asset.h"
#include "material/model/leading_part.h"
#include "material/model/maps.h"

namespace loden::asset {

// The first bytes of the file, built like those of PNG and KTX2: a byte that is not ASCII, a name, and line
// ends that text-mode copies would damage.
inline constexpr std::array<uint8_t, 12> kMagic = {0xAB, 'L',  'O',  'D',  'E',  'N',
                                                   '1',  0xBB, '\r', '\n', 0x1A, '\n'};
inline constexpr uint16_t kMajor = 1;
inline constexpr uint16_t kMinor = 0;

inline constexpr size_t kPreambleBytes = 32;  // bytes before the chunk table
inline constexpr size_t kEntryBytes = 48;     // bytes of one entry of the chunk table
static_assert(kPreambleBytes + AssetLimits::kMaxChunks * kEntryBytes <= AssetLimits::kTableEnd);
static_assert(kPreambleBytes + (AssetLimits::kMaxChunks + 1) * kEntryBytes > AssetLimits::kTableEnd);

constexpr uint32_t fourCharacters(const char (&name)[5]) {
  return uint32_t(name[0]) | uint32_t(name[1]) << 8 | uint32_t(name[2]) << 16 | uint32_t(name[3]) << 24;
}
inline constexpr uint32_t kHead = fourCharacters("HEAD");  // everything except texels
inline constexpr uint32_t kBand =
    fourCharacters("BAND");  // texels of one band or a share of it: weights, then table
inline constexpr uint32_t kGeom = fourCharacters("GEOM");  // texels of the geometry image
inline constexpr uint32_t kVdim =
    fourCharacters("VDIM");  // texels of the stored VDIM: reference, then packed
inline constexpr uint32_t kSurf =
    fourCharacters("SURF");  // texels of the surface maps, in the order of kSurfaceMapRows
inline constexpr uint32_t kMeta = fourCharacters("META");  // Material::meta_json

inline constexpr uint32_t kFlagCritical = 1;
inline constexpr uint32_t kCodecStored = 0;
inline constexpr uint32_t kCodecZstd = 1;

// Bits of the header's `parts` field.
inline constexpr uint32_t kPartGeometry = 1;
inline constexpr uint32_t kPartStoredVdim = 2;
inline constexpr uint32_t kPartSurface = 4;

constexpr uint64_t alignUp(uint64_t offset) {
  return (offset + AssetLimits::kAlignment - 1) / AssetLimits::kAlignment * AssetLimits::kAlignment;
}

// One chunk that this version knows; `band` indexes Material::bands for kBand, else -1. A split band, or
// split surface maps, are two chunks: the leading part (material/model/leading_part.h), and the rest.
struct Part {
  uint32_t type = 0;
  int band = -1;
  bool rest = false;
  friend bool operator==(const Part&, const Part&) = default;
};

// The parts of a material's file, in file order: HEAD, the coarsest band, the maps that find p, the finer
// bands, the surface maps, META. The maps that find p come before the coarsest band if that band is read at p
// too.
std::vector<Part> partsOf(const Material& material);

// The parts of one band, or of one other chunk type, in file order.
std::vector<Part> partsOf(const Material& material, uint32_t type, int band = -1,
                          Share share = Share::kWhole);

// The chunk type of a part's maps.
uint32_t chunkTypeOf(PartKind kind);

// The textures of which a part holds all or some texels, in order. Empty for kHead and kMeta.
std::vector<Texture*> partTextures(Material& material, const Part& part);
std::vector<const Texture*> partTextures(const Material& material, const Part& part);

// The number of raw bytes of a part, computed from the textures' extents.
uint64_t partBytes(const Material& material, const Part& part);

// Copies between a part's raw bytes and textures. gatherTexels needs textures whose data is complete;
// scatterTexels writes into data that is given its full size.
std::vector<std::byte> gatherTexels(const Material& material, const Part& part);
void scatterTexels(std::span<const std::byte> raw, const Part& part, Material& material);

}  // namespace loden::asset
