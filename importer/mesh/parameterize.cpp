#include "importer/mesh/parameterize.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "importer/mesh/weld.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

constexpr double kTolerance = 1e-6;  // of equal positions, tile periods
constexpr int kMaxIterations = 30;
constexpr int kFewestVotes = 2;
constexpr int kEnoughVotes = 4;  // a period needs this part of the most frequent distance's votes

Issue refuse(int id, const std::string& where, const std::string& why) {
  return {id, Severity::kError, where, why};
}

// The mesh as a torus: vertices one period apart are one node; each corner knows which period it stands in.
struct Torus {
  std::vector<uint32_t> node;     // per vertex
  std::vector<glm::dvec2> shift;  // per vertex: periods from the node's first vertex
  std::vector<uint32_t> first;    // per node: a vertex of it
};

Torus makeTorus(std::span<const glm::dvec3> positions) {
  Torus torus;
  const auto same = weldVertices(positions, {1, 1, 0}, kTolerance);
  std::vector<uint32_t> node_of(positions.size());
  for (uint32_t v = 0; v < positions.size(); ++v) {
    if (same[v] == v) node_of[v] = uint32_t(torus.first.size()), torus.first.push_back(v);
    torus.node.push_back(node_of[same[v]]);
    torus.shift.push_back(glm::round(glm::dvec2(positions[v] - positions[same[v]])));
  }
  return torus;
}

// Every edge between two triangles, one component, no handle but the torus's own: V - E + F = 0.
Status checkTorus(const Torus& torus, std::span<const glm::dvec3> positions,
                  std::span<const glm::uvec3> triangles, const MeshName& name) {
  // An edge of the torus: two nodes and the periods between them.
  using Edge = std::array<long, 4>;
  std::map<Edge, std::array<int, 3>> edges;  // uses forwards, backwards; a triangle
  std::vector<uint32_t> parent(torus.first.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](uint32_t n) {
    while (parent[n] != n) n = parent[n] = parent[parent[n]];
    return n;
  };
  for (size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      const uint32_t na = torus.node[a], nb = torus.node[b];
      if (na == nb)
        return refuse(issue_id::kTileUv, triangleName(name, t, positions, triangles),
                      "no texture coordinates (TEXCOORD_0), and the mesh is too coarse to make them: a "
                      "triangle spans a whole period");
      const glm::dvec2 d = torus.shift[b] - torus.shift[a];
      const bool forward = na < nb;
      const Edge edge = forward ? Edge{na, nb, long(d.x), long(d.y)} : Edge{nb, na, long(-d.x), long(-d.y)};
      auto& uses = edges.try_emplace(edge, std::array<int, 3>{0, 0, int(t)}).first->second;
      if (++uses[forward ? 0 : 1] > 1)
        return refuse(issue_id::kTileGeometry, triangleName(name, t, positions, triangles),
                      "an edge is shared by more than two triangles, or by two that face opposite ways; "
                      "repair the mesh");
      parent[std::max(root(na), root(nb))] = std::min(root(na), root(nb));
    }
  for (const auto& [edge, uses] : edges)
    if (uses[0] != 1 || uses[1] != 1)
      return refuse(issue_id::kTileUv, triangleName(name, size_t(uses[2]), positions, triangles),
                    "an edge is open: the surface has a hole, or its borders do not match; close it, or give "
                    "texture coordinates");
  for (const glm::uvec3& t : triangles)
    if (root(torus.node[t.x]) != root(torus.node[triangles[0].x]))
      return refuse(issue_id::kTileUv, name.file,
                    "the surface has several components; give texture coordinates, one chart each");
  std::vector<bool> used(torus.first.size());
  for (const glm::uvec3& t : triangles)
    for (int k = 0; k < 3; ++k) used[torus.node[t[k]]] = true;
  const long nodes = long(std::count(used.begin(), used.end(), true));
  if (nodes - long(edges.size()) + long(triangles.size()) != 0)
    return refuse(issue_id::kTileUv, name.file,
                  "the surface has handles besides the tile's own repetition; give texture coordinates");
  return {};
}

Status checkTriangles(std::span<const glm::dvec3> positions, std::span<const glm::uvec3> triangles,
                      const MeshName& name) {
  for (size_t t = 0; t < triangles.size(); ++t) {
    const glm::dvec3 a = positions[triangles[t].x], b = positions[triangles[t].y],
                     c = positions[triangles[t].z];
    const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    if (glm::length(glm::cross(b - a, c - a)) < 1e-9 * longest * longest || longest == 0)
      return refuse(issue_id::kTileGeometry, triangleName(name, t, positions, triangles),
                    "is degenerate: its corners lie on a line; remove or repair it");
  }
  return {};
}

// tan(angle / 2) at `at` between `b` and `c`.
double halfTangent(const glm::dvec3& at, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 u = glm::normalize(b - at), v = glm::normalize(c - at);
  return glm::length(glm::cross(u, v)) / (1 + glm::dot(u, v));
}

// A spring between two nodes, `to` standing `shift` periods away.
struct Pull {
  uint32_t from, to;
  glm::dvec2 shift;
  double weight;
};

// Floater 2003, eq. 2.1: each corner adds tan(angle / 2) / length to both of its edges. An edge gets the sum
// of both its ends' weights: on a torus unequal weights leave one node where no weighted mean of its
// neighbours is, and triangles flip there; equal positive ones never do (Gortler et al. 2006).
std::vector<Pull> meanValuePulls(const Torus& torus, std::span<const glm::dvec3> positions,
                                 std::span<const glm::uvec3> triangles) {
  std::vector<Pull> pulls;
  for (const glm::uvec3& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const uint32_t at = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      const double tangent = halfTangent(positions[at], positions[b], positions[c]);
      for (const uint32_t other : {b, c})
        pulls.push_back({torus.node[at], torus.node[other], torus.shift[other] - torus.shift[at],
                         tangent / glm::distance(positions[at], positions[other])});
    }
  return pulls;
}

// Parameters at which every node is the weighted mean of its neighbours; node 0 stays at the origin. Springs
// are weaker where the surface is large for its parameter area.
std::optional<std::vector<glm::dvec2>> solve(size_t nodes, std::span<const Pull> pulls,
                                             std::span<const double> stretch) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto side = static_cast<Eigen::Index>(nodes);
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(side, 2);
  const auto add = [&](uint32_t at, uint32_t other, const glm::dvec2& shift, double weight) {
    if (at == 0) return;
    entries.emplace_back(at, at, weight);
    if (other != 0) entries.emplace_back(at, other, -weight);
    right.row(at) += weight * Eigen::RowVector2d(shift.x, shift.y);
  };
  for (const Pull& pull : pulls) {
    const double weight = pull.weight / (stretch[pull.from] * stretch[pull.to]);
    add(pull.from, pull.to, pull.shift, weight);
    add(pull.to, pull.from, -pull.shift, weight);
  }
  entries.emplace_back(0, 0, 1.0);
  Eigen::SparseMatrix<double> matrix(side, side);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Eigen::MatrixX2d solution = solver.solve(right);
  std::vector<glm::dvec2> params;
  for (Eigen::Index n = 0; n < side; ++n) params.push_back({solution(n, 0), solution(n, 1)});
  return params;
}

double parameterArea(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
}

// Per node: square root of surface area over parameter area around it, relative to the whole (Yoshizawa,
// Belyaev and Seidel 2004, with area in place of stretch).
std::vector<double> nodeStretch(const Torus& torus, std::span<const glm::dvec3> positions,
                                std::span<const glm::dvec2> params, std::span<const glm::uvec3> triangles) {
  std::vector<double> surface(torus.first.size(), 0), parameter(torus.first.size(), 0);
  double total = 0;
  for (const glm::uvec3& t : triangles) {
    const double area =
        glm::length(glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x])) / 2;
    total += area;
    for (int k = 0; k < 3; ++k) {
      surface[torus.node[t[k]]] += area;
      parameter[torus.node[t[k]]] += parameterArea(params[t.x], params[t.y], params[t.z]);
    }
  }
  for (size_t n = 0; n < surface.size(); ++n)
    surface[n] = std::sqrt(std::min(surface[n] / (std::max(parameter[n], 1e-30) * total), 1e4));
  return surface;
}

std::vector<glm::dvec2> perVertex(const Torus& torus, std::span<const glm::dvec2> node_params) {
  std::vector<glm::dvec2> params;
  for (size_t v = 0; v < torus.node.size(); ++v)
    params.push_back(node_params[torus.node[v]] + torus.shift[v]);
  return params;
}

// The translation that brings p nearest to P.xy on the whole.
void centre(std::span<const glm::dvec3> positions, std::vector<glm::dvec2>& params) {
  glm::dvec2 offset(0);
  for (size_t v = 0; v < params.size(); ++v)
    offset += (glm::dvec2(positions[v]) - params[v]) / double(params.size());
  for (glm::dvec2& p : params) p += offset;
}

}  // namespace

ParameterizationQuality measureParameterization(std::span<const glm::dvec3> positions,
                                                std::span<const glm::dvec2> params,
                                                std::span<const glm::uvec3> triangles) {
  ParameterizationQuality quality;
  std::vector<std::pair<double, double>> densities;  // surface per parameter area, parameter area
  double surface = 0, parameter = 0;
  for (const glm::uvec3& t : triangles) {
    const double area =
        glm::length(glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x])) / 2;
    const double p = parameterArea(params[t.x], params[t.y], params[t.z]);
    surface += area, parameter += std::max(p, 0.0);
    if (p <= 0)
      ++quality.flipped;
    else
      densities.push_back({area / p, p});
  }
  std::sort(densities.begin(), densities.end());
  const double mean = surface / parameter;
  double variance = 0, below = 0;
  bool found_p5 = false, found_p95 = false;
  for (const auto& [density, p] : densities) {
    const double relative = density / mean;
    variance += p / parameter * (relative - 1) * (relative - 1);
    below += p / parameter;
    if (!found_p5 && below >= 0.05) quality.area_p5 = relative, found_p5 = true;
    if (!found_p95 && below >= 0.95) quality.area_p95 = relative, found_p95 = true;
  }
  quality.area_cv = std::sqrt(variance);
  return quality;
}

Result<glm::dvec2> findPeriod(std::span<const glm::dvec3> positions, std::span<const glm::uvec3> triangles,
                              const std::string& where) {
  glm::dvec3 low(1e300), high(-1e300);
  for (const glm::dvec3& p : positions) low = glm::min(low, p), high = glm::max(high, p);
  const double tolerance = kTolerance * glm::length(high - low);
  // Border vertices: ends of edges that only one triangle has.
  const auto same = weldVertices(positions, glm::dvec3(0), tolerance);
  std::map<std::pair<uint32_t, uint32_t>, int> uses;
  for (const glm::uvec3& t : triangles)
    for (int k = 0; k < 3; ++k) ++uses[std::minmax({same[t[k]], same[t[(k + 1) % 3]]})];
  std::set<uint32_t> ends;
  for (const auto& [edge, count] : uses)
    if (count == 1) ends.insert(edge.first), ends.insert(edge.second);
  std::vector<glm::dvec3> border;
  for (const uint32_t v : ends) border.push_back(positions[v]);
  glm::dvec2 period(0);
  for (int axis = 0; axis < 2; ++axis) {
    // Border vertices that differ along this axis only; the most frequent distance is the period.
    std::vector<glm::dvec3> flattened = border;
    for (glm::dvec3& p : flattened) p[axis] = 0;
    const auto group = weldVertices(flattened, glm::dvec3(0), tolerance);
    std::map<long, int> votes;
    for (size_t v = 0; v < border.size(); ++v)
      if (const long d = std::lround(std::abs(border[v][axis] - border[group[v]][axis]) / (4 * tolerance));
          d > 0)
        ++votes[d];
    // Pieces of the surface have equal borders on both sides as well: the largest distance with enough votes.
    auto best = std::max_element(votes.begin(), votes.end(),
                                 [](const auto& a, const auto& b) { return a.second < b.second; });
    const int enough = best == votes.end() ? 0 : std::max(kFewestVotes, best->second / kEnoughVotes);
    for (auto other = votes.begin(); other != votes.end(); ++other)
      if (other->second >= enough && other->first > best->first) best = other;
    if (best == votes.end() || best->second < kFewestVotes)
      return refuse(
          issue_id::kTileUv, where,
          "no texture coordinates (TEXCOORD_0) that parameterize the tile, and none can be made: "
          "the borders in " +
              std::string(axis == 0 ? "x" : "y") +
              " do not match each other one period on; the tile must lie flat (xz plane in glTF, "
              "xy plane in OBJ) "
              "with its sides along the axes, and opposite borders need equal vertices; or give the "
              "period by --mesh-period X,Y, in the file's units");
    double sum = 0;
    int count = 0;
    for (size_t v = 0; v < border.size(); ++v) {
      const double d = std::abs(border[v][axis] - border[group[v]][axis]);
      if (std::abs(double(std::lround(d / (4 * tolerance)) - best->first)) <= 1) sum += d, ++count;
    }
    period[axis] = sum / count;
  }
  return period;
}

Result<Parameterization> parameterizeTorus(std::span<const glm::dvec3> positions,
                                           std::span<const glm::uvec3> triangles, const MeshName& name) {
  if (const Status status = checkTriangles(positions, triangles, name); !status) return status.issue();
  const Torus torus = makeTorus(positions);
  if (const Status status = checkTorus(torus, positions, triangles, name); !status) return status.issue();
  const auto pulls = meanValuePulls(torus, positions, triangles);

  Parameterization best;
  best.quality.flipped = std::numeric_limits<int>::max();
  std::vector<double> stretch(torus.first.size(), 1.0), tried = stretch, more;
  double step = 0.5;  // exponent of the correction; halved when a full one goes too far
  for (int iteration = 0; iteration < kMaxIterations && step > 0.1; ++iteration) {
    const auto node_params = solve(torus.first.size(), pulls, tried);
    if (!node_params) break;
    auto params = perVertex(torus, *node_params);
    ParameterizationQuality quality = measureParameterization(positions, params, triangles);
    quality.iterations = iteration;
    // Flips can come from rounding, where the plain map shrinks the inside of deep pores to nothing.
    const ParameterizationQuality& before = best.quality;
    const bool fewer = quality.flipped < before.flipped;
    if (fewer || (quality.flipped == before.flipped && quality.area_cv < before.area_cv)) {
      const bool settled = !fewer && before.area_cv - quality.area_cv < 1e-3;
      stretch = tried, more = nodeStretch(torus, positions, params, triangles);
      best = {std::move(params), quality};
      if (settled) break;
    } else {
      step /= 2;
    }
    for (size_t n = 0; n < stretch.size(); ++n) tried[n] = stretch[n] * std::pow(more[n], step);
  }
  if (best.quality.flipped > 0)
    return refuse(issue_id::kTileGeometry, name.file,
                  "the parameterization folds over itself: the mesh has needle triangles; remesh it, or give "
                  "texture coordinates");
  centre(positions, best.params);
  return best;
}

}  // namespace loden::importer
