// The leading part of a band or of surface maps: what is stored first, and shown where there is room for no
// more. Of a band it is the band that its first quads make with the ratio layer, right in colour and in the
// average; of surface maps their coarser mips.
#pragma once

#include "material/model/material.h"

namespace loden {

// The band of the first lead_quads quads, or of all if it is 0; not split itself. Without texels if `band`
// has none.
Band leadOf(const Band& band);

// The maps from mip tail_mip on, whose lambda_first says so; not split themselves. Without texels if `maps`
// have none.
SurfaceMaps tailOf(const SurfaceMaps& maps);
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
