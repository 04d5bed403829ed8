#include "importer/tile/file/tile_params.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "importer/mesh/parameterize.h"
#include "importer/mesh/periodic_mesh.h"
#include "importer/mesh/segment.h"
#include "importer/mesh/weld.h"
#include "importer/tile/charts.h"
#include "material/base/issues.h"
#include "material/model/geometry_image.h"

namespace loden::importer {
namespace {

constexpr double kMatch = 1e-4;  // tolerance of matching borders, periods and texture coordinates

Issue refuse(int id, const std::string& where, const std::string& why) {
  return {id, Severity::kError, where, why};
}

// P(uv + axis) - P(uv) from the vertices that stand one period of texture coordinates apart; nothing if there
// are none, or if they disagree.
std::optional<glm::dvec3> periodAlong(const PolygonMesh& mesh, int axis) {
  std::vector<glm::dvec3> folded;
  for (const glm::dvec2& uv : mesh.uvs) folded.push_back({uv, 0});
  glm::dvec3 period(0);
  period[axis] = 1;
  const auto same = weldVertices(folded, period, kMatch);
  // Vertices with equal folded coordinates in order of the unfolded one; consecutive periods are compared.
  std::optional<glm::dvec3> shift;
  double scale = 0;
  for (size_t v = 0; v < mesh.uvs.size(); ++v) {
    const double periods = std::round(mesh.uvs[v][axis] - mesh.uvs[same[v]][axis]);
    if (periods == 0) continue;
    const glm::dvec3 d = (mesh.positions[v] - mesh.positions[same[v]]) / periods;
    if (!shift) shift = d, scale = glm::length(d);
    if (glm::distance(d, *shift) > 10 * kMatch * scale) return std::nullopt;
  }
  return shift;
}

// How the file's coordinates become a tile's: p = uv with its axes swapped or flipped to run along x and y.
struct Lattice {
  glm::dvec2 period{1};  // of the file's units
  bool swap = false;
  glm::dvec2 flip{1, 1};
};

// Sides that are equal but for rounding are equal.
Result<glm::dvec2> checkedPeriod(const glm::dvec2& period, const std::string& where) {
  if (std::abs(period.y - period.x) <= 10 * kMatch * period.x) return glm::dvec2(period.x);
  const double longer = std::max(period.x, period.y), shorter = std::min(period.x, period.y);
  if (longer <= kMostAspect * shorter) return period;
  return refuse(issue_id::kTileGeometry, where,
                "the period is " + std::to_string(period.x) + " x " + std::to_string(period.y) +
                    ", and no side may be more than " + std::to_string(int(kMostAspect)) +
                    " times the other; repeat the tile along its shorter side");
}

// What positions in the file are divided by to be tile coordinates: the period, and in z a tile length.
glm::dvec3 unitOf(const glm::dvec2& period) {
  return {period, period.x == period.y ? period.x : std::sqrt(period.x * period.y)};
}

// u, v: the steps of P from one period to the next.
Result<Lattice> latticeOf(const glm::dvec3& u, const glm::dvec3& v, const std::string& where) {
  Lattice lattice;
  lattice.swap = std::abs(u.x) < std::abs(u.y);
  const glm::dvec3 x = lattice.swap ? v : u, y = lattice.swap ? u : v;
  lattice.period = glm::abs(glm::dvec2(x.x, y.y));
  lattice.flip = glm::sign(glm::dvec2(x.x, y.y));
  const double off = std::max({std::abs(x.y), std::abs(x.z), std::abs(y.x), std::abs(y.z)});
  const double least = std::min(lattice.period.x, lattice.period.y);
  if (least == 0 || off > 10 * kMatch * least)
    return refuse(issue_id::kTileUv, where,
                  "u and v do not run along the tile's sides: the tile must lie flat (xz plane in glTF, xy "
                  "plane in OBJ) with its sides along the axes");
  const auto period = checkedPeriod(lattice.period, where);
  if (!period) return period.issue();
  lattice.period = *period;
  return lattice;
}

// Tile coordinates, parameters along x and y, the surface centred over its parameters.
void applyLattice(const Lattice& lattice, PolygonMesh& mesh, MeshName& name) {
  const glm::dvec3 unit = unitOf(lattice.period);
  mesh.aspect = lattice.period.y / lattice.period.x;
  glm::dvec2 centre(0);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    mesh.positions[v] /= unit;
    if (lattice.swap) std::swap(mesh.uvs[v].x, mesh.uvs[v].y);
    mesh.uvs[v] *= lattice.flip;
    centre += (glm::dvec2(mesh.positions[v]) - mesh.uvs[v]) / double(mesh.positions.size());
  }
  for (glm::dvec3& position : mesh.positions) position -= glm::dvec3(centre, 0);
  name.unit = unit, name.origin = {centre * lattice.period, 0};
}

// One point of the surface for each p. Upright walls, which have no area there, are none of p's.
Status checkFolds(const PolygonMesh& mesh, const MeshName& name) {
  const auto triangles = triangulate(mesh);
  size_t folded = 0, first = 0;
  for (size_t t = 0; t < triangles.size(); ++t) {
    const glm::dvec2 a = mesh.uvs[triangles[t].x], u = mesh.uvs[triangles[t].y] - a,
                     v = mesh.uvs[triangles[t].z] - a;
    const double area = u.x * v.y - u.y * v.x;
    if (area < -1e-9 * std::max(glm::dot(u, u), glm::dot(v, v)) && folded++ == 0) first = t;
  }
  if (2 * folded > triangles.size()) return {};  // upside down: seen later, from above
  if (folded == 0) return {};
  return refuse(issue_id::kTileUv, triangleName(name, first, mesh.positions, triangles),
                "its texture coordinates lie over those of others (so do " + std::to_string(folded - 1) +
                    " more): spread them, or leave texture coordinates out, and they are made");
}

// Tile coordinates at the origin, for a mesh whose texture coordinates do not say what its period is.
Status scaleToPeriod(PolygonMesh& mesh, const glm::dvec2& given, MeshName& name) {
  const auto period =
      given.x > 0 ? Result<glm::dvec2>(given) : findPeriod(mesh.positions, triangulate(mesh), name.file);
  if (!period) return period.issue();
  const auto checked = checkedPeriod(*period, name.file);
  if (!checked) return checked.issue();
  glm::dvec2 low(1e300), high(-1e300);
  for (const glm::dvec3& p : mesh.positions)
    low = glm::min(low, glm::dvec2(p)), high = glm::max(high, glm::dvec2(p));
  // By whole periods, so that what is near the origin stays in place: rays are of single precision.
  const glm::dvec3 away(glm::floor((low + high) / (2.0 * *checked)), 0), unit = unitOf(*checked);
  for (glm::dvec3& p : mesh.positions) p = p / unit - away;
  mesh.aspect = checked->y / checked->x;
  name.unit = unit, name.origin = away * unit;
  return {};
}

Status refine(PolygonMesh& mesh, int subdivide, const std::string& where) {
  if (subdivide == 0) return {};
  auto refined = subdivideMesh(mesh, {1, 1}, subdivide, where);
  if (!refined) return refined.issue();
  refined->aspect = mesh.aspect;
  mesh = std::move(*refined);
  // Of tile coordinates as yet.
  const glm::dvec3 per_length(periodsPerLength(mesh.aspect), 1);
  if (mesh.aspect != 1)
    for (glm::dvec3& normal : mesh.normals) normal = glm::normalize(normal * per_length);
  return {};
}

// Vertices as the charts have them, and copies of those that lie on several places of pictures; every polygon
// a triangle.
void takeCharts(const ChartedMesh& charted, const std::vector<glm::uvec3>& triangles, PolygonMesh& mesh) {
  PolygonMesh split;
  split.aspect = mesh.aspect;
  const bool textured = !mesh.texture_points.empty();
  const auto add = [&](size_t v, uint32_t source) {
    split.positions.push_back(charted.positions[v]), split.uvs.push_back(charted.params[v]);
    split.normals.push_back(mesh.normals[source]), split.brdfs.push_back(mesh.brdfs[source]);
    if (textured) split.texture_points.push_back(mesh.texture_points[source]);
    return uint32_t(split.positions.size() - 1);
  };
  for (size_t v = 0; v < charted.source.size(); ++v) add(v, charted.source[v]);
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> copies;  // [vertex of the chart, of the mesh]
  for (size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const uint32_t v = charted.triangles[t][k], own = triangles[t][k];
      uint32_t corner = v;
      if (textured && !(mesh.texture_points[own] == mesh.texture_points[charted.source[v]])) {
        const auto [entry, added] = copies.try_emplace({v, own}, 0u);
        if (added) entry->second = add(v, own);
        corner = entry->second;
      }
      split.corners.push_back(corner);
    }
  split.face_sizes.assign(triangles.size(), 3);
  Tile connected;  // by the charts' own vertices, before they were copied
  connected.params = charted.params, connected.triangles = charted.triangles;
  split.charts = chartsByVertices(connected);
  split.materials = std::move(mesh.materials);
  split.warnings = std::move(mesh.warnings);
  mesh = std::move(split);
}

// For a mesh of period 1: one periodic map if the surface is one closed piece that repeats both ways, else
// charts.
Result<ParamOrigin> makeParams(PolygonMesh& mesh, const MeshName& name) {
  const auto triangles = triangulate(mesh);
  const PeriodicNodes nodes = periodicNodes(mesh.positions);
  const auto neighbours = findNeighbours(mesh.positions, triangles, nodes, name);
  if (!neighbours) return neighbours.issue();
  if (countComponents(*neighbours) == 1) {
    auto made = parameterizeTorus(mesh.positions, triangles, name);
    const bool open =
        std::any_of(neighbours->begin(), neighbours->end(), [](const Neighbour& n) { return !n.exists(); });
    if (made) mesh.uvs = std::move(made->params);
    if (made) return ParamOrigin::kLattice;
    // Holes are more likely a mistake than meant, and what is too coarse for a map is so for charts. But a
    // tube folds, and other surfaces have handles.
    if (open ||
        (made.issue().id != issue_id::kTileGeometry && eulerNumber(nodes, triangles, *neighbours) == 0))
      return made.issue();
  }
  const auto charted = segmentMesh(mesh.positions, triangles, name, mesh.aspect);
  if (!charted) return charted.issue();
  takeCharts(*charted, triangles, mesh);
  return ParamOrigin::kCharts;
}

// Keeps texture coordinates that are an atlas, turned over as a whole if the file has v downwards.
bool takeAtlas(PolygonMesh& mesh) {
  const auto triangles = triangulate(mesh);
  if (isAtlas(mesh.uvs, triangles)) return true;
  std::vector<glm::dvec2> turned = mesh.uvs;
  for (glm::dvec2& uv : turned) uv.y = 1 - uv.y;
  if (!isAtlas(turned, triangles)) return false;
  mesh.uvs = std::move(turned);
  return true;
}

}  // namespace

std::vector<glm::uvec3> triangulate(const PolygonMesh& mesh) {
  std::vector<glm::uvec3> triangles;
  size_t first = 0;
  for (const int size : mesh.face_sizes) {
    for (size_t k = 2; k < size_t(size); ++k)
      triangles.push_back({mesh.corners[first], mesh.corners[first + k - 1], mesh.corners[first + k]});
    first += size_t(size);
  }
  return triangles;
}

namespace {

// A grid over the period, `depth` tile lengths below the mesh's lowest point, for rays that the mesh lets by.
void addGround(PolygonMesh& mesh, double depth) {
  constexpr uint32_t kCells = 16, kRow = kCells + 1;
  double low = 0;
  if (!mesh.positions.empty()) low = mesh.positions.front().z;
  for (const glm::dvec3& p : mesh.positions) low = std::min(low, p.z);
  const auto first = uint32_t(mesh.positions.size());
  LocalBrdf brdf;
  brdf.diffuse = glm::vec3(0.18f);
  for (uint32_t v = 0; v < kRow * kRow; ++v) {
    mesh.positions.push_back({glm::dvec2(v % kRow, v / kRow) / double(kCells), low - depth});
    mesh.normals.push_back({0, 0, 1});
    mesh.brdfs.push_back(brdf);
    if (!mesh.texture_points.empty()) mesh.texture_points.push_back({});
    if (!mesh.lines.empty()) mesh.lines.push_back(0);
  }
  const uint32_t last_number = mesh.numbers.empty() ? 0 : mesh.numbers.back();
  for (uint32_t j = 0; j < kCells; ++j)
    for (uint32_t i = 0; i < kCells; ++i) {
      const uint32_t a = first + j * kRow + i;
      mesh.corners.insert(mesh.corners.end(), {a, a + 1, a + kRow + 1, a + kRow});
      mesh.face_sizes.push_back(4);
      if (!mesh.numbers.empty()) mesh.numbers.push_back(last_number);
    }
}

// The file's parameters do not hold the ground: all are made.
Result<ParamOrigin> withGround(PolygonMesh& mesh, double depth, const MeshName& name) {
  addGround(mesh, depth / name.unit.z);
  mesh.uvs.clear();
  return makeParams(mesh, name);
}

}  // namespace

Result<ParamOrigin> giveParams(PolygonMesh& mesh, const TileOptions& options, const std::string& where) {
  const int subdivide = options.subdivide;
  MeshName name(where);
  name.numbers = mesh.numbers;
  if (!mesh.uvs.empty() && options.mesh_period.x == 0) {
    const auto along_u = periodAlong(mesh, 0), along_v = periodAlong(mesh, 1);
    if (along_u && along_v) {
      const auto lattice = latticeOf(*along_u, *along_v, where);
      if (!lattice) return lattice.issue();
      applyLattice(*lattice, mesh, name);
      if (subdivide == 0)  // a cage may cross itself where its limit does not
        if (const Status status = checkFolds(mesh, name); !status) return status.issue();
      if (const Status status = refine(mesh, subdivide, where); !status) return status.issue();
      if (options.ground) return withGround(mesh, *options.ground, name);
      return ParamOrigin::kLattice;
    }
  }
  if (const Status status = scaleToPeriod(mesh, options.mesh_period, name); !status) return status.issue();
  if (subdivide == 0 && !options.ground && !mesh.uvs.empty() && takeAtlas(mesh)) return ParamOrigin::kAtlas;
  if (subdivide > 0) {  // any texture coordinates do that repeat with the surface
    mesh.uvs.clear();
    for (const glm::dvec3& p : mesh.positions) mesh.uvs.push_back(glm::dvec2(p));
    if (const Status status = refine(mesh, subdivide, where); !status) return status.issue();
  }
  if (options.ground) return withGround(mesh, *options.ground, name);
  mesh.uvs.clear();
  return makeParams(mesh, name);
}

}  // namespace loden::importer
