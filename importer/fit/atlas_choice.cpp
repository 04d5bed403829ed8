#include "importer/fit/atlas_choice.h"

#include <algorithm>
#include <cmath>

namespace loden::importer {
namespace {

constexpr int kLeastDirections = 16, kMostDirections = 28;

double badness(const LookupError& error) { return error.mean_texels * error.over_1_texel; }

}  // namespace

std::vector<VdimAtlasSize> atlasCandidates() {
  std::vector<VdimAtlasSize> sizes;
  for (int directions = kLeastDirections; directions <= kMostDirections; directions += 2)
    sizes.push_back({static_cast<int>(std::sqrt(double(kMostAtlasBytes))) / directions, directions});
  return sizes;
}

AtlasChoice chooseAtlas(const GeometryImage& geometry, int side, int threads) {
  AtlasChoice choice;
  const LookupProbe probe(geometry, side, threads);
  for (const VdimAtlasSize size : atlasCandidates())
    choice.trials.push_back({size, probe.measure(buildVdimAtlas(geometry, size, threads), VdimTier::kDefault)});
  const auto best = std::min_element(choice.trials.begin(), choice.trials.end(),
                                     [](const AtlasTrial& a, const AtlasTrial& b) { return badness(a.error) < badness(b.error); });
  choice.size = best->size;
  return choice;
}

}  // namespace loden::importer
