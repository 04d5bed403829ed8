// The value at lambda 0 .. 6 against the area-averaged truth (LBTF figure 7): the mean of the BTF over the
// 2^lambda x 2^lambda texels around x, at sampled pairs. "point" is the finest level read there without any
// level of detail.
#include <cmath>

#include "importer/base/parallel.h"
#include "importer/base/progress.h"
#include "importer/base/random.h"
#include "importer/cook/cook.h"
#include "importer/cook/fused_plan.h"
#include "importer/cook/modes.h"
#include "importer/study/plot.h"
#include "importer/study/study_tile.h"
#include "material/eval/evaluate.h"
#include "material/model/color.h"
#include "material/model/leading_part.h"
#include "material/system/threads.h"

namespace loden::importer {
namespace {

constexpr int kLightStride =
    9;  // every ninth light, from a random one in each view: a regular shift would meet
        // the pairs of equal directions, where hot spots are, too often or too rarely
constexpr int kBoxesPerImage = 64;  // boxes of the level, evenly spread

// Root of the mean squared difference of Y.
double levelError(const Evaluator& evaluator, const BtfSource& source, const YccBtf& truth, int level,
                  double lambda, int threads) {
  const int boxes = truth.texels(), step = std::max(boxes / kBoxesPerImage, 1);
  std::vector<double> squares(size_t(truth.views()), 0.0);
  std::vector<int> counts(size_t(truth.views()), 0);
  LODEN_CHECK_EQ(source.size().x >> level, truth.side());
  const int stride = boxes < kBoxesPerImage ? 1 : kLightStride;
  parallelFor(size_t(truth.views()), threads, [&](size_t v) {
    Matrix block;
    truth.read(0, int(v), block);
    const glm::dvec3 wo = source.views().samples[v];
    const int first_light = static_cast<int>(mixSeed(v, 0) % uint64_t(stride));
    for (int box = int(v) % step; box < boxes; box += step) {
      const glm::dvec2 x =
          glm::dvec2(box % truth.side() + 0.5, box / truth.side() + 0.5) / double(truth.side());
      const Hit<double> hit = evaluator.findHit(x, lambda, wo);
      for (int l = first_light; l < truth.lights(); l += stride) {
        const glm::dvec3 value = evaluator.evaluate(hit, source.lights().samples[size_t(l)], wo);
        const double difference = yccFromRgb(value).x - block(box, l);
        squares[v] += difference * difference;
        ++counts[v];
      }
    }
  });
  double sum = 0, count = 0;
  for (size_t v = 0; v < squares.size(); ++v) sum += squares[v], count += counts[v];
  return std::sqrt(sum / count);
}

struct Candidate {
  std::string mode;
  Material material;
  bool point = false;  // always lambda 0
};

Result<std::vector<Candidate>> candidates(const StudyOptions& options, const StudyTile& tile) {
  std::vector<Candidate> all;
  CookOptions cook;
  cook.mode = Mode::kLod;
  cook.threads = options.threads;
  for (const Preset preset : {Preset::kSeed, Preset::kGame}) {
    cook.preset = preset;
    auto m = fitLod(*tile.source, tile.btf, cook);
    if (!m) return m.issue();
    all.push_back({preset == Preset::kSeed ? "lod-seed" : "lod", std::move(*m)});
  }
  const FusedPlan plan;
  const auto geometry = geometryOf(tile.baked, plan.geometry_side);
  if (!geometry) return geometry.issue();
  all.push_back({"fused", fitFusedBands(*tile.source, tile.btf, *geometry, plan, options.threads).material});
  const Material fused = all.back().material;
  all.push_back({"fused-point", fused, true});
  // What streaming shows first: the coarse band's leading part, and before that the mean.
  all.push_back({"fused-lead", fused});
  all.back().material.bands.back() = leadOf(fused.bands.back());
  all.push_back({"mean", fused});
  all.back().material.bands.clear();
  return all;
}

}  // namespace

Result<StudyRows> studyMinification(const StudyOptions& options) {
  StudyRows rows;
  Progress progress("minification", options.tiles.size(), options.quiet);
  for (const std::string& tile : options.tiles) {
    auto data = studyTile(options, tile);
    if (!data) return data.issue();
    const auto all = candidates(options, *data);
    if (!all) return all.issue();
    YccBtf truth = std::move(data->btf);
    for (int level = 0;; ++level) {
      for (const Candidate& c : *all) {
        const Evaluator evaluator(c.material, onThreads(options.threads));
        const double rmse =
            levelError(evaluator, *data->source, truth, level, c.point ? 0 : level, options.threads);
        StudyRow row;
        row.set("tile", tile).set("mode", c.mode).set("lambda", level).set("rmse_y", rmse);
        row.set("psnr_db", -20 * std::log10(std::max(rmse, 1e-12)));
        rows.push_back(std::move(row));
      }
      if (truth.side() == 1 || truth.side() % 2 != 0) break;
      truth = downsample(truth, BoxFilter::k2x2, options.threads);
    }
    progress.advance();
  }
  if (!options.pictures.empty()) {
    const auto mode = [](const StudyRow& row) { return std::get<std::string>(*row.find("mode")); };
    const Plot plot{"Value against the area-averaged truth", "lambda", "RMSE of Y, white = 1", false,
                    panelsOf(rows, "lambda", "rmse_y", mode)};
    if (const Status s = writePlot(plot, options.pictures / "minification.svg"); !s) return s.issue();
  }
  return rows;
}

}  // namespace loden::importer
