// A goal in bytes or in error, met by measuring candidate plans.
#pragma once

#include <functional>
#include <vector>

#include "importer/cook/fused_plan.h"
#include "material/base/result.h"

namespace loden::importer {

struct TradePoint {
  FusedPlan plan;
  uint64_t bytes = 0;  // raw bytes of the file
  double rmse_y = 0;   // measured with a shortened fit
};

struct Goal {
  uint64_t max_bytes = 0;  // 0: none
  double target_rmse = 0;  // of Y; 0: none
  int levels = 0;  // FusedPlan::levels of every plan: the error is measured at lambda 0, where no other level
                   // is read, so it cannot choose them
  int surface_side = 0;  // of the baked maps that a near term is made of; 0: plans have a flat-domain band
  int bounces = 0;       // FusedPlan::bounces of every plan
};

struct Choice {
  FusedPlan plan;
  std::vector<TradePoint> measured;  // every candidate that was fitted, by bytes
};

// The plan with the least error within max_bytes, or with the fewest bytes at target_rmse (within max_bytes
// if both are given). 16 bits are tried last, for the best plan of 8: they halve an error of rounding that
// more components or texels outweigh as long as there are more to have. `measure` fits a plan and returns the
// RMSE of Y. Fails with kGoal where no plan can meet the goal, and says what the nearest plan gives.
Result<Choice> choosePlan(const Goal& goal, int side, int geometry_side,
                          const std::function<Result<double>(const FusedPlan&)>& measure);

// Most calls of `measure` that choosePlan makes.
int mostTrials(const Goal& goal, int geometry_side);

// The most frugal plan of the search.
FusedPlan smallestPlan(int geometry_side);

// The measured plans that no other beats in both bytes and error, by bytes.
std::vector<TradePoint> paretoFront(std::vector<TradePoint> points);

}  // namespace loden::importer
