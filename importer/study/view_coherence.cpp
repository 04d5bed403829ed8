// How much the light vector of a texel changes with the view (FBTF section 4.3, table 2, figure 11).
//
// L_k(texel) is the vector of Lab values over all lights under view k. Reported per texel: the root mean
// square over views and lights of the Lab distance between L_k and its mean over views (the paper calls it
// variance, but its size is that of a standard deviation); then mean and maximum over texels.
#include <algorithm>
#include <cmath>
#include <functional>

#include "importer/base/parallel.h"
#include "importer/base/progress.h"
#include "importer/study/figure.h"
#include "importer/study/study.h"
#include "material/model/color.h"

namespace loden::importer {
namespace {

// Sums over views, per [light][texel]; `views[texel]` counts the views that took part.
class CoherenceSums {
 public:
  CoherenceSums(int lights, size_t texels)
      : lights_(lights),
        texels_(texels),
        mean_(lights * texels),
        spread_(lights * texels),
        views_(texels, 0) {}

  // One view; texels with use[texel] == 0 are left out. Welford's update, stable for many views.
  void add(const std::vector<glm::vec3>& values, const std::vector<uint8_t>& use, int threads) {
    for (size_t t = 0; t < texels_; ++t) views_[t] += use[t];
    parallelFor(lights_, threads, [&](size_t light) {
      for (size_t t = 0; t < texels_; ++t) {
        if (!use[t]) continue;
        const size_t i = light * texels_ + t;
        const glm::dvec3 lab = labFromRgb(glm::dvec3(values[i]));
        const glm::dvec3 before = lab - mean_[i];
        mean_[i] += before / double(views_[t]);
        spread_[i] += glm::dot(before, lab - mean_[i]);
      }
    });
  }

  // Per texel; negative where fewer than two views took part.
  std::vector<double> deviations() const {
    std::vector<double> deviations(texels_, -1);
    for (size_t t = 0; t < texels_; ++t) {
      if (views_[t] < 2) continue;
      double sum = 0;
      for (int light = 0; light < lights_; ++light) sum += spread_[light * texels_ + t];
      deviations[t] = std::sqrt(sum / (double(views_[t]) * lights_));
    }
    return deviations;
  }

 private:
  int lights_;
  size_t texels_;
  std::vector<glm::dvec3> mean_;
  std::vector<double> spread_;
  std::vector<int> views_;
};

struct Kind {
  const char* name;
  std::function<Result<std::vector<glm::vec3>>(int view)> values;
  bool visible_only;
  int side;
};

Result<StudyRow> measure(const BakedOutput& baked, const std::string& tile, const Kind& kind,
                         const StudyOptions& options) {
  const int views = baked.manifest().directions.size();
  const size_t texels = size_t(kind.side) * kind.side;
  CoherenceSums sums(views, texels);
  Progress progress("view-coherence " + tile + " " + kind.name, views, options.quiet);
  for (int view = 0; view < views; ++view) {
    const auto values = kind.values(view);
    if (!values) return values.issue();
    std::vector<uint8_t> use(texels, 1);
    if (kind.visible_only) {
      const auto visible = baked.visibleView(view);
      if (!visible) return visible.issue();
      for (size_t t = 0; t < texels; ++t) use[t] = (*visible)[t] > 0;
    }
    sums.add(*values, use, options.threads);
    progress.advance();
  }
  const auto deviations = sums.deviations();
  double sum = 0, largest = 0;
  int counted = 0;
  for (const double deviation : deviations) {
    if (deviation < 0) continue;
    sum += deviation, ++counted;
    largest = std::max(largest, deviation);
  }
  if (!options.pictures.empty()) {
    constexpr double kLeast = 0.1, kMost = 100;  // Lab, as FBTF figure 11
    const auto path = options.pictures / ("view-coherence-" + tile + "-" + kind.name + ".png");
    if (const Status status = writeFigure(logarithmicPicture(deviations, kind.side, kLeast, kMost), path);
        !status)
      return status.issue();
  }
  StudyRow row;
  row.set("tile", tile)
      .set("size", kind.side)
      .set("kind", kind.name)
      .set("mean", sum / std::max(1, counted))
      .set("max", largest);
  return row.set("texels", counted);
}

}  // namespace

Result<StudyRows> studyViewCoherence(const StudyOptions& options) {
  StudyRows rows;
  for (const std::string& tile : options.tiles) {
    const auto baked = studyBake(options, tile);
    if (!baked) return baked.issue();
    const auto btf = [&](int view) { return baked->btfView(view); };
    const auto flat = [&](int view) { return baked->flatView(view); };
    StudyBake by_view;
    by_view.fill = FillMethod::kNearestView;
    by_view.maps = {.btf = false, .flat = true, .vdim = false, .surface = false};
    const auto filled = studyBake(options, tile, by_view);
    if (!filled) return filled.issue();
    const auto flat_by_view = [&](int view) { return filled->flatView(view); };
    const int side = baked->manifest().size, flat_side = baked->manifest().flat_size;
    for (const Kind& kind : {Kind{"btf", btf, false, side}, Kind{"flat-filled", flat, false, flat_side},
                             Kind{"flat-filled-nearest-view", flat_by_view, false, flat_side},
                             Kind{"flat-visible", flat, true, flat_side}}) {
      auto row = measure(*baked, tile, kind, options);
      if (!row) return row.issue();
      rows.push_back(std::move(*row));
    }
  }
  return rows;
}

}  // namespace loden::importer
