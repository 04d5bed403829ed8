#include <cmath>
#include <cstdio>

#include "importer/cook/meta.h"
#include "importer/cook/modes.h"
#include "importer/fit/band_fit.h"
#include "importer/fit/grid_table.h"
#include "importer/fit/measure.h"
#include "importer/fit/ratio_fit.h"
#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "material/model/leading_part.h"

namespace loden::importer {
namespace {

Issue levelsIssue(const BtfSource& source, int levels) {
  return {issue_id::kOption, Severity::kError, source.name(),
          std::to_string(levels) + " levels need a side that is a multiple of " +
              std::to_string(1 << (levels - 1)) + ", not " + std::to_string(source.size().x) +
              "; name fewer levels"};
}

// L_k = F_k - up(F_{k+1}), nearest up-sampling (LBTF eq. 3).
ColumnBlocks laplacianBlocks(const YccBtf& fine, const YccBtf& coarse, int channel) {
  return {fine.texels(), fine.views(), fine.lights(), [&fine, &coarse, channel](int v, Matrix& into) {
            Matrix small;
            fine.read(channel, v, into);
            coarse.read(channel, v, small);
            const int side = fine.side();
            for (int l = 0; l < into.cols; ++l)
              for (int t = 0; t < into.rows; ++t)
                into(t, l) -= small(t / side / 2 * (side / 2) + t % side / 2, l);
          }};
}

Material emptyMaterial(const BtfSource& source) {
  Material m;
  m.mode = Mode::kLod;
  m.name = source.name();
  m.side = source.size().x;
  m.value_scale = static_cast<float>(1 / kPi);
  return m;
}

struct ComponentCounts {
  int y, cb, cr;
};

void advance(Progress* progress, uint64_t steps) {
  if (progress) progress->advance(steps);
}

// Components are given together: no chroma beside a number for Y means none.
ComponentCounts countsOr(const CookOptions& options, ComponentCounts preset) {
  const ComponentCounts given{options.y_components, options.cb_components, options.cr_components};
  if (given.y == 0 && given.cb == 0 && given.cr == 0) return preset;
  return {given.y ? given.y : preset.y, given.cb, given.cr};
}

// Ma et al. 2005, section 3, as published: 3 x 3 box, nearest up-sampling, PCA per level, Phong mean and
// constant chroma at the top, 32-bit weights and tables, nearest direction.
Result<Material> cookSeed(const BtfSource& source, const YccBtf& btf, const CookOptions& options,
                          Progress* progress) {
  const int levels = options.levels ? options.levels : 5;
  if (source.size().x % (1 << (levels - 1)) != 0) return levelsIssue(source, levels);
  const ComponentCounts counts = countsOr(options, {8, 2, 2});
  std::vector<YccBtf> pyramid;  // F_1 .. F_lambda_max
  for (int k = 1; k < levels; ++k)
    pyramid.push_back(downsample(k == 1 ? btf : pyramid.back(), BoxFilter::k3x3, options.threads));
  const auto level = [&](int k) -> const YccBtf& { return k == 0 ? btf : pyramid[size_t(k) - 1]; };

  Material m = emptyMaterial(source);
  m.lights = source.lights();
  m.views = source.views();
  m.lambda_max = static_cast<float>(levels - 1);
  const Matrix means = imageMeans(level(levels - 1), options.threads);
  m.mean = fitPhong(means, source.lights(), source.views(), {false, MeanChroma::kConstant}).mean;
  for (int k = 0; k < levels; ++k) {
    const bool top = k == levels - 1;
    const auto data = [&](int channel) {
      return top ? centredBlocks(level(k), channel, means) : laplacianBlocks(level(k), level(k + 1), channel);
    };
    BandFactors factors;
    factors.side = level(k).side();
    factors.y = leadingFactors(data(0), counts.y, options.threads);
    factors.cb = leadingFactors(data(1), counts.cb, options.threads);
    factors.cr = leadingFactors(data(2), counts.cr, options.threads);
    PackOptions pack{TableLayout::kNearest, Storage::kFloat32, {}, 1, top ? 1 : 0};
    Band band = packBand(factors, source.lights(), source.views(), pack);
    band.filter = WeightFilter::kNearest;
    band.lambda_first = static_cast<float>(k);
    if (!top) band.window = {-2, -1, float(k), float(k + 1)};
    m.bands.push_back(std::move(band));
    if (k == 0) advance(progress, 6);  // the finest level takes longer than all others
  }
  return m;
}

// One band over all levels: the value is linear in its weights, so filtering weights filters the BTF, and a
// basis that does not change with lambda needs no pyramid of bases.
Result<Material> cookMipMapped(const BtfSource& source, const YccBtf& btf, const CookOptions& options,
                               Progress* progress) {
  const bool reference = options.preset == Preset::kReference;
  const ComponentCounts counts =
      countsOr(options, reference ? ComponentCounts{24, 4, 4} : ComponentCounts{16, 0, 0});
  Material m = emptyMaterial(source);
  const DirectionGrid grid = gridFor(source.lights());
  m.theta_max = grid.theta_max;
  m.mean =
      fitPhong(imageMeans(btf, options.threads), source.lights(), source.views(), {true, MeanChroma::kRatio})
          .mean;
  const Matrix mean = sampleMean(m.mean, source.lights(), source.views());
  const Storage storage = reference ? Storage::kSnorm16 : Storage::kSnorm8;
  BandFactors factors;
  factors.side = source.size().x;
  factors.y = meanFirstFactors(centredBlocks(btf, 0, mean), counts.y, options.threads);
  advance(progress, 5);
  if (counts.cb > 0) {
    factors.cb = meanFirstFactors(centredBlocks(btf, 1, mean), counts.cb, options.threads);
    factors.cr = meanFirstFactors(centredBlocks(btf, 2, mean), counts.cr, options.threads);
  } else {
    const Indirection none = makeIndirection(
        source.size().x, source.size().x, source.views(), [](glm::dvec2 x, const glm::dvec3&) { return x; },
        options.threads);
    factors.ratio = {fitRatios(btf, wholeLuma(btf, factors.y, mean, none), m.mean, none, options.threads)};
  }
  const int mips = options.levels ? options.levels : fullMipCount(source.size().x, source.size().x);
  m.bands.push_back(
      packBand(factors, source.lights(), source.views(), {TableLayout::kGrid, storage, grid, mips, 0}));
  m.lambda_max = static_cast<float>(mips - 1);
  return m;
}

// Divides all texels but the ratio layer's, where they are floats: their scales are 1.
void divideWeights(Band& band, double unit) {
  Texture& t = band.weights;
  for (int mip = 0; mip < t.mips; ++mip)
    for (int z = 0; z < t.depth; ++z)
      for (int y = 0; y < t.mipHeight(mip) && !(band.ratio && z == band.quads()); ++y)
        for (int x = 0; x < t.mipWidth(mip); ++x)
          storeTexel(t, mip, x, y, z, fetchTexel(t, mip, x, y, z) / static_cast<float>(unit));
}

// Files, and the half floats of light from all around, hold what is within some powers of ten of white. What
// the material says is divided by a power of two that brings the BTF's largest value to 1..2 there, and
// value_scale multiplied.
void bringIntoRange(Material& m, double largest, bool quiet) {
  if (largest == 0 || (largest <= 64 && largest >= 1.0 / 64)) return;
  // At most 2^17, as files have no value_scale beyond 65504.
  const double unit = std::exp2(std::min(std::floor(std::log2(largest)), 17.0));
  const auto divide = [unit](float& value) { value = static_cast<float>(double(value) / unit); };
  for (float* k : {&m.mean.ka, &m.mean.kd, &m.mean.ks}) divide(*k);
  if (m.mean.chroma == MeanChroma::kConstant) divide(m.mean.cb), divide(m.mean.cr);
  for (Band& band : m.bands) {
    if (band.weights.format == TexelFormat::kRGBA32Sfloat)
      divideWeights(band, unit);
    else
      // Components without weight have a scale of 1 whatever the values are.
      for (glm::vec4& scale : band.quad_scale)
        scale = glm::min(scale / static_cast<float>(unit), glm::vec4(AssetLimits::kMaxValue));
  }
  m.value_scale *= static_cast<float>(unit);
  if (!quiet)
    std::fprintf(
        stderr,
        "%s: values go up to %g of white; they are stored divided by %g, with as much in value_scale\n",
        m.name.c_str(), largest, unit);
}

}  // namespace

Status checkLevels(int levels, int side) {
  const int most = fullMipCount(side, side);
  if (levels <= most) return {};
  return Issue{issue_id::kOption, Severity::kError, "levels",
               std::to_string(levels) + " are more than the " + std::to_string(most) + " that a side of " +
                   std::to_string(side) + " has"};
}

Result<Material> fitLod(const BtfSource& source, const YccBtf& btf, const CookOptions& options,
                        Progress* progress) {
  if (const Status status = checkLevels(options.levels, source.size().x); !status) return status.issue();
  return options.preset == Preset::kSeed ? cookSeed(source, btf, options, progress)
                                         : cookMipMapped(source, btf, options, progress);
}

Result<Material> cookLod(const BtfSource& source, const CookOptions& options) {
  auto btf = loadYcc(source, options.threads);
  if (!btf) return btf.issue();
  Progress progress("cook " + source.name() + ": fitting", kLodSteps, options.quiet);
  auto m = fitLod(source, *btf, options, &progress);
  if (!m) return m;
  splitLeadingParts(*m);
  const BtfError error = measureError(*m, *btf, source.lights(), source.views(), {}, options.threads);
  m->meta_json = cookMeta(*m, source.name(), presetName(options.preset), &error);
  progress.advance(kLodSteps);  // whatever is left
  bringIntoRange(*m, largestValue(*btf, options.threads), options.quiet);
  return m;
}

}  // namespace loden::importer
