// Parallel loops over independent work, by oneTBB, which the header does not expose.
#pragma once

#include <cstddef>
#include <functional>

namespace loden::importer {

// The number of threads to use for a request of `threads` (0: all): at most one per core, since oneTBB has no
// more, and warns on stderr.
int usableThreads(int threads);

// Calls body(i) once for every i in [0, count), on `threads` threads (0: all), in no set order. A reduction
// stays deterministic if body(i) fills slot i and the slots are merged in order afterwards.
void parallelFor(size_t count, int threads, const std::function<void(size_t)>& body);

}  // namespace loden::importer
