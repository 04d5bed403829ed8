// Every allocation of reading an asset fails in turn: an issue or success, no exception, no leak. A program
// of its own, because it replaces the allocator.
#include <gtest/gtest.h>

#include <limits>

#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "tests/failing_allocation.h"
#include "tests/unit/material_fixtures.h"

static thread_local bool counting = false;

bool loden::test::allocationCounts(const void*) {
  return counting;
}

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
  test::allocations.begin(fail_at, fail_from_then ? std::numeric_limits<long>::max() : 1);
  counting = true;
  try {
    run.id = work();
  } catch (...) {
    run.outcome = Outcome::kThrown;
  }
  counting = false;
  run.made = test::allocations.made;
  run.live = test::allocations.live;
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
