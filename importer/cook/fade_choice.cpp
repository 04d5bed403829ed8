#include "importer/cook/fade_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "importer/base/parallel.h"
#include "importer/base/random.h"
#include "material/eval/evaluate.h"
#include "material/model/color.h"
#include "material/system/threads.h"

namespace loden::importer {
namespace {

constexpr int kLevels = 3;
constexpr int kSamples = 8000;  // a level
constexpr float kBegins[] = {0.25f, 0.5f, 0.75f, 1.0f};
constexpr float kEnds[] = {1.5f, 1.75f, 2.0f, 2.25f, 2.5f, 2.75f, 3.0f};

// As displays show it: what is brighter than white counts as white, so that single peaks do not decide.
double luma(const glm::dvec3& rgb) {
  return std::min(yccFromRgb(rgb).x, 1.0);
}

FadeTrial measured(const Evaluator& near, const Evaluator& bands, const YccBtf& btf, int level,
                   const DirectionSet& lights, const DirectionSet& views, int threads) {
  struct Sums {
    double near = 0, band = 0, product = 0;
    int count = 0;
  };
  const int per_view = std::max(1, kSamples / btf.views());
  std::vector<Sums> of_view(size_t(btf.views()));
  parallelFor(of_view.size(), threads, [&](size_t v) {
    Matrix truth;
    btf.read(0, int(v), truth);
    const glm::dvec3& wo = views.samples[v];
    for (int s = 0; s < per_view; ++s) {
      const uint64_t seed = mixSeed(v, uint64_t(s));
      const int t = std::min(int(uniform(seed, 0) * btf.texels()), btf.texels() - 1);
      const int l = std::min(int(uniform(seed, 1) * btf.lights()), btf.lights() - 1);
      const glm::dvec3& wi = lights.samples[size_t(l)];
      const glm::dvec2 texel(t % btf.side(), t / btf.side());
      const double given = std::min(truth(t, l), 1.0);
      const auto valueOf = [&](const Evaluator& evaluator, double inside) {
        const auto hit = evaluator.findHit((texel + inside) / double(btf.side()), double(level), wo);
        return luma(evaluator.evaluate(hit, wi, wo));
      };
      const double a = (valueOf(near, 0.25) + valueOf(near, 0.75)) / 2 - given;
      const double b = valueOf(bands, 0.5) - given;
      Sums& sums = of_view[v];
      sums.near += a * a, sums.band += b * b, sums.product += a * b, ++sums.count;
    }
  });
  FadeTrial trial{level};
  int count = 0;
  for (const Sums& sums : of_view) {
    trial.near_mse += sums.near, trial.band_mse += sums.band, trial.product += sums.product;
    count += sums.count;
  }
  for (double* mean : {&trial.near_mse, &trial.band_mse, &trial.product}) *mean /= std::max(count, 1);
  return trial;
}

}  // namespace

std::vector<FadeTrial> chooseFade(Material& material, const YccBtf& btf, const DirectionSet& lights,
                                  const DirectionSet& views, int threads) {
  Material near_alone = material, bands_alone = material;
  near_alone.bands.clear();
  bands_alone.surface.reset();
  bands_alone.geometry = {};
  const Evaluator near(near_alone, onThreads(threads)), bands(bands_alone);
  std::vector<FadeTrial> trials;
  std::optional<YccBtf> coarse;
  // Beyond the last level the bands have nothing of their own.
  const int last = std::min(kLevels, static_cast<int>(std::lround(material.lambda_max)));
  for (int level = 1; level <= last && (coarse ? coarse->side() : btf.side()) > 1; ++level) {
    coarse = downsample(coarse ? *coarse : btf, BoxFilter::k2x2, threads);
    trials.push_back(measured(near, bands, *coarse, level, lights, views, threads));
  }
  double least = std::numeric_limits<double>::infinity();
  SurfaceMaps& maps = *material.surface;
  maps.fade_begin = kBegins[0], maps.fade_end = kEnds[0];
  for (const float begin : kBegins)
    for (const float end : kEnds) {
      if (end > material.lambda_max + 1) break;
      double product = 0;  // of the errors, as a sum of logarithms
      for (const FadeTrial& trial : trials) {
        const double w = std::clamp((double(end) - trial.level) / (double(end) - double(begin)), 0.0, 1.0);
        product += std::log(std::max(trial.mse(w), 1e-12));
      }
      if (product >= least) continue;
      least = product;
      maps.fade_begin = begin, maps.fade_end = end;
    }
  return trials;
}

}  // namespace loden::importer
