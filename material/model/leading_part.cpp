#include "material/model/leading_part.h"

#include <algorithm>
#include <cmath>

#include "material/model/environment.h"

namespace loden {
namespace {

// Layers or slices [first, end) of one mip.
TexelRun layerRun(size_t texture, const Texture& t, int mip, int first, int end) {
  const uint64_t layer = textureBytes(t.format, t.mipWidth(mip), t.mipHeight(mip), 1, 1);
  return {texture, t.mipOffset(mip) + first * layer, (end - first) * layer};
}

// Leaves of a texture's data what the leading part of the whole has of it.
template <class Whole>
void keepLead(const Whole& whole, size_t texture, Texture& t) {
  if (t.empty()) return;
  std::vector<std::byte> data;
  for (const TexelRun& run : leadRuns(whole)) {
    const auto from = t.data.begin() + ptrdiff_t(run.offset);
    if (run.texture == texture) data.insert(data.end(), from, from + ptrdiff_t(run.bytes));
  }
  t.data = std::move(data);
}

// The mip of a map whose level is that of tail_mip of normal and color, or the nearest that there is; 0 of
// tables.
int tailMip(const SurfaceMaps& maps, const SurfaceMapRow& row) {
  if (!row.first) return 0;
  const float finest = maps.lambda_first + float(maps.tail_mip) - maps.*row.first;
  return std::clamp(static_cast<int>(std::lround(finest)), 0, (maps.*row.texture).mips - 1);
}

}  // namespace

std::vector<TexelRun> leadRuns(const Band& band) {
  std::vector<TexelRun> runs;
  if (band.lead_quads == 0) return runs;
  for (int mip = 0; mip < band.weights.mips; ++mip) {
    runs.push_back(layerRun(0, band.weights, mip, 0, band.lead_quads));
    runs.push_back(layerRun(0, band.weights, mip, band.quads(), band.layers()));  // the ratio layer
  }
  runs.push_back(layerRun(1, band.table, 0, 0, band.table.depth / band.quads() * band.lead_quads));
  return runs;
}

std::vector<TexelRun> leadRuns(const SurfaceMaps& maps) {
  std::vector<TexelRun> runs;
  if (maps.tail_mip == 0) return runs;
  for (const SurfaceMapRow& row : kSurfaceMapRows)
    if (const Texture& map = maps.*row.texture; map.width > 0) {
      const uint64_t offset = map.mipOffset(tailMip(maps, row));
      runs.push_back({runs.size(), offset, textureBytes(map) - offset});
    }
  return runs;
}

Band leadOf(const Band& band) {
  if (band.lead_quads == 0) return band;
  Band lead = band;
  keepLead(band, 0, lead.weights);
  keepLead(band, 1, lead.table);
  lead.y_quads = band.lead_quads, lead.chroma_quads = lead.lead_quads = 0;
  lead.quad_scale.resize(size_t(lead.y_quads));
  lead.quad_levels.resize(size_t(lead.y_quads));
  lead.weights.depth = lead.layers();
  lead.table.depth = band.table.depth / band.quads() * lead.y_quads;
  return lead;
}

SurfaceMaps leadOf(const SurfaceMaps& maps) {
  if (maps.tail_mip == 0) return maps;
  SurfaceMaps lead = maps;
  size_t texture = 0;
  for (const SurfaceMapRow& row : kSurfaceMapRows) {
    Texture& map = lead.*row.texture;
    if (map.width == 0) continue;
    const int mip = tailMip(maps, row);
    keepLead(maps, texture++, map);
    map.width = map.mipWidth(mip), map.height = map.mipHeight(mip), map.mips -= mip;
    if (row.first) lead.*row.first = maps.*row.first + float(mip);
  }
  lead.tail_mip = 0;
  return lead;
}

SurfaceMaps withoutShadow(SurfaceMaps maps) {
  maps.shadow = maps.shadow_table = {};
  return maps;
}

uint64_t gpuBytes(const Band& band) {
  return textureBytes(band.weights) + textureBytes(band.table) + environmentTableBytes(band);
}
uint64_t gpuBytes(const SurfaceMaps& maps) {
  uint64_t bytes = 0;
  for (const SurfaceMapRow& row : kSurfaceMapRows)
    if ((maps.*row.texture).width > 0) bytes += textureBytes(maps.*row.texture);
  return bytes;
}

void splitLeadingParts(Material& material) {
  if (!material.bands.empty() && material.bands.back().domain == Domain::kReference) {
    Band& band = material.bands.back();
    const auto fits = [&](int quads) {
      band.lead_quads = quads;
      return gpuBytes(leadOf(band)) <= kLeadingPartBytes;
    };
    int lead = 0;
    if (gpuBytes(band) > kLeadingPartBytes)
      while (lead < band.y_quads && lead + 1 < band.quads() && fits(lead + 1)) ++lead;
    band.lead_quads = lead;
  }
  if (material.surface) {
    SurfaceMaps& maps = *material.surface;
    const int last = material.bands.empty() ? std::min(maps.normal.mips, maps.color.mips) - 1 : 0;
    maps.tail_mip = 0;
    while (maps.tail_mip < last && gpuBytes(leadOf(maps)) > kLeadingPartBytes) ++maps.tail_mip;
    if (gpuBytes(leadOf(maps)) > kLeadingPartBytes) maps.tail_mip = 0;
  }
}

uint64_t leadingPartBytes(const Material& material) {
  uint64_t bytes = 0;
  for (const Band& band : material.bands)
    if (band.lead_quads > 0) bytes += gpuBytes(leadOf(band));
  if (material.surface && material.surface->tail_mip > 0) bytes += gpuBytes(leadOf(*material.surface));
  return bytes;
}

}  // namespace loden
