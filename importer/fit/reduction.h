// Sums whose result does not depend on the number of threads: over fixed blocks first, then over blocks in
// order.
#pragma once

#include <cstdint>

#include "importer/base/parallel.h"

namespace loden::importer {

inline constexpr int kReductionBlocks = 8;
// Block b of `count` items is [blockBegin(count, b), blockBegin(count, b + 1)).
inline int blockBegin(int count, int b) {
  return static_cast<int>(int64_t{count} * b / kReductionBlocks);
}

}  // namespace loden::importer
