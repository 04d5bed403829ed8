// Sums whose result does not depend on the number of threads: first within fixed blocks, then over the blocks
// in order.
#pragma once

#include <cstdint>

#include "importer/base/parallel.h"

namespace loden::importer {

inline constexpr int kReductionBlocks = 8;
// The first item of block b of `count` items; block b is [blockBegin(count, b), blockBegin(count, b + 1)).
inline int blockBegin(int count, int b) {
  return static_cast<int>(int64_t{count} * b / kReductionBlocks);
}

}  // namespace loden::importer
