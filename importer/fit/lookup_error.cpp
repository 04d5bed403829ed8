#include "importer/fit/lookup_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "importer/parallel.h"
#include "importer/random.h"

namespace loden::importer {
namespace {

constexpr size_t kBlocks = 64, kPerBlock = 256;

struct Sum {
  double texels = 0, over = 0, fetches = 0;
  size_t count = 0;
};

Sum measureBlock(const Material& material, const VdimAtlas& atlas, const GeometryTracer& tracer, VdimTier tier, uint64_t seed) {
  Sum sum;
  for (uint64_t k = 0; k < kPerBlock; ++k) {
    const double z = 1 - uniform(seed, 4 * k) * (1 - std::cos(kThetaMax));
    const glm::dvec3 wo = directionFromSpherical({std::acos(z), 2 * kPi * uniform(seed, 4 * k + 1)});
    const glm::dvec2 x{uniform(seed, 4 * k + 2), uniform(seed, 4 * k + 3)};
    const auto truth = tracer.traceView(x, wo);
    if (!truth) continue;
    const VdimHit<double> hit = vdimLookup(atlas, tier, x, wo);
    const glm::dvec2 found(surfaceAt(material.geometry, hit.p).position), off = found - glm::dvec2(truth->position);
    const double texels = glm::length(off - glm::round(off)) * material.side;
    sum.texels += texels, sum.over += texels > 1, sum.fetches += hit.fetches, ++sum.count;
  }
  return sum;
}

}  // namespace

LookupError measureLookup(const Material& material, const VdimAtlas& atlas, VdimTier tier, int threads) {
  const GeometryTracer tracer(material.geometry);
  std::vector<Sum> sums(kBlocks);
  parallelFor(kBlocks, threads, [&](size_t b) { sums[b] = measureBlock(material, atlas, tracer, tier, mixSeed(0x100C, b)); });
  Sum all;
  for (const Sum& sum : sums) all.texels += sum.texels, all.over += sum.over, all.fetches += sum.fetches, all.count += sum.count;
  const double n = double(std::max<size_t>(1, all.count));
  return {all.texels / n, all.over / n, all.fetches / n};
}

}  // namespace loden::importer
