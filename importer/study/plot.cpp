#include "importer/study/plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "material/system/atomic_file.h"

namespace loden::importer {
namespace {

// Pixels.
constexpr double kPanel = 220, kGap = 24, kLeft = 64, kTop = 60, kBottom = 44, kLeast = 560;
constexpr const char* kColors[] = {"#1b6ca8", "#d1495b", "#2e8b57", "#8a6fb0", "#c77d0a", "#555555"};

// Data to pixels within a panel.
struct Axes {
  double x_low = 0, x_high = 1, y_high = 1;
  bool x_log = false;
  double x(double value) const {
    if (x_log) return kPanel * (std::log(value) - std::log(x_low)) / (std::log(x_high) - std::log(x_low));
    return kPanel * (value - x_low) / (x_high - x_low);
  }
  double y(double value) const { return kPanel * (1 - value / y_high); }
};

// 1, 2 or 5 times a power of ten, so that about five steps fill the range.
double niceStep(double range) {
  const double rough = range / 5, power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough) return factor * power;
  return 10 * power;
}

Axes axesOf(const Plot& plot) {
  Axes axes;
  axes.x_log = plot.x_log;
  double low = INFINITY, high = 0, top = 0;
  for (const PlotPanel& panel : plot.panels)
    for (const PlotSeries& series : panel.series)
      for (const auto& [x, y] : series.points) {
        low = std::min(low, x);
        high = std::max(high, x);
        top = std::max(top, y);
      }
  if (!(high > 0)) low = high = 1;
  axes.x_low = plot.x_log ? low / 1.2 : 0;
  axes.x_high = plot.x_log ? high * 1.2 : high * 1.04;
  axes.y_high = top > 0 ? top * 1.05 : 1;
  return axes;
}

std::vector<double> xTicks(const Axes& axes) {
  std::vector<double> ticks;
  if (axes.x_log) {
    for (double decade = std::pow(10, std::floor(std::log10(axes.x_low))); decade <= axes.x_high;
         decade *= 10)
      for (const double factor : {1.0, 3.0})
        if (decade * factor >= axes.x_low && decade * factor <= axes.x_high) ticks.push_back(decade * factor);
    return ticks;
  }
  const double step = niceStep(axes.x_high);
  for (int i = 0; i * step <= axes.x_high; ++i) ticks.push_back(i * step);
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
  Svg(double width, double height) {
    add("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" font-family=\"sans-serif\" "
        "font-size=\"11\">\n",
        width, height);
    add("<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n");
  }
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
  std::string finish() { return text_ + "</svg>\n"; }

 private:
  std::string text_;
};

void drawPanel(Svg& svg, const Plot& plot, const PlotPanel& panel, const Axes& axes, double left,
               bool first) {
  svg.add("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"none\" stroke=\"#999\"/>\n",
          left, kTop, kPanel, kPanel);
  svg.label(left + kPanel / 2, kTop - 6, "middle", panel.title);
  svg.label(left + kPanel / 2, kTop + kPanel + 34, "middle", plot.x_label);
  for (const double tick : xTicks(axes))
    svg.label(left + axes.x(tick), kTop + kPanel + 16, "middle", number(tick));
  const double step = niceStep(axes.y_high);
  for (int i = 0; i * step <= axes.y_high; ++i) {
    const double y = kTop + axes.y(i * step);
    svg.add("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#e5e5e5\"/>\n", left, y,
            left + kPanel, y);
    if (first) svg.label(left - 6, y + 4, "end", number(i * step));
  }
  for (size_t s = 0; s < panel.series.size(); ++s) {
    const char* color = kColors[s % std::size(kColors)];
    svg.add("<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\" points=\"", color);
    for (const auto& [x, y] : panel.series[s].points)
      svg.add("%.1f,%.1f ", left + axes.x(x), kTop + axes.y(y));
    svg.add("\"/>\n");
    for (const auto& [x, y] : panel.series[s].points)
      svg.add("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.6\" fill=\"%s\"/>\n", left + axes.x(x), kTop + axes.y(y),
              color);
  }
}

void drawLegend(Svg& svg, const Plot& plot) {
  if (plot.panels.empty()) return;
  double x = kLeft;
  for (size_t s = 0; s < plot.panels.front().series.size(); ++s) {
    const std::string& name = plot.panels.front().series[s].name;
    svg.add("<rect x=\"%.1f\" y=\"28\" width=\"12\" height=\"4\" fill=\"%s\"/>\n", x,
            kColors[s % std::size(kColors)]);
    svg.label(x + 17, 34, "start", name);
    x += 40 + 6.2 * double(name.size());
  }
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
  Svg svg(std::max(kLeft + panels * (kPanel + kGap), kLeast), kTop + kPanel + kBottom);
  svg.label(kLeft, 18, "start", plot.title + "; " + plot.y_label);
  drawLegend(svg, plot);
  for (size_t i = 0; i < plot.panels.size(); ++i)
    drawPanel(svg, plot, plot.panels[i], axes, kLeft + double(i) * (kPanel + kGap), i == 0);
  return svg.finish();
}

Status writePlot(const Plot& plot, const std::filesystem::path& path) {
  std::error_code ignored;  // the write says what is wrong
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), ignored);
  const std::string svg = plotSvg(plot);
  return writeFileAtomically(path, std::as_bytes(std::span(svg)));
}

}  // namespace loden::importer
