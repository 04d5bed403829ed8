// The loading threads: read parts of assets and build atlases while frames go on. Private to the runtime; no
// GL.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "runtime/stream/material_parts.h"

namespace loden::runtime {

// Counts the bytes read through it.
class CountingSource final : public ByteSource {
 public:
  CountingSource(std::shared_ptr<const ByteSource> source, std::atomic<uint64_t>& count)
      : source_(std::move(source)), count_(&count) {}
  uint64_t size() const override { return source_->size(); }
  Status read(uint64_t offset, std::span<std::byte> into) const override {
    *count_ += into.size();
    return source_->read(offset, into);
  }

 private:
  std::shared_ptr<const ByteSource> source_;
  std::atomic<uint64_t>* count_;
};

// One part asked for. The serial tells this request from earlier ones for the same part.
struct PartTicket {
  PartRef ref;
  uint64_t serial = 0;
};

// Two threads: one for what detail waits for, one for what only refines, so that a long build keeps nothing
// waiting. Both run at a lower priority than the thread that makes them, where the system lets them.
class LoadingThreads {
 public:
  struct Request {
    PartTicket ticket;
    std::shared_ptr<const AssetFile> file;
    PartPlan plan;
    std::shared_ptr<const Material> lead;  // of the whole's; null: read again
    int atlas_threads = 1;
  };
  struct Delivery {
    PartTicket ticket;
    Result<LoadedPart> part;
  };

  LoadingThreads();
  ~LoadingThreads();  // drops what is not done; what is in hand ends soon

  // Requests of one kind are served in order.
  void request(Request request);
  // Drops it, begun or not; it is not delivered from now on unless it has been.
  void cancel(PartRef ref);
  // What has been delivered since the last call; never waits.
  std::vector<Delivery> take();
  // Blocks until a delivery is there or nothing is under way.
  void wait();

 private:
  struct Lane {
    std::deque<Request> requests;
    std::optional<PartRef> in_hand;
    std::stop_source stop;  // of it
    std::thread thread;
  };
  void run(Lane& lane, int nicer);

  std::mutex mutex_;
  std::condition_variable wake_threads_, wake_owner_;
  std::array<Lane, 2> lanes_;  // index: whether the part refines
  std::vector<Delivery> deliveries_;
  bool stop_ = false;
};

}  // namespace loden::runtime
