#include "importer/bake/geometry_side.h"

#include <cmath>
#include <vector>

#include "importer/tile/param_map.h"
#include "material/model/geometry_image.h"

namespace loden::importer {
namespace {

// Texels. Of the builtin height fields sponge has .048 and pulli .058 at 128 texels per side, where twice as
// many are worth 1 to 2 dB in pictures, and bricks .027.
constexpr double kMostPatchError = 0.035;
constexpr int kMostDoubled = 256;  // texels per side; of more, twice as many would take megabytes

double heightAt(const Tile& tile, const ParamSample& at) {
  const glm::uvec3& corner = tile.triangles[at.triangle];
  const double z = tile.positions[corner.x].z;
  return z + double(at.b.x) * (tile.positions[corner.y].z - z) +
         double(at.b.y) * (tile.positions[corner.z].z - z);
}

}  // namespace

double patchError(const Tile& tile, int side) {
  const auto index = [side](int i, int j) {
    return size_t(wrapIndex(j, side)) * size_t(side) + size_t(wrapIndex(i, side));
  };
  const std::vector<ParamSample> centres = locateParams(tile, side, glm::dvec2(0.5));
  const glm::dvec2 per_length = periodsPerLength(tile.aspect);
  double sum = 0;
  size_t count = 0;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const glm::dvec2 within(quarter % 2, quarter / 2);  // of the quarter of a texel, whose middle is sampled
    const std::vector<ParamSample> between = locateParams(tile, side, 0.25 + 0.5 * within);
    const glm::dvec2 f = 0.75 - 0.5 * within;  // in the patch around it
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const int x = i - 1 + quarter % 2, y = j - 1 + quarter / 2;
        const ParamSample* const corners[] = {&centres[index(x, y)], &centres[index(x + 1, y)],
                                              &centres[index(x, y + 1)], &centres[index(x + 1, y + 1)]};
        const ParamSample& at = between[index(i, j)];
        double h[4];
        bool covered = at.covered();
        for (int k = 0; k < 4 && covered; ++k) {
          covered = corners[k]->covered();
          if (covered) h[k] = heightAt(tile, *corners[k]);
        }
        if (!covered) continue;
        const double z = glm::mix(glm::mix(h[0], h[1], f.x), glm::mix(h[2], h[3], f.x), f.y);
        const glm::dvec2 slope =
            per_length * double(side) *
            glm::dvec2(glm::mix(h[1] - h[0], h[3] - h[2], f.y), glm::mix(h[2] - h[0], h[3] - h[1], f.x));
        sum += std::abs(z - heightAt(tile, at)) / std::sqrt(1 + glm::dot(slope, slope));
        ++count;
      }
  }
  return count == 0 ? 0 : sum / double(count) * side;
}

int geometrySideOf(const Tile& tile, int least) {
  const bool finer =
      tile.identity_parameterization && least <= kMostDoubled && patchError(tile, least) > kMostPatchError;
  return finer ? 2 * least : least;
}

}  // namespace loden::importer
