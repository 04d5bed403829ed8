#include "importer/mesh/segment.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <queue>
#include <set>
#include <tuple>

#include "importer/mesh/periodic_mesh.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

constexpr double kMostStretch =
    3;  // of a chart: surface per parameter area, relative to its mean, for 90 % of it
constexpr size_t kMostCharts = 1000;

using Piece = std::vector<uint32_t>;  // triangles

struct Surface {
  std::span<const glm::dvec3> positions;
  std::span<const glm::uvec3> triangles;
  glm::dvec3 length;  // of a tile coordinate, along each axis, tile lengths
  PeriodicNodes nodes;
  std::vector<Neighbour> neighbours;

  glm::dvec3 corner(uint32_t t, int k) const { return positions[triangles[t][k]] * length; }
  // From the triangle's centre to the middle of edge k; the same in every period.
  double reach(uint32_t t, int k) const {
    return glm::distance((corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0,
                         (corner(t, k) + corner(t, (k + 1) % 3)) / 2.0);
  }
};

// A piece moved together: vertices of its own.
struct Sheet {
  std::vector<uint32_t> source;
  std::vector<glm::dvec3> positions;  // tile lengths
  std::vector<glm::uvec3> triangles;  // of Piece's order
  std::vector<glm::dvec2> params;
};

// The piece as a disc in space; nothing if it is none: it closes on itself, also one period on.
std::optional<Sheet> unfold(const Surface& surface, const Piece& piece) {
  std::map<uint32_t, size_t> index;  // triangle -> place in the piece
  for (size_t k = 0; k < piece.size(); ++k) index[piece[k]] = k;
  std::vector<std::optional<glm::ivec2>> shift(piece.size());
  std::vector<size_t> stack{0};
  shift[0] = glm::ivec2(0);
  size_t inner_edges = 0;  // counted from both sides
  while (!stack.empty()) {
    const size_t at = stack.back();
    stack.pop_back();
    for (int k = 0; k < 3; ++k) {
      const Neighbour& next = surface.neighbours[3 * piece[at] + size_t(k)];
      const auto found = next.exists() ? index.find(next.triangle) : index.end();
      if (found == index.end()) continue;
      ++inner_edges;
      const glm::ivec2 theirs = *shift[at] + next.shift;
      auto& known = shift[found->second];
      if (!known)
        known = theirs, stack.push_back(found->second);
      else if (*known != theirs)
        return std::nullopt;
    }
  }
  Sheet sheet;
  std::map<std::tuple<uint32_t, int, int>, uint32_t> vertices;  // node and its period
  for (size_t t = 0; t < piece.size(); ++t) {
    glm::uvec3 corners;
    for (int k = 0; k < 3; ++k) {
      const uint32_t v = surface.triangles[piece[t]][k];
      const glm::ivec2 period = *shift[t] + glm::ivec2(surface.nodes.shift[v]);
      const auto [entry, fresh] =
          vertices.try_emplace({surface.nodes.node[v], period.x, period.y}, uint32_t(sheet.source.size()));
      if (fresh)
        sheet.source.push_back(v),
            sheet.positions.push_back((surface.positions[v] + glm::dvec3(*shift[t], 0)) * surface.length);
      corners[k] = entry->second;
    }
    sheet.triangles.push_back(corners);
  }
  const long euler =
      long(sheet.positions.size()) - long(3 * piece.size() - inner_edges / 2) + long(piece.size());
  if (euler != 1) return std::nullopt;
  return sheet;
}

// A triangle in its own plane, counter-clockwise: first corner at 0, second on the x axis.
struct LocalTriangle {
  glm::dvec2 corner[3];
  double twice_area;
};
LocalTriangle localTriangle(const Sheet& sheet, const glm::uvec3& t) {
  const glm::dvec3 e1 = sheet.positions[t.y] - sheet.positions[t.x],
                   e2 = sheet.positions[t.z] - sheet.positions[t.x];
  const double length = glm::length(e1), area = glm::length(glm::cross(e1, e2));
  return {{{0, 0}, {length, 0}, {glm::dot(e1, e2) / length, area / length}}, area};
}

// The two vertices furthest apart along the sheet's longest axis.
std::pair<uint32_t, uint32_t> pins(const Sheet& sheet) {
  std::pair<uint32_t, uint32_t> best{0, 1};
  double furthest = -1;
  for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1),
                                glm::dvec3(1, 1, 0), glm::dvec3(1, -1, 0)}) {
    uint32_t low = 0, high = 0;
    for (uint32_t v = 0; v < sheet.positions.size(); ++v) {
      if (glm::dot(sheet.positions[v], axis) < glm::dot(sheet.positions[low], axis)) low = v;
      if (glm::dot(sheet.positions[v], axis) > glm::dot(sheet.positions[high], axis)) high = v;
    }
    const double distance = glm::distance(sheet.positions[low], sheet.positions[high]);
    if (distance > furthest) furthest = distance, best = {low, high};
  }
  return best;
}

// Levy et al. 2002, eq. 4: in each triangle the gradients of u and v are turned by a right angle, as nearly
// as least squares can make them, with two vertices held.
bool flatten(Sheet& sheet) {
  const auto [pin0, pin1] = pins(sheet);
  if (pin0 == pin1) return false;
  const size_t count = sheet.positions.size();
  std::vector<Eigen::Index> column(count, -1);
  Eigen::Index columns = 0;
  for (size_t v = 0; v < count; ++v)
    if (v != pin0 && v != pin1) column[v] = columns++;
  sheet.params.assign(count, glm::dvec2(0));
  sheet.params[pin1] = {glm::distance(sheet.positions[pin0], sheet.positions[pin1]), 0};
  const auto rows = static_cast<Eigen::Index>(2 * sheet.triangles.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(rows);
  for (size_t t = 0; t < sheet.triangles.size(); ++t) {
    const LocalTriangle local = localTriangle(sheet, sheet.triangles[t]);
    const double scale = 1 / std::sqrt(local.twice_area);
    const auto row = static_cast<Eigen::Index>(2 * t);
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 w = (local.corner[(k + 2) % 3] - local.corner[(k + 1) % 3]) * scale;
      const uint32_t v = sheet.triangles[t][k];
      const glm::dvec2 p = sheet.params[v];
      if (column[v] < 0) {
        right[row] -= w.x * p.x - w.y * p.y, right[row + 1] -= w.y * p.x + w.x * p.y;
        continue;
      }
      entries.emplace_back(row, 2 * column[v], w.x), entries.emplace_back(row, 2 * column[v] + 1, -w.y);
      entries.emplace_back(row + 1, 2 * column[v], w.y),
          entries.emplace_back(row + 1, 2 * column[v] + 1, w.x);
    }
  }
  Eigen::SparseMatrix<double> a(rows, 2 * columns);
  a.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> normal = a.transpose() * a;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
  if (solver.info() != Eigen::Success) return false;
  const Eigen::VectorXd solution = solver.solve(Eigen::VectorXd(a.transpose() * right));
  for (size_t v = 0; v < count; ++v)
    if (column[v] >= 0) sheet.params[v] = {solution[2 * column[v]], solution[2 * column[v] + 1]};
  return solution.allFinite();
}

double twiceArea(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Scaled to the surface's area; false where some of it is stretched much more than the rest.
bool scaleToArea(Sheet& sheet) {
  double surface = 0, parameter = 0;
  std::vector<std::pair<double, double>> densities;  // surface per parameter area, surface
  for (const glm::uvec3& t : sheet.triangles) {
    const double area = localTriangle(sheet, t).twice_area,
                 p = twiceArea(sheet.params[t.x], sheet.params[t.y], sheet.params[t.z]);
    surface += area, parameter += p;
    densities.push_back({area / p, area});
  }
  std::sort(densities.begin(), densities.end());
  double below = 0;
  bool even = true;
  for (const auto& [density, area] : densities) {
    below += area;
    const double relative = density * parameter / surface;
    if (below > 0.05 * surface && below < 0.95 * surface)
      even &= relative < kMostStretch && relative > 1 / kMostStretch;
  }
  for (glm::dvec2& p : sheet.params) p *= std::sqrt(surface / parameter);
  return even;
}

bool cross(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  return twiceArea(a, b, c) * twiceArea(a, b, d) < 0 && twiceArea(c, d, a) * twiceArea(c, d, b) < 0;
}

// Distances from the seeds within the piece, along paths from centre to centre over the edges' middles; and
// whose seed is nearest.
struct Distances {
  std::map<uint32_t, double> distance;
  std::map<uint32_t, uint32_t> seed;
};
Distances distancesFrom(const Surface& surface, const Piece& piece, std::span<const uint32_t> seeds) {
  const std::set<uint32_t> inside(piece.begin(), piece.end());
  Distances d;
  using Step = std::tuple<double, uint32_t, uint32_t>;  // distance, triangle, seed
  std::priority_queue<Step, std::vector<Step>, std::greater<>> queue;
  for (const uint32_t seed : seeds) queue.push({0, seed, seed});
  while (!queue.empty()) {
    const auto [distance, t, seed] = queue.top();
    queue.pop();
    if (!d.distance.try_emplace(t, distance).second) continue;
    d.seed[t] = seed;
    for (int k = 0; k < 3; ++k) {
      const Neighbour& next = surface.neighbours[3 * t + size_t(k)];
      if (!next.exists() || !inside.contains(next.triangle) || d.distance.contains(next.triangle)) continue;
      double onwards = 0;  // from the shared edge to the neighbour's centre
      for (int m = 0; m < 3; ++m)
        if (surface.neighbours[3 * next.triangle + size_t(m)].triangle == t)
          onwards = surface.reach(next.triangle, m);
      queue.push({distance + surface.reach(t, k) + onwards, next.triangle, seed});
    }
  }
  return d;
}

uint32_t furthestFrom(const Surface& surface, const Piece& piece, uint32_t seed) {
  const Distances d = distancesFrom(surface, piece, std::span(&seed, 1));
  uint32_t best = seed;
  for (const auto& [t, distance] : d.distance)
    if (distance > d.distance.at(best)) best = t;
  return best;
}

// What is nearer to one of two triangles far apart, and the rest: both connected.
std::pair<Piece, Piece> halve(const Surface& surface, const Piece& piece) {
  const uint32_t a = furthestFrom(surface, piece, piece[0]);
  uint32_t b = furthestFrom(surface, piece, a);
  if (b == a) b = a == piece[0] ? piece[1] : piece[0];
  const uint32_t seeds[] = {a, b};
  const Distances d = distancesFrom(surface, piece, seeds);
  std::pair<Piece, Piece> halves;
  for (const uint32_t t : piece) (d.seed.at(t) == a ? halves.first : halves.second).push_back(t);
  return halves;
}

std::vector<Piece> components(const Surface& surface) {
  std::vector<Piece> pieces;
  std::vector<bool> seen(surface.triangles.size(), false);
  for (uint32_t start = 0; start < surface.triangles.size(); ++start) {
    if (seen[start]) continue;
    Piece piece{start};
    seen[start] = true;
    for (size_t k = 0; k < piece.size(); ++k)
      for (int e = 0; e < 3; ++e) {
        const Neighbour& next = surface.neighbours[3 * piece[k] + size_t(e)];
        if (next.exists() && !seen[next.triangle]) seen[next.triangle] = true, piece.push_back(next.triangle);
      }
    std::sort(piece.begin(), piece.end());
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

std::optional<Sheet> chartOf(const Surface& surface, const Piece& piece) {
  auto sheet = unfold(surface, piece);
  if (!sheet || !flatten(*sheet) || !isFlat(sheet->params, sheet->triangles)) return std::nullopt;
  if (!scaleToArea(*sheet) && piece.size() > 1) return std::nullopt;
  return sheet;
}

void append(const Surface& surface, const Piece& piece, const Sheet& sheet, uint16_t chart,
            ChartedMesh& mesh) {
  const auto first = uint32_t(mesh.source.size());
  mesh.source.insert(mesh.source.end(), sheet.source.begin(), sheet.source.end());
  for (const glm::dvec3& position : sheet.positions) mesh.positions.push_back(position / surface.length);
  mesh.params.insert(mesh.params.end(), sheet.params.begin(), sheet.params.end());
  for (size_t t = 0; t < piece.size(); ++t)
    mesh.triangles[piece[t]] = sheet.triangles[t] + first, mesh.charts[piece[t]] = chart;
}

}  // namespace

bool isFlat(std::span<const glm::dvec2> params, std::span<const glm::uvec3> triangles) {
  std::map<std::pair<uint32_t, uint32_t>, int> uses;
  for (const glm::uvec3& t : triangles) {
    if (!(twiceArea(params[t.x], params[t.y], params[t.z]) > 0)) return false;
    for (int k = 0; k < 3; ++k) ++uses[std::minmax(t[k], t[(k + 1) % 3])];
  }
  struct Segment {
    glm::dvec2 a, b;
    double left, right;
  };
  std::vector<Segment> border;
  for (const auto& [edge, count] : uses) {
    const glm::dvec2 a = params[edge.first], b = params[edge.second];
    if (count == 1) border.push_back({a, b, std::min(a.x, b.x), std::max(a.x, b.x)});
  }
  std::sort(border.begin(), border.end(), [](const Segment& s, const Segment& t) { return s.left < t.left; });
  for (size_t i = 0; i < border.size(); ++i)
    for (size_t j = i + 1; j < border.size() && border[j].left <= border[i].right; ++j)
      if (cross(border[i].a, border[i].b, border[j].a, border[j].b)) return false;
  return true;
}

Result<ChartedMesh> segmentMesh(std::span<const glm::dvec3> positions, std::span<const glm::uvec3> triangles,
                                const MeshName& name, double aspect) {
  const double root = std::sqrt(aspect);
  Surface surface{positions, triangles, {1 / root, root, 1}, periodicNodes(positions), {}};
  auto neighbours = findNeighbours(positions, triangles, surface.nodes, name);
  if (!neighbours) return neighbours.issue();
  surface.neighbours = std::move(*neighbours);
  ChartedMesh mesh;
  mesh.triangles.resize(triangles.size());
  mesh.charts.resize(triangles.size());
  std::vector<Piece> left = components(surface);
  std::reverse(left.begin(), left.end());  // taken from the end
  size_t charts = 0;
  while (!left.empty()) {
    const Piece piece = std::move(left.back());
    left.pop_back();
    if (const auto sheet = chartOf(surface, piece)) {
      append(surface, piece, *sheet, uint16_t(++charts), mesh);
    } else if (piece.size() == 1) {
      return Issue{issue_id::kTileGeometry, Severity::kError,
                   triangleName(name, piece[0], positions, triangles), "cannot be flattened: it has no area"};
    } else {
      auto [a, b] = halve(surface, piece);
      left.push_back(std::move(b)), left.push_back(std::move(a));
    }
    if (charts + left.size() > kMostCharts)
      return Issue{issue_id::kTileUv, Severity::kError, name.file,
                   "the surface falls into more than " + std::to_string(kMostCharts) +
                       " charts; give texture coordinates"};
  }
  return mesh;
}

}  // namespace loden::importer
