#include "importer/cook/level_choice.h"

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

constexpr int kNearLevels = 3;  // that the near term may be shown at
constexpr int kSamples = 8000;  // a level
constexpr QuadLevels kNever{kNoEnd, -kNoEnd};
// Windows of the near term that are tried, in steps of kStep.
constexpr double kFirstBegin = 0.25, kLastEnd = kNearLevels, kStep = 0.25;
constexpr double kNarrowest = 0.75;  // so that nothing jumps: a step of .01 of lambda changes w by 1/75

// As a display shows it, so that single peaks do not decide.
glm::dvec3 shown(const glm::dvec3& rgb) {
  return glm::clamp(rgb, 0.0, 1.0);
}
// The mean over the channels.
double meanProduct(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::dot(a, b) / 3;
}

// The near term alone, and the bands alone with 1, 2 and more quads of the coarsest.
struct Candidates {
  std::optional<Material> near_alone;
  std::vector<Material> bands_alone;
  std::optional<Evaluator> near;
  std::vector<Evaluator> bands;

  Candidates(const Material& material, int threads) {
    if (material.surface) {
      near_alone = material;
      near_alone->bands.clear();
      near.emplace(*near_alone, onThreads(threads));
    }
    Material bands_of = material;
    bands_of.surface.reset();
    bands_of.geometry = {};
    const int quads = material.bands.back().quads();
    for (int count = 1; count <= quads; ++count) {
      std::vector<QuadLevels>& levels = bands_of.bands.back().quad_levels;
      std::fill(levels.begin(), levels.begin() + count, QuadLevels{});
      std::fill(levels.begin() + count, levels.end(), kNever);
      bands_alone.push_back(bands_of);
    }
    for (const Material& m : bands_alone) bands.emplace_back(m);
  }
};

LevelTrial measured(const Candidates& candidates, const YccBtf& btf, int level, const DirectionSet& lights,
                    const DirectionSet& views, int threads) {
  const bool with_near = candidates.near && level <= kNearLevels;
  const size_t counts = candidates.bands.size();
  LevelTrial none{level, 0, std::vector<LevelTrial::Quads>(counts)};
  const int per_view = std::max(1, kSamples / btf.views());
  std::vector<LevelTrial> of_view(size_t(btf.views()), none);
  parallelFor(of_view.size(), threads, [&](size_t v) {
    Matrix truth[3];
    for (int c = 0; c < 3; ++c) btf.read(c, int(v), truth[c]);
    const glm::dvec3& wo = views.samples[v];
    for (int s = 0; s < per_view; ++s) {
      const uint64_t seed = mixSeed(v, uint64_t(s));
      const int t = std::min(int(uniform(seed, 0) * btf.texels()), btf.texels() - 1);
      const int l = std::min(int(uniform(seed, 1) * btf.lights()), btf.lights() - 1);
      const glm::dvec3& wi = lights.samples[size_t(l)];
      const glm::dvec2 texel(t % btf.side(), t / btf.side());
      const glm::dvec3 given = shown(rgbFromYcc(glm::dvec3(truth[0](t, l), truth[1](t, l), truth[2](t, l))));
      const auto valueOf = [&](const Evaluator& evaluator) {
        const auto hit = evaluator.findHit((texel + 0.5) / double(btf.side()), double(level), wo);
        return shown(evaluator.evaluate(hit, wi, wo));
      };
      LevelTrial& sums = of_view[v];
      const glm::dvec3 near = with_near ? valueOf(*candidates.near) - given : glm::dvec3(0);
      sums.near_mse += meanProduct(near, near);
      for (size_t k = 0; k < counts; ++k) {
        const glm::dvec3 bands = valueOf(candidates.bands[k]) - given;
        sums.quads[k].mse += meanProduct(bands, bands), sums.quads[k].product += meanProduct(near, bands);
      }
    }
  });
  LevelTrial trial = none;
  const double count = double(per_view) * btf.views();
  for (const LevelTrial& sums : of_view) {
    trial.near_mse += sums.near_mse / count;
    for (size_t k = 0; k < counts; ++k) {
      trial.quads[k].mse += sums.quads[k].mse / count;
      trial.quads[k].product += sums.quads[k].product / count;
    }
  }
  return trial;
}

struct Window {
  double begin = 0, end = 0;
  double weightAt(double lambda) const { return std::clamp((end - lambda) / (end - begin), 0.0, 1.0); }
};

// Mean logarithm of the root mean square of what the window shows, from level 1 to kNearLevels or the last;
// between two levels by interpolation.
double errorOf(const Window& window, const std::vector<LevelTrial>& trials) {
  const double last = std::min(double(kNearLevels), double(trials.size()));
  double sum = 0;
  int count = 0;
  for (double lambda = 1; lambda <= last; lambda += kStep, ++count) {
    const size_t below = size_t(lambda) - 1, above = std::min(below + 1, trials.size() - 1);
    const double w = window.weightAt(lambda), t = lambda - std::floor(lambda);
    const auto mse = [&](size_t level) { return trials[level].mse(w, trials[level].quads.size()); };
    sum += std::log(std::max((1 - t) * mse(below) + t * mse(above), 1e-12)) / 2;
  }
  return sum / std::max(count, 1);
}

void chooseFade(SurfaceMaps& maps, const std::vector<LevelTrial>& trials, float lambda_max) {
  std::vector<std::pair<Window, double>> tried;
  double least = std::numeric_limits<double>::infinity();
  for (double end = kFirstBegin + kNarrowest; end <= kLastEnd; end += kStep)
    for (double begin = end - kNarrowest; begin >= kFirstBegin; begin -= kStep) {
      if (!tried.empty() && end > double(lambda_max) + 1) break;
      const Window window{begin, end};
      tried.emplace_back(window, errorOf(window, trials));
      least = std::min(least, tried.back().second);
    }
  const auto narrower = [&](const auto& a, const auto& b) {
    const double wide_a = a.first.end - a.first.begin, wide_b = b.first.end - b.first.begin;
    return std::pair(wide_a, a.second) < std::pair(wide_b, b.second);
  };
  std::erase_if(tried, [&](const auto& trial) { return trial.second > least + std::log(1 + kFadeLoss); });
  const Window& window = std::min_element(tried.begin(), tried.end(), narrower)->first;
  maps.fade_begin = float(window.begin), maps.fade_end = float(window.end);
}

void chooseQuads(Band& band, const std::vector<LevelTrial>& trials, const SurfaceMaps* maps) {
  // Without a near term what is finer than the levels that were measured is shown by all of them.
  std::fill(band.quad_levels.begin() + 1, band.quad_levels.end(), maps ? kNever : QuadLevels{-kNoEnd, 1});
  for (const LevelTrial& trial : trials) {
    const double w =
        maps ? Window{double(maps->fade_begin), double(maps->fade_end)}.weightAt(trial.level) : 0.0;
    const size_t all = trial.quads.size();
    const double allowed =
        std::max(std::sqrt(trial.mse(w, all)) * (1 + (w > 0 ? kBlendLoss : kQuadLoss)), kQuadFloor);
    size_t count = 1;
    while (count < all && std::sqrt(trial.mse(w, count)) > allowed) ++count;
    // What the last level reads, all beyond it read.
    const float end = trial.level == trials.back().level ? kNoEnd : float(trial.level + 1);
    for (size_t k = 1; k < count; ++k) {
      band.quad_levels[k].begin = std::min(band.quad_levels[k].begin, float(trial.level - 1));
      band.quad_levels[k].end = end;
    }
  }
}

}  // namespace

std::vector<LevelTrial> chooseLevels(Material& material, const YccBtf& half, const DirectionSet& lights,
                                     const DirectionSet& views, int threads) {
  Band& coarsest = material.bands.back();
  const Candidates candidates(material, threads);
  std::vector<LevelTrial> trials;
  std::optional<YccBtf> coarse;
  // Beyond the last level the bands have nothing of their own.
  const int last = static_cast<int>(std::lround(material.lambda_max));
  const YccBtf* truth = &half;
  for (int level = 1; level <= last; ++level) {
    trials.push_back(measured(candidates, *truth, level, lights, views, threads));
    if (truth->side() == 1 || level == last) break;
    coarse = downsample(*truth, BoxFilter::k2x2, threads);
    truth = &*coarse;
  }
  SurfaceMaps* maps = material.surface ? &*material.surface : nullptr;
  if (maps) chooseFade(*maps, trials, material.lambda_max);
  if (!trials.empty()) chooseQuads(coarsest, trials, maps);
  return trials;
}

double shownRmse(const Material& material, const std::vector<LevelTrial>& trials) {
  // Without a near term its weight is 0 from the first level on.
  Window window{-1, 0};
  if (material.surface) window = {double(material.surface->fade_begin), double(material.surface->fade_end)};
  return trials.empty() ? 0 : std::exp(errorOf(window, trials));
}

}  // namespace loden::importer
