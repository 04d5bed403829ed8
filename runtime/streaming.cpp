#include "runtime/streaming.h"

#include <algorithm>
#include <exception>
#include <string>
#include <utility>

#include "material/issues.h"

namespace loden::runtime {
namespace {

// Memory above all: a part that does not fit is a part that failed, not the end of the process.
Result<LoadedPart> loadRequest(const LoadingThread::Request& request) {
  try {
    return loadPart(*request.file, request.plan, request.atlas, request.atlas_threads);
  } catch (const std::exception& exception) {
    return Issue{issue_id::kMemory, Severity::kError, request.file->skeleton().name,
                 std::string("a part could not be prepared: ") + exception.what()};
  }
}

}  // namespace

LoadingThread::LoadingThread() : thread_([this] { run(); }) {}

LoadingThread::~LoadingThread() {
  {
    std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_thread_.notify_one();
  thread_.join();
}

void LoadingThread::request(Request request) {
  {
    std::lock_guard lock(mutex_);
    requests_.push_back(std::move(request));
  }
  wake_thread_.notify_one();
}

void LoadingThread::cancel(PartRef ref) {
  std::lock_guard lock(mutex_);
  std::erase_if(requests_, [ref](const Request& request) { return request.ticket.ref == ref; });
}

std::vector<LoadingThread::Delivery> LoadingThread::take() {
  std::lock_guard lock(mutex_);
  return std::exchange(deliveries_, {});
}

void LoadingThread::wait() {
  std::unique_lock lock(mutex_);
  wake_owner_.wait(lock, [this] { return !deliveries_.empty() || (requests_.empty() && !working_); });
}

void LoadingThread::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_thread_.wait(lock, [this] { return stop_ || !requests_.empty(); });
    if (stop_) return;
    const Request request = std::move(requests_.front());
    requests_.pop_front();
    working_ = true;
    lock.unlock();
    Result<LoadedPart> part = loadRequest(request);
    lock.lock();
    deliveries_.push_back({request.ticket, std::move(part)});
    working_ = false;
    wake_owner_.notify_all();
  }
}

}  // namespace loden::runtime
