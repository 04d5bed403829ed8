#include "runtime/stream/material_data.h"

#include <algorithm>
#include <cmath>

#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "material/model/environment.h"
#include "material/model/leading_part.h"
#include "runtime/stream/shader_variants.h"

namespace loden::runtime {

static_assert(LODEN_ENVIRONMENT_BASIS == kEnvironmentBasis && LODEN_ENVIRONMENT_THETAS == kEnvironmentThetas);

namespace {

// Reciprocal of a ramp's length; a step becomes a very steep ramp.
float ramp(float begin, float end) {
  return 1.0f / std::max(end - begin, 1e-6f);
}

glm::vec4 windowData(const Window& w) {
  return {w.in_begin, ramp(w.in_begin, w.in_end), w.out_end, ramp(w.out_begin, w.out_end)};
}

LodenBandData bandData(const Band& band) {
  LodenBandData data{};
  data.window = windowData(band.window);
  data.lambda_first = band.lambda_first, data.last_mip = float(band.weights.mips - 1);
  data.side = float(band.weights.width), data.per_table_depth = 1.0f / float(band.table.depth);
  const DirectionGrid grid = environmentGrid(band, 0);  // the table's, where that has one
  data.grid = {grid.thetas, grid.phis};
  data.per_grid = {1.0f / float(grid.thetas * grid.thetas), 1.0f / float(grid.phis)};
  if (band.domain == Domain::kFlat) data.bits |= LODEN_BAND_FLAT;
  if (band.filter == WeightFilter::kLinear) data.bits |= LODEN_BAND_LINEAR;
  if (band.ratio) data.bits |= LODEN_BAND_RATIO;
  data.y_quads = band.y_quads, data.chroma_quads = band.chroma_quads, data.ratio_layer = band.quads();
  std::copy(band.quad_scale.begin(), band.quad_scale.end(), data.quad_scale);
  for (size_t quad = 0; quad < band.quad_levels.size(); ++quad) {
    data.quad_begin[quad / 4][int(quad % 4)] = band.quad_levels[quad].begin;
    data.quad_end[quad / 4][int(quad % 4)] = band.quad_levels[quad].end;
  }
  data.ratio_scale = band.ratio_scale;
  data.rest_share = 1;
  return data;
}

// Reads the leading part's textures.
void readLead(LodenBandData& data, const Band& band) {
  data.y_quads = data.ratio_layer = band.lead_quads, data.chroma_quads = 0;
  data.per_table_depth *= float(band.quads()) / float(band.lead_quads);
}

// The quads behind the leading ones count by `share`.
void fadeRest(LodenBandData& data, const Band& band, float share) {
  for (int quad = band.lead_quads; quad < band.quads(); ++quad)
    data.quad_scale[quad] = band.quad_scale[size_t(quad)] * share;
  data.rest_share = share;
  data.first_rest = float(band.lead_quads);
}

Issue limitIssue(const Material& material, const std::string& text) {
  return {issue_id::kLimit, Severity::kError, material.name, text};
}

static_assert(ShaderLimits::kMaxBands == LODEN_MAX_BANDS && ShaderLimits::kMaxQuads == LODEN_MAX_QUADS);

Status checkBands(const Material& material) {
  if (material.surface && material.bands.front().layout == TableLayout::kNearest)
    return limitIssue(material, "surface maps among bands with nearest tables");
  if (material.surface && material.bands.size() > kMostNearBands)
    return limitIssue(material, "surface maps among more than " + std::to_string(kMostNearBands) + " bands");
  if (material.bands.size() > LODEN_MAX_BANDS)
    return limitIssue(material, std::to_string(material.bands.size()) + " bands, shaders read " +
                                    std::to_string(LODEN_MAX_BANDS) + "; cook with fewer levels");
  for (const Band& band : material.bands) {
    if (band.layout != material.bands.front().layout) return limitIssue(material, "bands mix table layouts");
    const int quads = band.quads();
    if (quads < 1 || quads > LODEN_MAX_QUADS || band.quad_scale.size() != size_t(quads))
      return limitIssue(material, "a band of " + std::to_string(quads) + " quads, shaders read 1 to " +
                                      std::to_string(LODEN_MAX_QUADS) + "; cook with fewer components");
  }
  return {};
}

bool readsParameter(const Material& material) {
  if (material.surface) return true;
  return std::any_of(material.bands.begin(), material.bands.end(),
                     [](const Band& band) { return band.domain == Domain::kFlat; });
}

// What a material of this variant finds V by.
Visibility shownVisibility(const SurfaceMaps& maps, const MaterialVariant& variant, Visibility wanted) {
  using enum Visibility;
  if (maps.visibility == kNone || wanted == kNone) return kNone;
  if (maps.shadow.width > 0 && (maps.visibility == kMap || wanted == kMap)) return kMap;
  if (!hasRelief(variant)) return kNone;
  const bool fast = wanted != kDefault || variant.lookup == Lookup::kFast;  // no better than for the eye
  return fast ? kFast : maps.visibility;
}

}  // namespace

Result<MaterialVariant> materialVariant(const Material& material, Lookup lookup, Visibility visibility) {
  MaterialVariant variant;
  if (material.bands.empty() && !material.surface)
    return limitIssue(material, "a material without bands and surface maps cannot be drawn");
  variant.near = material.surface.has_value();
  if (!material.bands.empty()) {
    if (Status status = checkBands(material); !status) return status.issue();
    variant.bands = static_cast<uint8_t>(material.bands.size());
    variant.nearest_tables = material.bands.front().layout == TableLayout::kNearest;
  }
  const bool has_geometry = material.geometry.side() > 0;
  if (lookup != Lookup::kNone && readsParameter(material)) {
    if (variant.nearest_tables) return limitIssue(material, "nearest tables with a flat band");
    if (material.stored_vdim && !(variant.near && variant.bands > 0) &&
        (lookup == Lookup::kPaper || !has_geometry))
      variant.lookup = Lookup::kPaper;
    else if (has_geometry)
      variant.lookup = lookup == Lookup::kFast ? lookup : Lookup::kDefault;
    variant.height_field = hasRelief(variant) && material.geometry.identity_parameterization;
  }
  variant.indirect = variant.near && material.surface->indirect.width > 0;
  if (variant.near) variant.visibility = shownVisibility(*material.surface, variant, visibility);
  if (variant.visibility == Visibility::kMap) {
    const int quads = material.surface->shadow.depth;
    if (quads > LODEN_MAX_SHADOW_QUADS)
      return limitIssue(material, "a shadow map of " + std::to_string(quads) + " layers, shaders read " +
                                      std::to_string(LODEN_MAX_SHADOW_QUADS));
    variant.shadow_quads = static_cast<uint8_t>(quads);
  }
  return variant;
}

LodenMaterialData makeMaterialData(const Material& m) {
  LodenMaterialData data{};
  if (m.mean.chroma == MeanChroma::kRatio) data.bits |= LODEN_MEAN_RATIO;
  if (m.cosine_included) data.bits |= LODEN_COSINE_INCLUDED;
  if (m.mode == Mode::kLod) data.bits |= LODEN_CLAMP_LAMBDA;
  if (m.surface && m.surface->lobe == Lobe::kGgx) data.bits |= LODEN_GGX;
  data.mean = {m.mean.ka, m.mean.kd, m.mean.ks, m.mean.alpha};
  data.mean_chroma = {m.mean.cb, m.mean.cr};
  data.theta_max = {m.theta_max, std::cos(m.theta_max), std::sin(m.theta_max), 1 / m.theta_max};
  data.geometry_range = packedRange(m.geometry), data.geometry_side = float(m.geometry.side());
  if (m.stored_vdim) {
    data.paper_range = m.stored_vdim->range;
    data.paper_size = {m.stored_vdim->zeniths, m.stored_vdim->azimuths};
  }
  data.periods_per_length = periodsPerLength(m.aspect);
  data.value_scale = m.value_scale, data.side = float(m.side), data.lambda_max = m.lambda_max;
  if (m.surface) {
    const SurfaceMaps& maps = *m.surface;
    data.specular_scale = maps.specular_scale, data.surface_lambda = maps.lambda_first;
    data.ambient_lambda = maps.ambient_first;
    data.shadow_side = float(maps.shadow_table.width);
    data.near_end = maps.fade_end, data.near_slope = ramp(maps.fade_begin, maps.fade_end);
  }
  if (!m.bands.empty()) {
    const EnvironmentMean mean = environmentMean(m);
    std::copy(mean.rows.begin(), mean.rows.end(), data.environment_mean);
    data.environment_unit = mean.unit;
  }
  for (size_t b = 0; b < std::min<size_t>(m.bands.size(), LODEN_MAX_BANDS); ++b)
    data.bands[b] = bandData(m.bands[b]);
  return data;
}

float coarsestLevel(const Material& material) {
  if (!material.bands.empty() || !material.surface) return material.lambda_max;
  const SurfaceMaps& maps = *material.surface;
  return maps.lambda_first + float(std::max(maps.normal.mips, maps.color.mips) - 1);
}

float coarsestFade(const Material& material) {
  return material.bands.empty() ? 3 : 1;
}

float coarsestShare(const Material& material, const ResidentState& state) {
  return glm::clamp((coarsestLevel(material) - state.lambda) / coarsestFade(material) + 1, 0.0f, 1.0f);
}

float shownLambda(const Material& material, float published) {
  const float finest = finestLevel(material);
  if (finest >= 0) return std::max(published, finest);
  return published < 1 ? finest + published * (1 - finest) : published;
}

void applyResidency(LodenMaterialData& data, const Material& material, const ResidentState& state) {
  data.resident_lambda = shownLambda(material, std::min(state.lambda, coarsestLevel(material)));
  data.geometry_resident = state.atlas.texels > 0 ? 1 : 0;
  data.atlas_texels = state.atlas.texels, data.atlas_directions = state.atlas.directions;
  if (material.surface) {
    const SurfaceMaps& maps = *material.surface;
    const SurfaceMaps read = state.tail ? leadOf(maps) : maps;
    data.surface_lambda = read.lambda_first, data.ambient_lambda = read.ambient_first;
    // Bands stand in for what is not there.
    data.near_end = maps.fade_end, data.near_slope = state.surface ? ramp(maps.fade_begin, maps.fade_end) : 0;
  }
  // A band that is needed at every lambda has no window to come in by: its weight follows the published
  // lambda from lambda_max + 1 to lambda_max. A ramp of the slope f / 1e6 over 1e6 levels is the constant f.
  const float share = coarsestShare(material, state);
  for (size_t b = 0; b < std::min<size_t>(material.bands.size(), LODEN_MAX_BANDS); ++b) {
    const Window& window = material.bands[b].window;
    data.bands[b] = bandData(material.bands[b]);
    if ((state.leads >> b & 1) != 0)
      readLead(data.bands[b], material.bands[b]);
    else if (material.bands[b].lead_quads > 0)
      fadeRest(data.bands[b], material.bands[b], state.rest[b]);
    const bool resident = (state.bands >> b & 1) != 0;
    if (!resident)
      data.bands[b].window = {0, 0, 0, 0};
    else if (window.out_end > material.lambda_max && share < 1)
      data.bands[b].window = {data.bands[b].window.x, data.bands[b].window.y, 1e6f, share * 1e-6f};
  }
}

}  // namespace loden::runtime
