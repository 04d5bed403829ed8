// The lookup on curved reference surfaces (FBTF section 3.1), against the bent tile itself.
//
// Points of a cylinder and a sphere (material/model/analytic_surface.h: 24 tiles around, curvature .26 per
// tile length) and views of them are random, views uniform in solid angle up to 85 degrees; on the sphere
// latitudes stay below 60 degrees. The truth is the first hit of the view ray with the tiles bent along the
// surface. `straight` looks up as on a plane, `bent` tells the lookup the surface's curvature and how its
// texture coordinates are stretched. The error is the distance of the two points' (x, y) on the tile, in
// reference texels, to the nearest periodic copy. Rays that the truth lets pass by the surface (miss_rate)
// have no error; found_rate is the share of them for which the lookup found something all the same, lost_rate
// that of the others of which it says that they miss.
#include <algorithm>
#include <cmath>

#include "importer/base/parallel.h"
#include "importer/base/progress.h"
#include "importer/base/random.h"
#include "importer/cook/atlas_choice.h"
#include "importer/cook/modes.h"
#include "importer/fit/lookup_error.h"
#include "importer/study/study.h"
#include "importer/tile/tile_tracer.h"
#include "importer/trace/bent_tiles.h"
#include "material/model/vdim.h"
#include "material/system/threads.h"

namespace loden::importer {
namespace {

constexpr int kGroups = 256, kSamplesPerGroup = 256;
constexpr double kStart = 1e-4;  // metres before the surface at which view rays start

struct Sample {
  glm::dvec2 x{0};
  glm::dvec3 wo{0, 0, 1};  // tangent frame
  LocalSurface<double> surface;
  glm::dvec2 truth{0};  // (x, y) of the traced point, tile periods
  bool hit = false;
};

// Of a unit tile length along s and t, at one point.
LocalSurface<double> localSurface(const AnalyticSurface& surface, glm::dvec2 st) {
  constexpr double kStep = 1e-5;
  const SurfaceFrame frame = surfaceFrame(surface, st);
  LocalSurface<double> local;
  glm::dmat2 tangent_from_x(0);
  for (int axis = 0; axis < 2; ++axis) {
    glm::dvec2 step(0);
    step[axis] = kStep / surface.tiles[axis];
    const SurfaceFrame after = surfaceFrame(surface, st + step), before = surfaceFrame(surface, st - step);
    const glm::dvec3 dp = (after.position - before.position) / (2 * kStep * AnalyticSurface::kTilePeriod);
    const glm::dvec3 dn = (after.normal - before.normal) / (2 * kStep);
    tangent_from_x[axis] = {glm::dot(dp, frame.tangent), glm::dot(dp, frame.bitangent)};
    local.curvature[axis] = {glm::dot(dn, frame.tangent), glm::dot(dn, frame.bitangent)};
  }
  local.x_from_tangent = glm::inverse(tangent_from_x);
  local.curvature = local.curvature * local.x_from_tangent;
  return local;
}

std::vector<Sample> drawSamples(const BentTiles& tiles, const AnalyticSurface& surface, int threads) {
  std::vector<Sample> samples(size_t(kGroups) * kSamplesPerGroup);
  const double lowest = std::cos(kThetaMax);
  const double t_range = surface.kind == SurfaceKind::kSphere ? 1.0 / 6 : 0.5;  // around the middle
  parallelFor(samples.size(), threads, [&](size_t i) {
    const FlushDenormals flush;
    const uint64_t seed = mixSeed(0xC0DE, i);
    const glm::dvec2 st(uniform(seed, 0), 0.5 + t_range * (2 * uniform(seed, 1) - 1) * 0.95);
    const double z = 1 - uniform(seed, 2) * (1 - lowest);
    Sample& sample = samples[i];
    sample.x = st * surface.tiles;
    sample.wo = directionFromSpherical({std::acos(z), 2 * kPi * uniform(seed, 3)});
    sample.surface = localSurface(surface, st);
    const SurfaceFrame frame = surfaceFrame(surface, st);
    const glm::dvec3 wo = glm::dmat3(frame.tangent, frame.bitangent, frame.normal) * sample.wo;
    const auto hit = tiles.intersect(frame.position + kStart * wo, -wo);
    sample.hit = hit && glm::dot(hit->geometric_normal, wo) > 0;
    if (sample.hit) sample.truth = glm::dvec2(hit->tile_position);
  });
  return samples;
}

void measure(StudyRow& row, const VdimAtlas& atlas, const GeometryImage& geometry, Lookup lookup, bool bent,
             const std::vector<Sample>& samples, glm::dvec2 theta_degrees, const StudyOptions& options) {
  std::vector<double> errors(samples.size(), -1);
  std::vector<int> fetches(samples.size(), 0);
  std::vector<uint8_t> counted(samples.size(), 0), missed_by_lookup(samples.size(), 0);
  parallelFor(samples.size(), options.threads, [&](size_t i) {
    const Sample& sample = samples[i];
    const double theta = std::acos(sample.wo.z) * 180 / kPi;
    if (theta < theta_degrees.x || theta >= theta_degrees.y) return;
    const auto found = vdimLookup({.atlas = &atlas}, lookup, sample.x, sample.wo,
                                  bent ? sample.surface : LocalSurface<double>::flat(geometry.aspect));
    counted[i] = 1, missed_by_lookup[i] = found.missed, fetches[i] = found.fetches;
    if (sample.hit)
      errors[i] =
          periodicDistance(glm::dvec2(surfaceAt(geometry, found.p).position), sample.truth) * options.size;
  });
  double all = 0, missed = 0, missed_found = 0, lost = 0, fetch_sum = 0, sum = 0, over = 0;
  std::vector<double> sorted;
  for (size_t i = 0; i < samples.size(); ++i) {
    if (!counted[i]) continue;
    all += 1, fetch_sum += fetches[i];
    if (errors[i] >= 0)
      sorted.push_back(errors[i]), sum += errors[i], over += errors[i] > 1, lost += missed_by_lookup[i];
    else
      missed += 1, missed_found += !missed_by_lookup[i];
  }
  std::sort(sorted.begin(), sorted.end());
  const double n = double(std::max<size_t>(1, sorted.size()));
  const auto percentile = [&](double share) {
    return sorted.empty() ? 0 : sorted[std::min(sorted.size() - 1, size_t(share * n))];
  };
  row.set("lookup", std::string(lookupName(lookup))).set("ray", bent ? "bent" : "straight");
  row.set("theta_from", theta_degrees.x)
      .set("theta_to", theta_degrees.y)
      .set("fetches", fetch_sum / std::max(all, 1.0));
  row.set("mean_texels", sum / n).set("median_texels", percentile(0.5)).set("p95_texels", percentile(0.95));
  row.set("over_1_texel", over / n).set("miss_rate", missed / std::max(all, 1.0));
  row.set("lost_rate", lost / n);
  row.set("found_rate", missed > 0 ? missed_found / missed : 0.0).set("samples", uint64_t(all));
}

Status measureTile(const std::string& name, const StudyOptions& options, StudyRows& rows) {
  StudyBake wanted;
  wanted.maps = {.btf = false, .flat = false, .vdim = false, .surface = true};
  const auto baked = studyBake(options, name, wanted);
  if (!baked) return baked.issue();
  const auto tile = loadTile(studyTileName(name));
  if (!tile) return tile.issue();
  const auto geometry = geometryOf(*baked, 0);
  if (!geometry) return geometry.issue();
  const VdimAtlas atlas = buildVdimAtlas(
      *geometry, chooseAtlas(*geometry, options.size, options.threads).size, onThreads(options.threads));
  const glm::dvec2 angles[] = {{0, 90}, {0, 60}, {60, 75}, {75, 90}};
  Progress progress("curved-lookup " + name, 2 * 2 * 2 * std::size(angles), options.quiet);
  for (const SurfaceKind kind : {SurfaceKind::kCylinder, SurfaceKind::kSphere}) {
    const AnalyticSurface surface = analyticSurface(kind, tile->aspect);
    const auto samples = drawSamples(BentTiles(*tile, surface), surface, options.threads);
    for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault})
      for (const bool bent : {false, true})
        for (const glm::dvec2 theta : angles) {
          StudyRow row;
          row.set("tile", name)
              .set("size", options.size)
              .set("surface", kind == SurfaceKind::kCylinder ? "cylinder" : "sphere");
          measure(row, atlas, *geometry, lookup, bent, samples, theta, options);
          rows.push_back(std::move(row));
          progress.advance();
        }
  }
  return {};
}

}  // namespace

Result<StudyRows> studyCurvedLookup(const StudyOptions& options) {
  StudyRows rows;
  for (const std::string& tile : options.tiles)
    if (const Status status = measureTile(tile, options, rows); !status) return status.issue();
  return rows;
}

}  // namespace loden::importer
