#include "importer/tile/file/mesh_repair.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "importer/mesh/periodic_mesh.h"
#include "importer/mesh/weld.h"
#include "importer/tile/file/tile_params.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

constexpr double kNeedle =
    1e-5;                       // height, or shortest edge, per longest edge: below, a triangle has no shape
constexpr double kSame = 1e-7;  // of equal positions, per extent of the mesh

struct Face {
  glm::uvec3 corners;
  size_t number;  // in the file
};

// Of vertices of one triangle.
TexturePoint between(const TexturePoint& a, const TexturePoint& b, double t) {
  return {a.material, glm::mix(a.base_color, b.base_color, t),
          glm::mix(a.metallic_roughness, b.metallic_roughness, t)};
}

class Repair {
 public:
  Repair(PolygonMesh& mesh, const std::string& where)
      : mesh_(mesh), where_(where), triangles_(triangulate(mesh)) {
    for (size_t t = 0; t < triangles_.size(); ++t) faces_.push_back({triangles_[t], t});
    glm::dvec3 low(1e300), high(-1e300);
    for (const glm::dvec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
    tolerance_ = std::max(kSame * glm::length(high - low), 1e-300);
    weld();
  }

  Status run() {
    joinShortEdges();
    dropShapeless();
    splitOpenEdges();
    dropShapeless();  // splinters
    dropRepeated();
    if (const Status status = checkEdges(); !status) return status;
    store();
    report();
    return {};
  }

 private:
  using Edge = std::pair<uint32_t, uint32_t>;  // welded vertices, the lower first

  void weld() { same_ = weldVertices(mesh_.positions, glm::dvec3(0), tolerance_); }
  const glm::dvec3& at(const Face& f, int k) const { return mesh_.positions[f.corners[k % 3]]; }
  uint32_t node(const Face& f, int k) const { return same_[f.corners[k % 3]]; }
  Edge edge(const Face& f, int k) const { return std::minmax(node(f, k), node(f, k + 1)); }

  // Vertices of an edge that is nothing beside its triangle's longest are put in one place.
  void joinShortEdges() {
    bool moved = false;
    for (const Face& f : faces_) {
      double longest = 0;
      for (int k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(at(f, k), at(f, k + 1)));
      for (int k = 0; k < 3; ++k) {
        const uint32_t a = node(f, k), b = node(f, k + 1);
        if (a == b || glm::distance(at(f, k), at(f, k + 1)) >= kNeedle * longest) continue;
        for (size_t v = 0; v < same_.size(); ++v)
          if (same_[v] == std::max(a, b)) mesh_.positions[v] = mesh_.positions[std::min(a, b)];
        moved = true;
        weld();
      }
    }
    if (moved) weld();
  }

  bool shapeless(const Face& f) const {
    if (node(f, 0) == node(f, 1) || node(f, 1) == node(f, 2) || node(f, 2) == node(f, 0)) return true;
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(at(f, k), at(f, k + 1)));
    return glm::length(glm::cross(at(f, 1) - at(f, 0), at(f, 2) - at(f, 0))) < kNeedle * longest * longest;
  }
  void dropShapeless() {
    std::erase_if(faces_, [&](const Face& f) { return shapeless(f); });
  }

  void dropRepeated() {
    std::set<std::array<uint32_t, 3>> seen;
    std::erase_if(faces_, [&](const Face& f) {
      std::array<uint32_t, 3> key{node(f, 0), node(f, 1), node(f, 2)};
      std::sort(key.begin(), key.end());
      return !seen.insert(key).second;
    });
  }

  std::set<Edge> openEdges() const {
    std::map<Edge, int> uses;
    for (const Face& f : faces_)
      for (int k = 0; k < 3; ++k) ++uses[edge(f, k)];
    std::set<Edge> open;
    for (const auto& [e, count] : uses)
      if (count == 1) open.insert(e);
    return open;
  }

  // How far along ab the vertex lies, if it lies on it and not at its ends; else 0.
  double along(const Edge& ab, uint32_t v) const {
    const glm::dvec3 a = mesh_.positions[ab.first], ab_vector = mesh_.positions[ab.second] - a,
                     av = mesh_.positions[v] - a;
    const double length = glm::length(ab_vector), t = glm::dot(av, ab_vector) / (length * length);
    const double off = glm::length(av - t * ab_vector);
    return t > kNeedle && t < 1 - kNeedle && off <= kNeedle * length ? t : 0;
  }

  // The vertices on each open edge. One counts if an open edge of its own runs along there, too: what merely
  // touches the edge is another surface.
  std::map<Edge, std::vector<uint32_t>> junctions() const {
    const std::set<Edge> open = openEdges();
    std::map<uint32_t, std::vector<uint32_t>> beside;  // ends of the open edges of a vertex
    for (const Edge& e : open) beside[e.first].push_back(e.second), beside[e.second].push_back(e.first);
    std::vector<std::pair<double, uint32_t>> by_x;
    for (const auto& [v, others] : beside) by_x.emplace_back(mesh_.positions[v].x, v);
    std::sort(by_x.begin(), by_x.end());
    std::map<Edge, std::vector<uint32_t>> found;
    for (const Edge& e : open) {
      const auto [low, high] = std::minmax(mesh_.positions[e.first].x, mesh_.positions[e.second].x);
      const double margin = kNeedle * glm::distance(mesh_.positions[e.first], mesh_.positions[e.second]);
      for (auto it = std::lower_bound(by_x.begin(), by_x.end(), std::pair(low - margin, 0u));
           it != by_x.end() && it->first <= high + margin; ++it) {
        const uint32_t v = it->second;
        if (along(e, v) == 0) continue;
        const auto& others = beside.at(v);
        if (std::any_of(others.begin(), others.end(),
                        [&](uint32_t w) { return w == e.first || w == e.second || along(e, w) > 0; }))
          found[e].push_back(v);
      }
    }
    return found;
  }

  // A copy of vertex `v` on edge k of a face: its position, the face's other attributes there.
  uint32_t vertexOnEdge(const Face& f, int k, uint32_t v, double t) {
    const uint32_t a = f.corners[k], b = f.corners[(k + 1) % 3];
    mesh_.positions.push_back(glm::dvec3(mesh_.positions[v]));
    mesh_.normals.push_back(glm::mix(mesh_.normals[a], mesh_.normals[b], t));
    if (!mesh_.uvs.empty()) mesh_.uvs.push_back(glm::mix(mesh_.uvs[a], mesh_.uvs[b], t));
    mesh_.brdfs.push_back(LocalBrdf(mesh_.brdfs[t < 0.5 ? a : b]));
    if (!mesh_.texture_points.empty())
      mesh_.texture_points.push_back(between(mesh_.texture_points[a], mesh_.texture_points[b], t));
    same_.push_back(v);
    return uint32_t(mesh_.positions.size() - 1);
  }

  void splitOpenEdges() {
    const auto found = junctions();
    if (found.empty()) return;
    for (size_t at_face = 0; at_face < faces_.size(); ++at_face)  // grows: halves are looked at again
      for (int k = 0; k < 3; ++k) {
        const Face f = faces_[at_face];
        // The pieces of a split edge are no keys themselves, so look for the vertices on any open edge they
        // lie on.
        const Edge mine = edge(f, k);
        const std::vector<uint32_t>* vertices = nullptr;
        if (const auto it = found.find(mine); it != found.end())
          vertices = &it->second;
        else if (const auto it2 = pieces_.find(mine); it2 != pieces_.end())
          vertices = &found.at(it2->second);
        if (!vertices) continue;
        const Edge whole = found.contains(mine) ? mine : pieces_.at(mine);
        for (const uint32_t v : *vertices) {
          const double t = along(mine, v);
          if (t == 0 || v == node(f, (k + 2) % 3)) continue;
          const uint32_t middle = vertexOnEdge(f, k, v, node(f, k) == mine.first ? t : 1 - t);
          const uint32_t a = f.corners[k], b = f.corners[(k + 1) % 3], c = f.corners[(k + 2) % 3];
          faces_[at_face].corners = {a, middle, c};
          faces_.push_back({{middle, b, c}, f.number});
          pieces_[std::minmax(same_[a], v)] = whole;
          pieces_[std::minmax(v, same_[b])] = whole;
          k = -1;  // the first half anew
          break;
        }
      }
  }

  Status checkEdges() const {
    std::map<Edge, std::vector<std::pair<size_t, bool>>>
        uses;  // number in the file, from lower to higher vertex
    for (const Face& f : faces_)
      for (int k = 0; k < 3; ++k) uses[edge(f, k)].push_back({f.number, node(f, k) < node(f, k + 1)});
    for (const auto& [e, faces] : uses) {
      if (faces.size() < 2 || (faces.size() == 2 && faces[0].second != faces[1].second)) continue;
      return Issue{issue_id::kTileGeometry, Severity::kError,
                   triangleName({where_}, faces.back().first, mesh_.positions, triangles_),
                   faces.size() > 2 ? "an edge is shared by more than two triangles (the surface is not a "
                                      "manifold); repair the mesh"
                                    : "faces the opposite way of triangle " + std::to_string(faces[0].first) +
                                          " beside it; turn one of them over"};
    }
    return {};
  }

  void store() {
    mesh_.face_sizes.assign(faces_.size(), 3);
    mesh_.corners.clear();
    for (const Face& f : faces_) mesh_.numbers.push_back(uint32_t(f.number));
    for (const Face& f : faces_)
      mesh_.corners.insert(mesh_.corners.end(), {f.corners.x, f.corners.y, f.corners.z});
  }

  // Says what has become of the file's triangles.
  void report() {
    std::vector<bool> kept(triangles_.size(), false);
    for (const Face& f : faces_) kept[f.number] = true;
    const auto dropped = std::count(kept.begin(), kept.end(), false);
    const auto pieces = std::ptrdiff_t(faces_.size()) - (std::ptrdiff_t(triangles_.size()) - dropped);
    if (dropped == 0 && pieces == 0) return;
    const auto first = size_t(std::find(kept.begin(), kept.end(), false) - kept.begin());
    const std::string place =
        dropped > 0 ? triangleName({where_}, first, mesh_.positions, triangles_) : where_;
    mesh_.warnings.push_back({issue_id::kTileGeometry, Severity::kWarning, place,
                              "repaired: " + std::to_string(dropped) +
                                  " triangles without area or repeated left out, " + std::to_string(pieces) +
                                  " more where open edges were split at vertices on them"});
  }

  PolygonMesh& mesh_;
  const std::string& where_;
  const std::vector<glm::uvec3> triangles_;  // as in the file
  std::vector<Face> faces_;
  std::vector<uint32_t> same_;   // per vertex: the lowest in the same place
  std::map<Edge, Edge> pieces_;  // of split edges: the whole edge
  double tolerance_ = 0;
};

}  // namespace

Status repairMesh(PolygonMesh& mesh, const std::string& where) {
  return Repair(mesh, where).run();
}

}  // namespace loden::importer
