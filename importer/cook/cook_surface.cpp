#include <algorithm>

#include "importer/cook/atlas_choice.h"
#include "importer/cook/meta.h"
#include "importer/cook/modes.h"
#include "importer/cook/near_term.h"
#include "importer/fit/band_fit.h"
#include "importer/fit/paper_vdim.h"
#include "material/model/leading_part.h"

namespace loden::importer {
namespace {

// Ma et al. eq. 5 fitted to the baked BTF's average where there is one: what far views fall back to.
Status fitMean(const BakedOutput& input, const CookOptions& options, Material& m) {
  if (!input.manifest().has_btf) return {};
  auto source = bakedSource(input);
  if (!source) return source.issue();
  auto btf = loadYcc(**source, options.threads);
  if (!btf) return btf.issue();
  m.mean = fitPhong(imageMeans(*btf, options.threads), (*source)->lights(), (*source)->views(),
                    {true, MeanChroma::kRatio})
               .mean;
  return {};
}

}  // namespace

Result<Material> cookSurface(const BakedOutput& input, const CookOptions& options) {
  const BakeManifest& manifest = input.manifest();
  const auto baked = bakedSurface(input);
  if (!baked) return baked.issue();
  Material m;
  m.mode = Mode::kSurface;
  m.name = manifest.tile;
  m.side = manifest.size;
  m.value_scale = static_cast<float>(1 / kPi);
  auto geometry = geometryOf(input, 0);
  if (!geometry) return geometry.issue();
  m.geometry = std::move(*geometry);
  Progress progress("cook " + m.name + ": fitting", 4, options.quiet);
  AtlasChoice atlas;
  if (!m.geometry.empty()) atlas = chooseAtlas(m.geometry, m.side, options.threads);
  m.atlas = atlas.size;
  progress.advance(2);
  // Without shadows there is too much light already.
  const Visibility visibility = options.visibility.value_or(Visibility::kNone);
  const int bounces = visibility == Visibility::kNone ? 0 : baked->bounces;
  m.surface =
      nearMaps(*baked, m.geometry, m.side, {.visibility = visibility, .bounces = bounces}, options.threads);
  m.lambda_max = std::max(m.surface->lambda_first + static_cast<float>(m.surface->color.mips - 1), 0.0f);
  // As published the indirection map itself is stored; it is also the only one where there is no geometry.
  if ((options.preset == Preset::kSeed || m.geometry.empty()) && !manifest.vdims.empty()) {
    const glm::ivec2 size = manifest.vdims.front();
    auto vdim = input.vdim(size.x, size.y);
    if (!vdim) return vdim.issue();
    m.stored_vdim = packPaperVdim(*vdim, manifest.size, size.x, size.y);
  }
  if (const Status status = fitMean(input, options, m); !status.ok()) return status.issue();
  splitLeadingParts(m);
  progress.advance(4);
  m.meta_json = cookMeta(m, manifest.tile, presetName(options.preset), nullptr, {}, atlas.trials);
  return m;
}

}  // namespace loden::importer
