#include "importer/fit/sampled_error.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "importer/base/parallel.h"
#include "material/model/color.h"

namespace loden::importer {
namespace {

struct Sums {
  double squares[3] = {0, 0, 0}, absolute[3] = {0, 0, 0}, lab = 0;
  int64_t count = 0;
};

glm::dvec3 meanOver(const Evaluator& evaluator, glm::ivec2 texel, int points, const glm::dvec3& wi,
                    const glm::dvec3& wo) {
  const double side = evaluator.material().side, lambda = -std::log2(double(points));
  glm::dvec3 sum(0);
  for (int k = 0; k < points * points; ++k) {
    const glm::dvec2 inside = (glm::dvec2(k % points, k / points) + 0.5) / double(points);
    const auto hit = evaluator.findHit((glm::dvec2(texel) + inside) / side, lambda, wo);
    sum += evaluator.evaluate(hit, wi, wo);
  }
  return sum / double(points * points);
}

}  // namespace

SampledError sampledError(const Evaluator& evaluator, const std::vector<BtfSample>& samples,
                          const DirectionSet& lights, const DirectionSet& views, int points, int threads) {
  std::vector<Sums> of_view(views.samples.size());
  const size_t per_view = samples.size() / of_view.size();
  parallelFor(of_view.size(), threads, [&](size_t v) {
    Sums& sums = of_view[v];
    for (const BtfSample& sample : std::span(samples).subspan(v * per_view, per_view)) {
      const glm::dvec3 value = meanOver(evaluator, sample.texel, points, lights.samples[size_t(sample.light)],
                                        views.samples[size_t(sample.view)]);
      const glm::dvec3 difference = yccFromRgb(value) - sample.ycc;
      for (int c = 0; c < 3; ++c) {
        sums.squares[c] += difference[c] * difference[c];
        sums.absolute[c] += std::abs(difference[c]);
      }
      sums.lab +=
          glm::length(labFromRgb(value) - labFromRgb(glm::max(rgbFromYcc(sample.ycc), glm::dvec3(0))));
      ++sums.count;
    }
  });
  SampledError error;
  Sums all;
  for (const Sums& sums : of_view) {
    for (int c = 0; c < 3; ++c) all.squares[c] += sums.squares[c], all.absolute[c] += sums.absolute[c];
    all.lab += sums.lab, all.count += sums.count;
  }
  for (int c = 0; c < 3; ++c)
    error.channel[c].mse = all.squares[c] / double(all.count),
    error.channel[c].mae = all.absolute[c] / double(all.count);
  error.lab = all.lab / double(all.count);
  return error;
}

}  // namespace loden::importer
