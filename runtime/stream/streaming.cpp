#include "runtime/stream/streaming.h"

#ifdef __linux__
#include <sys/resource.h>
#endif

#include <algorithm>
#include <exception>
#include <string>
#include <utility>

#include "material/base/issues.h"

namespace loden::runtime {
namespace {

// Added to the niceness of the thread that draws: frames come first, then what detail waits for.
constexpr int kLoadNicer = 10, kRefineNicer = 19;

// Memory above all: a part that does not fit is a part that failed, not the end of the process.
Result<LoadedPart> loadRequest(const LoadingThreads::Request& request, const std::stop_token& stop) {
  try {
    return loadPart(*request.file, request.plan, request.kept.get(), request.atlas_threads, stop);
  } catch (const std::exception& exception) {
    return Issue{issue_id::kMemory, Severity::kError, request.file->skeleton().name,
                 std::string("a part could not be prepared: ") + exception.what()};
  }
}

void lowerPriority([[maybe_unused]] int nicer) {
#ifdef __linux__
  const int nice = getpriority(PRIO_PROCESS, 0);  // of this thread, on Linux
  setpriority(PRIO_PROCESS, 0, std::min(nice + nicer, 19));
#endif
}

}  // namespace

LoadingThreads::LoadingThreads() {
  lanes_[0].thread = std::thread([this] { run(lanes_[0], kLoadNicer); });
  lanes_[1].thread = std::thread([this] { run(lanes_[1], kRefineNicer); });
}

LoadingThreads::~LoadingThreads() {
  {
    std::lock_guard lock(mutex_);
    stop_ = true;
    for (Lane& lane : lanes_) lane.stop.request_stop();
  }
  wake_threads_.notify_all();
  for (Lane& lane : lanes_) lane.thread.join();
}

void LoadingThreads::request(Request request) {
  {
    std::lock_guard lock(mutex_);
    lanes_[request.plan.desc.refines].requests.push_back(std::move(request));
  }
  wake_threads_.notify_all();
}

void LoadingThreads::cancel(PartRef ref) {
  std::lock_guard lock(mutex_);
  for (Lane& lane : lanes_) {
    std::erase_if(lane.requests, [ref](const Request& request) { return request.ticket.ref == ref; });
    if (lane.in_hand == ref) lane.stop.request_stop();
  }
}

std::vector<LoadingThreads::Delivery> LoadingThreads::take() {
  std::lock_guard lock(mutex_);
  return std::exchange(deliveries_, {});
}

void LoadingThreads::wait() {
  const auto idle = [](const Lane& lane) { return lane.requests.empty() && !lane.in_hand; };
  std::unique_lock lock(mutex_);
  wake_owner_.wait(lock,
                   [&] { return !deliveries_.empty() || std::all_of(lanes_.begin(), lanes_.end(), idle); });
}

void LoadingThreads::run(Lane& lane, int nicer) {
  lowerPriority(nicer);
  std::unique_lock lock(mutex_);
  while (true) {
    wake_threads_.wait(lock, [&] { return stop_ || !lane.requests.empty(); });
    if (stop_) return;
    const Request request = std::move(lane.requests.front());
    lane.requests.pop_front();
    lane.in_hand = request.ticket.ref;
    lane.stop = {};
    const std::stop_token stop = lane.stop.get_token();
    lock.unlock();
    Result<LoadedPart> part = loadRequest(request, stop);
    lock.lock();
    if (!stop.stop_requested()) deliveries_.push_back({request.ticket, std::move(part)});
    lane.in_hand.reset();
    wake_owner_.notify_all();
  }
}

}  // namespace loden::runtime
