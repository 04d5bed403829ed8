#include "importer/tile/charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "importer/base/periodic_noise.h"
#include "importer/mesh/weld.h"
#include "importer/tile/param_map.h"
#include "material/base/check.h"
#include "material/model/directions.h"

namespace loden::importer {
namespace {

constexpr double kSameParam = 1e-6;                                       // tile periods
constexpr double kGutters[] = {1.0 / 16, 1.0 / 32, 1.0 / 64, 1.0 / 128};  // tile periods, tried in this order
constexpr double kLeastUse =
    0.3;  // share of the domain that charts should cover before a smaller gutter is tried

// A chart's vertices and, after turning, its rectangle.
struct Box {
  std::vector<uint32_t> vertices;
  glm::dvec2 low{0}, size{0};
};

std::vector<Box> boxesOf(const Tile& tile) {
  std::vector<Box> boxes;
  std::vector<uint16_t> chart_of(tile.params.size(), 0);
  for (size_t t = 0; t < tile.triangles.size(); ++t) {
    const uint16_t chart = tile.charts[t];
    if (boxes.size() < chart) boxes.resize(chart);
    for (int k = 0; k < 3; ++k) {
      uint16_t& mine = chart_of[tile.triangles[t][k]];
      LODEN_CHECK(mine == 0 || mine == chart);
      if (mine == 0) boxes[chart - 1u].vertices.push_back(tile.triangles[t][k]);
      mine = chart;
    }
  }
  return boxes;
}

glm::dvec2 turned(glm::dvec2 p, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

void measure(const Tile& tile, double angle, Box& box) {
  glm::dvec2 low(1e300), high(-1e300);
  for (const uint32_t v : box.vertices) {
    const glm::dvec2 p = turned(tile.params[v], angle);
    low = glm::min(low, p), high = glm::max(high, p);
  }
  box.low = low, box.size = high - low;
}

// Turned so that its rectangle is smallest and stands upright.
void turnUpright(Tile& tile, Box& box) {
  double best = 0, best_area = 1e300;
  for (int degrees = 0; degrees < 90; ++degrees) {
    measure(tile, degrees * kPi / 180, box);
    const double area = box.size.x * box.size.y;
    if (area < best_area * (1 - 1e-6)) best = degrees * kPi / 180, best_area = area;
  }
  measure(tile, best, box);
  if (box.size.x > box.size.y) best += kPi / 2;
  if (best != 0)
    for (const uint32_t v : box.vertices) tile.params[v] = turned(tile.params[v], best);
  measure(tile, 0, box);
}

// Rows of rectangles, the highest first; lower left corners, or nothing if they do not fit.
std::vector<glm::dvec2> shelves(std::span<const Box> boxes, std::span<const size_t> order, double scale,
                                double gutter) {
  std::vector<glm::dvec2> corners(boxes.size());
  glm::dvec2 at(0);
  double row = 0;
  for (const size_t k : order) {
    const glm::dvec2 size = boxes[k].size * scale + gutter;
    if (at.x + size.x > 1) at = {0, at.y + row}, row = 0;
    row = std::max(row, size.y);
    if (at.x + size.x > 1 || at.y + row > 1) return {};
    corners[k] = at;
    at.x += size.x;
  }
  return corners;
}

double largestScale(std::span<const Box> boxes, std::span<const size_t> order, double gutter) {
  double low = 0, high = 1e3;
  for (int step = 0; step < 60; ++step) {
    const double scale = (low + high) / 2;
    (shelves(boxes, order, scale, gutter).empty() ? high : low) = scale;
  }
  return low;
}

// Components of triangles that share vertices; parent: per vertex, a vertex that it is one with.
std::vector<uint16_t> componentsOf(const Tile& tile, std::vector<uint32_t> parent) {
  const auto root = [&](uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const glm::uvec3& t : tile.triangles)
    for (int k = 1; k < 3; ++k) {
      const uint32_t a = root(t[0]), b = root(t[k]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  std::map<uint32_t, uint16_t> number;
  std::vector<uint16_t> charts;
  for (const glm::uvec3& t : tile.triangles)
    charts.push_back(number.try_emplace(root(t.x), uint16_t(number.size() + 1)).first->second);
  return charts;
}

}  // namespace

std::vector<uint16_t> findCharts(const Tile& tile) {
  std::vector<glm::dvec3> params;
  for (const glm::dvec2& p : tile.params) params.push_back({p, 0});
  return componentsOf(tile, weldVertices(params, {1, 1, 0}, kSameParam));
}

std::vector<uint16_t> chartsByVertices(const Tile& tile) {
  std::vector<uint32_t> parent(tile.params.size());
  std::iota(parent.begin(), parent.end(), 0u);
  return componentsOf(tile, std::move(parent));
}

bool isAtlas(std::span<const glm::dvec2> params, std::span<const glm::uvec3> triangles) {
  constexpr int kCells = 1024;
  constexpr double kInside = 1e-6;  // samples this near to an edge may be of both its triangles
  for (const glm::dvec2& p : params)
    if (!(p.x >= 0 && p.y >= 0 && p.x <= 1 && p.y <= 1)) return false;
  std::vector<bool> covered(size_t(kCells) * kCells, false);
  for (const glm::uvec3& t : triangles) {
    const glm::dvec2 a = params[t.x] * double(kCells), e1 = params[t.y] * double(kCells) - a,
                     e2 = params[t.z] * double(kCells) - a;
    const double area = e1.x * e2.y - e1.y * e2.x;
    if (!(area > 0)) return false;
    const glm::ivec2 first(glm::floor(a + glm::min(glm::dvec2(0), glm::min(e1, e2)))),
        last(glm::ceil(a + glm::max(glm::dvec2(0), glm::max(e1, e2))));
    for (int j = std::max(first.y, 0); j < std::min(last.y, kCells); ++j)
      for (int i = std::max(first.x, 0); i < std::min(last.x, kCells); ++i) {
        const glm::dvec2 d = glm::dvec2(i, j) + 0.5 - a;
        const double b1 = (d.x * e2.y - d.y * e2.x) / area, b2 = (e1.x * d.y - e1.y * d.x) / area;
        if (b1 < kInside || b2 < kInside || b1 + b2 > 1 - kInside) continue;
        if (covered[size_t(j) * kCells + size_t(i)]) return false;
        covered[size_t(j) * kCells + size_t(i)] = true;
      }
  }
  return true;
}

double packCharts(Tile& tile) {
  std::vector<Box> boxes = boxesOf(tile);
  double area = 0;
  for (Box& box : boxes) turnUpright(tile, box), area += box.size.x * box.size.y;
  std::vector<size_t> order(boxes.size());
  for (size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return boxes[a].size.y > boxes[b].size.y; });
  double gutter = 0, scale = 0;
  for (const double tried : kGutters) {
    gutter = tried, scale = largestScale(boxes, order, gutter);
    if (area * scale * scale >= kLeastUse) break;
  }
  LODEN_CHECK_LT(0.0, scale);
  const auto corners = shelves(boxes, order, scale, gutter);
  for (size_t k = 0; k < boxes.size(); ++k)
    for (const uint32_t v : boxes[k].vertices)
      tile.params[v] = corners[k] + gutter / 2 + (tile.params[v] - boxes[k].low) * scale;
  return gutter;
}

namespace {

// Free cells between the two nearest charts, as a square sees it: the larger distance of x and y. Charts grow
// ring by ring until two meet. All of them if there is one chart.
int freeBetweenCharts(int side, std::vector<uint16_t> labels) {
  for (int rings = 0; 2 * rings < side; ++rings) {
    const std::vector<uint16_t> before = labels;
    bool in_one_cell = false, grew = false;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        uint16_t& mine = labels[size_t(j) * size_t(side) + size_t(i)];
        const bool taken = mine != 0;
        for (int k = 0; k < 9; ++k) {
          const uint16_t theirs = before[size_t(wrapIndex(j + k / 3 - 1, side)) * size_t(side) +
                                         size_t(wrapIndex(i + k % 3 - 1, side))];
          if (theirs == 0 || theirs == mine) continue;
          if (taken) return 2 * rings;
          in_one_cell = in_one_cell || mine != 0;
          mine = theirs, grew = true;
        }
      }
    if (in_one_cell) return 2 * rings + 1;
    if (!grew) break;
  }
  return side;
}

}  // namespace

double gutterOf(const Tile& tile) {
  constexpr int kCells = 256;
  std::vector<uint16_t> labels(size_t(kCells) * kCells, 0);
  const auto cells = coverParams(tile, kCells, glm::dvec2(0.5));
  for (size_t t = 0; t < labels.size(); ++t)
    if (cells[t].covered()) labels[t] = tile.charts[cells[t].triangle];
  int least = freeBetweenCharts(kCells, labels);
  // Runs of free cells along rows and columns, between any two covered ones: of a chart from its repetition
  // too.
  for (int axis = 0; axis < 2; ++axis)
    for (int line = 0; line < kCells; ++line) {
      const auto at = [&](int k) {
        return labels[size_t(axis == 0 ? line * kCells + k % kCells : k % kCells * kCells + line)];
      };
      int start = 0;
      while (start < kCells && at(start) == 0) ++start;
      if (start == kCells) continue;
      int last = start;
      for (int k = start + 1; k <= start + kCells; ++k) {
        if (at(k) == 0) continue;
        // Bays of one chart's outline are no gutters.
        if (at(k) != at(last) || (k >= kCells && last < kCells && k - last > 1))
          least = std::min(least, k - last - 1);
        last = k;
      }
    }
  return double(least) / kCells;
}

std::vector<uint16_t> chartOwners(int side, std::span<const uint16_t> labels) {
  LODEN_CHECK_EQ(labels.size(), size_t(side) * size_t(side));
  // Each texel learns from its neighbours which labelled texel is nearest, until nothing changes.
  struct Nearest {
    uint16_t label = 0;
    glm::ivec2 towards{0};
    int squared = std::numeric_limits<int>::max();
  };
  std::vector<Nearest> now(labels.size());
  for (size_t t = 0; t < labels.size(); ++t)
    if (labels[t] != 0) now[t] = {labels[t], {0, 0}, 0};
  for (bool changed = true; changed;) {
    changed = false;
    const std::vector<Nearest> before = now;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        Nearest& mine = now[size_t(j) * size_t(side) + size_t(i)];
        if (mine.squared == 0) continue;
        for (int k = 0; k < 9; ++k) {
          const glm::ivec2 step(k % 3 - 1, k / 3 - 1);
          const Nearest& theirs = before[size_t(wrapIndex(j + step.y, side)) * size_t(side) +
                                         size_t(wrapIndex(i + step.x, side))];
          if (theirs.label == 0) continue;
          const glm::ivec2 towards = theirs.towards + step;
          const int squared = towards.x * towards.x + towards.y * towards.y;
          if (squared < mine.squared || (squared == mine.squared && theirs.label < mine.label))
            mine = {theirs.label, towards, squared}, changed = true;
        }
      }
  }
  std::vector<uint16_t> owners;
  for (const Nearest& nearest : now) owners.push_back(nearest.label);
  return owners;
}

std::vector<uint16_t> chartOwners(int side, const GeometryImage& geometry) {
  const int fine = geometry.side();
  const auto* codes = reinterpret_cast<const uint16_t*>(geometry.texels.data.data());
  std::vector<uint16_t> labels;
  for (size_t t = 0; t < size_t(fine) * size_t(fine); ++t) labels.push_back(codes[4 * t + 3]);
  const uint16_t highest = labels.empty() ? uint16_t(0) : *std::max_element(labels.begin(), labels.end());
  if (std::all_of(labels.begin(), labels.end(),
                  [&](uint16_t label) { return label == 0 || label == highest; }))
    return {};
  const auto owners = chartOwners(fine, labels);
  std::vector<uint16_t> result;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i)
      result.push_back(owners[size_t((2 * j + 1) * fine / (2 * side)) * size_t(fine) +
                              size_t((2 * i + 1) * fine / (2 * side))]);
  return result;
}

std::vector<uint16_t> halvedOwners(int side, std::span<const uint16_t> owners) {
  const int half = side / 2;
  std::vector<uint16_t> coarse;
  for (int j = 0; j < half; ++j)
    for (int i = 0; i < half; ++i) {
      std::array<uint16_t, 4> four;
      for (int k = 0; k < 4; ++k)
        four[size_t(k)] = owners[size_t(2 * j + k / 2) * size_t(side) + size_t(2 * i + k % 2)];
      std::sort(four.begin(), four.end());
      uint16_t best = four[0];
      for (const uint16_t label : four)
        if (std::count(four.begin(), four.end(), label) > std::count(four.begin(), four.end(), best))
          best = label;
      coarse.push_back(best);
    }
  return coarse;
}

unsigned childrenOf(int side, std::span<const uint16_t> owners, std::span<const uint16_t> halved, int i,
                    int j) {
  if (owners.empty()) return 15;
  unsigned children = 0;
  for (int k = 0; k < 4; ++k) {
    const uint16_t owner = owners[size_t(2 * j + k / 2) * size_t(side) + size_t(2 * i + k % 2)];
    if (owner == halved[size_t(j) * size_t(side / 2) + size_t(i)]) children |= 1u << k;
  }
  return children;
}

}  // namespace loden::importer
