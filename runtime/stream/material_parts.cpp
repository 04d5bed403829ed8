#include "runtime/stream/material_parts.h"

#include <algorithm>
#include <cmath>

#include "material/base/issues.h"
#include "material/model/environment.h"
#include "material/model/leading_part.h"
#include "material/system/threads.h"
#include "runtime/stream/material_data.h"
#include "shaders/loden_shared.h"

namespace loden::runtime {
namespace {

// Bands without an end, and the coarsest, are needed everywhere.
float bandEnd(const Material& material, const Band& band) {
  return std::min(band.window.out_end, material.lambda_max + coarsestFade(material));
}

// Where the near term of a material with bands is needed; nobody demands less than lambda 0.
float nearEnd(const Material& material) {
  return std::clamp(material.surface->fade_end, 1.0f, std::max(material.lambda_max, 0.0f) + 1);
}

// Where the lookup is seen at all: everywhere if it changes the parameterization; else where parallax is a
// quarter of a texel shown or more, at slopes up to 11 (85 degrees); material/model/vdim.h.
float parallaxEnd(const Material& material) {
  if (!material.geometry.identity_parameterization) return material.lambda_max + 1;
  const glm::dvec2 scale = periodsPerLength(material.aspect);
  const float texels =
      std::abs(material.geometry.range.z) * float(material.side) * 4 * 11 * float(std::max(scale.x, scale.y));
  return std::clamp(std::log2(std::max(texels, 1.0f)), 0.0f, material.lambda_max + 1);
}

PartPlan storedVdimPart(const Material& material, float lambda_end) {
  return {PartKind::kStoredVdim, 0, {}, {mapBytes(material, {PartKind::kStoredVdim}), lambda_end}};
}

// The surface maps that a variant reads, without texels.
SurfaceMaps shownMaps(const Material& material, const MaterialVariant& variant) {
  return variant.shadow_quads > 0 ? *material.surface : withoutShadow(*material.surface);
}

// The maps, or first their leading part and further on the whole.
void addSurface(std::vector<PartPlan>& parts, const Material& material, const MaterialVariant& variant) {
  const SurfaceMaps maps = shownMaps(material, variant);
  parts.push_back({PartKind::kSurface,
                   0,
                   {},
                   {gpuBytes(leadOf(maps)), coarsestLevel(material) + coarsestFade(material)},
                   maps.tail_mip > 0 ? Share::kLead : Share::kWhole,
                   variant.shadow_quads > 0});
}
void addWholeSurface(std::vector<PartPlan>& parts, const Material& material, const MaterialVariant& variant) {
  const SurfaceMaps maps = shownMaps(material, variant);
  if (maps.tail_mip == 0) return;
  // Nobody demands less than lambda 0.
  PartDesc desc{gpuBytes(maps), std::max(maps.lambda_first + float(maps.tail_mip), 1.0f)};
  desc.takes_over = true;
  const auto finer = std::find_if(parts.begin(), parts.end(), [&](const PartPlan& part) {
    return part.desc.lambda_end < desc.lambda_end;
  });
  parts.insert(finer, {PartKind::kSurface, 0, {}, desc, Share::kWhole, variant.shadow_quads > 0});
}

// The geometry image and its atlas, or first with a small one.
void addLookupPart(std::vector<PartPlan>& parts, const Material& material, Lookup lookup, float end,
                   VdimAtlasSize full) {
  if (lookup == Lookup::kPaper) parts.push_back(storedVdimPart(material, end));
  if (lookup != Lookup::kFast && lookup != Lookup::kDefault) return;
  const bool split = vdimDepthBytes(full) > vdimDepthBytes(kFirstVdimAtlas);
  const VdimAtlasSize atlas = split ? kFirstVdimAtlas : full;
  parts.push_back({PartKind::kGeometry,
                   0,
                   atlas,
                   {vdimAtlasBytes(material.geometry, atlas), end},
                   split ? Share::kLead : Share::kWhole});
}
// The depths alone: image and volume stay those of the leading part.
void addFullAtlas(std::vector<PartPlan>& parts, float end, VdimAtlasSize full) {
  const bool split = std::any_of(parts.begin(), parts.end(), [](const PartPlan& part) {
    return part.kind == PartKind::kGeometry && part.share == Share::kLead;
  });
  if (!split) return;
  parts.push_back(
      {PartKind::kGeometry, 0, full, {vdimDepthBytes(full), std::min(end, kFirstAtlasLambda), true}});
}

// What follows them is needed below `next_end`.
void addBands(std::vector<PartPlan>& parts, const Material& material, Domain domain, float next_end) {
  for (int b = int(material.bands.size()) - 1; b >= 0; --b) {
    const Band& band = material.bands[size_t(b)];
    if (band.domain != domain) continue;
    const float end = bandEnd(material, band);
    const bool split = band.lead_quads > 0;
    if (split) parts.push_back({PartKind::kBand, b, {}, {gpuBytes(leadOf(band)), end}, Share::kLead});
    // Where only leading quads add something, nobody asks for the rest.
    const float rest_end =
        split ? std::min(end, std::max(band.quad_levels[size_t(band.lead_quads)].end, next_end)) : end;
    parts.push_back({PartKind::kBand, b, {}, {gpuBytes(band), rest_end, split}});
  }
}

std::shared_ptr<const Material> keeping(Material lead) {
  return std::make_shared<const Material>(std::move(lead));
}

Result<LoadedPart> loadBandPart(const AssetFile& file, const PartPlan& plan, const Material* lead) {
  const int index = plan.band;
  Result<Band> band = file.loadBand(index, plan.share, lead ? &lead->bands.front() : nullptr);
  if (!band) return band.issue();
  const Sampling weights =
      band->filter == WeightFilter::kLinear ? Sampling::kRepeatTrilinear : Sampling::kRepeatNearest;
  const Sampling table =
      band->layout == TableLayout::kGrid ? Sampling::kClampLinear : Sampling::kClampNearest;
  Texture environment = environmentTable(file.skeleton(), *band);
  LoadedPart part;
  if (plan.share == Share::kLead) part.lead = keeping({.bands = {*band}});
  part.textures.push_back({LODEN_UNIT_WEIGHTS + index, weights, false, "weights", std::move(band->weights)});
  const int bands = static_cast<int>(file.skeleton().bands.size());
  part.textures.push_back({LODEN_UNIT_TABLE(bands) + index, table, false, "table", std::move(band->table)});
  part.textures.push_back({LODEN_UNIT_ENVIRONMENT(bands) + index, Sampling::kClampLinear, false,
                           "environment", std::move(environment)});
  return part;
}

PartTexture depthTexture(Texture depth) {
  return {LODEN_UNIT_VDIM_DEPTH, Sampling::kRepeatNearest, false, "VDIM depth", std::move(depth)};
}

Result<LoadedPart> loadGeometryPart(const AssetFile& file, const PartPlan& plan, const Material* lead,
                                    int threads, const std::stop_token& stop) {
  GeometryImage read;
  if (!lead) {
    Result<GeometryImage> image = file.loadGeometry();
    if (!image) return image.issue();
    read = std::move(*image);
  }
  const GeometryImage& image = lead ? lead->geometry : read;
  if (Status status = checkVdimWork(image, plan.atlas); !status) return status.issue();
  LoadedPart part;
  if (plan.desc.refines) {
    part.textures.push_back(depthTexture(buildVdimDepth(image, plan.atlas, onThreads(threads, stop))));
    return part;
  }
  VdimAtlas atlas = buildVdimAtlas(image, plan.atlas, onThreads(threads, stop));
  const Sampling sampling =
      image.identity_parameterization ? Sampling::kRepeatLinear : Sampling::kRepeatNearest;
  part.textures.push_back(
      {LODEN_UNIT_GEOMETRY, sampling, true, "geometry", std::move(atlas.geometry.texels)});
  part.textures.push_back(depthTexture(std::move(atlas.depth)));
  if (!atlas.volume.empty())
    part.textures.push_back(
        {LODEN_UNIT_VDIM_VOLUME, Sampling::kClampNearest, false, "VDIM volume", std::move(atlas.volume)});
  if (plan.share == Share::kLead) part.lead = keeping({.geometry = std::move(read)});
  return part;
}

Result<LoadedPart> loadStoredVdimPart(const AssetFile& file) {
  Result<PaperVdim> vdim = file.loadStoredVdim();
  if (!vdim) return vdim.issue();
  LoadedPart part;
  part.textures.push_back({LODEN_UNIT_PAPER_REFERENCE, Sampling::kRepeatNearest, false, "VDIM reference",
                           std::move(vdim->reference)});
  part.textures.push_back(
      {LODEN_UNIT_PAPER_PACKED, Sampling::kRepeatLinear, false, "VDIM packed", std::move(vdim->packed)});
  return part;
}

// Units of the near term's maps stand in the order of kSurfaceMapRows.
static_assert(LODEN_UNIT_COLOR(1) == LODEN_UNIT_NORMAL(1) + 1 &&
              LODEN_UNIT_AMBIENT(1) == LODEN_UNIT_NORMAL(1) + 2 &&
              LODEN_UNIT_SHADOW(1) == LODEN_UNIT_NORMAL(1) + 3 &&
              LODEN_UNIT_SHADOW_TABLE(1) == LODEN_UNIT_NORMAL(1) + 4 &&
              LODEN_UNIT_INDIRECT(1) == LODEN_UNIT_NORMAL(1) + 5);

Result<LoadedPart> loadSurfacePart(const AssetFile& file, const PartPlan& plan, const Material* lead) {
  Result<SurfaceMaps> maps = file.loadSurface(plan.share, lead ? &*lead->surface : nullptr);
  if (!maps) return maps.issue();
  LoadedPart part;
  if (plan.share == Share::kLead) part.lead = keeping({.surface = *maps});
  const int bands = static_cast<int>(file.skeleton().bands.size());
  if (!plan.shadow) *maps = withoutShadow(std::move(*maps));
  int unit = LODEN_UNIT_NORMAL(bands);
  for (const SurfaceMapRow& row : kSurfaceMapRows) {
    Texture& map = (*maps).*row.texture;
    const Sampling sampling = row.first ? Sampling::kRepeatTrilinear : Sampling::kClampLinear;
    if (!map.empty()) part.textures.push_back({unit, sampling, false, row.name, std::move(map)});
    ++unit;
  }
  return part;
}

// A texture that is going to be allocated.
struct Extents {
  std::string what;
  TextureShape shape;
  glm::ivec3 size;
};

std::string extentsText(glm::ivec3 size) {
  return std::to_string(size.x) + " x " + std::to_string(size.y) + " x " + std::to_string(size.z);
}

void addExtents(std::vector<Extents>& all, const Material& material, const PartPlan& plan) {
  if (plan.share == Share::kLead && plan.kind != PartKind::kGeometry) return;  // the whole is larger
  const MaterialPart part{plan.kind, plan.band};
  for (const auto& map : mapsOf(material, part)) {
    const Texture& t = *map.texture;
    all.push_back({mapName(part, map.name), t.shape, {t.width, t.height, t.depth}});
  }
  if (plan.kind != PartKind::kGeometry) return;
  const VdimAtlasSize atlas = plan.atlas;
  all.push_back({"the VDIM atlas",
                 TextureShape::kArray2D,
                 {atlas.texels, atlas.texels, atlas.directions * atlas.directions}});
}

}  // namespace

std::vector<PartPlan> planParts(const Material& material, const MaterialVariant& variant,
                                VdimAtlasSize full_atlas) {
  std::vector<PartPlan> parts;
  if (variant.bands == 0) {
    const float end = parallaxEnd(material);
    addSurface(parts, material, variant);
    addLookupPart(parts, material, variant.lookup, end, full_atlas);
    addWholeSurface(parts, material, variant);
    addFullAtlas(parts, end, full_atlas);
    return parts;
  }
  const float near_end = variant.near ? nearEnd(material) : 0;
  float flat_end = near_end;
  for (const Band& band : material.bands)
    if (band.domain == Domain::kFlat) flat_end = std::max(flat_end, bandEnd(material, band));
  addBands(parts, material, Domain::kReference, flat_end);
  addLookupPart(parts, material, variant.lookup, flat_end, full_atlas);
  if (variant.near)
    parts.push_back({PartKind::kSurface,
                     0,
                     {},
                     {gpuBytes(shownMaps(material, variant)), near_end},
                     Share::kWhole,
                     variant.shadow_quads > 0});
  addBands(parts, material, Domain::kFlat, 0);
  addFullAtlas(parts, flat_end, full_atlas);
  return parts;
}

Status checkExtents(const Material& material, std::span<const PartPlan> parts, const Capabilities& gl) {
  std::vector<Extents> textures;
  for (const PartPlan& part : parts) addExtents(textures, material, part);
  for (const Extents& t : textures) {
    const bool volume = t.shape == TextureShape::kVolume;
    const int side = volume ? gl.max_volume_side : gl.max_texture_side;
    const int depth = volume ? gl.max_volume_side : gl.max_array_layers;
    if (t.size.x <= side && t.size.y <= side && t.size.z <= depth) continue;
    return Issue{issue_id::kLimit, Severity::kError, material.name,
                 t.what + " of " + extentsText(t.size) + " texels, this driver takes " +
                     extentsText({side, side, depth})};
  }
  return {};
}

Result<LoadedPart> loadPart(const AssetFile& file, const PartPlan& plan, const Material* lead, int threads,
                            const std::stop_token& stop) {
  switch (plan.kind) {
    case PartKind::kBand:
      return loadBandPart(file, plan, lead);
    case PartKind::kGeometry:
      return loadGeometryPart(file, plan, lead, threads, stop);
    case PartKind::kStoredVdim:
      return loadStoredVdimPart(file);
    case PartKind::kSurface:
      break;
  }
  return loadSurfacePart(file, plan, lead);
}

}  // namespace loden::runtime
