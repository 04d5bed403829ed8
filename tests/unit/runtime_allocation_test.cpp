// Every allocation of the loading threads fails in turn: what was asked for is delivered, or an issue in its
// place, and the program goes on. A program of its own, because it replaces operator new.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "material/base/issues.h"
#include "runtime/stream/streaming.h"
#include "tests/unit/material_fixtures.h"

namespace {

thread_local bool exempt = false;  // the thread of the tests
std::atomic<long> made{0};         // allocations of all others
std::atomic<long> fail_at{-1};     // the one that fails, counted from 0; -1: none
std::atomic<long> fail_count{1};   // and how many from it on

bool fails() {
  if (exempt) return false;
  const long number = made++, first = fail_at;
  return first >= 0 && number >= first && number < first + fail_count;
}

}  // namespace

__attribute__((noinline)) void* operator new(size_t bytes) {
  void* pointer = fails() ? nullptr : std::malloc(bytes ? bytes : 1);
  if (!pointer) throw std::bad_alloc();
  return pointer;
}
__attribute__((noinline)) void operator delete(void* pointer) noexcept {
  std::free(pointer);
}
__attribute__((noinline)) void operator delete(void* pointer, size_t) noexcept {
  std::free(pointer);
}

namespace loden::runtime {
namespace {

class LoadingAllocation : public testing::TestWithParam<PartKind> {
 protected:
  LoadingAllocation() {
    exempt = true;
    auto bytes = serializeAsset(test::fusedMaterial());
    file_ = std::make_shared<const AssetFile>(
        *AssetFile::open(memorySource(std::move(*bytes), "fused"), "fused"));
  }

  // The issue of what is delivered, or 0.
  int load() {
    LoadingThreads threads;
    threads.request({{{0, 0}, 0}, file_, {GetParam(), 1, kFirstVdimAtlas, {}}, nullptr, 1});
    std::vector<LoadingThreads::Delivery> delivered;
    while (delivered.empty()) {
      threads.wait();
      delivered = threads.take();
    }
    EXPECT_EQ(delivered.size(), 1u);
    return delivered[0].part.ok() ? 0 : delivered[0].part.issue().id;
  }

  std::shared_ptr<const AssetFile> file_;
};

TEST_P(LoadingAllocation, FailuresAreDeliveredAndNotTheEnd) {
  ASSERT_EQ(load(), 0);
  made = 0;
  ASSERT_EQ(load(), 0);
  const long all = made;
  ASSERT_GT(all, 3);
  for (const long count : {1L, 3L})
    for (long n = 0; n < all; ++n) {
      made = 0;
      fail_count = count;
      fail_at = n;
      const int id = load();
      fail_at = -1;
      ASSERT_TRUE(id == 0 || id == issue_id::kMemory) << "allocation " << n << " of " << all << ": " << id;
    }
  EXPECT_EQ(load(), 0);
}

INSTANTIATE_TEST_SUITE_P(Parts, LoadingAllocation, testing::Values(PartKind::kBand, PartKind::kGeometry));

}  // namespace
}  // namespace loden::runtime
