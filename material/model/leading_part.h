// The leading part of a band or of surface maps: what is stored first, and shown where there is room for no
// more. Of a band it is the band that its first quads make with the ratio layer, right in colour and in the
// average; of surface maps their coarser mips.
#pragma once

#include "material/model/material.h"

namespace loden {

// How much of a band or of surface maps; of what is not split either is all.
enum class Share { kLead, kWhole };

// Bytes that stand together in the data of one texture.
struct TexelRun {
  size_t texture =
      0;  // of a band 0 the weights, 1 the table; of surface maps the place among those there are
  uint64_t offset = 0, bytes = 0;
};

// The leading part's texels, in the order in which they are stored; the rest is what they leave over. Nothing
// if the band or the maps are not split.
std::vector<TexelRun> leadRuns(const Band& band);
std::vector<TexelRun> leadRuns(const SurfaceMaps& maps);

// The band or the maps that the leading part makes; of what is not split, all. Not split themselves. Without
// texels if the whole has none.
Band leadOf(const Band& band);
SurfaceMaps leadOf(const SurfaceMaps& maps);

// Bytes on the GPU, with the table for light from all around that a band is given there.
uint64_t gpuBytes(const Band& band);
uint64_t gpuBytes(const SurfaceMaps& maps);

// A leading part takes at most this much of GPU memory.
inline constexpr uint64_t kLeadingPartBytes = 64u << 10;

// Sets lead_quads and tail_mip as cooked assets have them. Of the coarsest band, if it lies in the reference
// domain and takes more than kLeadingPartBytes: as many quads as fit into these. Of surface maps that take
// more, in materials without bands: the first mip from which they fit. What fits as a whole, or not at all,
// is not split.
void splitLeadingParts(Material& material);

// Bytes on the GPU of all leading parts, which stay there beside the whole.
uint64_t leadingPartBytes(const Material& material);

}  // namespace loden
