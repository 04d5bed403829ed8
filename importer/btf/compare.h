// How far one BTF, material or picture is from another.
#pragma once

#include <limits>

#include "importer/base/metrics.h"
#include "importer/base/picture.h"
#include "importer/btf/btf_source.h"

namespace loden::importer {

struct CompareOptions {
  int level = 0;  // the reference is averaged over 2^level x 2^level texels first
  int every = 1;  // only every n-th view and light
  int threads = 0;
  bool quiet = false;
};

// Spread of a number over light-view images.
struct Spread {
  double mean = 0, min = std::numeric_limits<double>::infinity(), max = 0;
};

struct BtfDifference {
  ErrorSums all;
  ErrorSums low, high;   // views up to 60 degrees from the normal, and beyond
  Spread image_rmse_y;   // over light-view images
  double flip_mean = 0;  // over one image per view, light = 37 * view modulo lights
  int images = 0;
};

// Both must have the same texels (after averaging), lights and views. Deterministic at any number of threads.
Result<BtfDifference> compareBtfs(const BtfSource& reference, const BtfSource& test,
                                  const CompareOptions& options);

struct PictureDifference {
  ErrorSums all;
  double flip_mean = 0, flip_max = 0;
};
Result<PictureDifference> comparePictures(const Picture& reference, const Picture& test);

// Mean over 2^level x 2^level blocks of one width x height image; sides must be multiples.
std::vector<glm::vec3> boxAveraged(std::span<const glm::vec3> image, glm::ivec2 size, int level);

}  // namespace loden::importer
