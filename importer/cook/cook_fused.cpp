#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "importer/base/progress.h"
#include "importer/cook/fused_plan.h"
#include "importer/cook/goal.h"
#include "importer/cook/level_choice.h"
#include "importer/cook/meta.h"
#include "importer/cook/modes.h"
#include "importer/fit/band_fit.h"
#include "importer/fit/coarse_fit.h"
#include "importer/fit/flat_fit.h"
#include "importer/fit/grid_table.h"
#include "importer/fit/ratio_fit.h"
#include "importer/tile/charts.h"
#include "material/eval/evaluate.h"
#include "material/model/leading_part.h"
#include "material/system/threads.h"

namespace loden::importer {
namespace {

constexpr int kFullPhis = 25;  // from here on the grid can give back every sample of Bonn's rings
// Averages over the tile's surface are not averages over what a view sees of it: at lambda 1 the unfiltered
// maps are closer to the truth than their mip 1, and half way between is the closest.
constexpr float kFlatFirst = 0.5f;
constexpr int kFlatMips = 2;  // to lambda 1.5; at 2 the reference-domain band has taken over
constexpr float kCrossFadeBegin = 1, kCrossFadeEnd = 2;
// Filtering of mips blurs: a pixel shows the average over its footprint, and between two levels that is 1 to
// 4 dB closer to what is read half a level finer. At a level whose texels the pixels lie on it is the same.
constexpr float kCoarseFirst = 1.5f;
constexpr int kChromaSweeps = 2;

// A single texel is its own average.
bool hasCoarseBand(const FusedPlan& plan, int side) {
  return plan.coarse_y > 0 && plan.levels != 1 && side > 1;
}
int flatMips(const FusedPlan& plan, int flat_side) {
  return plan.levels == 1 ? 1 : std::min(kFlatMips, fullMipCount(flat_side, flat_side));
}
int coarseMips(const FusedPlan& plan, int half) {
  const int all = fullMipCount(half, half);
  return plan.levels == 0 ? all : std::min(plan.levels - 1, all);
}

// What the fits of both bands share.
struct FusedInput {
  const BtfSource& source;
  const Material& material;  // mean and geometry are set
  Matrix means;              // of each image, (views * lights) x 3
  Matrix mean;               // the fitted mean at the samples, of the same shape
  int threads;
};

// Cb and Cr of the fine band beyond a ratio to the luma that results.
void fitFlatChroma(const FusedInput& in, const YccBtf& btf, const Indirection& a, const FusedPlan& plan,
                   const DirectionGrid& grid, const ColumnBlocks& luma, FlatFitOptions fit,
                   BandFactors& factors) {
  fit.components = plan.chroma_components;
  fit.sweeps = kChromaSweeps;
  for (const int channel : {1, 2}) {
    const ColumnBlocks rest = ratioResidual(btf, channel, luma, factors.ratio[0], a);
    Factors& f = channel == 1 ? factors.cb : factors.cr;
    f.weights = quantisedWeights(fitFlat(rest, a, fit).factors.weights, plan.storage);
    f.basis = factors.on_grid ? solveGridBasis(rest, a, f.weights, grid, in.source.lights(),
                                               in.source.views(), in.threads)
                              : solveBasis(rest, a, f.weights, in.threads);
  }
}

// The fine band: joint fit of Y through the lookup, then the table again for the weights as they are stored,
// then chroma as a ratio to the Y that results, and what that leaves where components are given for it.
Band fitFlatBand(const FusedInput& in, const YccBtf& btf, const Indirection& a, const FusedPlan& plan) {
  const DirectionSet &lights = in.source.lights(), &views = in.source.views();
  const DirectionGrid grid = gridFor(lights, 6, plan.phis);
  BandFactors factors;
  factors.side = flatSide(plan, btf.side());
  const ColumnBlocks luma = centredBlocks(btf, 0, in.mean);
  FlatFitOptions fit;
  fit.components = plan.y_components;
  fit.sweeps = plan.sweeps;
  fit.owners = chartOwners(factors.side, in.material.geometry);
  fit.threads = in.threads;
  const Matrix weights = quantisedWeights(fitFlat(luma, a, fit).factors.weights, plan.storage);
  factors.on_grid = plan.phis < kFullPhis;
  Factors at_samples{weights, {}};
  if (factors.on_grid) {
    const Matrix table = solveGridBasis(luma, a, weights, grid, lights, views, in.threads);
    factors.y = {weights, table};
    at_samples.basis = mapTables(table, gridSampling(grid, lights), gridSampling(grid, views));
  } else {
    at_samples.basis = solveBasis(luma, a, weights, in.threads);
    factors.y = at_samples;
  }
  const ColumnBlocks whole = wholeLuma(btf, at_samples, in.mean, a);
  factors.ratio = {fitRatios(btf, whole, in.material.mean, a, in.threads)};
  if (plan.chroma_components > 0) fitFlatChroma(in, btf, a, plan, grid, whole, fit, factors);
  const int mips = flatMips(plan, factors.side);
  Band band = packBand(factors, lights, views, {TableLayout::kGrid, plan.storage, grid, mips, 0, fit.owners});
  band.domain = Domain::kFlat;
  band.lambda_first = kFlatFirst;
  if (hasCoarseBand(plan, btf.side())) band.window = {-2, -1, kCrossFadeBegin, kCrossFadeEnd};
  return band;
}

// Fits the chroma of the coarse band to the luma that results. Ratios are fitted to each level's own
// averages: a mean of ratios is not the ratio of means. Components hold what the ratios leave.
void fitCoarseChroma(const FusedInput& in, const YccBtf& half, Factors luma, const CoarseFitOptions& options,
                     BandFactors& factors) {
  std::deque<YccBtf> coarser;  // keep what the blocks read
  std::deque<Factors> lumas;
  std::deque<Indirection> straights;
  std::vector<ColumnBlocks> rest[2];  // of Cb and Cr, by level
  for (const YccBtf* level = &half;; level = &coarser.back()) {
    const Indirection& straight =
        straights.emplace_back(identityIndirection(level->texels(), level->views()));
    const ColumnBlocks whole = wholeLuma(*level, lumas.emplace_back(luma), in.mean, straight);
    factors.ratio.push_back(fitRatios(*level, whole, in.material.mean, straight, in.threads));
    for (int c = 0; c < 2; ++c)
      rest[c].push_back(ratioResidual(*level, c + 1, whole, factors.ratio.back(), straight));
    if (level->side() == 1) break;
    luma.weights = downsample(luma.weights, level->side(), BoxFilter::k2x2);
    coarser.push_back(downsample(*level, BoxFilter::k2x2, in.threads));
  }
  if (options.chroma_components == 0) return;
  const DirectionSet &lights = in.source.lights(), &views = in.source.views();
  factors.cb = fitCoarseChroma(rest[0], half.side(), lights, views, options);
  factors.cr = fitCoarseChroma(rest[1], half.side(), lights, views, options);
}

// The coarse band: apparent reflectance over the reference plane, from lambda 1 to the full average; `half`
// the BTF of half the side.
Band fitCoarseBand(const FusedInput& in, const FusedPlan& plan, const YccBtf& half) {
  const DirectionSet &lights = in.source.lights(), &views = in.source.views();
  const CoarseFitOptions fit{plan.coarse_y, plan.coarse_chroma.value_or(0),
                             averageGrid(in.means, in.mean, lights, views, plan.coarse_phis), in.threads};
  BandFactors factors = fitCoarse(half, lights, views, in.mean, fit);
  const Matrix sample_lights = gridSampling(fit.grid, lights), sample_views = gridSampling(fit.grid, views);
  const Factors at_samples{factors.y.weights, mapTables(factors.y.basis, sample_lights, sample_views)};
  fitCoarseChroma(in, half, at_samples, fit, factors);
  const int mips = coarseMips(plan, half.side());
  Band band = packBand(factors, lights, views, {TableLayout::kGrid, Storage::kSnorm8, fit.grid, mips, 0});
  band.lambda_first = kCoarseFirst;
  band.window = {kCrossFadeBegin, kCrossFadeEnd};
  return band;
}

// The last level that the bands have, or without one the near maps.
float coarsestLevelOf(const Material& m) {
  if (m.bands.empty()) return std::max(m.surface->lambda_first + float(m.surface->color.mips - 1), 0.0f);
  const Band& last = m.bands.back();
  return last.lambda_first + static_cast<float>(last.weights.mips - 1);
}

}  // namespace

int flatSide(const FusedPlan& plan, int side) {
  return std::max(1, static_cast<int>(std::lround(side * plan.flat_scale)));
}

namespace {

// Luma that the mean and the coarse band of a near term are fitted to at most, white = 1. Peaks of metal
// stand for a few light and view pairs; they would decide a least squares fit alone, and drown all else.
constexpr double kBrightest = 2;
constexpr int kErrorSamples = 20000;  // random texels, lights and views
constexpr int kErrorPoints = 2;       // evaluations per side of a texel
// The default lookup towards the light takes up to twice the fetches of the fast one: it has to leave no more
// than this share of the error.
constexpr double kDefaultGain = 0.975;
// A quad of the coarse band holds chroma in place of Y if that leaves no more than this share of the error.
constexpr double kChromaGain = 0.95;

void advance(Progress* progress, uint64_t steps) {
  if (progress) progress->advance(steps);
}

// The coarse band that takes over from the near term, and its levels. Without a number in the plan, quads
// hold chroma in place of Y for as long as each brings what is shown clearly closer.
void fitCoarseLevels(FusedFit& fit, const FusedInput& in, const FusedPlan& plan, const YccBtf& half,
                     const YccBtf& bounded) {
  const int quads = (plan.coarse_y + 3) / 4, most = plan.coarse_chroma ? 0 : quads - 1;
  for (int chroma = 0; chroma <= most; ++chroma) {
    FusedPlan tried = plan;
    if (chroma > 0) tried.coarse_y = 4 * (quads - chroma), tried.coarse_chroma = 2 * chroma;
    Material m = fit.material;
    m.bands = {fitCoarseBand(in, tried, bounded)};
    m.bands.back().window = {};
    m.lambda_max = coarsestLevelOf(m);
    std::vector<LevelTrial> levels = chooseLevels(m, half, in.source.lights(), in.source.views(), in.threads);
    const double rmse = shownRmse(m, levels);
    const bool closer = chroma == 0 || rmse < kChromaGain * fit.chroma.back().rmse_rgb;
    if (most > 0) fit.chroma.push_back({chroma, rmse, closer});
    if (!closer) break;
    fit.material = std::move(m), fit.levels = std::move(levels);
  }
}

// A near term and the coarse band that takes over from it. `bounded`: the BTF at half the side, up to
// kBrightest.
void fitNear(FusedFit& fit, const FusedInput& in, const FusedPlan& plan, const BakedSurface& surface,
             const HalvedBtf& btf, const YccBtf& bounded, Progress* progress) {
  Material& m = fit.material;
  NearOptions near{surface.side / plan.surface_side, hasCoarseBand(plan, m.side),
                   plan.visibility.value_or(Visibility::kFast), plan.bounces};
  m.surface = nearMaps(surface, m.geometry, m.side, near, in.threads);
  const auto measure = [&](int points) {
    const Evaluator evaluator(m, onThreads(in.threads));
    return sampledError(evaluator, btf.samples, in.source.lights(), in.source.views(), points, in.threads);
  };
  if (m.surface->indirect.width > 0) {
    fit.indirect.emplace();
    fit.indirect->with = measure(kErrorPoints).channel[0].rmse();
    const Texture indirect = std::exchange(m.surface->indirect, {});
    fit.indirect->without = measure(kErrorPoints).channel[0].rmse();
    if (fit.indirect->with < fit.indirect->without) m.surface->indirect = indirect;
  }
  advance(progress, 2);
  if (near.with_bands) {
    fitCoarseLevels(fit, in, plan, btf.half, bounded);
    advance(progress, 5);
  }
  fit.near_at_centres = measure(1);
  // The frugal lookup, unless another is clearly better with one evaluation, as pictures have it.
  if (!plan.visibility && m.surface->visibility != Visibility::kNone) {
    for (const auto& [visibility, gain] :
         {std::pair{Visibility::kDefault, kDefaultGain}, {Visibility::kNone, 1.0}}) {
      const Visibility before = std::exchange(m.surface->visibility, visibility);
      const SampledError other = measure(1);
      if (other.channel[0].rmse() < gain * fit.near_at_centres->channel[0].rmse())
        fit.near_at_centres = other;
      else
        m.surface->visibility = before;
    }
  }
  fit.near = measure(kErrorPoints);
  for (int c = 0; c < 3; ++c) fit.error.channel[c] = fit.near->channel[c];
}

// A flat-domain band through the lookup, and the coarse one.
void fitBands(FusedFit& fit, const FusedInput& in, const YccBtf& btf, const FusedPlan& plan, int lab_every,
              Progress* progress) {
  Material& m = fit.material;
  const VdimAtlas atlas = buildVdimAtlas(m.geometry, m.atlas, onThreads(in.threads));
  VdimMaps maps;
  maps.atlas = &atlas;
  const Indirection a = makeIndirection(
      btf.side(), flatSide(plan, btf.side()), in.source.views(),
      [&](glm::dvec2 x, const glm::dvec3& wo) { return vdimLookup(maps, Lookup::kDefault, x, wo).p; },
      in.threads);
  m.bands.push_back(fitFlatBand(in, btf, a, plan));
  advance(progress, 6);
  if (hasCoarseBand(plan, m.side))
    m.bands.push_back(fitCoarseBand(in, plan, downsample(btf, BoxFilter::k2x2, in.threads)));
  fit.error = measureError(m, btf, in.source.lights(), in.source.views(), a, in.threads, lab_every);
}

// What both kinds of plan begin with.
void begin(FusedFit& fit, const BtfSource& source, int side, const GeometryImage& geometry,
           const FusedPlan& plan, int threads, Progress* progress) {
  Material& m = fit.material;
  m.mode = Mode::kFused;
  m.name = source.name();
  m.side = side;
  m.value_scale = static_cast<float>(1 / kPi);
  m.geometry = geometry;
  AtlasChoice atlas;
  if (plan.atlas)
    atlas.size = *plan.atlas;
  else
    atlas = chooseAtlas(geometry, m.side, threads);
  m.atlas = atlas.size;
  fit.atlases = std::move(atlas.trials);
  advance(progress, 2);
  m.theta_max = gridFor(source.lights()).theta_max;
}

// Fits the mean to the images of the BTF, and sets it.
FusedInput fitMean(FusedFit& fit, const BtfSource& source, const YccBtf& btf, int threads) {
  Matrix means = imageMeans(btf, threads);
  PhongMean& mean = fit.material.mean;
  mean = fitPhong(means, source.lights(), source.views(), {true, MeanChroma::kRatio}).mean;
  return {source, fit.material, std::move(means), sampleMean(mean, source.lights(), source.views()), threads};
}

void finish(Material& m) {
  m.lambda_max = coarsestLevelOf(m);
  splitLeadingParts(m);
}

}  // namespace

FusedFit fitFusedBands(const BtfSource& source, const YccBtf& btf, const GeometryImage& geometry,
                       const FusedPlan& plan, int threads, int lab_every, Progress* progress) {
  FusedFit fit;
  begin(fit, source, btf.side(), geometry, plan, threads, progress);
  fitBands(fit, fitMean(fit, source, btf, threads), btf, plan, lab_every, progress);
  finish(fit.material);
  return fit;
}

FusedFit fitFusedNear(const BtfSource& source, const HalvedBtf& btf, const BakedSurface& surface,
                      const GeometryImage& geometry, const FusedPlan& plan, int threads, Progress* progress) {
  FusedFit fit;
  begin(fit, source, btf.side, geometry, plan, threads, progress);
  std::optional<YccBtf> bounded;
  if (btf.side > 1) bounded = limited(btf.half, kBrightest, threads);
  const YccBtf& fitted = bounded ? *bounded : btf.half;
  fitNear(fit, fitMean(fit, source, fitted, threads), plan, surface, btf, fitted, progress);
  finish(fit.material);
  return fit;
}

uint64_t fusedBytes(const FusedPlan& plan, int side, int geometry_side) {
  const auto maps = [](Storage storage, int texels_side, int mips, int layers) {
    return textureBytes(formatOf(storage), uint64_t(texels_side), uint64_t(texels_side), uint64_t(layers),
                        mips);
  };
  const auto tables = [](Storage storage, int quads, int phis) {
    return textureBytes(formatOf(storage), uint64_t(phis), 36, uint64_t(quads * phis), 1);
  };
  const int flat_side = flatSide(plan, side);
  const int fine_quads = (plan.y_components + 3) / 4 + (plan.chroma_components + 1) / 2,
            coarse_quads = (plan.coarse_y + 3) / 4 + (plan.coarse_chroma.value_or(0) + 1) / 2;
  uint64_t bytes =
      textureBytes(TexelFormat::kRGBA16Unorm, uint64_t(geometry_side), uint64_t(geometry_side), 1, 1);
  if (plan.surface_side > 0) {
    bytes += nearBytes(plan.surface_side, side, hasCoarseBand(plan, side),
                       plan.visibility == Visibility::kMap, plan.bounces > 0);
    if (hasCoarseBand(plan, side))
      bytes += maps(Storage::kSnorm8, side / 2, coarseMips(plan, side / 2), coarse_quads + 1) +
               tables(Storage::kSnorm8, coarse_quads, plan.coarse_phis);
    return bytes;
  }
  bytes += maps(plan.storage, flat_side, flatMips(plan, flat_side), fine_quads + 1) +
           tables(plan.storage, fine_quads, plan.phis);
  if (hasCoarseBand(plan, side))
    bytes += maps(Storage::kSnorm8, side / 2, coarseMips(plan, side / 2), coarse_quads + 1) +
             tables(Storage::kSnorm8, coarse_quads, plan.coarse_phis);
  return bytes;
}

namespace {

constexpr int kTrialSweeps = 2;  // enough to rank candidates

FusedPlan presetPlan(const CookOptions& options, const BakedSurface& surface) {
  FusedPlan plan;
  if (options.preset == Preset::kReference)
    plan = {.y_components = 32, .flat_scale = 2, .phis = 25, .coarse_y = 16, .coarse_phis = 25};
  if (options.near == Near::kSurface) {
    plan.surface_side = surface.side;
    plan.visibility = options.visibility;
    plan.bounces = surface.bounces;
    if (options.y_components) plan.coarse_y = options.y_components;
    if (options.y_components || options.cb_components) plan.coarse_chroma = options.cb_components;
  }
  if (options.y_components) plan.y_components = options.y_components;
  plan.chroma_components = options.cb_components;
  plan.levels = options.levels;
  return plan;
}

// The BTF as the kind of plan reads it, and fits of such plans.
class FusedFits {
 public:
  static Result<FusedFits> load(const BtfSource& source, const BakedSurface& surface, bool near,
                                int threads) {
    FusedFits fits(source, surface, threads);
    if (near) {
      auto halved = loadHalved(source, kErrorSamples, threads);
      if (!halved) return halved.issue();
      fits.halved_ = std::move(*halved);
    } else {
      auto whole = loadYcc(source, threads);
      if (!whole) return whole.issue();
      fits.whole_ = std::move(*whole);
    }
    return fits;
  }
  FusedFit fit(const FusedPlan& plan, const GeometryImage& geometry, Progress* progress = nullptr) const {
    return halved_ ? fitFusedNear(source_, *halved_, surface_, geometry, plan, threads_, progress)
                   : fitFusedBands(source_, *whole_, geometry, plan, threads_, 0, progress);
  }

 private:
  FusedFits(const BtfSource& source, const BakedSurface& surface, int threads)
      : source_(source), surface_(surface), threads_(threads) {}

  const BtfSource& source_;
  const BakedSurface& surface_;
  int threads_;
  std::optional<HalvedBtf> halved_;
  std::optional<YccBtf> whole_;
};

}  // namespace

Result<Material> cookFused(const BtfSource& source, const GeometryReader& geometry,
                           const BakedSurface& surface, const CookOptions& options) {
  const Status levels = checkLevels(options.levels, source.size().x);
  if (!levels) return levels.issue();
  FusedPlan plan = presetPlan(options, surface);
  const int side = source.size().x;
  const auto fits = FusedFits::load(source, surface, plan.surface_side > 0, options.threads);
  if (!fits) return fits.issue();
  std::vector<TradePoint> measured;
  if (options.max_bytes > 0 || options.target_rmse > 0) {
    const auto baked = geometry(0);
    if (!baked) return baked.issue();
    Goal goal{options.max_bytes, options.target_rmse, options.levels};
    goal.surface_side = plan.surface_side;
    goal.bounces = plan.bounces;
    Progress progress("cook " + source.name() + ": trying plans", uint64_t(mostTrials(goal, baked->side())),
                      options.quiet);
    std::map<int, VdimAtlasSize> atlases;  // by side of the geometry image
    const auto trial = [&](FusedPlan candidate) -> Result<double> {
      const auto image = geometry(candidate.geometry_side);
      if (!image) return image.issue();
      if (!atlases.contains(image->side()))
        atlases[image->side()] = chooseAtlas(*image, side, options.threads).size;
      candidate.atlas = atlases[image->side()];
      candidate.sweeps = kTrialSweeps;
      candidate.coarse_y = 0;
      if (!candidate.visibility) candidate.visibility = Visibility::kFast;
      const double rmse = fits->fit(candidate, *image).error.channel[0].rmse();
      progress.advance();
      return rmse;
    };
    auto choice = choosePlan(goal, side, baked->side(), trial);
    if (!choice) return choice.issue();
    progress.advance(uint64_t(mostTrials(goal, baked->side())) -
                     choice->measured.size());  // the search ended early
    plan = choice->plan;
    plan.visibility = options.visibility;
    measured = std::move(choice->measured);
  }
  const auto image = geometry(plan.geometry_side);
  if (!image) return image.issue();
  Progress progress("cook " + source.name() + ": fitting", kFusedSteps, options.quiet);
  FusedFit fit = fits->fit(plan, *image, &progress);
  progress.advance(kFusedSteps);  // whatever the plan left out
  fit.material.meta_json = cookMeta(fit.material, source.name(), presetName(options.preset), &fit.error,
                                    measured, fit.atlases, &fit);
  return std::move(fit.material);
}

}  // namespace loden::importer
