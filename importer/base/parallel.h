// Loops over independent work; oneTBB stays behind it.
#pragma once

#include <cstddef>
#include <functional>

namespace loden::importer {

// At most one per core, whatever is asked for (0: all): oneTBB has no more, and warns on stderr.
int usableThreads(int threads);

// Calls body(i) once for every i in [0, count), on `threads` threads (0: all), in no set order. A reduction
// stays deterministic if body(i) fills slot i and the slots are merged in order afterwards.
void parallelFor(size_t count, int threads, const std::function<void(size_t)>& body);

}  // namespace loden::importer
