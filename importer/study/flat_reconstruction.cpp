// What is lost on the way from a BTF to Flat-BTF and back (FBTF section 4.1, table 1, figure 9).
//
// paper      sampled views: every reference texel is the mean over kGrid x kGrid points of the Flat-BTF,
// filtered
//            linearly, at the traced p of each point ("all the VDIMs by oversampling"). The reference has as
//            many samples a texel, so that what is measured is not their noise. With options.every the
//            sampled views are each N-th only, and the BTF is baked for these.
// unsampled  random views up to 85 degrees, all sampled lights: p from the stored, blended 16x16 map at texel
//            centres, the Flat-BTF interpolated between the views of the rings around; truth is the tile's
//            mesh, traced and shaded at 2 x 2 points per texel.
// Lab distance is CIE76 between texels; lab_mean, lab_max, lab_min and lab_variance are over light-view
// images of each image's mean distance; lab_texel_max is the largest of any texel. Rows tell apart Flat-BTFs
// whose texels hold the mean of what a view sees of them, and those that are fitted to the linear filter
// (fill_method.h).
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>

#include "importer/base/metrics.h"
#include "importer/base/parallel.h"
#include "importer/base/progress.h"
#include "importer/base/random.h"
#include "importer/fit/paper_vdim.h"
#include "importer/study/figure.h"
#include "importer/study/ring_interpolation.h"
#include "importer/study/study.h"
#include "importer/tile/tile_tracer.h"

namespace loden::importer {
namespace {

constexpr int kGrid = 8;  // points and samples of the reference per texel side, paper's protocol
constexpr int kFlatSupersample = 4;
constexpr int kUnsampledViews = 24;
constexpr int kTruthGrid = 2;  // points per texel side of the unsampled truth

// Weights of flat texels that make one reference texel.
struct Footprint {
  std::vector<std::pair<int, float>> taps;

  void addBilinear(glm::dvec2 p, int side, double weight) {
    const glm::dvec2 at = p * double(side) - 0.5, cell = glm::floor(at), f = at - cell;
    for (int k = 0; k < 4; ++k) {
      const int dx = k & 1, dy = k >> 1;
      const int x = wrapIndex(static_cast<int>(cell.x) + dx, side),
                y = wrapIndex(static_cast<int>(cell.y) + dy, side);
      const double share = (dx ? f.x : 1 - f.x) * (dy ? f.y : 1 - f.y);
      taps.emplace_back(y * side + x, static_cast<float>(share * weight));
    }
  }
  // The same texel often comes from several points: fewer taps, faster sums.
  void compact() {
    std::sort(taps.begin(), taps.end());
    size_t kept = 0;
    for (size_t i = 1; i < taps.size(); ++i) {
      if (taps[i].first == taps[kept].first)
        taps[kept].second += taps[i].second;
      else
        taps[++kept] = taps[i];
    }
    if (!taps.empty()) taps.resize(kept + 1);
  }
  glm::vec3 read(const glm::vec3* flat) const {
    glm::vec3 sum(0);
    for (const auto& [texel, weight] : taps) sum += weight * flat[texel];
    return sum;
  }
};

std::vector<Footprint> tracedFootprints(const TileTracer& tracer, const glm::dvec3& wo, int side,
                                        int flat_side, int view) {
  std::vector<Footprint> footprints(size_t(side) * side);
  for (size_t t = 0; t < footprints.size(); ++t) {
    const uint64_t seed = mixSeed(0xF1A7 + view, t);
    int hits = 0;
    std::array<glm::dvec2, kGrid * kGrid> p;
    for (int k = 0; k < kGrid * kGrid; ++k) {
      // Jittered: points on mesh vertices would leak.
      const glm::dvec2 in_texel((k % kGrid + uniform(seed, 2 * k)) / kGrid,
                                (k / kGrid + uniform(seed, 2 * k + 1)) / kGrid);
      const auto hit = tracer.intersectView(
          (glm::dvec2(double(t % side), double(t / side)) + in_texel) / double(side), wo);
      if (hit) p[hits++] = hit->p;
    }
    for (int k = 0; k < hits; ++k) footprints[t].addBilinear(p[k], flat_side, 1.0 / hits);
    footprints[t].compact();
  }
  return footprints;
}

struct ViewError {
  ErrorSums sums;
  std::vector<double> image_lab;  // mean Lab distance per light
};

void addImage(ViewError& error, std::span<const glm::vec3> truth, std::span<const glm::vec3> test) {
  ErrorSums sums;
  sums.add(truth, test);
  error.image_lab.push_back(sums.labMean());
  error.sums.merge(sums);
}

// One tile's inputs: the BTF, a Flat-BTF that may be finer, and the mesh.
struct Subject {
  const std::string& name;
  const BakedOutput& btf;
  const BakedOutput& flat;
  const TileTracer& tracer;
  const StudyOptions& options;
  int side() const { return btf.manifest().size; }
  int flatSide() const { return flat.manifest().flat_size; }
};

const char* texelsName(const Subject& subject) {
  return subject.flat.manifest().texels == TexelMethod::kLinear ? "linear" : "mean";
}

StudyRow rowOf(const std::vector<std::optional<ViewError>>& views, const Subject& subject,
               const char* protocol) {
  ErrorSums all;
  std::vector<double> images;
  for (const auto& view : views) {
    all.merge(view->sums);
    images.insert(images.end(), view->image_lab.begin(), view->image_lab.end());
  }
  double mean = 0, variance = 0;
  for (const double lab : images) mean += lab / double(images.size());
  for (const double lab : images) variance += (lab - mean) * (lab - mean) / double(images.size());
  StudyRow row;
  row.set("tile", subject.name)
      .set("size", subject.side())
      .set("flat_size", subject.flatSide())
      .set("texels", texelsName(subject));
  row.set("protocol", protocol).set("lab_mean", mean);
  row.set("lab_max", *std::max_element(images.begin(), images.end())).set("lab_variance", variance);
  row.set("lab_min", *std::min_element(images.begin(), images.end())).set("lab_texel_max", all.labMax());
  row.set("rmse_y", all.y().rmse).set("mse_y", all.y().mse).set("mae_y", all.y().mae);
  return row.set("images", uint64_t{images.size()});
}

// FBTF figure 9, one slice: the Flat-BTF over p, the VDIM (p within its period as red and green), the
// reconstruction, the reference and their absolute difference over x. One size for all, that of the Flat-BTF.
Status writeSlices(const Subject& subject, const glm::dvec3& wo, std::span<const glm::vec3> flat,
                   std::span<const glm::vec3> test, std::span<const glm::vec3> truth) {
  const int side = subject.side();
  std::vector<glm::vec3> vdim, difference;
  for (size_t t = 0; t < truth.size(); ++t) {
    const auto hit = subject.tracer.intersectView(
        (glm::dvec2(double(t % side), double(t / side)) + .5) / double(side), wo);
    vdim.push_back(hit ? glm::vec3(glm::vec2(glm::fract(hit->p)), 0) : glm::vec3(0, 0, 1));
    difference.push_back(glm::abs(truth[t] - test[t]));
  }
  struct Slice {
    const char* name;
    std::span<const glm::vec3> texels;
    int side;
  };
  const std::string stem = "flat-reconstruction-" + subject.name + "-" + std::to_string(subject.flatSide()) +
                           "-" + texelsName(subject);
  for (const Slice& slice : {Slice{"flat", flat, subject.flatSide()},
                             {"vdim", vdim, side},
                             {"reconstructed", test, side},
                             {"reference", truth, side},
                             {"difference", difference, side}}) {
    const Picture picture = texelPicture(slice.texels, slice.side, subject.flatSide() / slice.side);
    if (const Status status =
            writeFigure(picture, subject.options.pictures / (stem + "-" + slice.name + ".png"));
        !status)
      return status;
  }
  return {};
}

Result<ViewError> paperView(const Subject& subject, int view) {
  const FlushDenormals flush;
  const auto truth = subject.btf.btfView(view), flat = subject.flat.flatView(view);
  if (!truth) return truth.issue();
  if (!flat) return flat.issue();
  const DirectionSet& directions = subject.btf.manifest().directions;
  const auto footprints =
      tracedFootprints(subject.tracer, directions.samples[view], subject.side(), subject.flatSide(), view);
  const size_t texels = footprints.size(), flat_texels = size_t(subject.flatSide()) * subject.flatSide();
  ViewError error;
  std::vector<glm::vec3> image(texels);
  constexpr int kFigureView = 40, kFigureLight = 10;
  for (int light = 0; light < directions.size(); ++light) {
    const auto slice = std::span(*flat).subspan(light * flat_texels, flat_texels);
    for (size_t t = 0; t < texels; ++t) image[t] = footprints[t].read(slice.data());
    const auto truth_image = std::span(*truth).subspan(light * texels, texels);
    addImage(error, truth_image, image);
    if (view == kFigureView && light == kFigureLight && !subject.options.pictures.empty())
      if (const Status status = writeSlices(subject, directions.samples[view], slice, image, truth_image);
          !status)
        return status.issue();
  }
  return error;
}

// Traced and shaded, [light][texel].
std::vector<glm::vec3> tracedView(const Subject& subject, const glm::dvec3& wo, uint64_t seed) {
  const DirectionSet& lights = subject.btf.manifest().directions;
  const int side = subject.side();
  const size_t texels = size_t(side) * side;
  std::vector<glm::vec3> values(texels * lights.size(), glm::vec3(0));
  for (size_t t = 0; t < texels; ++t)
    for (int k = 0; k < kTruthGrid * kTruthGrid; ++k) {
      const uint64_t point = mixSeed(seed, t * kTruthGrid * kTruthGrid + k);
      const glm::dvec2 in_texel((k % kTruthGrid + uniform(point, 0)) / kTruthGrid,
                                (k / kTruthGrid + uniform(point, 1)) / kTruthGrid);
      const auto hit = subject.tracer.intersectView(
          (glm::dvec2(double(t % side), double(t / side)) + in_texel) / double(side), wo);
      if (!hit) continue;
      for (int light = 0; light < lights.size(); ++light)
        values[light * texels + t] +=
            glm::vec3(shadeHit(subject.tracer, *hit, lights.samples[light], wo, 0, 0)) /
            float(kTruthGrid * kTruthGrid);
    }
  return values;
}

Result<ViewError> unsampledView(const Subject& subject, const PaperVdim& vdim, int index) {
  const FlushDenormals flush;
  const uint64_t seed = mixSeed(0x0FF, index);
  const double z = 1 - uniform(seed, 0) * (1 - std::cos(kThetaMax));
  const glm::dvec3 wo = directionFromSpherical({std::acos(z), 2 * kPi * uniform(seed, 1)});
  const auto truth = tracedView(subject, wo, mixSeed(seed, 2));
  const int side = subject.side(), flat_side = subject.flatSide(),
            lights = subject.btf.manifest().directions.size();
  const size_t texels = size_t(side) * side, flat_texels = size_t(flat_side) * flat_side;
  std::vector<Footprint> footprints(texels);
  for (size_t t = 0; t < texels; ++t)
    footprints[t].addBilinear(
        vdimLookup({.paper = &vdim}, Lookup::kPaper,
                   glm::dvec2(double(t % side) + .5, double(t / side) + .5) / double(side), wo)
            .p,
        flat_side, 1);
  std::vector<glm::vec3> test(texels * lights, glm::vec3(0));
  const DirectionWeights weights = interpolateRings(bonn81Rings(), wo);
  for (int k = 0; k < 4; ++k) {
    if (weights.weight[k] == 0) continue;
    const auto flat = subject.flat.flatView(weights.index[k]);
    if (!flat) return flat.issue();
    for (int light = 0; light < lights; ++light)
      for (size_t t = 0; t < texels; ++t)
        test[light * texels + t] +=
            float(weights.weight[k]) * footprints[t].read(&(*flat)[light * flat_texels]);
  }
  ViewError error;
  for (int light = 0; light < lights; ++light)
    addImage(error, std::span(truth).subspan(light * texels, texels),
             std::span(test).subspan(light * texels, texels));
  return error;
}

template <class Body>
Result<StudyRow> measure(const Subject& subject, const char* protocol, size_t views, const Body& body) {
  std::vector<std::optional<ViewError>> errors(views);
  std::optional<Issue> issue;
  std::mutex issue_mutex;
  Progress progress("flat-reconstruction " + subject.name + " " + protocol + " " +
                        std::to_string(subject.flatSide()) + " " + texelsName(subject),
                    views, subject.options.quiet);
  parallelFor(views, subject.options.threads, [&](size_t view) {
    auto error = body(static_cast<int>(view));
    if (error) {
      errors[view] = std::move(*error);
    } else {
      const std::lock_guard lock(issue_mutex);
      issue = error.issue();
    }
    progress.advance();
  });
  if (issue) return *issue;
  return rowOf(errors, subject, protocol);
}

Status measureTile(const std::string& name, const StudyOptions& options, StudyRows& rows) {
  const auto tile = loadTile(studyTileName(name));
  if (!tile) return tile.issue();
  const TileTracer tracer(*tile);
  StudyBake stored;
  stored.maps = {.btf = false, .flat = false, .vdim = true, .surface = false};
  const auto baked = studyBake(options, name, stored);
  if (!baked) return baked.issue();
  const auto displacements = baked->vdim(16, 16);
  if (!displacements) return displacements.issue();
  const PaperVdim vdim = packPaperVdim(*displacements, options.size, 16, 16);
  const StudyBake truth{0,
                        kGrid,
                        FillMethod::kPushPull,
                        TexelMethod::kMean,
                        {.btf = true, .flat = false, .vdim = false, .surface = false},
                        true};
  const auto btf = studyBake(options, name, truth);
  if (!btf) return btf.issue();
  std::vector<int> views;
  for (int view = options.every / 2; view < btf->manifest().directions.size(); view += options.every)
    views.push_back(view);
  struct FlatMap {
    int size;
    TexelMethod texels;
  };
  for (const auto& [flat_size, texels] : {FlatMap{options.size, TexelMethod::kMean},
                                          {2 * options.size, TexelMethod::kMean},
                                          {2 * options.size, TexelMethod::kLinear}}) {
    const bool between =
        texels == TexelMethod::kMean;  // of others the stored map loses far more than the texels
    const StudyBake wanted{flat_size,
                           kFlatSupersample,
                           FillMethod::kPushPull,
                           texels,
                           {.btf = false, .flat = true, .vdim = false, .surface = false},
                           !between};
    const auto flat = studyBake(options, name, wanted);
    if (!flat) return flat.issue();
    const Subject subject{name, *btf, *flat, tracer, options};
    auto paper = measure(subject, "paper", views.size(), [&](int k) { return paperView(subject, views[k]); });
    if (!paper) return paper.issue();
    rows.push_back(std::move(*paper));
    if (!between) continue;
    auto unsampled = measure(subject, "unsampled", kUnsampledViews,
                             [&](int view) { return unsampledView(subject, vdim, view); });
    if (!unsampled) return unsampled.issue();
    rows.push_back(std::move(*unsampled));
  }
  return {};
}

}  // namespace

Result<StudyRows> studyFlatReconstruction(const StudyOptions& options) {
  StudyRows rows;
  for (const std::string& tile : options.tiles)
    if (const Status status = measureTile(tile, options, rows); !status) return status.issue();
  return rows;
}

}  // namespace loden::importer
