#include "importer/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace loden::importer {

void parallelFor(size_t count, int threads, const std::function<void(size_t)>& body) {
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, count, 1),
        [&](const tbb::blocked_range<size_t>& range) {
          for (size_t i = range.begin(); i != range.end(); ++i) body(i);
        },
        tbb::simple_partitioner());
  });
}

}  // namespace loden::importer
