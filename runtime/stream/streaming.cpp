#include "runtime/stream/streaming.h"

#ifdef __linux__
#include <sys/resource.h>
#endif

#include <algorithm>
#include <chrono>
#include <exception>
#include <new>
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
    return loadPart(*request.file, request.plan, request.lead.get(), request.atlas_threads, stop);
  } catch (const std::exception& exception) {
    try {
      return Issue{issue_id::kMemory, Severity::kError, request.file->skeleton().name,
                   std::string("a part could not be prepared: ") + exception.what()};
    } catch (const std::exception&) {
      return Issue{issue_id::kMemory, Severity::kError, "", "out of memory"};  // short: not allocated
    }
  }
}

// Does `work`, which leaves things as they were where it finds no memory, again and again until it finds
// some; the lock is free in between. False if it was given up before.
template <class Work, class GivenUp>
bool withRoom(std::unique_lock<std::mutex>& lock, const Work& work, const GivenUp& given_up) {
  while (!given_up()) {
    try {
      work();
      return true;
    } catch (const std::bad_alloc&) {
      lock.unlock();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      lock.lock();
    }
  }
  return false;
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
    if (!withRoom(
            lock, [&] { lane.stop = {}; }, [&] { return stop_; }))
      return;
    if (lane.requests.empty()) continue;  // cancelled meanwhile
    const Request request = std::move(lane.requests.front());
    lane.requests.pop_front();
    lane.in_hand = request.ticket.ref;
    const std::stop_token stop = lane.stop.get_token();
    lock.unlock();
    Result<LoadedPart> part = loadRequest(request, stop);
    lock.lock();
    Delivery delivery{request.ticket, std::move(part)};
    withRoom(
        lock, [&] { deliveries_.push_back(std::move(delivery)); }, [&] { return stop.stop_requested(); });
    lane.in_hand.reset();
    wake_owner_.notify_all();
  }
}

}  // namespace loden::runtime
