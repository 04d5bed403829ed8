#include "material/model/leading_part.h"

#include <algorithm>
#include <cmath>

#include "material/model/environment.h"

namespace loden {
namespace {

// Without texels.
Texture described(const Texture& t, int width, int height, int depth, int mips) {
  return {t.format, t.shape, width, height, depth, mips, {}};
}

// Appends layers [first, first + count) of one mip.
void appendLayers(const Texture& from, int mip, int first, int count, std::vector<std::byte>& into) {
  const size_t layer = from.mipBytes(mip) / size_t(from.depth);
  const auto begin = from.data.begin() + ptrdiff_t(from.mipOffset(mip) + size_t(first) * layer);
  into.insert(into.end(), begin, begin + ptrdiff_t(size_t(count) * layer));
}

Texture tailOf(const Texture& map, int mip) {
  if (map.width == 0) return map;
  Texture tail = described(map, map.mipWidth(mip), map.mipHeight(mip), map.depth, map.mips - mip);
  if (!map.empty()) tail.data.assign(map.data.begin() + ptrdiff_t(map.mipOffset(mip)), map.data.end());
  return tail;
}

}  // namespace

Band leadOf(const Band& band) {
  if (band.lead_quads == 0) return band;
  Band lead;
  lead.domain = band.domain;
  lead.filter = band.filter;
  lead.layout = band.layout;
  lead.window = band.window;
  lead.lambda_first = band.lambda_first;
  lead.y_quads = band.lead_quads;
  lead.ratio = band.ratio;
  lead.quad_scale.assign(band.quad_scale.begin(), band.quad_scale.begin() + band.lead_quads);
  lead.quad_levels.assign(band.quad_levels.begin(), band.quad_levels.begin() + band.lead_quads);
  lead.ratio_scale = band.ratio_scale;
  const Texture &weights = band.weights, &table = band.table;
  const int slices = table.depth / band.quads() * band.lead_quads;
  lead.weights = described(weights, weights.width, weights.height, lead.layers(), weights.mips);
  lead.table = described(table, table.width, table.height, slices, 1);
  for (int mip = 0; mip < weights.mips && !weights.empty(); ++mip) {
    appendLayers(weights, mip, 0, band.lead_quads, lead.weights.data);
    if (band.ratio) appendLayers(weights, mip, band.quads(), 1, lead.weights.data);
  }
  if (!table.empty()) appendLayers(table, 0, 0, slices, lead.table.data);
  return lead;
}

SurfaceMaps withoutShadow(SurfaceMaps maps) {
  maps.shadow = maps.shadow_table = {};
  return maps;
}

int tailMip(const SurfaceMaps& maps, const SurfaceMapRow& row) {
  if (!row.first) return 0;
  const float finest = maps.lambda_first + float(maps.tail_mip) - maps.*row.first;
  return std::clamp(static_cast<int>(std::lround(finest)), 0, (maps.*row.texture).mips - 1);
}

SurfaceMaps tailOf(const SurfaceMaps& maps) {
  SurfaceMaps tail;
  for (const SurfaceMapRow& row : kSurfaceMapRows) {
    tail.*row.texture = tailOf(maps.*row.texture, tailMip(maps, row));
    if (row.first && (maps.*row.texture).width > 0)
      tail.*row.first = maps.*row.first + float(tailMip(maps, row));
  }
  tail.lobe = maps.lobe;
  tail.specular_scale = maps.specular_scale;
  tail.fade_begin = maps.fade_begin, tail.fade_end = maps.fade_end;
  tail.visibility = maps.visibility;
  return tail;
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
    while (maps.tail_mip < last && gpuBytes(tailOf(maps)) > kLeadingPartBytes) ++maps.tail_mip;
    if (gpuBytes(tailOf(maps)) > kLeadingPartBytes) maps.tail_mip = 0;
  }
}

uint64_t leadingPartBytes(const Material& material) {
  uint64_t bytes = 0;
  for (const Band& band : material.bands)
    if (band.lead_quads > 0) bytes += gpuBytes(leadOf(band));
  if (material.surface && material.surface->tail_mip > 0) bytes += gpuBytes(tailOf(*material.surface));
  return bytes;
}

}  // namespace loden
