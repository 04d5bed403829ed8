// Line plots as SVG, for the record of a study.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "importer/study/study.h"

namespace loden::importer {

enum class PlotMark { kLineAndPoints, kPoints, kLine };  // the last is grey, behind all others

struct PlotSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  // by x
  PlotMark mark = PlotMark::kLineAndPoints;
};

struct PlotPanel {
  std::string title;
  std::vector<PlotSeries> series;  // the same names, in the same order, in every panel
};

struct Plot {
  std::string title, x_label, y_label;
  bool x_log = false;             // else linear, from 0 or less
  std::vector<PlotPanel> panels;  // side by side, on common axes
  bool y_log = false;             // else linear, from 0
  bool y_from_least = false;      // if linear: from the least instead
};

// Of points that cost x and are worth y, those that no other beats in both, by x: a Pareto front.
std::vector<std::pair<double, double>> paretoFront(std::vector<std::pair<double, double>> points);

// One panel per tile: column `y` over column `x`. `series_of` names the series of a row; rows that it gives
// an empty name are left out.
std::vector<PlotPanel> panelsOf(const StudyRows& rows, std::string_view x, std::string_view y,
                                const std::function<std::string(const StudyRow&)>& series_of);

std::string plotSvg(const Plot& plot);
// Makes the folder; written whole or not at all.
Status writePlot(const Plot& plot, const std::filesystem::path& path);

}  // namespace loden::importer
