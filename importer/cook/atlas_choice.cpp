#include "importer/cook/atlas_choice.h"

#include <algorithm>
#include <cmath>

#include "material/system/threads.h"

namespace loden::importer {
namespace {

constexpr int kLeastDirections = 16, kMostDirections = 28;
constexpr int kHalvings = 3;
constexpr double kNearly = 1.1;  // of the least product: what half the bytes may cost
constexpr double kUnseen =
    0.03 * 0.001;  // a product as small as that of a mean of .03 texels and .1 % over one cannot be seen

double badness(const LookupError& error) {
  return error.mean_texels * error.over_1_texel;
}

VdimAtlasSize sizeFor(uint64_t bytes, int directions) {
  return {std::max(1, static_cast<int>(std::sqrt(double(bytes))) / directions), directions};
}

// Half the bytes `times` times, off texels and directions alike.
VdimAtlasSize smaller(VdimAtlasSize size, uint64_t bytes, int times) {
  const double directions = size.directions * std::pow(2.0, -0.25 * times);
  return sizeFor(bytes >> times, 2 * static_cast<int>(std::lround(directions / 2)));
}

}  // namespace

uint64_t mostAtlasBytes(const GeometryImage& geometry) {
  constexpr int64_t kUsualTexels = 128 * 128, kBytesPerTexel = 2;
  if (!geometry.identity_parameterization) return kMostAtlasBytes;
  const int64_t more = std::max(int64_t{geometry.side()} * geometry.side() - kUsualTexels, int64_t{0});
  return std::max(int64_t{kMostAtlasBytes} - kBytesPerTexel * more, int64_t{kMostAtlasBytes} / 2);
}

std::vector<VdimAtlasSize> atlasCandidates(uint64_t bytes) {
  std::vector<VdimAtlasSize> sizes;
  for (int directions = kLeastDirections; directions <= kMostDirections; directions += 2)
    sizes.push_back(sizeFor(bytes, directions));
  return sizes;
}

AtlasChoice chooseAtlas(const GeometryImage& geometry, int side, int threads) {
  AtlasChoice choice;
  const uint64_t bytes = mostAtlasBytes(geometry);
  const LookupProbe probe(geometry, side, threads);
  const auto measure = [&](VdimAtlasSize size) {
    choice.trials.push_back(
        {size, probe.measure(buildVdimAtlas(geometry, size, onThreads(threads)), Lookup::kDefault)});
    return badness(choice.trials.back().error);
  };
  double least = 0;
  for (const VdimAtlasSize size : atlasCandidates(bytes)) {
    const double bad = measure(size);
    if (choice.trials.size() == 1 || bad < least) choice.size = size, least = bad;
  }
  const VdimAtlasSize best = choice.size;
  for (int times = 1; times <= kHalvings; ++times) {
    const VdimAtlasSize size = smaller(best, bytes, times);
    if (measure(size) > std::max(kNearly * least, kUnseen)) break;
    choice.size = size;
  }
  return choice;
}

}  // namespace loden::importer
