// Scripted demands against the residency policy.
#include <gtest/gtest.h>

#include <random>

#include "runtime/stream/residency.h"

namespace loden::runtime {
namespace {

constexpr uint64_t kKib = 1024;
constexpr float kFrame = 1.0f / 60;

// Four levels like a fused material's: each finer one four times the bytes.
std::vector<PartDesc> fourLevels(uint64_t coarsest = 64 * kKib) {
  return {{coarsest, 4}, {4 * coarsest, 3}, {16 * coarsest, 2}, {64 * coarsest, 1}};
}

// Drives the policy as the material system does, with every part arriving `latency` frames after it was asked
// for, and checks on every frame what must hold always.
class Player {
 public:
  explicit Player(const ResidencyOptions& options, int latency = 0)
      : residency(options), budget_(options.budget_bytes), latency_(latency) {}

  void frame(std::initializer_list<std::pair<uint32_t, float>> demands, float seconds = kFrame) {
    for (const auto& [slot, lambda] : demands) residency.demand(slot, lambda);
    step(seconds);
  }
  void step(float seconds) {
    for (size_t i = 0; i < under_way_.size();) {
      if (under_way_[i].second-- > 0) {
        ++i;
        continue;
      }
      const PartRef ref = under_way_[i].first;
      under_way_.erase(under_way_.begin() + ptrdiff_t(i));
      fails(ref) ? residency.failed(ref) : residency.arrived(ref);
    }
    const Residency::Actions& actions = residency.advance(seconds);
    evictions += int(actions.evict.size());
    loads += int(actions.load.size());
    for (PartRef ref : actions.evict)
      std::erase_if(under_way_, [ref](const auto& item) { return item.first == ref; });
    for (PartRef ref : actions.load) under_way_.push_back({ref, latency_});
    EXPECT_LE(residency.committedBytes(), budget_) << "over budget";
  }
  void setBudget(uint64_t bytes) { residency.setBudget(budget_ = bytes); }

  Residency residency;
  int evictions = 0, loads = 0;
  std::vector<PartRef> failing;

  bool fails(PartRef ref) const { return std::find(failing.begin(), failing.end(), ref) != failing.end(); }

 private:
  uint64_t budget_;
  int latency_;
  std::vector<std::pair<PartRef, int>> under_way_;
};

TEST(Residency, LoadsCoarsestFirstAndNoFinerThanDemanded) {
  Player player({.budget_bytes = 100000 * kKib, .max_loading = 1});
  const uint32_t slot = player.residency.add(fourLevels());
  EXPECT_EQ(player.residency.publishedLambda(slot), 4) << "nothing is resident";
  for (int i = 0; i < 200; ++i) player.frame({{slot, 2.0f}});
  EXPECT_TRUE(player.residency.resident({slot, 1}));
  EXPECT_FALSE(player.residency.resident({slot, 2})) << "needed below lambda 2 only";
  EXPECT_EQ(player.loads, 2);
  EXPECT_FLOAT_EQ(player.residency.publishedLambda(slot), 2);
  EXPECT_TRUE(player.residency.settled());
}

TEST(Residency, FadesInAtTheGivenRate) {
  Player player({.budget_bytes = 100000 * kKib});
  const uint32_t slot = player.residency.add(fourLevels());
  float before = player.residency.publishedLambda(slot);
  for (int i = 0; i < 120; ++i) {
    player.frame({{slot, 0.0f}});
    const float now = player.residency.publishedLambda(slot);
    EXPECT_LE(before - now, 4 * kFrame + 1e-5f);
    before = now;
  }
  EXPECT_EQ(before, 0);
}

TEST(Residency, KeepsTheFloorOfWhatNobodySees) {
  Player player({.budget_bytes = 400 * kKib,
                 .unseen_floor_share = 0.5f});  // a second part would fit if two floors went
  std::vector<uint32_t> slots;
  for (int i = 0; i < 3; ++i) slots.push_back(player.residency.add(fourLevels()));
  for (int i = 0; i < 10; ++i) player.frame({});
  for (uint32_t slot : slots) EXPECT_TRUE(player.residency.resident({slot, 0}));
  for (int i = 0; i < 50; ++i) player.frame({{slots[0], 0.0f}});
  for (uint32_t slot : slots)
    EXPECT_TRUE(player.residency.resident({slot, 0})) << "evicted for finer levels of another";
}

TEST(Residency, LoadsNothingWithoutABudget) {
  Player player({.budget_bytes = 0});
  const uint32_t slot = player.residency.add(fourLevels());
  for (int i = 0; i < 20; ++i) player.frame({{slot, 0.0f}});
  EXPECT_EQ(player.loads, 0);
  EXPECT_EQ(player.residency.publishedLambda(slot), 4);
  EXPECT_TRUE(player.residency.settled());
}

TEST(Residency, EvictsWhatWasSeenLongestAgo) {
  // Room for one material down to part 2 and the floors of all.
  Player player({.budget_bytes = (64 * 3 + 20 * 64 * 2) * kKib, .floor_bytes = 64 * kKib});
  std::vector<uint32_t> slots;
  for (int i = 0; i < 3; ++i) slots.push_back(player.residency.add(fourLevels()));
  for (uint32_t slot : slots)
    for (int i = 0; i < 40; ++i) player.frame({{slot, 1.0f}});
  EXPECT_FALSE(player.residency.resident({slots[0], 2}));
  EXPECT_TRUE(player.residency.resident({slots[1], 2}));
  EXPECT_TRUE(player.residency.resident({slots[2], 2}));
}

TEST(Residency, DoesNotThrashWhenDemandExceedsTheBudget) {
  // Both materials want everything on every frame; only one fits.
  Player player({.budget_bytes = 90 * 64 * kKib}, 2);
  const uint32_t a = player.residency.add(fourLevels()), b = player.residency.add(fourLevels());
  for (int i = 0; i < 600; ++i) player.frame({{a, 0.0f}, {b, 0.0f}});
  EXPECT_LE(player.loads, 8);
  EXPECT_EQ(player.evictions, 0);
}

TEST(Residency, DoesNotThrashWhenTheViewFlickers) {
  // Two materials seen on alternate frames, of which only one fits whole.
  Player player({.budget_bytes = 90 * 64 * kKib}, 1);
  const uint32_t a = player.residency.add(fourLevels()), b = player.residency.add(fourLevels());
  for (int i = 0; i < 600; ++i) player.frame({{i % 2 ? a : b, 0.0f}});
  EXPECT_LE(player.loads, 10) << player.evictions;
}

TEST(Residency, PrefersCoarseOfOneToFineOfAnother) {
  Player player({.budget_bytes = 90 * 64 * kKib}, 1);
  const uint32_t a = player.residency.add(fourLevels()), b = player.residency.add(fourLevels());
  for (int i = 0; i < 60; ++i) player.frame({{a, 0.0f}});
  EXPECT_TRUE(player.residency.resident({a, 3}));
  for (int i = 0; i < 60; ++i) player.frame({{a, 0.0f}, {b, 0.0f}});
  EXPECT_TRUE(player.residency.resident({b, 2})) << "levels 0..2 of both fit once a's finest is gone";
  EXPECT_FALSE(player.residency.resident({a, 3}));
}

TEST(Residency, GivesUpLoadsThatNobodyWantsAnyMore) {
  Player player({.budget_bytes = 100000 * kKib, .floor_bytes = 0, .max_loading = 2},
                1000);  // a very slow disk
  const uint32_t a = player.residency.add(fourLevels()), b = player.residency.add(fourLevels());
  for (int i = 0; i < 20; ++i) player.frame({{a, 0.0f}});
  EXPECT_EQ(player.loads, 2);
  for (int i = 0; i < 20; ++i) player.frame({{b, 0.0f}});
  EXPECT_EQ(player.evictions, 2) << "a's, to be dropped on arrival";
  EXPECT_EQ(player.loads, 4);
}

TEST(Residency, KeepsTheCoarseLevelOfADamagedFile) {
  Player player({.budget_bytes = 100000 * kKib}, 1);
  const uint32_t slot = player.residency.add(fourLevels());
  player.failing = {{slot, 2}};
  for (int i = 0; i < 200; ++i) player.frame({{slot, 0.0f}});
  EXPECT_TRUE(player.residency.resident({slot, 1}));
  EXPECT_EQ(player.residency.publishedLambda(slot), 2);
  EXPECT_TRUE(player.residency.settled()) << "asks again and again";
  EXPECT_LE(player.loads, 4);
}

TEST(Residency, GivesUpWhatArrivedBehindADamagedPart) {
  Player player({.budget_bytes = 400 * kKib}, 1);
  const uint32_t damaged = player.residency.add({{64 * kKib, 4}, {64 * kKib, 3}, {200 * kKib, 2}});
  player.failing = {{damaged, 1}};
  const uint32_t sound = player.residency.add({{64 * kKib, 4}, {250 * kKib, 3}});
  for (int i = 0; i < 20; ++i) player.frame({{damaged, 0.0f}});
  for (int i = 0; i < 200; ++i) player.frame({{damaged, 0.0f}, {sound, 0.0f}});
  EXPECT_TRUE(player.residency.resident({sound, 1})) << "its room is held by what nobody can show";
  EXPECT_FALSE(player.residency.resident({damaged, 2}));
  EXPECT_TRUE(player.residency.settled());
}

TEST(Residency, ObeysABudgetThatShrinks) {
  Player player({.budget_bytes = 200 * 64 * kKib}, 3);
  const uint32_t slot = player.residency.add(fourLevels());
  for (int i = 0; i < 60; ++i) player.frame({{slot, 0.0f}});
  EXPECT_TRUE(player.residency.resident({slot, 3}));
  player.setBudget(10 * 64 * kKib);
  for (int i = 0; i < 60; ++i) player.frame({{slot, 0.0f}});
  EXPECT_TRUE(player.residency.resident({slot, 1}));
  EXPECT_EQ(player.residency.publishedLambda(slot), 2);
}

TEST(Residency, ReusesSlotsAndFreesBytes) {
  Player player({.budget_bytes = 100000 * kKib});
  const uint32_t slot = player.residency.add(fourLevels());
  for (int i = 0; i < 10; ++i) player.frame({{slot, 0.0f}});
  EXPECT_GT(player.residency.committedBytes(), 0u);
  player.residency.remove(slot);
  EXPECT_EQ(player.residency.committedBytes(), 0u);
  EXPECT_EQ(player.residency.add(fourLevels()), slot);
}

TEST(Residency, StartsAgainAfterALostContext) {
  Player player({.budget_bytes = 100000 * kKib});
  const uint32_t slot = player.residency.add(fourLevels());
  for (int i = 0; i < 120; ++i) player.frame({{slot, 0.0f}});
  player.residency.dropAll();
  EXPECT_EQ(player.residency.committedBytes(), 0u);
  EXPECT_EQ(player.residency.publishedLambda(slot), 4);
  for (int i = 0; i < 120; ++i) player.frame({{slot, 0.0f}});
  EXPECT_EQ(player.residency.publishedLambda(slot), 0);
}

TEST(Residency, TakesTenThousandMaterials) {
  Player player({.budget_bytes = 32 * kKib * kKib}, 2);
  std::vector<uint32_t> slots;
  for (int i = 0; i < 10000; ++i) slots.push_back(player.residency.add(fourLevels(16 * kKib)));
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    for (int k = 0; k < 50; ++k)
      player.residency.demand(slots[(size_t(i) * 10 + size_t(k)) % slots.size()], 2);
    player.step(kFrame);
  }
  EXPECT_GT(player.residency.residentParts(), 0);
}

// A reference band, geometry with a small atlas, a flat band, and the full atlas.
std::vector<PartDesc> withRefinement() {
  return {{100, 7}, {50, 2}, {200, 2}, {300, 1, true}};
}

TEST(Residency, ShowsDetailWithoutWhatOnlyRefinesIt) {
  Player player({.budget_bytes = 500, .floor_bytes = 0});
  const uint32_t slot = player.residency.add(withRefinement());
  for (int i = 0; i < 200; ++i) player.frame({{slot, 0.0f}});
  EXPECT_FALSE(player.residency.resident({slot, 3})) << "the budget has no room for it";
  EXPECT_EQ(player.residency.publishedLambda(slot), 0);
  EXPECT_TRUE(player.residency.settled());
  player.setBudget(650);
  for (int i = 0; i < 10; ++i) player.frame({{slot, 0.0f}});
  EXPECT_TRUE(player.residency.resident({slot, 3}));
  player.setBudget(400);
  for (int i = 0; i < 10; ++i) player.frame({{slot, 0.0f}});
  EXPECT_FALSE(player.residency.resident({slot, 3})) << "evicted like any level";
  EXPECT_EQ(player.residency.publishedLambda(slot), 0) << "falls back to the small one";
}

TEST(Residency, RefinesOneAtATimeAndAfterAllDetail) {
  Player player({.budget_bytes = 1200, .floor_bytes = 0}, 5);
  const uint32_t a = player.residency.add(withRefinement()), b = player.residency.add(withRefinement());
  bool refined = false;
  for (int i = 0; i < 60; ++i) {
    player.frame({{a, 0.0f}, {b, 0.0f}});
    for (uint32_t slot : {a, b})
      if (!refined && player.residency.resident({slot, 3})) {
        refined = true;
        EXPECT_TRUE(player.residency.resident({a, 2}) && player.residency.resident({b, 2}));
        EXPECT_FALSE(player.residency.resident({slot == a ? b : a, 3}));
      }
  }
  EXPECT_TRUE(refined);
  EXPECT_FALSE(player.residency.resident({a, 3}) && player.residency.resident({b, 3})) << "room for one";
  EXPECT_TRUE(player.residency.resident({a, 2}) && player.residency.resident({b, 2}));
  EXPECT_TRUE(player.residency.settled());
}

TEST(Residency, DoesNotRefineWhatIsBroken) {
  Player player({.budget_bytes = 100000, .floor_bytes = 0}, 1);
  const uint32_t slot = player.residency.add(withRefinement());
  player.failing = {{slot, 2}};
  for (int i = 0; i < 60; ++i) player.frame({{slot, 0.0f}});
  EXPECT_EQ(player.loads, 3);
  EXPECT_TRUE(player.residency.settled());
}

// A leading part that fits into the floor, the whole that takes its place, geometry, a flat band, and the
// full atlas.
std::vector<PartDesc> withLeadingPart() {
  return {{60 * kKib, 7}, {285 * kKib, 7, true}, {100 * kKib, 2}, {400 * kKib, 2}, {300 * kKib, 1, true}};
}

TEST(Residency, KeepsTheLeadingPartAsTheFloor) {
  Player player({.budget_bytes = 1000 * kKib});
  const uint32_t slot = player.residency.add(withLeadingPart());
  for (int i = 0; i < 30; ++i) player.frame({});
  EXPECT_TRUE(player.residency.resident({slot, 0}));
  EXPECT_EQ(player.residency.residentParts(), 1);
  EXPECT_EQ(player.residency.publishedLambda(slot), 2)
      << "what comes after the whole is missing, not the whole";
  EXPECT_TRUE(player.residency.settled());
}

TEST(Residency, ShowsDetailWhereOnlyTheLeadingPartFits) {
  Player player({.budget_bytes = 600 * kKib});
  const uint32_t slot = player.residency.add(withLeadingPart());
  for (int i = 0; i < 200; ++i) player.frame({{slot, 0.0f}});
  EXPECT_TRUE(player.residency.resident({slot, 3})) << "detail comes before what refines";
  EXPECT_FALSE(player.residency.resident({slot, 1}));
  EXPECT_EQ(player.residency.publishedLambda(slot), 0);
  EXPECT_TRUE(player.residency.settled());
}

TEST(Residency, FillsUpWithDetailAndThenWithWholes) {
  Player player({.budget_bytes = 900 * kKib}, 3);
  const uint32_t slot = player.residency.add(withLeadingPart());
  for (int i = 0; i < 100; ++i) player.frame({{slot, 0.0f}});
  EXPECT_TRUE(player.residency.resident({slot, 1}) && player.residency.resident({slot, 3}));
  EXPECT_FALSE(player.residency.resident({slot, 4}))
      << "the whole of a coarse band counts more than an atlas";
  player.setBudget(600 * kKib);
  for (int i = 0; i < 100; ++i) player.frame({{slot, 0.0f}});
  EXPECT_FALSE(player.residency.resident({slot, 1})) << "goes alone: nothing reads through it";
  EXPECT_TRUE(player.residency.resident({slot, 3}));
  EXPECT_EQ(player.residency.publishedLambda(slot), 0);
  EXPECT_EQ(player.loads, 4) << "nothing was read twice";
}

TEST(Residency, FadesTheWholeInWhereItIsSeen) {
  Player player({.budget_bytes = 1000 * kKib, .release_seconds = 1});
  const uint32_t slot = player.residency.add(withLeadingPart());
  const PartRef whole{slot, 1};
  float before = 0;
  for (int i = 0; i < 60; ++i) {
    player.frame({{slot, 3.0f}});
    const float now = player.residency.shownShare(whole);
    EXPECT_LE(now - before, 4 * kFrame + 1e-5f);
    EXPECT_GE(now, before);
    before = now;
  }
  EXPECT_EQ(before, 1);
  player.setBudget(100 * kKib);
  player.frame({{slot, 3.0f}});
  EXPECT_EQ(player.residency.shownShare(whole), 0) << "gone";
  player.setBudget(1000 * kKib);
  for (int i = 0; i < 3; ++i) player.frame({{slot, 3.0f}});
  EXPECT_LT(player.residency.shownShare(whole), 0.5f) << "and comes in again";
  player.residency.endFades();
  EXPECT_EQ(player.residency.shownShare(whole), 1);
}

TEST(Residency, ShowsTheWholeAtOnceWhereNobodyLooked) {
  Player player({.budget_bytes = 1000 * kKib}, 5);
  const uint32_t slot = player.residency.add(withLeadingPart());
  for (int i = 0; i < 8; ++i) player.frame({{slot, 3.0f}});
  for (int i = 0; i < 8; ++i) player.frame({});
  ASSERT_TRUE(player.residency.resident({slot, 1})) << "was under way";
  player.frame({{slot, 3.0f}});
  EXPECT_EQ(player.residency.shownShare({slot, 1}), 1);
}

TEST(Residency, DoesWithoutAWholeThatIsDamaged) {
  Player player({.budget_bytes = 1000 * kKib}, 1);
  const uint32_t slot = player.residency.add(withLeadingPart());
  player.failing = {{slot, 1}};
  for (int i = 0; i < 200; ++i) player.frame({{slot, 0.0f}});
  EXPECT_TRUE(player.residency.resident({slot, 0}) && player.residency.resident({slot, 3}) &&
              player.residency.resident({slot, 4}));
  EXPECT_EQ(player.residency.publishedLambda(slot), 0);
  EXPECT_EQ(player.loads, 5);
  for (int i = 0; i < 300; ++i) player.frame({});
  EXPECT_TRUE(player.residency.active().empty()) << "at rest";
}

// The tail of surface maps, geometry, and the maps: only the first is a floor, and the maps wait for it.
TEST(Residency, AsksForWhatTakesOverWhenTheEarlierPartIsThere) {
  Player player({.budget_bytes = 1000 * kKib}, 5);
  std::vector<PartDesc> parts{{20 * kKib, 8}, {100 * kKib, 7}, {75 * kKib, 1}};
  parts[2].takes_over = true;
  const uint32_t slot = player.residency.add(parts);
  player.frame({{slot, 0.0f}});
  EXPECT_EQ(player.loads, 2) << "the first two side by side";
  while (!player.residency.resident({slot, 1})) player.frame({{slot, 0.0f}});
  for (int i = 0; i < 150; ++i) player.frame({{slot, 0.0f}});
  EXPECT_EQ(player.loads, 3);
  EXPECT_EQ(player.residency.publishedLambda(slot), 0);
}

// Twenty visible materials whose wholes would need ten times the budget: each is shown, and nothing goes
// round in circles.
TEST(Residency, ShowsTheLeadingPartsOfAllInATightBudget) {
  Player player({.budget_bytes = 1300 * kKib}, 2);
  std::vector<uint32_t> slots;
  for (int i = 0; i < 20; ++i) slots.push_back(player.residency.add(withLeadingPart()));
  for (int frame = 0; frame < 300; ++frame) {
    for (uint32_t slot : slots) player.residency.demand(slot, 2.5f);
    player.step(kFrame);
  }
  for (uint32_t slot : slots) EXPECT_EQ(player.residency.publishedLambda(slot), 2);
  EXPECT_TRUE(player.residency.settled());
  EXPECT_EQ(player.loads, 20) << "1200 KiB of floors leave no room for a whole";
}

TEST(Residency, ComesNearestToEveryDemandRatherThanToOne) {
  // Room for the detail of one of two, of which one asks for little more than it has.
  Player player({.budget_bytes = 700 * kKib});
  const uint32_t far = player.residency.add(withLeadingPart()),
                 near = player.residency.add(withLeadingPart());
  for (int i = 0; i < 130; ++i) player.frame({{far, 1.9f}, {near, 0.0f}});
  EXPECT_TRUE(player.residency.resident({near, 3}));
  EXPECT_EQ(player.residency.publishedLambda(near), 0);
  EXPECT_EQ(player.residency.publishedLambda(far), 2);
}

TEST(Residency, ReadsFloorsThatNobodySeesLast) {
  Player player({.budget_bytes = 100000 * kKib, .max_loading = 1});
  std::vector<uint32_t> slots;
  for (int i = 0; i < 50; ++i) slots.push_back(player.residency.add(withLeadingPart()));
  for (int i = 0; i < 15; ++i) player.frame({{slots[40], 0.0f}});
  EXPECT_TRUE(player.residency.resident({slots[40], 4})) << "all of what is seen";
  for (int i = 0; i < 80; ++i) player.frame({{slots[40], 0.0f}});
  for (uint32_t slot : slots) EXPECT_TRUE(player.residency.resident({slot, 0}));
}

TEST(Residency, ReleasesWhatNobodyWantsForAWhile) {
  Player player({.budget_bytes = 100000 * kKib, .release_seconds = 2});
  const uint32_t slot = player.residency.add(fourLevels());
  for (int i = 0; i < 60; ++i) player.frame({{slot, 0.0f}});
  ASSERT_TRUE(player.residency.resident({slot, 3}));
  for (int i = 0; i < 110; ++i) player.frame({});
  EXPECT_EQ(player.evictions, 0) << "looked away for less than two seconds";
  player.frame({{slot, 0.0f}});
  EXPECT_EQ(player.residency.publishedLambda(slot), 0) << "and finds it as it was";
  for (int i = 0; i < 130; ++i) player.frame({{slot, 2.5f}});
  EXPECT_FALSE(player.residency.resident({slot, 2})) << "seen, but from too far for that";
  EXPECT_TRUE(player.residency.resident({slot, 1}));
  for (int i = 0; i < 130; ++i) player.frame({});
  EXPECT_FALSE(player.residency.resident({slot, 1}));
  EXPECT_TRUE(player.residency.resident({slot, 0})) << "the floor stays";
}

TEST(Residency, DoesNotFadeWhatArrivesUnseen) {
  Player player({.budget_bytes = 100000 * kKib});
  const uint32_t slot = player.residency.add(fourLevels());
  for (int i = 0; i < 5; ++i) player.frame({});
  ASSERT_TRUE(player.residency.resident({slot, 0})) << "its floor";
  player.frame({{slot, 3.5f}});
  EXPECT_EQ(player.residency.publishedLambda(slot), 3) << "shown at once";
}

TEST(Residency, FadesNoFasterWhereFramesAreLong) {
  Player player({.budget_bytes = 100000 * kKib, .fade_levels_per_frame = 0.1f});
  const uint32_t slot = player.residency.add(fourLevels());
  for (int i = 0; i < 2; ++i) player.frame({{slot, 0.0f}}, 0.001f);
  const float before = player.residency.publishedLambda(slot);
  player.frame({{slot, 0.0f}}, 2);
  EXPECT_NEAR(before - player.residency.publishedLambda(slot), 0.1f, 1e-5f);  // rounding of levels up to 4
  player.residency.endFades();
  EXPECT_EQ(player.residency.publishedLambda(slot), 0);
}

// Unseen floors take a quarter of the budget at most, however many there are: what is seen has the rest.
TEST(Residency, LeavesRoomBesideTheFloorsOfThousands) {
  Player player({.budget_bytes = 32 * kKib * kKib});
  std::vector<uint32_t> slots;
  for (int i = 0; i < 10000; ++i) slots.push_back(player.residency.add(fourLevels(16 * kKib)));
  for (int i = 0; i < 300; ++i) player.frame({});
  EXPECT_LE(player.residency.committedBytes(), 8 * kKib * kKib);
  EXPECT_GT(player.residency.committedBytes(), 7 * kKib * kKib);
  for (int i = 0; i < 60; ++i) player.frame({{slots.back(), 0.0f}});
  EXPECT_TRUE(player.residency.resident({slots.back(), 3})) << "the last of them, whose floor was not there";
}

// What a frame costs depends on what happens, not on how many materials there are.
TEST(Residency, LooksAtNothingThatRests) {
  Player player({.budget_bytes = 1024 * kKib * kKib, .unseen_floor_share = 0.5f, .release_seconds = 1});
  std::vector<uint32_t> slots;
  for (int i = 0; i < 10000; ++i) slots.push_back(player.residency.add(fourLevels(2 * kKib)));
  int frames = 0;
  while (!player.residency.active().empty() && frames < 10000) player.frame({}), ++frames;
  EXPECT_LT(frames, 10000);
  const int loads = player.loads;
  EXPECT_EQ(loads, 30000) << "all floors: three parts each fit in 64 KiB";
  for (int i = 0; i < 30; ++i) {
    player.frame({{slots[5], 0.0f}, {slots[7], 3.0f}});
    EXPECT_LE(player.residency.active().size(), 2u);
  }
  EXPECT_EQ(player.loads, loads + 1);
  for (int i = 0; i < 80; ++i) player.frame({});
  EXPECT_TRUE(player.residency.active().empty()) << "released, and at rest again";
  EXPECT_EQ(player.residency.residentParts(), 30000);
}

// One part per material, and room for one of the two: what is wanted more by a step that exceeds the head
// start wins.
TEST(Residency, SettlesWhereOnePartOutranksAnother) {
  for (const float finer : {2.3f, 2.5f, 2.6f, 2.8f, 3.0f, 3.2f}) {
    Player player({.budget_bytes = 100, .floor_bytes = 0}, 1);
    const uint32_t resident = player.residency.add({{100, 2.0f}}),
                   absent = player.residency.add({{100, finer}});
    for (int i = 0; i < 60; ++i) player.frame({{resident, 0.0f}});
    ASSERT_TRUE(player.residency.resident({resident, 0}));
    for (int i = 0; i < 200; ++i) player.frame({{resident, 0.0f}, {absent, 0.0f}});
    EXPECT_TRUE(player.residency.settled()) << finer;
    EXPECT_EQ(player.residency.resident({absent, 0}), finer > 2.5f) << finer;
    EXPECT_LE(player.loads, 2) << finer;
  }
}

// Property test: from any state that demands led to, constant demand comes to rest, and stays there.
TEST(Residency, SettlesUnderConstantDemand) {
  std::mt19937 random(11);
  const auto below = [&](uint32_t n) { return uint32_t(random() % n); };
  for (int trial = 0; trial < 300; ++trial) {
    Player player({.budget_bytes = (1 + below(4000)) * kKib, .max_loading = 1 + int(below(8))},
                  int(below(4)));
    std::vector<uint32_t> slots;
    const bool damaged = below(3) == 0;
    for (uint32_t i = 0; i < 2 + below(12); ++i) {
      std::vector<PartDesc> parts;
      float end = 3 + float(below(300)) * 0.01f;
      for (uint32_t k = 1 + below(5); k > 0; --k, end -= float(below(150)) * 0.01f) {
        parts.push_back({(1 + below(800)) * kKib, end, !parts.empty() && below(4) == 0});
        parts.back().takes_over = below(4) == 0;
      }
      slots.push_back(player.residency.add(parts));
      if (damaged && below(2) == 0) player.failing.push_back({slots.back(), below(uint32_t(parts.size()))});
    }
    const auto demands = [&] {
      std::vector<std::pair<uint32_t, float>> chosen;
      for (uint32_t slot : slots)
        if (below(4) > 0) chosen.push_back({slot, float(below(500)) * 0.01f});
      return chosen;
    };
    const auto show = [&](const std::vector<std::pair<uint32_t, float>>& chosen, int frames) {
      for (int i = 0; i < frames; ++i) {
        for (const auto& [slot, lambda] : chosen) player.residency.demand(slot, lambda);
        player.step(0.1f);
      }
    };
    for (int scene = 0; scene < 4; ++scene) {
      show(demands(), int(below(30)));
      if (below(2) > 0) player.setBudget((1 + below(4000)) * kKib);
      const auto last = demands();
      show(last, 400);
      ASSERT_TRUE(player.residency.settled()) << "trial " << trial << ", scene " << scene;
      const int loads = player.loads, evictions = player.evictions;
      show(last, 40);
      ASSERT_EQ(player.loads, loads) << "trial " << trial;
      ASSERT_EQ(player.evictions, evictions) << "trial " << trial;
    }
  }
}

// Property test: any demands, any failures, any budget.
TEST(Residency, NeverExceedsTheBudgetUnderRandomDemand) {
  std::mt19937 random(7);
  const auto below = [&](uint32_t n) { return uint32_t(random() % n); };
  Player player({.budget_bytes = 3000 * kKib}, 2);
  std::vector<uint32_t> slots;
  for (int i = 0; i < 40; ++i) slots.push_back(player.residency.add(fourLevels((1 + below(32)) * kKib)));
  for (int i = 0; i < 20; ++i) player.failing.push_back({slots[below(40)], below(4)});
  for (int frame = 0; frame < 2000; ++frame) {
    if (below(100) == 0) player.setBudget(below(6000) * kKib);
    for (uint32_t k = below(10); k > 0; --k)
      player.residency.demand(slots[below(40)], float(below(500)) * 0.01f);
    player.step(kFrame);
    for (uint32_t slot : slots)
      for (uint32_t part = 1; part < 4; ++part)
        ASSERT_TRUE(!player.residency.resident({slot, part}) || player.residency.resident({slot, part - 1}) ||
                    player.fails({slot, part - 1}))
            << "a finer part without the coarser one, slot " << slot << ", part " << part << ", frame "
            << frame;
  }
}

}  // namespace
}  // namespace loden::runtime
