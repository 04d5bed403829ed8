// Finds a plan that meets a goal in bytes or in error, by measuring candidate plans.
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
  double target_rmse = 0;  // RMSE of Y; 0: none
  // FusedPlan::levels of every plan. The search cannot choose it, since the error is measured at lambda 0,
  // where no other level is read.
  int levels = 0;
  // Texels per side of the baked maps from which a near term is made; 0: plans have a flat-domain band.
  int surface_side = 0;
  int bounces = 0;  // FusedPlan::bounces of every plan
};

struct Choice {
  FusedPlan plan;
  std::vector<TradePoint> measured;  // every candidate that was fitted, by bytes
};

// The plan with the least error within max_bytes, or with the fewest bytes at target_rmse (within max_bytes
// if both are given). 16 bits are tried last, for the best plan of 8 bits, because they halve the rounding
// error, which more components or texels outweigh as long as there is room for more of them. `measure` fits a
// plan and returns the RMSE of Y. Issues: kGoal if no plan can meet the goal; it says what the nearest plan
// gives.
Result<Choice> choosePlan(const Goal& goal, int side, int geometry_side,
                          const std::function<Result<double>(const FusedPlan&)>& measure);

// The most calls of `measure` that choosePlan makes.
int mostTrials(const Goal& goal, int geometry_side);

// The plan with the fewest bytes in the search.
FusedPlan smallestPlan(int geometry_side);

// The Pareto front by bytes: the measured plans that no other beats in both bytes and error.
std::vector<TradePoint> paretoFront(std::vector<TradePoint> points);

}  // namespace loden::importer
