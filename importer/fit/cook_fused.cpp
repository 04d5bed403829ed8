#include "importer/fit/band_fit.h"
#include "importer/fit/flat_fit.h"
#include "importer/fit/grid_table.h"
#include "importer/fit/measure.h"
#include "importer/fit/meta.h"
#include "importer/fit/modes.h"
#include "importer/fit/ratio_fit.h"
#include "material/evaluate.h"

namespace loden::importer {
namespace {

constexpr int kFlatMips = 3;  // lambda 0 .. 2, where the reference-domain band has taken over
constexpr float kCrossFadeBegin = 1, kCrossFadeEnd = 2;

// The fine band: joint fit of Y through the lookup, then the basis again for the weights as they are stored,
// then chroma as a ratio to the Y that results.
Band fitFlatBand(const BtfSource& source, const YccBtf& btf, const Material& m, const Indirection& a, int flat_side,
                 int components, int threads) {
  const Matrix mean = sampleMean(m.mean, source.lights(), source.views());
  const ColumnBlocks luma = centredBlocks(btf, 0, mean);
  FlatFitOptions fit;
  fit.components = components;
  fit.threads = threads;
  BandFactors factors;
  factors.side = flat_side;
  factors.y.weights = quantisedWeights(fitFlat(luma, a, fit).factors.weights, Storage::kSnorm8);
  factors.y.basis = solveBasis(luma, a, factors.y.weights, threads);
  factors.ratio = fitRatios(btf, factors.y, mean, m.mean, a, threads);
  Band band = packBand(factors, source.lights(), source.views(),
                       {TableLayout::kGrid, Storage::kSnorm8, m.grid, kFlatMips, 0});
  band.domain = Domain::kFlat;
  band.window = {-2, -1, kCrossFadeBegin, kCrossFadeEnd};
  return band;
}

// The coarse band: apparent reflectance over the reference plane, from lambda 1 to the full average.
Band fitCoarseBand(const BtfSource& source, const YccBtf& btf, const Material& m, int y_components, int threads) {
  const YccBtf half = downsample(btf, BoxFilter::k2x2, threads);
  const Matrix mean = sampleMean(m.mean, source.lights(), source.views());
  BandFactors factors;
  factors.side = half.side();
  factors.y = meanFirstFactors(centredBlocks(half, 0, mean), y_components, threads);
  factors.cb = meanFirstFactors(centredBlocks(half, 1, mean), 2, threads);
  factors.cr = meanFirstFactors(centredBlocks(half, 2, mean), 2, threads);
  Band band = packBand(factors, source.lights(), source.views(),
                       {TableLayout::kGrid, Storage::kSnorm8, m.grid, fullMipCount(half.side(), half.side()), 0});
  band.lambda_first = 1;
  band.window = {kCrossFadeBegin, kCrossFadeEnd};
  return band;
}

}  // namespace

Result<Material> cookFused(const BtfSource& source, const GeometryImage& geometry, const CookOptions& options) {
  auto btf = loadYcc(source, options.threads);
  if (!btf) return btf.issue();
  Material m;
  m.mode = Mode::kFused;
  m.name = source.name();
  m.side = source.size().x;
  m.value_scale = static_cast<float>(1 / kPi);
  m.geometry = geometry;
  m.grid = gridFor(source.lights());
  m.theta_max = m.grid.theta_max;
  m.mean = fitPhong(imageMeans(*btf, options.threads), source.lights(), source.views(), {true, MeanChroma::kRatio}).mean;

  const Evaluator lookup(m, {}, options.threads);
  const int flat_side = source.size().x;
  const Indirection a = makeIndirection(
      source.size().x, flat_side, source.views(),
      [&](glm::dvec2 x, const glm::dvec3& wo) { return lookup.findHit(x, 0.0, wo).p; }, options.threads);
  const int y = options.y_components ? options.y_components : options.preset == Preset::kReference ? 32 : 12;
  m.bands.push_back(fitFlatBand(source, *btf, m, a, flat_side, y, options.threads));
  m.bands.push_back(fitCoarseBand(source, *btf, m, 4, options.threads));
  m.lambda_max = 1 + static_cast<float>(m.bands.back().weights.mips - 1);
  const BtfError error = measureError(m, *btf, source.lights(), source.views(), a, options.threads);
  m.meta_json = cookMeta(m, source.name(), presetName(options.preset), &error);
  return m;
}

}  // namespace loden::importer
