#include "material/system/threads.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace loden {

ForEach onThreads(int threads, std::stop_token stop) {
  if (threads <= 0) threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  return [threads, stop = std::move(stop)](int count, const std::function<void(int)>& body) {
    std::atomic<int> next{0};
    const auto work = [&] {
      for (int k; !stop.stop_requested() && (k = next.fetch_add(1)) < count;) body(k);
    };
    std::vector<std::jthread> pool;
    for (int t = 1; t < std::min(threads, count); ++t) pool.emplace_back(work);
    work();
  };
}

}  // namespace loden
