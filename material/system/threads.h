// A ForEach (material/base/for_each.h) that works on several threads.
#pragma once

#include <stop_token>

#include "material/base/for_each.h"

namespace loden {

// A ForEach that runs on `threads` threads (0: one per core). After a stop request it begins no further
// piece.
ForEach onThreads(int threads = 0, std::stop_token stop = {});

}  // namespace loden
