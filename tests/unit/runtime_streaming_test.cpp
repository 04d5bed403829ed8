// The loading threads, on an asset in memory.
#include <gtest/gtest.h>

#include <latch>

#include "material_fixtures.h"
#include "runtime/stream/streaming.h"

namespace loden::runtime {
namespace {

constexpr VdimAtlasSize kLong{1, 4096};  // seconds to build

// Stops reads, from the moment it is told to, until it lets them go.
class GatedSource final : public ByteSource {
 public:
  explicit GatedSource(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {}
  uint64_t size() const override { return source_->size(); }
  Status read(uint64_t offset, std::span<std::byte> into) const override {
    if (closed) {
      if (!reading.try_wait()) reading.count_down();
      open.wait();
    }
    return source_->read(offset, into);
  }
  std::atomic<bool> closed{false};
  mutable std::latch reading{1}, open{1};

 private:
  std::unique_ptr<ByteSource> source_;
};

struct Loading : ::testing::Test {
  Loading() {
    auto bytes = serializeAsset(test::fusedMaterial());
    EXPECT_TRUE(bytes.ok());
    source = std::make_shared<GatedSource>(memorySource(std::move(*bytes), "fused"));
    auto opened = AssetFile::open(source, "fused");
    EXPECT_TRUE(opened.ok());
    file = std::make_shared<const AssetFile>(std::move(*opened));
  }
  LoadingThreads::Request request(uint32_t part, PartKind kind, VdimAtlasSize atlas = kFirstVdimAtlas) const {
    return {{{0, part}, part}, file, {kind, 1, atlas, {}}, nullptr, 1};
  }
  std::shared_ptr<GatedSource> source;
  std::shared_ptr<const AssetFile> file;
};

TEST_F(Loading, DeliversPartsInOrder) {
  LoadingThreads threads;
  threads.request(request(0, PartKind::kBand));
  threads.request(request(1, PartKind::kGeometry));
  std::vector<uint32_t> parts;
  while (parts.size() < 2) {
    threads.wait();
    for (const LoadingThreads::Delivery& delivery : threads.take()) {
      EXPECT_TRUE(delivery.part.ok());
      parts.push_back(delivery.ticket.ref.part);
    }
  }
  EXPECT_EQ(parts, (std::vector<uint32_t>{0, 1}));
}

TEST_F(Loading, CancelDropsThePartInHand) {
  LoadingThreads threads;
  source->closed = true;
  threads.request(request(0, PartKind::kGeometry, kLong));
  source->reading.wait();
  threads.cancel({0, 0});
  source->closed = false;
  threads.request(request(1, PartKind::kBand));
  source->open.count_down();
  threads.wait();
  const std::vector<LoadingThreads::Delivery> delivered = threads.take();
  ASSERT_EQ(delivered.size(), 1u);
  EXPECT_EQ(delivered[0].ticket.ref.part, 1u);
}

TEST_F(Loading, EndDropsAllRequests) {
  auto threads = std::make_unique<LoadingThreads>();
  source->closed = true;
  threads->request(request(0, PartKind::kGeometry, kLong));
  threads->request(request(1, PartKind::kBand));
  source->reading.wait();
  source->closed = false;
  std::thread ending([&] { threads.reset(); });
  source->open.count_down();
  ending.join();
  EXPECT_EQ(file.use_count(), 1) << "no request is left";
}

}  // namespace
}  // namespace loden::runtime
