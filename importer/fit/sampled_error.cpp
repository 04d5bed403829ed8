#include "importer/fit/sampled_error.h"

#include <algorithm>
#include <cmath>

#include "importer/base/parallel.h"
#include "importer/base/random.h"
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

SampledError sampledError(const Evaluator& evaluator, const YccBtf& btf, const DirectionSet& lights,
                          const DirectionSet& views, int points, int samples, int threads) {
  const int per_view = std::max(1, samples / btf.views());
  std::vector<Sums> of_view(size_t(btf.views()));
  parallelFor(of_view.size(), threads, [&](size_t v) {
    Matrix truth[3];
    for (int c = 0; c < 3; ++c) btf.read(c, int(v), truth[c]);
    Sums& sums = of_view[v];
    for (int s = 0; s < per_view; ++s) {
      const uint64_t seed = mixSeed(v, uint64_t(s));
      const int t = std::min(int(uniform(seed, 0) * btf.texels()), btf.texels() - 1);
      const int l = std::min(int(uniform(seed, 1) * btf.lights()), btf.lights() - 1);
      const glm::dvec3 value = meanOver(evaluator, {t % btf.side(), t / btf.side()}, points,
                                        lights.samples[size_t(l)], views.samples[v]);
      const glm::dvec3 given(truth[0](t, l), truth[1](t, l), truth[2](t, l));
      const glm::dvec3 difference = yccFromRgb(value) - given;
      for (int c = 0; c < 3; ++c) {
        sums.squares[c] += difference[c] * difference[c];
        sums.absolute[c] += std::abs(difference[c]);
      }
      sums.lab += glm::length(labFromRgb(value) - labFromRgb(glm::max(rgbFromYcc(given), glm::dvec3(0))));
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
