// Line plots as SVG, for the record of a study.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "importer/study/study.h"

namespace loden::importer {

enum class PlotMark { kLineAndPoints, kPoints, kLine };  // kLine is grey, behind all others

struct PlotSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  // in ascending x
  PlotMark mark = PlotMark::kLineAndPoints;
};

struct PlotPanel {
  std::string title;
  std::vector<PlotSeries> series;  // every panel has the same names in the same order
};

struct Plot {
  std::string title, x_label, y_label;
  bool x_log = false;             // otherwise linear, from 0 or less
  std::vector<PlotPanel> panels;  // drawn side by side, on common axes
  bool y_log = false;             // otherwise linear, from 0
  bool y_from_least = false;      // if linear: from the least value instead of 0
};

// The Pareto front by x of points with cost x and value y: those that no other point beats in both.
std::vector<std::pair<double, double>> paretoFront(std::vector<std::pair<double, double>> points);

// One panel per tile, of column `y` over column `x`. `series_of` names the series of a row; rows for which it
// returns an empty name are left out.
std::vector<PlotPanel> panelsOf(const StudyRows& rows, std::string_view x, std::string_view y,
                                const std::function<std::string(const StudyRow&)>& series_of);

std::string plotSvg(const Plot& plot);
// Writes the plot, whole or not at all; creates the folder first.
Status writePlot(const Plot& plot, const std::filesystem::path& path);

}  // namespace loden::importer
