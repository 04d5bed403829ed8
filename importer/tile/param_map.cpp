#include "importer/tile/param_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "importer/base/periodic_noise.h"
#include "importer/mesh/weld.h"

namespace loden::importer {
namespace {

constexpr double kInside = 1e-9;  // tolerance of barycentric weights, so that samples on shared edges are met

// A triangle in p; 0 for `area` (twice its area, with its sign) means that it has no place there.
struct Flat {
  Flat(const Tile& tile, uint32_t triangle) {
    for (int k = 0; k < 3; ++k) corner[k] = tile.params[tile.triangles[triangle][k]];
    e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    area = e1.x * e2.y - e1.y * e2.x;
  }
  // Of the second and third corner.
  glm::dvec2 weights(glm::dvec2 p) const {
    const glm::dvec2 d = p - corner[0];
    return glm::dvec2(d.x * e2.y - d.y * e2.x, e1.x * d.y - e1.y * d.x) / area;
  }
  glm::dvec2 along(int edge) const { return corner[(edge + 1) % 3] - corner[edge]; }

  glm::dvec2 corner[3], e1{0}, e2{0};
  double area = 0;
};

void rasterize(const Flat& flat, uint32_t triangle, int side, glm::dvec2 position,
               std::vector<ParamSample>& samples) {
  if (flat.area == 0) return;
  const auto& corner = flat.corner;
  const glm::dvec2 low = glm::min(corner[0], glm::min(corner[1], corner[2]));
  const glm::dvec2 high = glm::max(corner[0], glm::max(corner[1], corner[2]));
  const glm::ivec2 first(glm::ceil(low * double(side) - position - 1e-6)),
      last(glm::floor(high * double(side) - position + 1e-6));
  for (int j = first.y; j <= last.y; ++j)
    for (int i = first.x; i <= last.x; ++i) {
      ParamSample& sample = samples[size_t(wrapIndex(j, side)) * size_t(side) + size_t(wrapIndex(i, side))];
      if (sample.covered()) continue;
      const glm::dvec2 b = flat.weights((glm::dvec2(i, j) + position) / double(side));
      if (b.x < -kInside || b.y < -kInside || b.x + b.y > 1 + kInside) continue;
      sample = {triangle, glm::vec2(b)};
    }
}

// Edge k of a triangle runs from its corner k to the next.
struct Edge {
  uint32_t triangle;
  int corner;
};

// Narrows a range of t to where low <= from + t * along <= high; empty if its first is above its last.
void clip(double from, double along, double low, double high, glm::dvec2& range) {
  if (along == 0) {
    if (from < low || from > high) range = {1, 0};
    return;
  }
  const double a = (low - from) / along, b = (high - from) / along;
  range = {std::max(range.x, std::min(a, b)), std::min(range.y, std::max(a, b))};
}

// Cells and the points found for them so far.
struct Cover {
  int side;
  glm::dvec2 position;  // of a cell's sample in it
  std::vector<ParamSample> samples;
  std::vector<double> distance;  // of the point from the sample, cells
};

// All cells that an edge passes through. A triangle that overlaps a cell and does not hold its sample has an
// edge there, and its nearest point in the cell is on one: so this is the whole test of a triangle against a
// square, and costs no more than the cells along its edges.
void coverEdge(const Edge& edge, const glm::dvec2& a, const glm::dvec2& along, Cover& cover) {
  constexpr double kGraze = 1e-9;  // cells
  const auto span = [](double u, double v) {
    return glm::ivec2(int(std::floor(std::min(u, v))), int(std::floor(std::max(u, v))));
  };
  const glm::ivec2 rows = span(a.y, a.y + along.y);
  for (int j = rows.x; j <= rows.y; ++j) {
    glm::dvec2 in_row(0, 1);
    clip(a.y, along.y, j + kGraze, j + 1 - kGraze, in_row);
    if (in_row.x > in_row.y) continue;
    const glm::ivec2 columns = span(a.x + in_row.x * along.x, a.x + in_row.y * along.x);
    for (int i = columns.x; i <= columns.y; ++i) {
      glm::dvec2 in_cell = in_row;
      clip(a.x, along.x, i + kGraze, i + 1 - kGraze, in_cell);
      if (in_cell.x > in_cell.y) continue;
      const glm::dvec2 from_a = glm::dvec2(i, j) + cover.position - a;
      const double t = std::clamp(glm::dot(from_a, along) / glm::dot(along, along), in_cell.x, in_cell.y);
      const double distance = glm::distance(from_a, t * along);
      const size_t cell =
          size_t(wrapIndex(j, cover.side)) * size_t(cover.side) + size_t(wrapIndex(i, cover.side));
      if (distance >= cover.distance[cell]) continue;
      glm::dvec3 weights(0);
      weights[edge.corner] = 1 - t, weights[(edge.corner + 1) % 3] = t;
      cover.samples[cell] = {edge.triangle, glm::vec2(weights.y, weights.z)}, cover.distance[cell] = distance;
    }
  }
}

std::vector<Edge> borderEdges(const Tile& tile) {
  std::vector<glm::dvec3> params;
  for (const glm::dvec2& p : tile.params) params.push_back({p, 0});
  const auto same = weldVertices(params, {1, 1, 0}, 1e-9);
  std::map<std::array<long, 5>, std::pair<int, Edge>> uses;  // ends, periods between them, chart
  for (uint32_t t = 0; t < tile.triangles.size(); ++t) {
    if (Flat(tile, t).area == 0) continue;
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = tile.triangles[t][k], b = tile.triangles[t][(k + 1) % 3];
      const glm::dvec2 across =
          glm::round(tile.params[b] - tile.params[same[b]] - tile.params[a] + tile.params[same[a]]);
      const long x = long(across.x), y = long(across.y);
      const auto key = same[a] < same[b]
                           ? std::array<long, 5>{long(same[a]), long(same[b]), x, y, tile.charts[t]}
                           : std::array<long, 5>{long(same[b]), long(same[a]), -x, -y, tile.charts[t]};
      ++uses.try_emplace(key, 0, Edge{t, k}).first->second.first;
    }
  }
  std::vector<Edge> edges;
  for (const auto& [key, use] : uses)
    if (use.first == 1) edges.push_back(use.second);
  return edges;
}

void extendEdge(const Tile& tile, const Edge& edge, int side, double radius,
                std::vector<ParamExtension>& cells) {
  const Flat flat(tile, edge.triangle);
  const glm::dvec2 a = flat.corner[edge.corner], along = flat.along(edge.corner);
  const glm::dvec2 low = glm::min(a, a + along) * double(side) - radius,
                   high = glm::max(a, a + along) * double(side) + radius;
  for (int j = int(std::floor(low.y)); j <= int(std::ceil(high.y)); ++j)
    for (int i = int(std::floor(low.x)); i <= int(std::ceil(high.x)); ++i) {
      const glm::dvec2 p = (glm::dvec2(i, j) + 0.5) / double(side);
      const glm::dvec2 nearest =
          a + along * std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0, 1.0);
      const double distance = glm::distance(p, nearest) * side;
      ParamExtension& cell = cells[size_t(wrapIndex(j, side)) * size_t(side) + size_t(wrapIndex(i, side))];
      if (distance > radius || distance >= cell.distance) continue;
      cell = {edge.triangle, flat.weights(p), flat.weights(nearest), distance};
    }
}

}  // namespace

std::vector<ParamExtension> extendParams(const Tile& tile, int side, double radius) {
  std::vector<ParamExtension> cells(size_t(side) * size_t(side));
  for (const Edge& edge : borderEdges(tile)) extendEdge(tile, edge, side, radius, cells);
  return cells;
}

std::vector<ParamSample> locateParams(const Tile& tile, int side, glm::dvec2 position) {
  std::vector<ParamSample> samples(size_t(side) * size_t(side));
  for (uint32_t t = 0; t < tile.triangles.size(); ++t) rasterize(Flat(tile, t), t, side, position, samples);
  return samples;
}

std::vector<ParamSample> coverParams(const Tile& tile, int side, glm::dvec2 position) {
  Cover cover{side, position, locateParams(tile, side, position), {}};
  for (const ParamSample& sample : cover.samples) cover.distance.push_back(sample.covered() ? 0.0 : 1e300);
  for (uint32_t t = 0; t < tile.triangles.size(); ++t) {
    const Flat flat(tile, t);
    if (flat.area == 0) continue;
    for (int k = 0; k < 3; ++k)
      coverEdge({t, k}, flat.corner[k] * double(side), flat.along(k) * double(side), cover);
  }
  return std::move(cover.samples);
}

}  // namespace loden::importer
