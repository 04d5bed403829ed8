// How far looked-up parameters are from traced ones at views between the samples (FBTF section 4.2, figure
// 10).
//
// Views are random, uniform in solid angle up to 85 degrees; points x are random, uniform over the tile, and
// do not fall on texel centres or mesh vertices. The truth is the first hit of the view ray with the tile's
// own mesh. Both parameters are mapped back to the tile's surface; the error is the distance of the two
// points' (x, y), in reference texels, to the nearest periodic copy; a parameter in a gutter counts as the
// point between the texels around it. Rays that miss the mesh are counted and left out. Pictures are of the
// published maps and of the cooker's choice. On height fields a cone map is measured beside the lookups.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "importer/bake/bake_scene.h"
#include "importer/base/parallel.h"
#include "importer/base/progress.h"
#include "importer/base/random.h"
#include "importer/cook/atlas_choice.h"
#include "importer/fit/lookup_error.h"
#include "importer/fit/paper_vdim.h"
#include "importer/study/cone_map.h"
#include "importer/study/figure.h"
#include "importer/study/study.h"
#include "importer/tile/tile_tracer.h"
#include "material/model/vdim.h"
#include "material/system/threads.h"

namespace loden::importer {
namespace {

constexpr int kViews = 256, kPointsPerView = 512;
constexpr int kFineGeometry = 256;  // texels per side

struct Sample {
  glm::dvec2 x{0};
  glm::dvec3 wo{0, 0, 1};
  glm::dvec2 truth{0};  // (x, y) of the traced point, tile periods
  bool hit = false;
};

std::vector<Sample> drawSamples(const TileTracer& tracer, int threads) {
  std::vector<Sample> samples(size_t(kViews) * kPointsPerView);
  const double lowest = std::cos(kThetaMax);
  parallelFor(kViews, threads, [&](size_t v) {
    const FlushDenormals flush;
    const uint64_t seed = mixSeed(0x5EED, v);
    const double z = 1 - uniform(seed, 0) * (1 - lowest);
    const glm::dvec3 wo = directionFromSpherical({std::acos(z), 2 * kPi * uniform(seed, 1)});
    for (int k = 0; k < kPointsPerView; ++k) {
      Sample& sample = samples[v * kPointsPerView + k];
      sample.wo = wo;
      sample.x = {uniform(seed, 2 + 2 * k), uniform(seed, 3 + 2 * k)};
      const auto hit = tracer.intersectView(sample.x, wo);
      sample.hit = hit.has_value();
      if (hit) sample.truth = glm::dvec2(hit->position);
    }
  });
  return samples;
}

// What a lookup gives: the parameter, and how many texture fetches the shader spends on it.
struct Answer {
  glm::dvec2 p{0};
  int fetches = 0;
};

struct Candidate {
  std::string map, lookup;
  size_t bytes = 0;  // on the GPU
  std::function<Answer(glm::dvec2 x, const glm::dvec3& wo)> find;
  const GeometryImage* geometry = nullptr;  // that p is mapped back through
  bool cooked = false;                      // the atlas that the cooker chooses for this tile
};

StudyRow measure(const Candidate& candidate, const std::vector<Sample>& samples, const std::string& tile,
                 const StudyOptions& options) {
  std::vector<double> errors(samples.size(), -1);
  std::vector<int> fetches(samples.size(), 0);
  parallelFor(kViews, options.threads, [&](size_t v) {
    for (size_t i = v * kPointsPerView; i < (v + 1) * kPointsPerView; ++i) {
      if (!samples[i].hit) continue;
      const Answer answer = candidate.find(samples[i].x, samples[i].wo);
      const auto point = surfaceAt(*candidate.geometry, answer.p);
      errors[i] = periodicDistance(glm::dvec2(point.position), samples[i].truth) * options.size;
      fetches[i] = answer.fetches;
    }
  });
  double sum = 0, fetch_sum = 0;
  for (size_t i = 0; i < errors.size(); ++i) fetch_sum += errors[i] >= 0 ? fetches[i] : 0;
  std::erase_if(errors, [](double e) { return e < 0; });
  std::sort(errors.begin(), errors.end());
  const size_t count = errors.size();
  for (const double error : errors) sum += error;
  const auto over = count - (std::upper_bound(errors.begin(), errors.end(), 1.0) - errors.begin());
  const auto percentile = [&](double share) {
    return count ? errors[std::min(count - 1, static_cast<size_t>(share * double(count)))] : 0;
  };
  const double n = double(std::max<size_t>(1, count));
  StudyRow row;
  row.set("tile", tile).set("size", options.size).set("map", candidate.map).set("lookup", candidate.lookup);
  row.set("fetches", fetch_sum / n).set("bytes", uint64_t{candidate.bytes}).set("mean_texels", sum / n);
  row.set("median_texels", percentile(0.5))
      .set("p95_texels", percentile(0.95))
      .set("over_1_texel", double(over) / n);
  return row.set("samples", uint64_t{count}).set("cooked", candidate.cooked ? "yes" : "");
}

// FBTF figure 10: the mean error of each view. The disc of views has zenith as radius, 85 degrees at its
// edge; black is kLeast texels and white kMost.
Status writeErrorDisc(const Candidate& candidate, const TileTracer& tracer, const std::string& tile,
                      const StudyOptions& options) {
  constexpr int kSide = 128, kPoints = 128;
  constexpr double kLeast = 0.01, kMost = 10;
  std::vector<double> errors(size_t(kSide) * kSide, -1);
  parallelFor(errors.size(), options.threads, [&](size_t pixel) {
    const FlushDenormals flush;
    const glm::dvec2 at =
        (glm::dvec2(double(pixel % kSide), double(pixel / kSide)) + .5) * (2.0 / kSide) - 1.0;
    if (glm::length(at) >= 1) return;
    const glm::dvec3 wo = directionFromSpherical({glm::length(at) * kThetaMax, std::atan2(at.y, at.x)});
    const uint64_t seed = mixSeed(0xF10, pixel);
    double sum = 0;
    int hits = 0;
    for (int k = 0; k < kPoints; ++k) {
      const glm::dvec2 x(uniform(seed, 2 * k), uniform(seed, 2 * k + 1));
      const auto hit = tracer.intersectView(x, wo);
      if (!hit) continue;
      const auto point = surfaceAt(*candidate.geometry, candidate.find(x, wo).p);
      sum += periodicDistance(glm::dvec2(point.position), glm::dvec2(hit->position)) * options.size;
      ++hits;
    }
    if (hits > 0) errors[pixel] = sum / hits;
  });
  std::string name = "vdim-interpolation-" + tile + "-" + (candidate.cooked ? "cooked" : candidate.map) +
                     "-" + candidate.lookup + ".png";
  std::replace(name.begin(), name.end(), ':', '-');
  return writeFigure(logarithmicPicture(errors, kSide, kLeast, kMost), options.pictures / name);
}

// `owner` keeps the maps alive.
Candidate lookupCandidate(const std::string& map, size_t bytes, const VdimMaps& maps, Lookup lookup,
                          const GeometryImage& geometry, std::shared_ptr<const void> owner) {
  const auto find = [maps, lookup, owner = std::move(owner)](glm::dvec2 x, const glm::dvec3& wo) {
    const auto hit = vdimLookup(maps, lookup, x, wo);
    return Answer{hit.p, hit.fetches};
  };
  return {map, std::string(lookupName(lookup)), bytes, find, &geometry};
}

// The published map of the bake, blended as published.
Result<Candidate> paperCandidate(const BakedOutput& baked, glm::ivec2 shape, const GeometryImage& geometry) {
  const auto displacements = baked.vdim(shape.x, shape.y);
  if (!displacements) return displacements.issue();
  auto vdim =
      std::make_shared<PaperVdim>(packPaperVdim(*displacements, baked.manifest().size, shape.x, shape.y));
  const size_t bytes = vdim->reference.data.size() + vdim->packed.data.size();
  const std::string map = "latlong:" + std::to_string(shape.x) + "x" + std::to_string(shape.y);
  return lookupCandidate(map, bytes, {.paper = vdim.get()}, Lookup::kPaper, geometry, vdim);
}

// texels as BakedOutput::geometry gives them.
GeometryImage encodeTexels(int side, std::span<const glm::vec4> texels, bool identity_parameterization) {
  std::vector<glm::dvec3> positions;
  std::vector<uint16_t> charts;
  for (size_t t = 0; t < texels.size(); ++t) {
    const glm::dvec2 p((double(t % size_t(side)) + .5) / side, (double(t / size_t(side)) + .5) / side);
    positions.emplace_back(glm::dvec2(texels[t]) + p, std::min(texels[t].z, 0.0f));
    charts.push_back(static_cast<uint16_t>(texels[t].w));
  }
  return encodeGeometryImage(side, positions, charts, identity_parameterization);
}

Result<GeometryImage> geometryOf(const BakedOutput& baked) {
  const auto texels = baked.geometry();
  if (!texels) return texels.issue();
  return encodeTexels(baked.manifest().geometry_size, *texels, baked.manifest().identity_parameterization);
}

// The geometry image that --geometry-size would give.
GeometryImage geometryOfSize(const TileTracer& mesh, int side) {
  BakeManifest manifest;
  manifest.geometry_size = side;
  manifest.flat_size = 64, manifest.supersample = 1;  // of maps that are not used here
  BakeCounters counters;
  const Image image = bakeSurface({mesh, manifest, counters}).geometry;
  std::vector<glm::vec4> texels;
  for (size_t t = 0; t < image.pixels.size(); t += 4)
    texels.emplace_back(image.pixels[t], image.pixels[t + 1], image.pixels[t + 2], image.pixels[t + 3]);
  return encodeTexels(side, texels, mesh.tile().identity_parameterization);
}

Candidate qualityCandidate(const GeometryImage& geometry) {
  const auto tracer = std::make_shared<GeometryTracer>(geometry, Interpolation::kCubic);
  return lookupCandidate("geometry " + std::to_string(geometry.side()), geometry.texels.data.size(),
                         {.tracer = tracer.get()}, Lookup::kQuality, geometry, tracer);
}

// The first hit on the triangles of the geometry image, which is what the atlas's searches look for.
Candidate triangleCandidate(const GeometryImage& geometry) {
  const auto tracer = std::make_shared<GeometryTracer>(geometry);
  Candidate candidate =
      lookupCandidate("geometry " + std::to_string(geometry.side()), geometry.texels.data.size(),
                      {.tracer = tracer.get()}, Lookup::kQuality, geometry, tracer);
  candidate.lookup = "triangles";
  return candidate;
}

std::vector<Candidate> searchCandidates(const GeometryImage& geometry, VdimAtlasSize size, int threads) {
  const auto atlas = std::make_shared<VdimAtlas>(buildVdimAtlas(geometry, size, onThreads(threads)));
  const std::string texels = std::to_string(size.texels),
                    map = "concentric:" + std::to_string(size.directions) + " of " + texels + "x" + texels;
  std::vector<Candidate> candidates;
  for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault})
    candidates.push_back(
        lookupCandidate(map, atlas->bytes(), {.atlas = atlas.get()}, lookup, geometry, atlas));
  return candidates;
}

// As many fetches as the atlas's lookups take, and twice to four times as many.
std::vector<Candidate> coneCandidates(const GeometryImage& geometry, int threads) {
  const auto cones = std::make_shared<ConeMap>(buildConeMap(geometry, threads));
  std::vector<Candidate> candidates;
  for (const int taps : {4, 6, 8, 10, 13, 19, 32}) {
    const auto find = [cones, taps](glm::dvec2 x, const glm::dvec3& wo) {
      const ConeHit hit = coneLookup(*cones, taps, x, wo);
      return Answer{hit.p, hit.fetches};
    };
    candidates.push_back({"cones " + std::to_string(cones->side), std::to_string(taps) + " taps",
                          cones->bytes(), find, &geometry});
  }
  return candidates;
}

Status measureTile(const std::string& name, const StudyOptions& options, StudyRows& rows) {
  StudyBake wanted;
  wanted.maps = {.btf = false, .flat = false, .vdim = true, .surface = true};
  const auto baked = studyBake(options, name, wanted);
  if (!baked) return baked.issue();
  const auto tile = loadTile(studyTileName(name));
  if (!tile) return tile.issue();
  const auto geometry = geometryOf(*baked);
  if (!geometry) return geometry.issue();
  const TileTracer mesh(*tile);
  const auto samples = drawSamples(mesh, options.threads);
  std::vector<Candidate> candidates;
  for (const glm::ivec2 shape : baked->manifest().vdims) {
    auto candidate = paperCandidate(*baked, shape, *geometry);
    if (!candidate) return candidate.issue();
    candidates.push_back(std::move(*candidate));
  }
  const AtlasChoice choice = chooseAtlas(*geometry, options.size, options.threads);
  std::vector<VdimAtlasSize> sizes{kFirstVdimAtlas, {16, 16}};
  for (const AtlasTrial& trial : choice.trials) sizes.push_back(trial.size);
  for (const VdimAtlasSize size : sizes)
    for (Candidate& candidate : searchCandidates(*geometry, size, options.threads)) {
      candidate.cooked = size == choice.size;
      candidates.push_back(std::move(candidate));
    }
  const GeometryImage fine = geometryOfSize(mesh, kFineGeometry);
  if (geometry->identity_parameterization)
    for (Candidate& candidate : coneCandidates(*geometry, options.threads))
      candidates.push_back(std::move(candidate));
  candidates.push_back(triangleCandidate(*geometry));
  candidates.push_back(qualityCandidate(*geometry));
  if (geometry->side() != kFineGeometry) candidates.push_back(qualityCandidate(fine));
  Progress progress("vdim-interpolation " + name, candidates.size(), options.quiet);
  for (const Candidate& candidate : candidates) {
    rows.push_back(measure(candidate, samples, name, options));
    if (!options.pictures.empty() && (candidate.lookup == "paper" || candidate.cooked))
      if (const Status status = writeErrorDisc(candidate, mesh, name, options); !status)
        return status.issue();
    progress.advance();
  }
  return {};
}

}  // namespace

Result<StudyRows> studyVdimInterpolation(const StudyOptions& options) {
  StudyRows rows;
  for (const std::string& tile : options.tiles)
    if (const Status status = measureTile(tile, options, rows); !status) return status.issue();
  return rows;
}

}  // namespace loden::importer
