#include "importer/study/plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "material/system/atomic_file.h"

namespace loden::importer {
namespace {

// Pixels.
constexpr double kPanel = 220, kGap = 24, kLeft = 64, kLegend = 28, kLegendLine = 16, kBottom = 44,
                 kLeast = 560;
constexpr const char* kColors[] = {"#1b6ca8", "#d1495b", "#2e8b57", "#8a6fb0", "#c77d0a", "#555555",
                                   "#00a0a0", "#e377c2", "#7f7f00", "#9c4a1a", "#3b3bd6", "#a0a0a0",
                                   "#000000", "#6abf4b", "#ff5a1f", "#5b2a86"};

// Data to a share of a panel's side.
struct Axis {
  double low = 0, high = 1;
  bool log = false;
  double at(double value) const {
    if (log) return (std::log(value) - std::log(low)) / (std::log(high) - std::log(low));
    return (value - low) / (high - low);
  }
};

// Data to pixels within a panel.
struct Axes {
  Axis of_x, of_y;
  double x(double value) const { return kPanel * of_x.at(value); }
  double y(double value) const { return kPanel * (1 - of_y.at(value)); }
};

// 1, 2 or 5 times a power of ten, so that about five steps fill the range.
double niceStep(double range) {
  const double rough = range / 5, power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough) return factor * power;
  return 10 * power;
}

Axes axesOf(const Plot& plot) {
  double least[2] = {INFINITY, INFINITY}, most[2] = {-INFINITY, -INFINITY};
  for (const PlotPanel& panel : plot.panels)
    for (const PlotSeries& series : panel.series)
      for (const auto& [x, y] : series.points)
        for (const int axis : {0, 1}) {
          least[axis] = std::min(least[axis], axis == 0 ? x : y);
          most[axis] = std::max(most[axis], axis == 0 ? x : y);
        }
  const auto logarithmic = [&](int axis) { return Axis{least[axis] / 1.2, most[axis] * 1.2, true}; };
  Axes axes;
  if (!(least[0] <= most[0])) return axes;
  axes.of_x = plot.x_log ? logarithmic(0) : Axis{std::min(least[0] * 1.04, 0.0), most[0] * 1.04};
  axes.of_y = plot.y_log ? logarithmic(1) : Axis{0, most[1] * 1.05};
  if (!plot.y_log && plot.y_from_least) axes.of_y.low = least[1] - 0.05 * (most[1] - least[1]);
  for (Axis* axis : {&axes.of_x, &axes.of_y})
    if (!(axis->high > axis->low)) axis->high = axis->low + 1;
  return axes;
}

std::vector<double> ticksOf(const Axis& axis) {
  std::vector<double> ticks;
  if (axis.log) {
    for (double decade = std::pow(10, std::floor(std::log10(axis.low))); decade <= axis.high; decade *= 10)
      for (const double factor : {1.0, 3.0})
        if (decade * factor >= axis.low && decade * factor <= axis.high) ticks.push_back(decade * factor);
    return ticks;
  }
  const double step = niceStep(axis.high - axis.low);
  for (int i = static_cast<int>(std::ceil(axis.low / step)); i * step <= axis.high; ++i)
    ticks.push_back(i * step);
  return ticks;
}

std::string number(double value) {
  char text[32];
  if (value >= 1e6)
    std::snprintf(text, sizeof text, "%gM", value / 1e6);
  else if (value >= 1e4)
    std::snprintf(text, sizeof text, "%gk", value / 1e3);
  else
    std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
  return out;
}

class Svg {
 public:
  template <class... Values>
  void add(const char* format, Values... values) {
    char line[512];
    std::snprintf(line, sizeof line, format, values...);
    text_ += line;
  }
  void label(double x, double y, const char* anchor, const std::string& text) {
    add("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor);
    text_ += escaped(text) + "</text>\n";
  }
  // The whole file, for a picture of that size.
  std::string finish(double width, double height) const {
    char head[256];
    std::snprintf(head, sizeof head,
                  "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
                  "font-family=\"sans-serif\" font-size=\"11\">\n"
                  "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
                  width, height);
    return head + text_ + "</svg>\n";
  }

 private:
  std::string text_;
};

const char* colorOf(const PlotPanel& panel, size_t series) {
  return panel.series[series].mark == PlotMark::kLine ? "#bbbbbb" : kColors[series % std::size(kColors)];
}

void drawSeries(Svg& svg, const PlotSeries& series, const char* color, const Axes& axes, double left,
                double top) {
  if (series.mark != PlotMark::kPoints) {
    svg.add("<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\" points=\"", color);
    for (const auto& [x, y] : series.points) svg.add("%.1f,%.1f ", left + axes.x(x), top + axes.y(y));
    svg.add("\"/>\n");
  }
  if (series.mark == PlotMark::kLine) return;
  const double radius = series.mark == PlotMark::kPoints ? 4 : 2.6;
  for (const auto& [x, y] : series.points)
    svg.add("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"%s\"/>\n", left + axes.x(x), top + axes.y(y),
            radius, color);
}

// Left upper corner at (left, top).
void drawPanel(Svg& svg, const Plot& plot, const PlotPanel& panel, const Axes& axes, double left, double top,
               bool first) {
  svg.add("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"none\" stroke=\"#999\"/>\n",
          left, top, kPanel, kPanel);
  svg.label(left + kPanel / 2, top - 6, "middle", panel.title);
  svg.label(left + kPanel / 2, top + kPanel + 34, "middle", plot.x_label);
  for (const double tick : ticksOf(axes.of_x))
    svg.label(left + axes.x(tick), top + kPanel + 16, "middle", number(tick));
  for (const double tick : ticksOf(axes.of_y)) {
    const double y = top + axes.y(tick);
    svg.add("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#e5e5e5\"/>\n", left, y,
            left + kPanel, y);
    if (first) svg.label(left - 6, y + 4, "end", number(tick));
  }
  for (const bool behind : {true, false})
    for (size_t s = 0; s < panel.series.size(); ++s)
      if ((panel.series[s].mark == PlotMark::kLine) == behind)
        drawSeries(svg, panel.series[s], colorOf(panel, s), axes, left, top);
}

// In lines as wide as the plot; returns where the panels begin.
double drawLegend(Svg& svg, const Plot& plot, double width) {
  double x = kLeft, y = kLegend;
  for (size_t s = 0; !plot.panels.empty() && s < plot.panels.front().series.size(); ++s) {
    const std::string& name = plot.panels.front().series[s].name;
    const double length = 40 + 6.2 * double(name.size());
    if (x > kLeft && x + length > width) x = kLeft, y += kLegendLine;
    svg.add("<rect x=\"%.1f\" y=\"%.1f\" width=\"12\" height=\"4\" fill=\"%s\"/>\n", x, y,
            colorOf(plot.panels.front(), s));
    svg.label(x + 17, y + 6, "start", name);
    x += length;
  }
  return y + 32;
}

}  // namespace

namespace {

double numberOf(const StudyRow& row, std::string_view key) {
  const StudyValue* value = row.find(key);
  if (!value) return 0;
  if (const auto* integer = std::get_if<int64_t>(value)) return double(*integer);
  const auto* real = std::get_if<double>(value);
  return real ? *real : 0;
}

template <class T>
T& named(std::vector<T>& items, std::string T::*name, const std::string& wanted) {
  const auto found =
      std::find_if(items.begin(), items.end(), [&](const T& item) { return item.*name == wanted; });
  if (found != items.end()) return *found;
  items.emplace_back();
  items.back().*name = wanted;
  return items.back();
}

}  // namespace

std::vector<PlotPanel> panelsOf(const StudyRows& rows, std::string_view x, std::string_view y,
                                const std::function<std::string(const StudyRow&)>& series_of) {
  std::vector<PlotPanel> panels;
  for (const StudyRow& row : rows) {
    const StudyValue* tile = row.find("tile");
    const std::string name = series_of(row);
    if (name.empty() || !tile || !std::holds_alternative<std::string>(*tile)) continue;
    PlotPanel& panel = named(panels, &PlotPanel::title, std::get<std::string>(*tile));
    named(panel.series, &PlotSeries::name, name).points.emplace_back(numberOf(row, x), numberOf(row, y));
  }
  return panels;
}

std::string plotSvg(const Plot& plot) {
  const Axes axes = axesOf(plot);
  const auto panels = double(plot.panels.size());
  const double width = std::max(kLeft + panels * (kPanel + kGap), kLeast);
  Svg svg;
  svg.label(kLeft, 18, "start", plot.title + "; " + plot.y_label);
  const double top = drawLegend(svg, plot, width);
  for (size_t i = 0; i < plot.panels.size(); ++i)
    drawPanel(svg, plot, plot.panels[i], axes, kLeft + double(i) * (kPanel + kGap), top, i == 0);
  return svg.finish(width, top + kPanel + kBottom);
}

std::vector<std::pair<double, double>> paretoFront(std::vector<std::pair<double, double>> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  });
  std::vector<std::pair<double, double>> front;
  for (const auto& point : points)
    if (front.empty() || point.second > front.back().second) front.push_back(point);
  return front;
}

Status writePlot(const Plot& plot, const std::filesystem::path& path) {
  std::error_code ignored;  // the write says what is wrong
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), ignored);
  const std::string svg = plotSvg(plot);
  return writeFileAtomically(path, std::as_bytes(std::span(svg)));
}

}  // namespace loden::importer
