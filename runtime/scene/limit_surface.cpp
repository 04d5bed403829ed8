#include "runtime/scene/limit_surface.h"

#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <set>

#include "material/base/issues.h"

namespace loden::runtime {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

constexpr size_t kMaxLimitVertices = size_t(1) << 24;

// What OpenSubdiv refines: quads over welded positions, and the same quads over welded UVs.
struct Cage {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec2> uvs;
  std::vector<int> position_of_corner, uv_of_corner;  // four per quad
  int quads() const { return static_cast<int>(position_of_corner.size() / 4); }
};

// Gives equal keys equal numbers, in order of first appearance.
template <class Key>
class Welder {
 public:
  // The number of `key`, and whether it is new.
  std::pair<int, bool> number(const Key& key) {
    const auto [it, fresh] = numbers_.try_emplace(key, static_cast<int>(numbers_.size()));
    return {it->second, fresh};
  }

 private:
  std::map<Key, int> numbers_;
};

Issue cageIssue(const std::string& place, std::string text) {
  return {issue_id::kGltfExtension, Severity::kError, place, std::move(text)};
}

// The four corners of each pair of triangles; an Issue where a pair shares no diagonal.
Result<std::vector<uint32_t>> quadCorners(const Mesh& mesh, const std::string& place) {
  if (mesh.indices.empty() || mesh.indices.size() % 6 != 0)
    return cageIssue(place, "a cage needs an even number of triangles, two for each quad");
  std::vector<uint32_t> corners;
  for (size_t i = 0; i < mesh.indices.size(); i += 6) {
    const uint32_t* t = &mesh.indices[i];
    if (t[3] != t[0] || t[4] != t[2])
      return cageIssue(place, "triangles " + std::to_string(i / 3) + " and " + std::to_string(i / 3 + 1) +
                                  " are not (a b c), (a c d): write the cage as quads");
    corners.insert(corners.end(), {t[0], t[1], t[2], t[5]});
  }
  return corners;
}

// A UV is one value per cage vertex and chart: keyed by vertex too, so that charts do not merge by chance.
Cage weld(const Mesh& mesh, const std::vector<uint32_t>& corners) {
  Cage cage;
  Welder<std::array<float, 3>> positions;
  Welder<std::pair<int, std::array<float, 2>>> uvs;
  for (uint32_t corner : corners) {
    const Vertex& vertex = mesh.vertices[corner];
    const glm::vec3 p = vertex.position + 0.0f;  // -0 becomes 0
    const auto [position, new_position] = positions.number({p.x, p.y, p.z});
    if (new_position) cage.positions.push_back(p);
    const auto [uv, new_uv] = uvs.number({position, {vertex.uv.x, vertex.uv.y}});
    if (new_uv) cage.uvs.push_back(vertex.uv);
    cage.position_of_corner.push_back(position);
    cage.uv_of_corner.push_back(uv);
  }
  return cage;
}

// OpenSubdiv stops on a quad with a repeated corner and mends non-manifold edges in ways we do not want.
Status checkTopology(const Cage& cage, const std::string& place) {
  std::set<std::pair<int, int>> edges;
  for (int q = 0; q < cage.quads(); ++q) {
    const int* c = &cage.position_of_corner[4 * q];
    const std::set<int> distinct(c, c + 4);
    if (distinct.size() != 4)
      return cageIssue(place, "quad " + std::to_string(q) + " has two corners at one place");
    for (int k = 0; k < 4; ++k)
      if (!edges.insert({c[k], c[(k + 1) % 4]}).second)
        return cageIssue(place,
                         "quad " + std::to_string(q) + " shares an edge with two others, or is turned over");
  }
  return {};
}

std::unique_ptr<Far::TopologyRefiner> makeRefiner(const Cage& cage, int levels) {
  const std::vector<int> counts(cage.quads(), 4);
  Far::TopologyDescriptor::FVarChannel channel;
  channel.numValues = static_cast<int>(cage.uvs.size());
  channel.valueIndices = cage.uv_of_corner.data();
  Far::TopologyDescriptor descriptor;
  descriptor.numVertices = static_cast<int>(cage.positions.size());
  descriptor.numFaces = cage.quads();
  descriptor.numVertsPerFace = counts.data();
  descriptor.vertIndicesPerFace = cage.position_of_corner.data();
  descriptor.numFVarChannels = 1;
  descriptor.fvarChannels = &channel;

  using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
  Sdc::Options options;
  options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  options.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_CORNERS_ONLY);
  std::unique_ptr<Far::TopologyRefiner> refiner(
      Factory::Create(descriptor, Factory::Options(Sdc::SCHEME_CATMARK, options)));
  if (refiner) {
    Far::TopologyRefiner::AdaptiveOptions adaptive(std::max(levels, 3));
    adaptive.considerFVarChannels = true;
    refiner->RefineAdaptive(adaptive);
  }
  return refiner;
}

// The same (n + 1)^2 places (s, t) on every quad, s fastest.
struct Grid {
  int n = 1;
  std::vector<float> s, t;
  int points() const { return (n + 1) * (n + 1); }
};
Grid makeGrid(int levels) {
  Grid grid{1 << levels, {}, {}};
  for (int j = 0; j <= grid.n; ++j)
    for (int i = 0; i <= grid.n; ++i) {
      grid.s.push_back(static_cast<float>(i) / grid.n);
      grid.t.push_back(static_cast<float>(j) / grid.n);
    }
  return grid;
}

// A quantity at every grid point of every quad, with its derivatives in s and t.
template <class Value>
struct Limit {
  std::vector<Value> value, ds, dt;
};

template <class Value>
Limit<Value> evaluateLimit(const Far::TopologyRefiner& refiner, const Grid& grid,
                           const std::vector<Value>& cage_values, unsigned interpolation, int quads) {
  // The factory of the same name without Real makes one of these, too, and casts it to what it is not.
  using Factory = Far::LimitStencilTableFactoryReal<float>;
  Factory::LocationArrayVec places(quads);
  for (int q = 0; q < quads; ++q) {
    places[q].ptexIdx = q;  // quads only: one ptex face each
    places[q].numLocations = grid.points();
    places[q].s = grid.s.data();
    places[q].t = grid.t.data();
  }
  Factory::Options options;
  options.interpolationMode = interpolation;
  options.generate1stDerivatives = true;
  const std::unique_ptr<const Far::LimitStencilTableReal<float>> table(
      Factory::Create(refiner, places, nullptr, nullptr, options));
  Limit<Value> limit;
  if (!table || table->GetNumStencils() != quads * grid.points()) return limit;
  for (int i = 0; i < table->GetNumStencils(); ++i) {
    const Far::LimitStencilReal<float> stencil = table->GetLimitStencil(i);
    Value value(0), ds(0), dt(0);
    for (int k = 0; k < stencil.GetSize(); ++k) {
      const Value& from = cage_values[stencil.GetVertexIndices()[k]];
      value += stencil.GetWeights()[k] * from;
      ds += stencil.GetDuWeights()[k] * from;
      dt += stencil.GetDvWeights()[k] * from;
    }
    limit.value.push_back(value);
    limit.ds.push_back(ds);
    limit.dt.push_back(dt);
  }
  return limit;
}

// dP/du of a surface given over (s, t), made orthogonal to the normal; w as in Vertex.
glm::vec4 tangentOf(const glm::vec3& normal, const glm::vec3& dp_ds, const glm::vec3& dp_dt,
                    const glm::vec2& duv_ds, const glm::vec2& duv_dt) {
  const float area = duv_ds.x * duv_dt.y - duv_dt.x * duv_ds.y;
  if (!(std::abs(area) > 1e-20f)) return {1, 0, 0, 0};
  const glm::vec3 dp_du = (dp_ds * duv_dt.y - dp_dt * duv_ds.y) / area;
  const glm::vec3 tangent = dp_du - normal * glm::dot(normal, dp_du);
  const float length = glm::length(tangent);
  if (!(length > 1e-20f)) return {1, 0, 0, 0};
  return {tangent / length, area > 0 ? 1.0f : -1.0f};
}

// Which points of different quads are the same: a key per point made of cage vertices.
class SharedPoints {
 public:
  SharedPoints(const Cage& cage, const Grid& grid) : cage_(cage), grid_(grid) {}

  // Index of the first point of all that lie where point (i, j) of quad q lies; `own` if it is the first.
  int first(int q, int i, int j, int own) {
    const int n = grid_.n;
    const bool on_s = i == 0 || i == n, on_t = j == 0 || j == n;
    if (!on_s && !on_t) return own;
    return points_.try_emplace(key(q, i, j), own).first->second;
  }

 private:
  // Corner: (vertex, vertex, 0). Edge point: (lower vertex, higher vertex, steps from the lower).
  std::array<int, 3> key(int q, int i, int j) const {
    const int n = grid_.n;
    const int* c = &cage_.position_of_corner[4 * q];
    int from = c[0], to = c[1], step = i;  // t = 0: corner 0 to 1
    if (j == n)
      from = c[3], to = c[2];
    else if (j != 0)
      from = i == 0 ? c[0] : c[1], to = i == 0 ? c[3] : c[2], step = j;
    if (step == 0) return {from, from, 0};
    if (step == n) return {to, to, 0};
    return from < to ? std::array{from, to, step} : std::array{to, from, n - step};
  }

  const Cage& cage_;
  const Grid& grid_;
  std::map<std::array<int, 3>, int> points_;
};

std::vector<Vertex> makeVertices(const Cage& cage, const Grid& grid, const Limit<glm::vec3>& position,
                                 const Limit<glm::vec2>& uv) {
  std::vector<Vertex> vertices(position.value.size());
  SharedPoints shared(cage, grid);
  for (int q = 0, at = 0; q < cage.quads(); ++q)
    for (int j = 0; j <= grid.n; ++j)
      for (int i = 0; i <= grid.n; ++i, ++at) {
        const int same = shared.first(q, i, j, at);
        Vertex& vertex = vertices[at];
        vertex.position = position.value[same];
        const glm::vec3 normal = glm::cross(position.ds[same], position.dt[same]);
        const float length = glm::length(normal);
        vertex.normal = length > 0 ? normal / length : glm::vec3(0, 1, 0);
        vertex.uv = uv.value[at];
        vertex.tangent = tangentOf(vertex.normal, position.ds[at], position.dt[at], uv.ds[at], uv.dt[at]);
      }
  return vertices;
}

std::vector<uint32_t> makeIndices(int quads, const Grid& grid) {
  std::vector<uint32_t> indices;
  const uint32_t row = grid.n + 1;
  for (int q = 0; q < quads; ++q)
    for (int j = 0; j < grid.n; ++j)
      for (int i = 0; i < grid.n; ++i) {
        const uint32_t a = q * grid.points() + j * row + i, d = a + row;
        indices.insert(indices.end(), {a, a + 1, d + 1, a, d + 1, d});
      }
  return indices;
}

}  // namespace

Result<Mesh> limitSurface(const Mesh& mesh, int levels, const std::string& place) {
  LODEN_CHECK(levels >= 1 && levels <= kMaxLimitLevels);
  const auto corners = quadCorners(mesh, place);
  if (!corners) return corners.issue();
  const Cage cage = weld(mesh, *corners);
  const Grid grid = makeGrid(levels);
  if (size_t(cage.quads()) * grid.points() > kMaxLimitVertices)
    return cageIssue(place, "the limit surface would have too many points: lower the levels");
  if (Status topology = checkTopology(cage, place); !topology) return topology.issue();
  const auto refiner = makeRefiner(cage, levels);
  if (!refiner) return cageIssue(place, "the cage is not a manifold of quads");

  using Factory = Far::LimitStencilTableFactory;
  const auto position =
      evaluateLimit(*refiner, grid, cage.positions, Factory::INTERPOLATE_VERTEX, cage.quads());
  const auto uv = evaluateLimit(*refiner, grid, cage.uvs, Factory::INTERPOLATE_FACE_VARYING, cage.quads());
  if (position.value.empty() || uv.value.empty())
    return cageIssue(place, "the limit surface cannot be evaluated");
  Mesh result;
  result.name = mesh.name;
  result.vertices = makeVertices(cage, grid, position, uv);
  result.indices = makeIndices(cage.quads(), grid);
  result.bounds = boundsOf(result);
  return result;
}

}  // namespace loden::runtime
