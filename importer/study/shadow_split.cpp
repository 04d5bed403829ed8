// Cast shadows apart from shading (FBTF section 5: "light-visibility map"): does a map V(p, wi) of its own, times an
// appearance fitted without shadows, come closer at equal bytes than one appearance fitted with them?
//
// joint   the flat band of mode fused: Kb components of Y, tables over light and view.
// split   Ku components of Y without cast shadows, times V(p, wi) in Kv components whose tables know only the light. V is
//         fitted per light to the shadowed data for the appearance as fitted, then reduced to its leading factors.
// Both are free at the sampled directions and unquantised; bytes are counted at 8 bits on the grid of the default plan,
// without the coarse band and the geometry image. Through the shader's default lookup.
#include <cmath>

#include "importer/fit/atlas_choice.h"
#include "importer/fit/band_fit.h"
#include "importer/fit/flat_fit.h"
#include "importer/fit/fused_plan.h"
#include "importer/fit/modes.h"
#include "importer/fit/ratio_fit.h"
#include "importer/local_brdf.h"
#include "importer/parallel.h"
#include "importer/progress.h"
#include "importer/study/study.h"
#include "importer/tile_tracer.h"
#include "material/color.h"
#include "material/evaluate.h"

namespace loden::importer {
namespace {

constexpr int kJoint[] = {8, 12, 16, 20, 24};
constexpr int kShading[] = {4, 8, 12};
constexpr int kVisibility[] = {4, 8, 16};
constexpr int kSubsamples = 2;  // per texel side, of the data without shadows

// Y without cast shadows, [view] a matrix of texels x lights.
using Blocks = std::vector<Matrix>;

Blocks unshadowed(const TileTracer& tracer, const BtfSource& source, int threads) {
  const std::vector<glm::dvec3>&lights = source.lights().samples, &views = source.views().samples;
  const int side = source.size().x;
  Blocks blocks(views.size());
  parallelFor(views.size(), threads, [&](size_t v) {
    const FlushDenormals flush;
    Matrix& block = blocks[v] = Matrix(side * side, static_cast<int>(lights.size()));
    for (int t = 0; t < side * side; ++t)
      for (int s = 0; s < kSubsamples * kSubsamples; ++s) {
        const glm::dvec2 inside = (glm::dvec2(s % kSubsamples, s / kSubsamples) + 0.4871) / double(kSubsamples);
        const auto hit = tracer.intersectView((glm::dvec2(t % side, t / side) + inside) / double(side), views[v]);
        for (size_t l = 0; hit && l < lights.size(); ++l) {
          const double cosine = glm::dot(hit->normal, lights[l]);
          if (cosine > 0)
            block(t, int(l)) += yccFromRgb(reflectance(hit->brdf, hit->normal, lights[l], views[v]) * cosine).x / (kSubsamples * kSubsamples);
        }
      }
  });
  return blocks;
}

ColumnBlocks blocksOf(const Blocks& blocks) {
  return {blocks.front().rows, static_cast<int>(blocks.size()), blocks.front().cols, [&blocks](int v, Matrix& into) { into = blocks[size_t(v)]; }};
}

// One light of each view.
ColumnBlocks lightOf(const ColumnBlocks& all, const Blocks& blocks, int light) {
  return {all.rows, all.blocks, 1, [&blocks, light](int v, Matrix& into) {
            const auto column = blocks[size_t(v)].col(light);
            into = Matrix(blocks[size_t(v)].rows, 1);
            std::copy(column.begin(), column.end(), into.data.begin());
          }};
}

// texels x lights of view v, from factors over the flat domain.
Matrix decoded(const Factors& f, const Indirection& a, int v, int lights) {
  Matrix seen, out(a.texels, lights);
  a.apply(v, f.weights, seen);
  for (int l = 0; l < lights; ++l)
    for (int k = 0; k < f.components(); ++k) {
      const double e = f.basis(v * lights + l, k);
      for (int t = 0; t < a.texels; ++t) out(t, l) += seen(t, k) * e;
    }
  return out;
}

struct SplitData {
  const Blocks& truth;
  const Indirection& a;
  int lights, side, threads;
};

// V(p, wi): flat texels x lights. Texels that no view sees are lit.
Matrix fitVisibility(const SplitData& data, const Blocks& shading) {
  Matrix visibility(data.a.flat_texels, data.lights);
  const ColumnBlocks all = blocksOf(shading);
  parallelFor(size_t(data.lights), data.threads, [&](size_t l) {
    const std::vector<double> v = fitRatio(lightOf(all, shading, int(l)), lightOf(all, data.truth, int(l)), data.a, 1.0, 1);
    std::copy(v.begin(), v.end(), visibility.col(int(l)).begin());
  });
  return visibility;
}

double splitError(const SplitData& data, const Blocks& shading, const Factors& visibility) {
  std::vector<double> squares(shading.size());
  parallelFor(shading.size(), data.threads, [&](size_t v) {
    Matrix seen;
    data.a.apply(int(v), visibility.weights, seen);
    for (int l = 0; l < data.lights; ++l)
      for (int t = 0; t < data.a.texels; ++t) {
        double lit = 0;
        for (int k = 0; k < visibility.components(); ++k) lit += seen(t, k) * visibility.basis(l, k);
        const double difference = lit * shading[v](t, l) - data.truth[v](t, l);
        squares[v] += difference * difference;
      }
  });
  double sum = 0;
  for (const double s : squares) sum += s;
  return std::sqrt(sum / (double(data.a.texels) * data.lights * double(shading.size())));
}

// Bytes of `quads` maps of weights with one mip below, and of their tables.
uint64_t bytesOf(int quads, int side, uint64_t table) {
  return uint64_t(quads) * (textureBytes(TexelFormat::kRGBA8Snorm, uint64_t(side), uint64_t(side), 1, 2) + table);
}

StudyRow row(const std::string& tile, const char* kind, const std::string& components, uint64_t bytes, double rmse) {
  StudyRow r;
  r.set("tile", tile).set("kind", kind).set("components", components).set("coefficient_bytes", bytes).set("rmse_y", rmse);
  return r;
}

void addRows(const std::string& tile, const SplitData& data, const Blocks& bare, StudyRows& rows) {
  const auto phis = uint64_t(FusedPlan{}.phis), half_table = phis * 6 * 4, table = phis * 6 * half_table;
  FlatFitOptions fit;
  fit.threads = data.threads;
  for (const int k : kJoint) {
    fit.components = k;
    const FlatFit joint = fitFlat(blocksOf(data.truth), data.a, fit);
    rows.push_back(row(tile, "joint", std::to_string(k), bytesOf(k / 4, data.side, table), joint.rmse));
  }
  for (const int ku : kShading) {
    fit.components = ku;
    const FlatFit without = fitFlat(blocksOf(bare), data.a, fit);
    Blocks shading(bare.size());
    parallelFor(bare.size(), data.threads, [&](size_t v) { shading[v] = decoded(without.factors, data.a, int(v), data.lights); });
    const Matrix visibility = fitVisibility(data, shading);
    for (const int kv : kVisibility) {
      const double rmse = splitError(data, shading, leadingFactors(blocksOf(visibility), kv, data.threads));
      const uint64_t bytes = bytesOf(ku / 4, data.side, table) + bytesOf(kv / 4, data.side, half_table);
      rows.push_back(row(tile, "split", std::to_string(ku) + "+" + std::to_string(kv), bytes, rmse));
    }
  }
}

}  // namespace

Result<StudyRows> studyShadowSplit(const StudyOptions& options) {
  StudyRows rows;
  Progress progress("shadow-split", options.tiles.size(), options.quiet);
  for (const std::string& tile : options.tiles) {
    const auto baked = studyBake(options, tile);
    if (!baked) return baked.issue();
    const auto source = bakedSource(*baked);
    if (!source) return source.issue();
    const auto btf = loadYcc(**source, options.threads);
    if (!btf) return btf.issue();
    const auto geometry = geometryOf(*baked, 0);
    if (!geometry) return geometry.issue();
    const auto mesh = loadTile(studyTileName(tile));
    if (!mesh) return mesh.issue();

    Material m;
    m.side = btf->side();
    m.geometry = *geometry;
    m.atlas = chooseAtlas(m.geometry, m.side, options.threads).size;
    const Evaluator evaluator(m, options.threads);
    const auto lookup = [&](glm::dvec2 x, const glm::dvec3& wo) { return evaluator.findHit(x, 0.0, wo).p; };
    const Indirection a = makeIndirection(btf->side(), btf->side(), (*source)->views(), lookup, options.threads);
    Blocks truth(size_t(btf->views()));
    for (int v = 0; v < btf->views(); ++v) btf->read(0, v, truth[size_t(v)]);
    const Blocks bare = unshadowed(TileTracer(*mesh), **source, options.threads);
    addRows(tile, {truth, a, btf->lights(), btf->side(), options.threads}, bare, rows);
    progress.advance();
  }
  return rows;
}

}  // namespace loden::importer
