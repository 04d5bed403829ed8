// Work on several threads, for material/base/for_each.h.
#pragma once

#include <stop_token>

#include "material/base/for_each.h"

namespace loden {

// Runs on `threads` threads (0: one per core). After a stop no further piece is begun.
ForEach onThreads(int threads = 0, std::stop_token stop = {});

}  // namespace loden
