// Error per channel against components, mode and bytes (LBTF table 1, figure 6 and the 43.9x of section 4.2),
// at the sampled directions over all texels and pairs, and at random directions between them against the
// traced tile. Fused rows go through the shader's own default lookup at the atlas size that gpu_bytes counts.
#include <cmath>
#include <tuple>

#include "importer/base/parallel.h"
#include "importer/base/progress.h"
#include "importer/cook/cook.h"
#include "importer/cook/fused_plan.h"
#include "importer/cook/goal.h"
#include "importer/cook/meta.h"
#include "importer/cook/modes.h"
#include "importer/study/plot.h"
#include "importer/study/random_directions.h"
#include "importer/study/study_tile.h"
#include "importer/tile/tile_tracer.h"
#include "material/eval/evaluate.h"
#include "material/model/color.h"
#include "material/model/environment.h"
#include "material/system/threads.h"

namespace loden::importer {
namespace {

constexpr int kReferenceSteps[] = {1, 2, 4, 8, 12, 16, 24};  // Y components, nested: one fit serves all
constexpr int kFusedSteps[] = {4, 8, 12, 16, 20, 28};        // one joint fit each
constexpr int kUnsampled = 20000;                            // random (texel, light, view)
constexpr int kSubsamples = 4;                               // per texel side, of the traced truth

// A pair of directions between the samples, and what the traced tile shows over one texel.
struct Unsampled {
  glm::dvec2 x{0};           // the texel's centre
  glm::dvec3 wi, wo, truth;  // truth: Y, Cb, Cr
};

glm::dvec3 tracedTexel(const TileTracer& tracer, glm::dvec2 centre, int size, const glm::dvec3& wi,
                       const glm::dvec3& wo) {
  glm::dvec3 sum(0);
  for (int s = 0; s < kSubsamples * kSubsamples; ++s) {
    const glm::dvec2 offset =
        (glm::dvec2(s % kSubsamples, s / kSubsamples) + 0.4871) / double(kSubsamples) - 0.5;
    if (const auto hit = tracer.intersectView(centre + offset / double(size), wo))
      sum += shadeHit(tracer, *hit, wi, wo, 0, 0);
  }
  return sum / double(kSubsamples * kSubsamples);
}

Result<std::vector<Unsampled>> unsampledTruth(const StudyOptions& options, const StudyTile& data,
                                              double theta_max) {
  auto tile = loadTile(studyTileName(data.name));
  if (!tile) return tile.issue();
  const int size = data.btf.side();
  const TileTracer tracer(*tile);
  std::vector<Unsampled> samples(kUnsampled);
  std::mt19937_64 random(2026);
  for (Unsampled& s : samples) {
    const int texel = static_cast<int>(random() % uint64_t(size * size));
    s.x = glm::dvec2(texel % size + 0.5, texel / size + 0.5) / double(size);
    s.wi = randomDirection(random, theta_max);
    s.wo = randomDirection(random, theta_max);
  }
  parallelFor(samples.size(), options.threads, [&](size_t i) {
    const FlushDenormals flush;
    Unsampled& s = samples[i];
    s.truth = yccFromRgb(tracedTexel(tracer, s.x, size, s.wi, s.wo));
  });
  return samples;
}

BtfError unsampledError(const Material& material, const std::vector<Unsampled>& samples, int threads) {
  const Evaluator evaluator(material, onThreads(threads));
  std::vector<glm::dvec3> difference(samples.size());
  parallelFor(samples.size(), threads, [&](size_t i) {
    const Unsampled& s = samples[i];
    difference[i] = yccFromRgb(evaluator.evaluate(evaluator.findHit(s.x, 0.0, s.wo), s.wi, s.wo)) - s.truth;
  });
  BtfError error;
  for (const glm::dvec3& d : difference)
    for (int c = 0; c < 3; ++c) {
      error.channel[c].mse += d[c] * d[c] / double(samples.size());
      error.channel[c].mae += std::abs(d[c]) / double(samples.size());
    }
  return error;
}

// The first y components of a material whose components are ordered by energy: the rest is silenced, and its
// quads are dropped from the count of bytes.
Material keepComponents(const Material& whole, int y) {
  Material kept = whole;
  for (Band& band : kept.bands)
    for (int c = y; c < 4 * band.y_quads; ++c) band.quad_scale[size_t(c / 4)][c % 4] = 0;
  return kept;
}
struct DroppedBytes {
  uint64_t file = 0, gpu = 0;  // gpu: with the tables of light from all around, which the runtime makes
};
DroppedBytes droppedBytes(const Material& whole, int y) {
  DroppedBytes bytes;
  for (const Band& band : whole.bands) {
    const auto dropped = uint64_t(std::max(band.y_quads - (y + 3) / 4, 0)), quads = uint64_t(band.quads());
    const uint64_t file =
        dropped * (band.table.data.size() / quads + band.weights.data.size() / uint64_t(band.weights.depth));
    bytes.file += file;
    bytes.gpu += file + dropped * (environmentTableBytes(band) / quads);
  }
  return bytes;
}

struct RowContext {
  const StudyTile& data;
  const char* preset;
  const char* storage;
  const char* directions;
};

StudyRow errorRow(const RowContext& context, const Material& m, int y, const DroppedBytes& dropped,
                  const BtfError& error) {
  uint64_t coefficients = 0;
  for (const Band& band : m.bands) coefficients += band.bytes();
  const int chroma = m.bands.empty() ? 0 : 2 * m.bands.front().chroma_quads;
  std::string counts = std::to_string(y) + "," + std::to_string(chroma) + "," + std::to_string(chroma);
  StudyRow row;
  row.set("tile", context.data.name).set("size", context.data.btf.side()).set("mode", modeName(m.mode));
  row.set("preset", context.preset)
      .set("components", counts)
      .set("y_components", y)
      .set("storage", context.storage);
  row.set("coefficient_bytes", coefficients - dropped.file).set("file_bytes", rawFileBytes(m) - dropped.file);
  row.set("gpu_bytes", residentBytes(m) - dropped.gpu);
  const char* names[3] = {"y", "cb", "cr"};
  for (int c = 0; c < 3; ++c) {
    const std::string name = names[c];
    row.set("rmse_" + name, error.channel[c].rmse())
        .set("mse_" + name, error.channel[c].mse)
        .set("mae_" + name, error.channel[c].mae);
  }
  if (error.max_image_mse[0] > 0)
    row.set("min_image_mse_y", error.min_image_mse[0]).set("max_image_mse_y", error.max_image_mse[0]);
  row.set("directions", context.directions);
  return row;
}

// One mode of the reference domain: a fit with the most components, then its leading ones.
Status addReferenceRows(const StudyOptions& options, const StudyTile& data,
                        const std::vector<Unsampled>& unsampled, Preset preset, int usual, StudyRows& rows) {
  CookOptions cook;
  cook.mode = Mode::kLod;
  cook.preset = preset;
  cook.y_components = 24;
  cook.threads = options.threads;
  const auto whole = fitLod(*data.source, data.btf, cook);
  if (!whole) return whole.issue();
  const char* storage = preset == Preset::kSeed ? "float32" : "snorm8";
  for (const int y : kReferenceSteps) {
    const Material m = keepComponents(*whole, y);
    const BtfError error =
        measureError(m, data.btf, data.source->lights(), data.source->views(), {}, options.threads);
    rows.push_back(
        errorRow({data, presetName(preset), storage, "sampled"}, m, y, droppedBytes(*whole, y), error));
    if (y == usual)
      rows.push_back(errorRow({data, presetName(preset), storage, "unsampled"}, m, y, droppedBytes(*whole, y),
                              unsampledError(m, unsampled, options.threads)));
  }
  return {};
}

Status addFusedRows(const StudyOptions& options, const StudyTile& data,
                    const std::vector<Unsampled>& unsampled, StudyRows& rows) {
  const auto add = [&](const FusedPlan& plan, const char* preset, bool between) -> Status {
    const auto geometry = geometryOf(data.baked, plan.geometry_side);
    if (!geometry) return geometry.issue();
    const FusedFit fit = fitFusedBands(*data.source, data.btf, *geometry, plan, options.threads);
    rows.push_back(
        errorRow({data, preset, "snorm8", "sampled"}, fit.material, plan.y_components, {}, fit.error));
    if (between)
      rows.push_back(errorRow({data, preset, "snorm8", "unsampled"}, fit.material, plan.y_components, {},
                              unsampledError(fit.material, unsampled, options.threads)));
    return {};
  };
  for (const int y : kFusedSteps) {
    FusedPlan plan;
    const bool usual = y == plan.y_components;
    plan.y_components = y;
    if (const Status s = add(plan, "game", usual); !s) return s;
  }
  return add(smallestPlan(data.baked.manifest().geometry_size), "smallest", false);
}

// LBTF figure 6 for all modes: the error of Y over components, and over the bytes of the coefficients.
Status writePlots(const StudyRows& rows, const std::filesystem::path& folder) {
  const auto series = [](const StudyRow& row) -> std::string {
    const auto text = [&](const char* key) { return std::get<std::string>(*row.find(key)); };
    if (text("directions") != "sampled" || text("preset") == "smallest") return {};
    return text("mode") == "fused"    ? "fused"
           : text("preset") == "seed" ? "lod, as published"
                                      : "lod, one basis, 8 bit";
  };
  const std::string title = "Error at the sampled directions", label = "RMSE of Y, white = 1";
  for (const auto& [x, x_label, x_log, file] :
       {std::tuple{"y_components", "Y components", false, "lod-fit-components.svg"},
        std::tuple{"coefficient_bytes", "bytes of weights and tables", true, "lod-fit-bytes.svg"}}) {
    const Plot plot{title, x_label, label, x_log, panelsOf(rows, x, "rmse_y", series)};
    if (const Status s = writePlot(plot, folder / file); !s) return s;
  }
  return {};
}

}  // namespace

Result<StudyRows> studyLodFit(const StudyOptions& options) {
  StudyRows rows;
  Progress progress("lod-fit", options.tiles.size() * 3, options.quiet);
  for (const std::string& tile : options.tiles) {
    const auto data = studyTile(options, tile);
    if (!data) return data.issue();
    const auto unsampled = unsampledTruth(options, *data, 75 * kPi / 180);
    if (!unsampled) return unsampled.issue();
    if (const Status s = addReferenceRows(options, *data, *unsampled, Preset::kSeed, 8, rows); !s)
      return s.issue();
    progress.advance();
    if (const Status s = addReferenceRows(options, *data, *unsampled, Preset::kGame, 16, rows); !s)
      return s.issue();
    progress.advance();
    if (const Status s = addFusedRows(options, *data, *unsampled, rows); !s) return s.issue();
    progress.advance();
  }
  if (!options.pictures.empty())
    if (const Status s = writePlots(rows, options.pictures); !s) return s.issue();
  return rows;
}

}  // namespace loden::importer
