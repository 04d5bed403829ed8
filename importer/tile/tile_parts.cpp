#include "importer/tile/tile_parts.h"

#include <algorithm>
#include <cmath>

#include "importer/tile/charts.h"

namespace loden::importer {
namespace {

// Of a surface in lengths, by differences far below the finest feature and far above rounding.
template <class Position>
glm::dvec3 normalOf(const Position& position, glm::dvec2 at, double step) {
  const glm::dvec3 du = position(at + glm::dvec2(step, 0)) - position(at - glm::dvec2(step, 0));
  const glm::dvec3 dv = position(at + glm::dvec2(0, step)) - position(at - glm::dvec2(0, step));
  const glm::dvec3 normal = glm::cross(du, dv);
  // None of a point that no triangle needs.
  return glm::dot(normal, normal) > 1e-24 ? glm::normalize(normal) : glm::dvec3(0, 0, 1);
}

// Two triangles a cell of columns x rows vertices that have been added last.
void addTriangles(Tile& tile, uint32_t columns, uint32_t rows, uint16_t chart) {
  const uint32_t first = uint32_t(tile.positions.size()) - columns * rows;
  for (uint32_t j = 0; j + 1 < rows; ++j)
    for (uint32_t i = 0; i + 1 < columns; ++i) {
      const uint32_t a = first + j * columns + i;
      tile.triangles.push_back({a, a + 1, a + columns + 1});
      tile.triangles.push_back({a, a + columns + 1, a + columns});
      tile.charts.insert(tile.charts.end(), 2, chart);
    }
}

constexpr double kSheetStep = 2e-3;  // of differences, of the sheet in each direction

// One line of a sheet's grid: a crease is two of them in one place, each with the normals of its own side.
struct Line {
  double at, normal_at;
  double length = 0;  // parameter length from the first line
};
// With the mean length of the sheet up to each.
std::vector<Line> linesOf(const Sheet& sheet, int axis) {
  const int cells = sheet.cells[axis];
  std::vector<Line> lines;
  for (int k = 0; k <= cells; ++k) {
    const double at = double(k) / cells;
    const bool crease = std::any_of(sheet.creases[axis].begin(), sheet.creases[axis].end(),
                                    [at](double c) { return std::abs(c - at) < 1e-9; });
    if (crease) lines.push_back({at, at - 2 * kSheetStep});
    lines.push_back({at, crease ? at + 2 * kSheetStep : at});
  }
  constexpr int kAcross = 5;
  for (size_t k = 1; k < lines.size(); ++k) {
    double sum = 0;
    for (int other = 0; other < kAcross; ++other) {
      glm::dvec2 from((other + 0.5) / kAcross), to = from;
      from[axis] = lines[k - 1].at, to[axis] = lines[k].at;
      sum += glm::distance(sheet.position(from), sheet.position(to));
    }
    lines[k].length = lines[k - 1].length + sheet.density * sum / kAcross;
  }
  return lines;
}

}  // namespace

Tile gridTile(const std::string& name, int resolution, const TorusSurface& surface) {
  Tile tile;
  tile.name = name;
  tile.aspect = surface.aspect;
  tile.identity_parameterization = surface.identity_parameterization;
  for (int j = 0; j <= resolution; ++j)
    for (int i = 0; i <= resolution; ++i) {
      // The last row and column are the first, one period on: evaluated there, so that they agree exactly.
      const glm::ivec2 wrap(i == resolution, j == resolution);
      const glm::dvec2 p = glm::dvec2(i, j) / double(resolution) - glm::dvec2(wrap);
      const glm::dvec3 position = surface.position(p);
      constexpr double kStep = 5e-4;  // tile periods
      glm::dvec3 normal = normalOf(surface.position, p, kStep);
      if (surface.aspect != 1) normal = glm::normalize(normal * tile.perLength());
      tile.positions.push_back(position + glm::dvec3(wrap, 0));
      tile.normals.push_back(normal);
      tile.params.push_back(p + glm::dvec2(wrap));
      tile.brdfs.push_back(surface.brdf(p, position));
    }
  const uint32_t row = static_cast<uint32_t>(resolution) + 1;
  addTriangles(tile, row, row, 1);
  return tile;
}

SheetTile::SheetTile(const std::string& name, double aspect) {
  tile_.name = name;
  tile_.aspect = aspect;
}

void SheetTile::add(const Sheet& sheet) {
  const auto columns = linesOf(sheet, 0), rows = linesOf(sheet, 1);
  for (const Line& v : rows)
    for (const Line& u : columns) {
      const glm::dvec3 position = sheet.position({u.at, v.at});
      tile_.positions.push_back(position);
      tile_.normals.push_back(normalOf(sheet.position, {u.normal_at, v.normal_at}, kSheetStep));
      tile_.params.push_back({u.length, v.length});
      tile_.brdfs.push_back(sheet.brdf({u.at, v.at}, position));
    }
  addTriangles(tile_, uint32_t(columns.size()), uint32_t(rows.size()), ++charts_);
}

Tile SheetTile::take() {
  // The period is 1 x aspect as yet, and the root of the aspect a tile length.
  const glm::dvec3 unit(1, tile_.aspect, std::sqrt(tile_.aspect));
  for (glm::dvec3& position : tile_.positions) position /= unit;
  packCharts(tile_);
  return std::move(tile_);
}

glm::dvec3 tubePoint(const std::function<glm::dvec3(double t)>& axis, double t, double angle, double radius,
                     const glm::dvec3& up) {
  constexpr double kStep = 1e-4;
  const glm::dvec3 along = glm::normalize(axis(t + kStep) - axis(t - kStep));
  const glm::dvec3 side = glm::normalize(glm::cross(along, up)), over = glm::cross(side, along);
  return axis(t) + radius * (std::cos(angle) * over + std::sin(angle) * side);
}

}  // namespace loden::importer
