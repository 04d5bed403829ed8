#include "importer/mesh/periodic_mesh.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "importer/mesh/weld.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

constexpr double kTolerance = 1e-6;  // of equal positions, tile periods

// Two nodes and the periods between them, the lower node first.
using Edge = std::array<long, 4>;
struct Use {
  uint32_t triangle;
  int corner;
  bool forward;
};

}  // namespace

std::string triangleName(const MeshName& name, size_t triangle, std::span<const glm::dvec3> positions,
                         std::span<const glm::uvec3> triangles) {
  const glm::uvec3& t = triangles[triangle];
  const glm::dvec3 centre =
      name.origin + name.unit * (positions[t.x] + positions[t.y] + positions[t.z]) / 3.0;
  char text[96];
  std::snprintf(text, sizeof text, ": triangle %u at (%.4g, %.4g, %.4g)", name.number(triangle), centre.x,
                centre.y, centre.z);
  return name.file + text;
}

PeriodicNodes periodicNodes(std::span<const glm::dvec3> positions) {
  PeriodicNodes nodes;
  const auto same = weldVertices(positions, {1, 1, 0}, kTolerance);
  std::vector<uint32_t> node_of(positions.size());
  for (uint32_t v = 0; v < positions.size(); ++v) {
    if (same[v] == v) node_of[v] = uint32_t(nodes.first.size()), nodes.first.push_back(v);
    nodes.node.push_back(node_of[same[v]]);
    nodes.shift.push_back(glm::round(glm::dvec2(positions[v] - positions[same[v]])));
  }
  return nodes;
}

Result<std::vector<Neighbour>> findNeighbours(std::span<const glm::dvec3> positions,
                                              std::span<const glm::uvec3> triangles,
                                              const PeriodicNodes& nodes, const MeshName& name) {
  std::map<Edge, std::vector<Use>> edges;
  for (uint32_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3], na = nodes.node[a],
                     nb = nodes.node[b];
      const glm::dvec2 d = nodes.shift[b] - nodes.shift[a];
      const bool forward = na < nb || (na == nb && (d.x > 0 || (d.x == 0 && d.y > 0)));
      const Edge edge = forward ? Edge{na, nb, long(d.x), long(d.y)} : Edge{nb, na, long(-d.x), long(-d.y)};
      edges[edge].push_back({t, k, forward});
    }
  std::vector<Neighbour> neighbours(3 * triangles.size());
  const auto nodeShift = [&](const Use& use) {  // periods of the edge's first node in the triangle
    return nodes.shift[triangles[use.triangle][use.forward ? use.corner : (use.corner + 1) % 3]];
  };
  for (const auto& [edge, uses] : edges) {
    if (uses.size() == 1) continue;
    if (uses.size() > 2 || uses[0].forward == uses[1].forward)
      return Issue{issue_id::kTileGeometry, Severity::kError,
                   triangleName(name, uses.back().triangle, positions, triangles),
                   uses.size() > 2 ? "an edge is shared by more than two triangles (the surface is not a "
                                     "manifold); repair the mesh"
                                   : "faces the other way than triangle " +
                                         std::to_string(name.number(uses[0].triangle)) +
                                         " beside it; turn one of them over"};
    const glm::ivec2 shift(nodeShift(uses[0]) - nodeShift(uses[1]));
    neighbours[3 * uses[0].triangle + size_t(uses[0].corner)] = {uses[1].triangle, shift};
    neighbours[3 * uses[1].triangle + size_t(uses[1].corner)] = {uses[0].triangle, -shift};
  }
  return neighbours;
}

long eulerNumber(const PeriodicNodes& nodes, std::span<const glm::uvec3> triangles,
                 std::span<const Neighbour> neighbours) {
  std::vector<bool> used(nodes.first.size(), false);
  for (const glm::uvec3& t : triangles)
    for (int k = 0; k < 3; ++k) used[nodes.node[t[k]]] = true;
  const auto inner =
      std::count_if(neighbours.begin(), neighbours.end(), [](const Neighbour& n) { return n.exists(); });
  return long(std::count(used.begin(), used.end(), true)) - (long(neighbours.size()) - long(inner) / 2) +
         long(triangles.size());
}

size_t countComponents(std::span<const Neighbour> neighbours) {
  std::vector<bool> seen(neighbours.size() / 3, false);
  size_t count = 0;
  for (uint32_t start = 0; start < seen.size(); ++start) {
    if (seen[start]) continue;
    ++count;
    std::vector<uint32_t> stack{start};
    seen[start] = true;
    while (!stack.empty()) {
      const uint32_t t = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k)
        if (const Neighbour& next = neighbours[3 * t + size_t(k)]; next.exists() && !seen[next.triangle])
          seen[next.triangle] = true, stack.push_back(next.triangle);
    }
  }
  return count;
}

}  // namespace loden::importer
