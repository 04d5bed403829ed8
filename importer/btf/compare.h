// Compares two BTFs, materials or pictures.
#pragma once

#include <limits>

#include "importer/base/metrics.h"
#include "importer/base/picture.h"
#include "importer/btf/btf_source.h"

namespace loden::importer {

struct CompareOptions {
  int level = 0;  // the reference is first averaged over blocks of 2^level x 2^level texels
  int every = 1;  // compares every n-th view and light only
  int threads = 0;
  bool quiet = false;
};

// The spread of a number over images of a BTF, one per pair of light and view.
struct Spread {
  double mean = 0, min = std::numeric_limits<double>::infinity(), max = 0;
};

struct BtfDifference {
  ErrorSums all;
  ErrorSums low, high;   // sums over views up to 60 degrees from the normal, and over views beyond
  Spread image_rmse_y;   // RMSE of Y per image
  double flip_mean = 0;  // mean FLIP over one image per view, with light = 37 * view modulo lights
  int images = 0;
};

// The difference of two BTFs, which must have the same texels (after averaging), lights and views.
// Deterministic at any number of threads.
Result<BtfDifference> compareBtfs(const BtfSource& reference, const BtfSource& test,
                                  const CompareOptions& options);

struct PictureDifference {
  ErrorSums all;
  double flip_mean = 0, flip_max = 0;
};
Result<PictureDifference> comparePictures(const Picture& reference, const Picture& test);

// The means over 2^level x 2^level blocks of one width x height image, whose sides must be multiples of
// 2^level.
std::vector<glm::vec3> boxAveraged(std::span<const glm::vec3> image, glm::ivec2 size, int level);

}  // namespace loden::importer
