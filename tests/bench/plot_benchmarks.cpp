// Plots from the JSON of bench_time_error and bench_motion:
//   plot_benchmarks FOLDER RUN.json...
// pareto-time-TILE.svg, pareto-bytes-TILE.svg  PSNR against time and GPU bytes, a panel per view, with the
// front
//                                              of what no other renderer beats in both
// distance-psnr.svg, distance-time.svg         over lambda, seen from straight above, a panel per tile
// motion-MOTION.svg                            difference energy over lambda, a panel per tile
// A renderer with several settings has a point for each; lines show its default lookup, or its last setting.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "importer/study/plot.h"

namespace {

using namespace loden;
using namespace loden::importer;
using nlohmann::json;

[[noreturn]] void fail(const std::string& text) {
  std::fprintf(stderr, "plot_benchmarks: %s\n", text.c_str());
  std::exit(1);
}

// The rows of a run of one kind.
std::vector<json> rowsOf(const std::vector<json>& runs, const std::string& study) {
  std::vector<json> rows;
  for (const json& run : runs)
    if (run.value("study", "") == study)
      for (const json& row : run.value("rows", json::array())) rows.push_back(row);
  return rows;
}

double numberIn(const json& row, const std::string& key) {
  const auto found = row.find(key);
  if (found == row.end() || !found->is_number()) fail("a row without the number " + key + ": " + row.dump());
  return *found;
}

std::vector<std::string> namesIn(const std::vector<json>& rows, const std::string& key) {
  std::vector<std::string> names;
  for (const json& row : rows) {
    const std::string name = row.value(key, "");
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::string viewOf(const json& row) {
  char text[64];
  const double degrees = numberIn(row, "degrees");
  std::snprintf(text, sizeof text, degrees == 0 ? "lambda %g" : "lambda %g, %g degrees",
                numberIn(row, "lambda"), degrees);
  return text;
}

void write(const Plot& plot, const std::filesystem::path& path) {
  if (const Status status = writePlot(plot, path); !status) fail(path.string() + ": " + status.issue().text);
  std::printf("%s\n", path.c_str());
}

// Of one tile: a panel per view, a point per renderer and setting.
void plotPareto(const std::vector<json>& all, const std::string& tile, const std::string& key,
                const std::string& label, const std::filesystem::path& path) {
  std::vector<json> rows;
  for (const json& row : all)
    if (row.value("tile", "") == tile) rows.push_back(row);
  std::vector<PlotPanel> panels;
  std::set<std::string> views;
  for (const json& of : rows) {
    if (!views.insert(viewOf(of)).second) continue;
    PlotPanel panel{viewOf(of), {}};
    std::vector<std::pair<double, double>> points;
    for (const std::string& renderer : namesIn(rows, "renderer")) {
      PlotSeries series{renderer, {}, PlotMark::kPoints};
      for (const json& row : rows)
        if (row.value("renderer", "") == renderer && viewOf(row) == panel.title && numberIn(row, key) > 0)
          series.points.emplace_back(numberIn(row, key), numberIn(row, "psnr_db"));
      points.insert(points.end(), series.points.begin(), series.points.end());
      panel.series.push_back(std::move(series));
    }
    panel.series.push_back({"Pareto front", paretoFront(points), PlotMark::kLine});
    panels.push_back(std::move(panel));
  }
  write({tile, label, "PSNR, dB", true, panels, false, true}, path);
}

// The setting of each renderer that lines show.
std::map<std::string, std::string> shownSettings(const std::vector<json>& rows) {
  std::map<std::string, std::string> shown;
  for (const json& row : rows) {
    std::string& setting = shown[row.value("renderer", "")];
    if (setting != "default lookup") setting = row.value("setting", "");
  }
  return shown;
}

// A panel per tile, a line per renderer over lambda; ratios on a logarithmic scale.
void plotOverLambda(const std::vector<json>& rows, const std::string& key, const std::string& title,
                    const std::string& label, bool ratio, const std::filesystem::path& path) {
  const auto shown = shownSettings(rows);
  std::vector<PlotPanel> panels;
  for (const std::string& tile : namesIn(rows, "tile")) {
    PlotPanel panel{tile, {}};
    for (const std::string& renderer : namesIn(rows, "renderer")) {
      PlotSeries series{renderer, {}};
      for (const json& row : rows)
        if (row.value("tile", "") == tile && row.value("renderer", "") == renderer &&
            row.value("setting", "") == shown.at(renderer))
          series.points.emplace_back(numberIn(row, "lambda"), numberIn(row, key));
      std::sort(series.points.begin(), series.points.end());
      panel.series.push_back(std::move(series));
    }
    panels.push_back(std::move(panel));
  }
  if (!panels.empty()) write({title, "lambda", label, false, panels, ratio, true}, path);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) fail("usage: plot_benchmarks FOLDER RUN.json...");
  const std::filesystem::path folder = argv[1];
  std::vector<json> runs;
  for (int i = 2; i < argc; ++i) {
    std::ifstream file(argv[i]);
    json run = json::parse(file, nullptr, false);
    if (!run.is_object()) fail(std::string(argv[i]) + ": no JSON object");
    runs.push_back(std::move(run));
  }
  const std::vector<json> time_error = rowsOf(runs, "time-error"), motion = rowsOf(runs, "motion");
  for (const std::string& tile : namesIn(time_error, "tile")) {
    const std::string stem = std::filesystem::path(tile).stem().string() + ".svg";
    plotPareto(time_error, tile, "ratio_to_normal_map", "time, ratio to a normal map",
               folder / ("pareto-time-" + stem));
    plotPareto(time_error, tile, "gpu_bytes", "bytes on the GPU", folder / ("pareto-bytes-" + stem));
  }
  std::vector<json> above;
  for (const json& row : time_error)
    if (numberIn(row, "degrees") == 0) above.push_back(row);
  plotOverLambda(above, "psnr_db", "Error over distance", "PSNR, dB", false, folder / "distance-psnr.svg");
  plotOverLambda(above, "ratio_to_normal_map", "Time over distance", "ratio to a normal map", true,
                 folder / "distance-time.svg");
  for (const std::string& name : namesIn(motion, "motion")) {
    std::vector<json> rows;
    for (const json& row : motion)
      if (row.value("motion", "") == name && row.value("renderer", "") != "traced") rows.push_back(row);
    plotOverLambda(rows, "energy_ratio", "Motion: " + name, "difference energy, ratio to the truth's", true,
                   folder / ("motion-" + name + ".svg"));
  }
  return std::fflush(stdout) == 0 ? 0 : 2;
}
