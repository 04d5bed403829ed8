// Every allocation of reading an asset fails in turn: an issue or success, no exception, no leak. A program
// of its own, because it replaces the allocator.
#include <gtest/gtest.h>

#include <cerrno>
#include <cstdlib>
#include <new>

#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "tests/unit/material_fixtures.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LODEN_OWN_MALLOC 0  // the sanitizer's stays; operator new alone fails
#elif defined(__GLIBC__)
#define LODEN_OWN_MALLOC 1
#else
#define LODEN_OWN_MALLOC 0
#endif

namespace {

// Of this thread; counted only between begin() and end().
struct Allocations {
  bool counting = false;
  long made = 0, live = 0;
  long fail_at = -1;            // the allocation that fails, counted from 0; -1: none
  bool fail_from_then = false;  // and all that follow

  bool next() {
    if (!counting) return true;
    const long number = made++;
    if (fail_at >= 0 && (number == fail_at || (fail_from_then && number > fail_at))) return false;
    ++live;
    return true;
  }
  void freed(const void* pointer) {
    if (counting && pointer) --live;
  }
};
thread_local Allocations allocations;

}  // namespace

#if LODEN_OWN_MALLOC
// C libraries, zstd among them, allocate here; so does operator new.
extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void __libc_free(void*);

void* malloc(size_t bytes) {
  if (allocations.next()) return __libc_malloc(bytes);
  errno = ENOMEM;
  return nullptr;
}
void* calloc(size_t count, size_t bytes) {
  if (allocations.next()) return __libc_calloc(count, bytes);
  errno = ENOMEM;
  return nullptr;
}
void free(void* pointer) {
  allocations.freed(pointer);
  __libc_free(pointer);
}
}
#else
__attribute__((noinline)) void* operator new(size_t bytes) {
  void* pointer = allocations.next() ? std::malloc(bytes ? bytes : 1) : nullptr;
  if (!pointer) throw std::bad_alloc();
  return pointer;
}
__attribute__((noinline)) void operator delete(void* pointer) noexcept {
  allocations.freed(pointer);
  std::free(pointer);
}
__attribute__((noinline)) void operator delete(void* pointer, size_t) noexcept {
  operator delete(pointer);
}
#endif

namespace loden {
namespace {

using Bytes = std::vector<std::byte>;

enum class Outcome { kSuccess, kMemory, kOther, kThrown };

// What a run of `work` comes to, which returns an issue's id or 0, with one allocation failing or all from
// one on. What the run allocated is free again.
struct Run {
  Outcome outcome = Outcome::kSuccess;
  long made = 0, live = 0;
  int id = 0;
};
template <class Work>
Run runWith(long fail_at, bool fail_from_then, const Work& work) {
  Run run;
  allocations = {true, 0, 0, fail_at, fail_from_then};
  try {
    run.id = work();
  } catch (...) {
    run.outcome = Outcome::kThrown;
  }
  allocations.counting = false;
  run.made = allocations.made;
  run.live = allocations.live;
  if (run.outcome != Outcome::kThrown && run.id != 0)
    run.outcome = run.id == issue_id::kMemory ? Outcome::kMemory : Outcome::kOther;
  return run;
}

// `work` without a fault succeeds; with every allocation failing in turn, it says so or succeeds all the
// same.
enum class Says { kAlways, kWhereThereIsRoom };  // whether a list of issues is what comes back
template <class Work>
void expectSurvived(const char* what, const Work& work, Says says = Says::kAlways) {
  SCOPED_TRACE(what);
  work();  // what is made once and kept
  const Run whole = runWith(-1, false, work);
  ASSERT_EQ(whole.outcome, Outcome::kSuccess) << whole.id;
  ASSERT_EQ(whole.live, 0);
  ASSERT_GT(whole.made, 3);
  for (const bool all_that_follow : {false, true}) {
    long refused = 0;
    for (long n = 0; n < whole.made; ++n) {
      const Run run = runWith(n, all_that_follow, work);
      ASSERT_EQ(run.live, 0) << "allocation " << n << " of " << whole.made;
      const bool no_room =
          all_that_follow && says == Says::kWhereThereIsRoom && run.outcome == Outcome::kThrown;
      ASSERT_TRUE(no_room || run.outcome == Outcome::kMemory || run.outcome == Outcome::kSuccess)
          << "allocation " << n << " of " << whole.made << (all_that_follow ? " and all that follow" : "")
          << (run.outcome == Outcome::kThrown ? ": an exception" : ": issue ") << run.id;
      refused += run.outcome != Outcome::kSuccess;
    }
    EXPECT_GT(refused, 0) << "no failure was noticed";
  }
  EXPECT_EQ(runWith(-1, false, work).outcome, Outcome::kSuccess) << "after all failures";
}

// Too long for a string without an allocation.
const std::string kName = "a folder of materials/a piece of cloth.loden";

template <class T>
int idOf(const Result<T>& result) {
  return result ? 0 : result.issue().id;
}

class Allocation : public testing::TestWithParam<Material (*)()> {
 protected:
  Bytes bytes = *serializeAsset(GetParam()());
};

TEST_P(Allocation, ReadingAnAssetSurvivesEveryFailure) {
  expectSurvived("parseAsset", [&] { return idOf(parseAsset(bytes, kName)); });
}

TEST_P(Allocation, ValidatingAnAssetSurvivesEveryFailure) {
  const auto validate = [&] {
    const std::vector<Issue> issues = validateAsset(bytes, kName);
    return issues.empty() ? 0 : issues.front().id;
  };
  expectSurvived("validateAsset", validate, Says::kWhereThereIsRoom);
}

TEST_P(Allocation, OpeningAndLoadingPartsSurvivesEveryFailure) {
  const std::shared_ptr<const ByteSource> source = memorySource(bytes, kName);
  expectSurvived("AssetFile::open", [&] { return idOf(AssetFile::open(source, kName)); });
  const Result<AssetFile> file = AssetFile::open(source, kName);
  ASSERT_TRUE(file.ok());
  for (size_t band = 0; band < file->skeleton().bands.size(); ++band) {
    expectSurvived("loadBand", [&] { return idOf(file->loadBand(int(band))); });
    const Result<Band> lead = file->loadBand(int(band), Share::kLead);
    ASSERT_TRUE(lead.ok());
    if (file->skeleton().bands[band].lead_quads > 0)
      expectSurvived("the rest of a band",
                     [&] { return idOf(file->loadBand(int(band), Share::kWhole, &*lead)); });
  }
  if (!file->skeleton().geometry.texels.width) return;
  expectSurvived("loadGeometry", [&] { return idOf(file->loadGeometry()); });
  if (file->skeleton().surface) expectSurvived("loadSurface", [&] { return idOf(file->loadSurface()); });
}

TEST_P(Allocation, WritingAnAssetSurvivesEveryFailure) {
  const Material material = GetParam()();
  expectSurvived("serializeAsset", [&] { return idOf(serializeAsset(material)); });
}

INSTANTIATE_TEST_SUITE_P(Modes, Allocation,
                         testing::Values(test::surfaceMaterial, test::lodMaterial, test::fusedMaterial,
                                         test::nearMaterial, test::splitFusedMaterial,
                                         test::splitSurfaceMaterial));

}  // namespace
}  // namespace loden
