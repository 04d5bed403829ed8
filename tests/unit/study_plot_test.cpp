// Plots of studies and benchmarks.
#include <gtest/gtest.h>

#include <regex>

#include "importer/study/plot.h"

namespace loden::importer {
namespace {

using Points = std::vector<std::pair<double, double>>;

// Centres of the points of a plot, in its order.
Points circlesOf(const std::string& svg) {
  static const std::regex circle("<circle cx=\"([0-9.]+)\" cy=\"([0-9.]+)\"");
  Points points;
  for (std::sregex_iterator at(svg.begin(), svg.end(), circle), end; at != end; ++at)
    points.emplace_back(std::stod((*at)[1]), std::stod((*at)[2]));
  return points;
}

TEST(Plot, ParetoFront_KeepsWhatNoOtherBeats) {
  const Points front = paretoFront({{3, 30}, {1, 10}, {2, 9}, {1, 8}, {4, 30}, {2, 20}});
  EXPECT_EQ(front, (Points{{1, 10}, {2, 20}, {3, 30}}));
  EXPECT_TRUE(paretoFront({}).empty());
}

TEST(Plot, LogarithmicAxes_PutDecadesAtEvenSteps) {
  Plot plot{"title", "x", "y", true, {{"panel", {{"series", {{1, 1}, {10, 10}, {100, 100}}}}}}, true};
  const Points at = circlesOf(plotSvg(plot));
  ASSERT_EQ(at.size(), 3u);
  EXPECT_NEAR(at[1].first - at[0].first, at[2].first - at[1].first, 0.2);  // positions have one decimal
  EXPECT_NEAR(at[0].second - at[1].second, at[1].second - at[2].second, 0.2);
  EXPECT_GT(at[1].first, at[0].first + 50);
  EXPECT_GT(at[0].second, at[1].second + 50);
}

TEST(Plot, LinearAxes_ReachBelowZeroAndStartAtTheLeastWhereAsked) {
  Plot plot{"title", "x", "y", false, {{"panel", {{"series", {{-1, 20}, {0, 25}, {1, 30}}}}}}};
  const auto height = [&](bool from_least) {
    plot.y_from_least = from_least;
    const Points at = circlesOf(plotSvg(plot));
    EXPECT_EQ(at.size(), 3u);
    EXPECT_NEAR(at[1].first - at[0].first, at[2].first - at[1].first, 0.2);
    return at.front().second - at.back().second;
  };
  EXPECT_GT(height(true), 2 * height(false));
}

TEST(Plot, Series_AreLinesOrPointsOrBoth) {
  const auto count = [](PlotMark mark, const char* what) {
    Plot plot{"title", "x", "y", false, {{"panel", {{"series", {{1, 1}, {2, 2}}, mark}}}}};
    const std::string svg = plotSvg(plot);
    const std::regex shape(what);
    return std::distance(std::sregex_iterator(svg.begin(), svg.end(), shape), std::sregex_iterator());
  };
  EXPECT_EQ(count(PlotMark::kLineAndPoints, "<circle"), 2);
  EXPECT_EQ(count(PlotMark::kLineAndPoints, "<polyline"), 1);
  EXPECT_EQ(count(PlotMark::kPoints, "<polyline"), 0);
  EXPECT_EQ(count(PlotMark::kLine, "<circle"), 0);
}

}  // namespace
}  // namespace loden::importer
