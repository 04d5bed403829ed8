// Cast shadows apart from shading (FBTF section 5 leaves them in the Flat-BTF and names their removal as work
// to come): what the light factor of a flat band (material/model/band.h) gives at equal bytes.
//
// joint   the flat band as cooked by default: components that hold shadow and shading at once.
// split   components of shading, times clamp(V(p, wi)) in components whose table knows only the light.
// Both as stored in 8 bits, through the shader's default lookup; bytes are those of the flat band: the coarse
// band and the geometry image are left out, as they are the same.
#include "importer/base/progress.h"
#include "importer/cook/fused_plan.h"
#include "importer/cook/modes.h"
#include "importer/study/study_tile.h"
#include "material/eval/evaluate.h"

namespace loden::importer {
namespace {

constexpr int kLabEvery = 5;  // lights

// Components: Y, each of Cb and Cr, light factor.
struct Split {
  int y, chroma, light;
};
constexpr Split kSplits[] = {{8, 0, 0}, {16, 0, 0}, {20, 0, 0}, {16, 2, 0},
                             {4, 0, 8}, {8, 0, 8},  {8, 0, 12}, {8, 2, 8}};

std::string componentsText(const Split& s) {
  const std::string chroma = std::to_string(s.chroma),
                    text = std::to_string(s.y) + "," + chroma + "," + chroma;
  return s.light > 0 ? text + " x " + std::to_string(s.light) : text;
}

}  // namespace

Result<StudyRows> studyShadowSplit(const StudyOptions& options) {
  StudyRows rows;
  Progress progress("shadow-split", options.tiles.size() * std::size(kSplits), options.quiet);
  for (const std::string& tile : options.tiles) {
    const auto data = studyTile(options, tile);
    if (!data) return data.issue();
    const auto geometry = geometryOf(data->baked, 0);
    if (!geometry) return geometry.issue();
    for (const Split& split : kSplits) {
      FusedPlan plan;
      plan.y_components = split.y;
      plan.chroma_components = split.chroma;
      plan.light_components = split.light;
      plan.coarse_y = 0;
      const FusedFit fit = fitFused(*data->source, data->btf, *geometry, plan, options.threads, kLabEvery);
      StudyRow row;
      row.set("tile", tile)
          .set("kind", split.light > 0 ? "split" : "joint")
          .set("components", componentsText(split));
      row.set("coefficient_bytes", uint64_t{fit.material.bands.front().bytes()});
      row.set("rmse_y", fit.error.channel[0].rmse())
          .set("rmse_cb", fit.error.channel[1].rmse())
          .set("rmse_cr", fit.error.channel[2].rmse());
      rows.push_back(row.set("lab_mean", fit.error.lab.mean()));
      progress.advance();
    }
  }
  return rows;
}

}  // namespace loden::importer
