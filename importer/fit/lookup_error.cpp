#include "importer/fit/lookup_error.h"

#include <algorithm>
#include <cmath>

#include "importer/base/parallel.h"
#include "importer/base/random.h"
#include "material/model/geometry_image.h"

namespace loden::importer {
namespace {

constexpr size_t kBlocks = 64, kPerBlock = 1024;

struct Sum {
  double texels = 0, over = 0, fetches = 0;
};

}  // namespace

LookupProbe::LookupProbe(const GeometryImage& geometry, int side, int threads)
    : geometry_(geometry), side_(side), threads_(threads), blocks_(kBlocks) {
  const GeometryTracer tracer(geometry);
  parallelFor(kBlocks, threads, [&](size_t b) {
    const uint64_t seed = mixSeed(0x100C, b);
    for (uint64_t k = 0; k < kPerBlock; ++k) {
      const double z = 1 - uniform(seed, 4 * k) * (1 - std::cos(kThetaMax));
      Ray ray;
      ray.wo = directionFromSpherical({std::acos(z), 2 * kPi * uniform(seed, 4 * k + 1)});
      ray.x = {uniform(seed, 4 * k + 2), uniform(seed, 4 * k + 3)};
      const auto truth = tracer.traceView(ray.x, ray.wo);
      if (!truth) continue;
      ray.truth = glm::dvec2(truth->position);
      blocks_[b].push_back(ray);
    }
  });
}

LookupError LookupProbe::measure(const VdimAtlas& atlas, Lookup lookup) const {
  std::vector<Sum> sums(kBlocks);
  parallelFor(kBlocks, threads_, [&](size_t b) {
    for (const Ray& ray : blocks_[b]) {
      const VdimHit<double> hit = vdimLookup({.atlas = &atlas}, lookup, ray.x, ray.wo);
      const double texels =
          periodicDistance(glm::dvec2(surfaceAt(geometry_, hit.p).position), ray.truth) * side_;
      sums[b].texels += texels, sums[b].over += texels > 1, sums[b].fetches += hit.fetches;
    }
  });
  Sum all;
  size_t count = 0;
  for (size_t b = 0; b < kBlocks; ++b) {
    all.texels += sums[b].texels, all.over += sums[b].over, all.fetches += sums[b].fetches;
    count += blocks_[b].size();
  }
  const double n = double(std::max<size_t>(1, count));
  return {all.texels / n, all.over / n, all.fetches / n};
}

}  // namespace loden::importer
