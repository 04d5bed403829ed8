// The loading threads, which read parts of assets and build atlases while frames are drawn. Private to the
// runtime; no GL.
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

// A ByteSource that counts the bytes read through it.
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

// The identity of one request for a part. The serial tells it from earlier requests for the same part.
struct PartTicket {
  PartRef ref;
  uint64_t serial = 0;
};

// Two loading threads: one for parts that detail waits for and one for parts that only refine, so that a long
// atlas build delays nothing else. Both run at a lower priority than the thread that creates them, if the
// system allows that.
class LoadingThreads {
 public:
  struct Request {
    PartTicket ticket;
    std::shared_ptr<const AssetFile> file;
    PartPlan plan;
    // LoadedPart::lead of the leading part, if `plan` is the whole; null: it is read again
    std::shared_ptr<const Material> lead;
    int atlas_threads = 1;
  };
  struct Delivery {
    PartTicket ticket;
    Result<LoadedPart> part;
  };

  LoadingThreads();
  // Discards all requests; a request that is being worked on is stopped and waited for.
  ~LoadingThreads();

  // Queues a request. Requests of one thread are served in order.
  void request(Request request);
  // Discards the request for this part, even if work on it has begun. It is not delivered afterwards, unless
  // it already has been.
  void cancel(PartRef ref);
  // The deliveries since the last call. Never waits.
  std::vector<Delivery> take();
  // Blocks until there is a delivery or no request is left.
  void wait();

 private:
  struct Lane {
    std::deque<Request> requests;
    std::optional<PartRef> in_hand;
    std::stop_source stop;  // for the request in hand
    std::thread thread;
  };
  void run(Lane& lane, int nicer);

  std::mutex mutex_;
  std::condition_variable wake_threads_, wake_owner_;
  std::array<Lane, 2> lanes_;  // [0]: parts that detail waits for, [1]: parts that refine
  std::vector<Delivery> deliveries_;
  bool stop_ = false;
};

}  // namespace loden::runtime
