// Every allocation of the loading threads fails in turn: what was asked for is delivered, or an issue in its
// place, and the program goes on. A program of its own, because it replaces operator new.
#include <gtest/gtest.h>

#include "material/base/issues.h"
#include "runtime/stream/streaming.h"
#include "tests/failing_allocation.h"
#include "tests/unit/material_fixtures.h"

static thread_local bool exempt = false;  // the thread of the tests

bool loden::test::allocationCounts(const void*) {
  return !exempt;
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
  test::allocations.begin(-1);
  ASSERT_EQ(load(), 0);
  const long all = test::allocations.made;
  ASSERT_GT(all, 3);
  for (const long count : {1L, 3L})
    for (long n = 0; n < all; ++n) {
      test::allocations.begin(n, count);
      const int id = load();
      test::allocations.begin(-1);
      ASSERT_TRUE(id == 0 || id == issue_id::kMemory) << "allocation " << n << " of " << all << ": " << id;
    }
  EXPECT_EQ(load(), 0);
}

INSTANTIATE_TEST_SUITE_P(Parts, LoadingAllocation, testing::Values(PartKind::kBand, PartKind::kGeometry));

}  // namespace
}  // namespace loden::runtime
