#include "importer/cook/cook.h"

#include "importer/cook/modes.h"
#include "material/asset/asset.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

Issue missing(const BakedOutput& input, const char* what, const char* maps) {
  return {issue_id::kBakeIncomplete, Severity::kError, input.folder().string(),
          std::string("holds no ") + what + "; bake it with --maps " + maps};
}

// Refuses options that the mode would ignore. Issues name fields of CookOptions; `components` are all three.
Status checkOptions(const CookOptions& o) {
  const auto refuse = [](const char* field, const char* why) -> Status {
    return Issue{issue_id::kOption, Severity::kError, field, why};
  };
  const bool goal = o.max_bytes > 0 || o.target_rmse > 0, chroma = o.cb_components > 0 || o.cr_components > 0;
  const char* goal_field = o.max_bytes > 0 ? "max_bytes" : "target_rmse";
  if (!(o.target_rmse >= 0)) return refuse("target_rmse", "must not be negative");
  if (goal && o.mode != Mode::kFused) return refuse(goal_field, "has a meaning in mode fused only");
  if (goal && (o.y_components > 0 || chroma || o.preset != Preset::kGame))
    return refuse(goal_field, "chooses the components itself; give neither components nor a preset with it");
  if (o.mode == Mode::kSurface && (o.levels > 0 || o.y_components > 0 || chroma))
    return refuse(o.levels > 0 ? "levels" : "components",
                  "has no meaning in mode surface, which has no bands");
  const bool near = o.mode == Mode::kFused && o.near == Near::kSurface;
  if (o.near == Near::kBand && o.mode != Mode::kFused)
    return refuse("near", "has a meaning in mode fused only");
  if (o.visibility && !near && o.mode != Mode::kSurface)
    return refuse("visibility", "has a meaning with a near term only");
  if (o.cb_components != o.cr_components)
    return refuse("components", "CB and CR must be equal: they share quads of the tables");
  if ((o.y_components + 3) / 4 + (o.cb_components + 1) / 2 > ShaderLimits::kMaxQuads)
    return refuse(
        "components",
        "gives more than 16 quads of components, which no shader reads: a quad holds 4 of Y, or 2 of "
        "CB and CR");
  if (o.mode == Mode::kLod && o.levels > ShaderLimits::kMaxBands)
    return refuse("levels", "is more than 8, which no shader reads: each is a band");
  if (o.mode == Mode::kFused && o.preset == Preset::kSeed)
    return refuse("preset", "seed reproduces the paper's level-of-detail material, which needs mode lod");
  return {};
}

}  // namespace

Result<GeometryImage> geometryOf(const BakedOutput& input, int side) {
  auto baked = input.geometry();
  if (!baked) return baked.issue();
  const int fine = input.manifest().geometry_size;
  if (side == 0) side = fine;
  LODEN_CHECK_EQ(fine % side, 0);
  const int step = fine / side;
  std::vector<glm::dvec3> positions;
  std::vector<uint16_t> charts;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      glm::dvec3 sum(0);
      uint16_t chart = 0xffff;
      for (int s = 0; s < step * step; ++s) {
        const glm::vec4& texel =
            (*baked)[size_t(j * step + s / step) * size_t(fine) + size_t(i * step + s % step)];
        // A texel beside a chart continues it, so one of the chart's own among them is enough.
        if (const auto of_texel = static_cast<uint16_t>(texel.w); of_texel != 0)
          chart = chart == 0xffff || chart == of_texel ? of_texel : uint16_t(0);
        sum += glm::dvec3(texel);
      }
      if (chart == 0xffff) chart = 0;
      const glm::dvec3 mean = sum / double(step * step);
      const glm::dvec2 p((i + 0.5) / side, (j + 0.5) / side);
      positions.emplace_back(mean.x + p.x, mean.y + p.y, std::min(mean.z, 0.0));
      charts.push_back(chart);
    }
  auto image = encodeGeometryImage(side, positions, charts, input.manifest().identity_parameterization);
  image.aspect = static_cast<float>(input.manifest().aspect);
  return image;
}

namespace {

Result<Material> cookBake(const BakedOutput& input, const CookOptions& options) {
  if (options.mode == Mode::kSurface) return cookSurface(input, options);
  auto source = bakedSource(input);
  if (!source) return source.issue();
  if (options.mode == Mode::kLod) return cookLod(**source, options);
  const auto surface = bakedSurface(input);
  if (!surface) return surface.issue();
  return cookFused(
      **source, [&](int side) { return geometryOf(input, side); }, *surface, options);
}

}  // namespace

Result<Material> cook(const BakedOutput& input, const CookOptions& options) {
  if (const Status status = checkOptions(options); !status) return status.issue();
  const BakeManifest& manifest = input.manifest();
  if (options.mode != Mode::kSurface && !manifest.has_btf) return missing(input, "BTF", "btf");
  if (options.mode != Mode::kLod && !manifest.has_surface) return missing(input, "geometry", "surface");
  auto material = cookBake(input, options);
  if (material)
    material->aspect = static_cast<float>(manifest.aspect),
    material->period = static_cast<float>(manifest.period);
  return material;
}

Result<Material> cook(const BtfSource& input, const CookOptions& options) {
  if (options.mode != Mode::kLod)
    return Issue{issue_id::kOption, Severity::kError, input.name(),
                 "has no meso-geometry; cook it with --mode lod"};
  if (const Status status = checkOptions(options); !status) return status.issue();
  if (input.size().x != input.size().y)
    return Issue{issue_id::kMeasured, Severity::kError, input.name(), "is not square"};
  return cookLod(input, options);
}

}  // namespace loden::importer
