// The leading part of a band or of surface maps: what is stored first, and shown alone if there is no room
// for more. For a band it is the band's first quads with the ratio layer, which have the right colour and
// average. For surface maps it is their coarser mips.
#pragma once

#include "material/model/material.h"

namespace loden {

// How much of a band or of surface maps: the leading part or everything. If they are not split, kLead means
// everything too.
enum class Share { kLead, kWhole };

// A run of consecutive bytes in the data of one texture.
struct TexelRun {
  // For a band 0 is the weights and 1 the table; for surface maps it is the index among the maps that are
  // present.
  size_t texture = 0;
  uint64_t offset = 0, bytes = 0;
};

// The byte ranges of the leading part's texels, in the order in which they are stored; the rest is everything
// else. Empty if the band or the maps are not split.
std::vector<TexelRun> leadRuns(const Band& band);
std::vector<TexelRun> leadRuns(const SurfaceMaps& maps);

// The band or the maps that consist of the leading part alone; a copy if they are not split. The result is
// not split. It has no texels if the whole has none.
Band leadOf(const Band& band);
SurfaceMaps leadOf(const SurfaceMaps& maps);

// Bytes on the GPU. For a band they include environmentTable, which the runtime computes for it.
uint64_t gpuBytes(const Band& band);
uint64_t gpuBytes(const SurfaceMaps& maps);

// The most GPU memory that a leading part takes.
inline constexpr uint64_t kLeadingPartBytes = 64u << 10;

// Splits the material's bands and maps as cooked assets do, by setting Band::lead_quads and
// SurfaceMaps::tail_mip. The coarsest band is split if it lies in the reference domain and takes more than
// kLeadingPartBytes: its leading part has as many quads as fit into these. Surface maps that take more, in
// materials without bands, are split at the first mip from which on they fit. What fits as a whole, or does
// not fit even when split, is not split.
void splitLeadingParts(Material& material);

// Bytes on the GPU of all leading parts, which stay there beside the whole parts.
uint64_t leadingPartBytes(const Material& material);

}  // namespace loden
