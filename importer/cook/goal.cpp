#include "importer/cook/goal.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "material/base/issues.h"

namespace loden::importer {
namespace {

constexpr int kMostComponents = 40;

constexpr int kLeastGeometry = 16;  // texels per side

// Everything but the number of components, from frugal to lavish. Of near terms: sides of their maps and of
// the geometry image. Of flat-domain bands: columns of the flat band's grid (more than 11 buy less than more
// components do, but a lavish plan has enough of these), scale of the flat map, share of the baked geometry
// image.
std::vector<FusedPlan> structures(int geometry_side, int surface_side) {
  std::vector<FusedPlan> all;
  for (const int surface_share : {4, 2, 1})
    for (const int share : {4, 2, 1}) {
      if (surface_side == 0 || surface_side % surface_share != 0) continue;
      if (share > 1 && (geometry_side % share != 0 || geometry_side / share < kLeastGeometry)) continue;
      FusedPlan plan;
      plan.surface_side = surface_side / surface_share;
      plan.geometry_side = geometry_side / share;
      all.push_back(plan);
    }
  if (surface_side > 0) return all;
  for (const int phis : {7, 11, 17})
    for (const int scale : {1, 2})
      for (const int share : {4, 2, 1}) {
        if (share > 1 && (geometry_side % share != 0 || geometry_side / share < kLeastGeometry)) continue;
        FusedPlan plan;
        plan.phis = phis;
        plan.flat_scale = scale;
        plan.geometry_side = geometry_side / share;
        all.push_back(plan);
      }
  return all;
}

// The coarse band keeps step: as many components, which have to hold the shadows too there, and a grid finer
// by the same margin as in the default.
FusedPlan withComponents(FusedPlan plan, int y) {
  if (plan.surface_side > 0) {  // the near term has none
    plan.coarse_y = y;
    return plan;
  }
  plan.y_components = y;
  plan.coarse_y = y;
  plan.coarse_phis = plan.phis + FusedPlan{}.coarse_phis - FusedPlan{}.phis;
  return plan;
}

// Components that a search for the fewest bytes tries, in order.
std::vector<int> componentSteps(const Goal& goal) {
  // An error at lambda 0 does not tell how many the coarse band of a near term needs: the default.
  if (goal.surface_side > 0) return {FusedPlan{}.coarse_y};
  std::vector<int> steps;
  for (int y = 4; y <= kMostComponents; y += y < 16 ? 4 : 8) steps.push_back(y);
  return steps;
}

Issue unreachable(const char* field, double wanted, const TradePoint& nearest) {
  char text[200];
  std::snprintf(text, sizeof text, "%g cannot be met: the nearest plan takes %llu bytes for an RMSE of %.4f",
                wanted, static_cast<unsigned long long>(nearest.bytes), nearest.rmse_y);
  return {issue_id::kGoal, Severity::kError, field, text};
}

class Search {
 public:
  Search(const Goal& goal, int side, int geometry_side,
         const std::function<Result<double>(const FusedPlan&)>& measure)
      : goal_(goal), side_(side), geometry_side_(geometry_side), measure_(measure) {}

  Result<Choice> run() { return goal_.target_rmse > 0 ? fewestBytes() : leastError(); }

 private:
  std::vector<FusedPlan> plans() const {
    std::vector<FusedPlan> all = structures(geometry_side_, goal_.surface_side);
    for (FusedPlan& plan : all) plan.levels = goal_.levels, plan.bounces = goal_.bounces;
    return all;
  }
  FusedPlan smallest() const { return withComponents(plans().front(), 4); }
  uint64_t bytes(const FusedPlan& plan) const { return fusedBytes(plan, side_, plan.geometry_side); }
  bool fits(const FusedPlan& plan) const { return goal_.max_bytes == 0 || bytes(plan) <= goal_.max_bytes; }

  Result<TradePoint> measured(const FusedPlan& plan) {
    const auto rmse = measure_(plan);
    if (!rmse) return rmse.issue();
    TradePoint point{plan, bytes(plan), *rmse};
    choice_.measured.push_back(point);
    return point;
  }

  Result<Choice> finish(const TradePoint& best) {
    choice_.plan = best.plan;
    std::sort(choice_.measured.begin(), choice_.measured.end(),
              [](const TradePoint& a, const TradePoint& b) { return a.bytes < b.bytes; });
    return std::move(choice_);
  }

  // For each structure the most components that fit; the least error of these.
  Result<Choice> leastError() {
    std::optional<TradePoint> best;
    for (const FusedPlan& structure : plans()) {
      int y = kMostComponents;
      while (y > 0 && !fits(withComponents(structure, y))) y -= 4;
      if (y == 0) continue;
      const auto point = measured(withComponents(structure, y));
      if (!point) return point.issue();
      if (!best || point->rmse_y < best->rmse_y) best = *point;
    }
    if (best) {
      const auto finer = finerStorage(*best);
      if (!finer) return finer.issue();
      return finish(*finer);
    }
    return Issue{issue_id::kGoal, Severity::kError, "max_bytes",
                 std::to_string(goal_.max_bytes) +
                     " is too little: the smallest fused asset of this input takes " +
                     std::to_string(bytes(smallest())) + " bytes"};
  }

  // For each structure the fewest components that reach the target, unless they already cost more than the
  // best.
  Result<Choice> fewestBytes() {
    std::optional<TradePoint> best, nearest;
    for (const FusedPlan& structure : plans())
      for (const int y : componentSteps(goal_)) {
        const FusedPlan plan = withComponents(structure, y);
        if (!fits(plan) || (best && bytes(plan) >= best->bytes)) break;
        const auto point = measured(plan);
        if (!point) return point.issue();
        if (!nearest || point->rmse_y < nearest->rmse_y) nearest = *point;
        if (point->rmse_y > goal_.target_rmse) continue;
        best = *point;
        break;
      }
    if (!best && nearest) {
      const auto finer = finerStorage(*nearest);
      if (!finer) return finer.issue();
      nearest = *finer;
      if (finer->rmse_y <= goal_.target_rmse) best = *finer;
    }
    if (best) return finish(*best);
    if (nearest) return unreachable("target_rmse", goal_.target_rmse, *nearest);
    return leastError();  // nothing fits into max_bytes: its message says so
  }

  // The same plan in 16 bits where that fits and is better.
  Result<TradePoint> finerStorage(const TradePoint& point) {
    FusedPlan plan = point.plan;
    plan.storage = Storage::kSnorm16;
    if (plan.surface_side > 0 || !fits(plan)) return point;
    const auto finer = measured(plan);
    if (!finer) return finer.issue();
    return finer->rmse_y < point.rmse_y ? *finer : point;
  }

  Goal goal_;
  int side_, geometry_side_;
  const std::function<Result<double>(const FusedPlan&)>& measure_;
  Choice choice_;
};

}  // namespace

Result<Choice> choosePlan(const Goal& goal, int side, int geometry_side,
                          const std::function<Result<double>(const FusedPlan&)>& measure) {
  return Search(goal, side, geometry_side, measure).run();
}

int mostTrials(const Goal& goal, int geometry_side) {
  const auto count = static_cast<int>(structures(geometry_side, goal.surface_side).size());
  return 1 + (goal.target_rmse > 0 ? count * static_cast<int>(componentSteps(goal).size()) : count);
}

FusedPlan smallestPlan(int geometry_side) {
  return withComponents(structures(geometry_side, 0).front(), 4);
}

std::vector<TradePoint> paretoFront(std::vector<TradePoint> points) {
  std::sort(points.begin(), points.end(), [](const TradePoint& a, const TradePoint& b) {
    return a.bytes != b.bytes ? a.bytes < b.bytes : a.rmse_y < b.rmse_y;
  });
  std::vector<TradePoint> front;
  for (const TradePoint& p : points)
    if (front.empty() || p.rmse_y < front.back().rmse_y) front.push_back(p);
  return front;
}

}  // namespace loden::importer
