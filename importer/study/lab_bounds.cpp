// What keeps the mean Lab distance of a fused asset where it is: the lookup, the number of components, or
// the chroma. All rows are of flat maps with as many texels as the BTF has unless
// they say otherwise, free tables at the sampled directions, nothing quantised.
//
// flat-btf       the Flat-BTF as baked, not compressed, read through the lookup: what any factorisation of it
// can reach.
//                Texels that hold the mean of what views see, and twice as many a side, fitted to the filter.
// components     the joint fit of Y with chroma as a ratio to Y.
// luma-exact     the same with the BTF's own Y: what the chroma ratio alone costs.
// chroma-exact   the same with the BTF's own chroma ratio at every sample: what luma alone costs.
// shared-tables  the same plus, for Cb and Cr, tables over the weights of Y for what the ratio leaves.
#include <cmath>
#include <functional>
#include <optional>

#include "importer/base/parallel.h"
#include "importer/base/progress.h"
#include "importer/cook/atlas_choice.h"
#include "importer/cook/fused_plan.h"
#include "importer/cook/modes.h"
#include "importer/fit/band_fit.h"
#include "importer/fit/flat_fit.h"
#include "importer/fit/ratio_fit.h"
#include "importer/study/study_tile.h"
#include "material/eval/evaluate.h"
#include "material/model/color.h"
#include "material/system/threads.h"

namespace loden::importer {
namespace {

constexpr int kComponents[] = {4, 8, 20, 64};
constexpr int kTakenApart = 20;  // components of the rows that take luma and chroma apart
constexpr int kLabEvery = 5;     // lights

// [Y, Cb, Cr] texels x lights of one view.
using Values = std::function<void(int view, Matrix (&value)[3])>;

struct Bounds {
  const std::string& tile;
  const YccBtf& btf;
  const Matrix& mean;
  const PhongMean& phong;
  int threads;
  StudyRows& rows;

  void add(const char* what, const char* lookup, const std::string& components, const Values& values) const {
    std::vector<LabSums> sums(size_t(btf.views()));
    std::vector<double> squares(size_t(btf.views()));
    parallelFor(sums.size(), threads, [&](size_t v) {
      Matrix value[3], truth;
      values(int(v), value);
      sums[v] = labOfView(btf, int(v), value, kLabEvery);
      btf.read(0, int(v), truth);
      for (size_t i = 0; i < truth.data.size(); ++i)
        squares[v] += std::pow(std::max(value[0].data[i], 0.0) - truth.data[i], 2);
    });
    LabSums all;
    double sum = 0;
    for (size_t v = 0; v < sums.size(); ++v) all.merge(sums[v]), sum += squares[v];
    const double rmse = std::sqrt(sum / (double(btf.texels()) * btf.lights() * btf.views()));
    rows.emplace_back();
    rows.back()
        .set("tile", tile)
        .set("size", btf.side())
        .set("what", what)
        .set("lookup", lookup)
        .set("components", components);
    rows.back()
        .set("lab_mean", all.mean())
        .set("lab_black", all.blackMean())
        .set("lab_lit", all.litMean())
        .set("rmse_y", rmse);
  }
};

// One channel of one view through the lookup.
Matrix through(const Indirection& a, int view, const Matrix& flat) {
  Matrix seen;
  a.apply(view, flat, seen);
  return seen;
}

Status addFlatBtf(const Bounds& to, const StudyOptions& options, const char* lookup,
                  const DirectionSet& views, const IndirectionLookup& find) {
  for (const int scale : {1, 2}) {
    const TexelMethod texels = scale == 1 ? TexelMethod::kMean : TexelMethod::kLinear;
    const auto flat = studyBake(options, to.tile,
                                {scale * options.size,
                                 4,
                                 FillMethod::kPushPull,
                                 texels,
                                 {.btf = false, .flat = true, .vdim = false, .surface = false}});
    if (!flat) return flat.issue();
    const int side = scale * options.size;
    const Indirection a = makeIndirection(to.btf.side(), side, views, find, options.threads);
    std::vector<std::optional<Issue>> issues(size_t(to.btf.views()));
    to.add(scale == 1 ? "flat-btf" : "flat-btf, 2x", lookup, "all", [&](int v, Matrix(&value)[3]) {
      const auto rgb = flat->flatView(v);
      Matrix planes[3];
      for (Matrix& plane : planes) plane = Matrix(side * side, to.btf.lights());
      if (!rgb) issues[size_t(v)] = rgb.issue();
      for (size_t i = 0; rgb && i < rgb->size(); ++i) {
        const glm::dvec3 ycc = yccFromRgb(glm::dvec3((*rgb)[i]));
        for (int c = 0; c < 3; ++c) planes[c].data[i] = ycc[c];
      }
      for (int c = 0; c < 3; ++c) value[c] = through(a, v, planes[c]);
    });
    for (const auto& issue : issues)
      if (issue) return *issue;
  }
  return {};
}

// texels x lights of one view of factors whose basis is at the samples.
void addProduct(const Factors& f, const Indirection& a, int view, int lights, Matrix& into) {
  const Matrix seen = through(a, view, f.weights);
  for (int k = 0; k < f.components(); ++k)
    for (int l = 0; l < lights; ++l)
      for (int t = 0; t < into.rows; ++t) into(t, l) += seen(t, k) * f.basis(view * lights + l, k);
}

// Chroma of a value as `ratio` of its Y, per texel or per sample.
void addComponents(const Bounds& to, const char* lookup, const Indirection& a, int components) {
  FlatFitOptions fit;
  fit.components = components;
  fit.threads = to.threads;
  const Factors luma = fitFlat(centredBlocks(to.btf, 0, to.mean), a, fit).factors;
  const ColumnBlocks whole = wholeLuma(to.btf, luma, to.mean, a);
  const std::vector<glm::dvec2> ratios = fitRatios(to.btf, whole, to.phong, a, to.threads);
  const auto values = [&](int v, Matrix(&value)[3]) {
    whole.read(v, value[0]);
    for (int c = 1; c < 3; ++c) {
      Matrix ratio(a.flat_texels, 1);
      for (int t = 0; t < ratio.rows; ++t) ratio(t, 0) = ratios[size_t(t)][c - 1];
      const Matrix seen = through(a, v, ratio);
      value[c] = value[0];
      for (int l = 0; l < value[c].cols; ++l)
        for (int t = 0; t < value[c].rows; ++t) value[c](t, l) *= seen(t, 0);
    }
  };
  const std::string text = std::to_string(components);
  to.add("components", lookup, text, values);
  if (components != kTakenApart) return;
  to.add("luma-exact", lookup, text, [&](int v, Matrix(&value)[3]) {
    values(v, value);
    Matrix truth;
    to.btf.read(0, v, truth);
    for (size_t i = 0; i < truth.data.size(); ++i)
      for (int c = 2; c >= 0; --c)
        value[c].data[i] = value[0].data[i] > 0 ? value[c].data[i] * truth.data[i] / value[0].data[i]
                                                : (c == 0 ? truth.data[i] : 0);
  });
  to.add("chroma-exact", lookup, text, [&](int v, Matrix(&value)[3]) {
    values(v, value);
    Matrix y, chroma;
    to.btf.read(0, v, y);
    for (int c = 1; c < 3; ++c) {
      to.btf.read(c, v, chroma);
      for (size_t i = 0; i < y.data.size(); ++i)
        if (y.data[i] > 0) value[c].data[i] = value[0].data[i] * chroma.data[i] / y.data[i];
    }
  });
  Factors chroma[2];
  for (int c = 1; c < 3; ++c)
    chroma[c - 1] = {luma.weights,
                     solveBasis(ratioResidual(to.btf, c, whole, ratios, a), a, luma.weights, to.threads)};
  to.add("shared-tables", lookup, text, [&](int v, Matrix(&value)[3]) {
    values(v, value);
    for (int c = 1; c < 3; ++c) addProduct(chroma[c - 1], a, v, to.btf.lights(), value[c]);
  });
}

Status addTile(const StudyOptions& options, const std::string& tile, StudyRows& rows) {
  const auto data = studyTile(options, tile);
  if (!data) return data.issue();
  const BtfSource& source = *data->source;
  const YccBtf& btf = data->btf;
  const auto geometry = geometryOf(data->baked, 0);
  if (!geometry) return geometry.issue();
  Material m;
  m.side = btf.side();
  m.geometry = *geometry;
  m.atlas = chooseAtlas(m.geometry, m.side, options.threads).size;
  const Evaluator evaluator(m, onThreads(options.threads));
  const GeometryTracer tracer(m.geometry);
  const IndirectionLookup by_default = [&](glm::dvec2 x, const glm::dvec3& wo) {
    return evaluator.findHit(x, 0.0, wo).p;
  };
  const IndirectionLookup traced = [&](glm::dvec2 x, const glm::dvec3& wo) {
    const auto hit = tracer.traceView(x, wo);
    return hit ? hit->p : x;
  };
  const DirectionSet &lights = source.lights(), &views = source.views();
  const PhongMean phong =
      fitPhong(imageMeans(btf, options.threads), lights, views, {true, MeanChroma::kRatio}).mean;
  const Matrix mean = sampleMean(phong, lights, views);
  const Bounds to{tile, btf, mean, phong, options.threads, rows};
  struct Way {
    const char* name;
    const IndirectionLookup& find;
    bool all;  // numbers of components
  };
  for (const Way& way : {Way{"triangles", traced, false}, Way{"default", by_default, true}}) {
    if (const Status s = addFlatBtf(to, options, way.name, views, way.find); !s) return s;
    const Indirection a = makeIndirection(btf.side(), btf.side(), views, way.find, options.threads);
    for (const int k : kComponents)
      if (k <= btf.texels() && (way.all || k == kTakenApart)) addComponents(to, way.name, a, k);
  }
  return {};
}

}  // namespace

Result<StudyRows> studyLabBounds(const StudyOptions& options) {
  StudyRows rows;
  Progress progress("lab-bounds", options.tiles.size(), options.quiet);
  for (const std::string& tile : options.tiles) {
    if (const Status s = addTile(options, tile, rows); !s) return s.issue();
    progress.advance();
  }
  return rows;
}

}  // namespace loden::importer
