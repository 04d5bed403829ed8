#include "importer/cook.h"

#include "importer/fit/modes.h"
#include "material/issues.h"

namespace loden::importer {
namespace {

Issue missing(const BakedOutput& input, const char* what, const char* maps) {
  return {issue_id::kBakeIncomplete, Severity::kError, input.folder().string(),
          std::string("holds no ") + what + "; bake it with --maps " + maps};
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
        const glm::vec4& texel = (*baked)[size_t(j * step + s / step) * size_t(fine) + size_t(i * step + s % step)];
        const auto of_texel = static_cast<uint16_t>(texel.w);
        chart = chart == 0xffff || chart == of_texel ? of_texel : uint16_t(0);
        sum += glm::dvec3(texel);
      }
      const glm::dvec3 mean = sum / double(step * step);
      const glm::dvec2 p((i + 0.5) / side, (j + 0.5) / side);
      positions.emplace_back(mean.x + p.x, mean.y + p.y, std::min(mean.z, 0.0));
      charts.push_back(chart);
    }
  return encodeGeometryImage(side, positions, charts, input.manifest().identity_parameterization);
}

Result<Material> cook(const BakedOutput& input, const CookOptions& options) {
  const BakeManifest& manifest = input.manifest();
  if (options.mode != Mode::kSurface && !manifest.has_btf) return missing(input, "BTF", "btf");
  if (options.mode != Mode::kLod && !manifest.has_surface) return missing(input, "geometry", "surface");
  if (options.mode == Mode::kSurface) return cookSurface(input, options);
  auto source = bakedSource(input);
  if (!source) return source.issue();
  if (options.mode == Mode::kLod) return cookLod(**source, options);
  return cookFused(**source, [&](int side) { return geometryOf(input, side); }, options);
}

Result<Material> cook(const BtfSource& input, const CookOptions& options) {
  if (options.mode != Mode::kLod)
    return Issue{issue_id::kOption, Severity::kError, input.name(), "has no meso-geometry; cook it with --mode lod"};
  if (input.size().x != input.size().y)
    return Issue{issue_id::kMeasured, Severity::kError, input.name(), "is not square"};
  return cookLod(input, options);
}

}  // namespace loden::importer
