// A tile from a mesh file: period, orientation, parameterization, charts.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "importer/charts.h"
#include "importer/parameterize.h"
#include "importer/tile_internal.h"
#include "importer/weld.h"
#include "material/issues.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;

constexpr double kMatch = 1e-4;  // tolerance of matching borders, periods and texture coordinates

Issue refuse(int id, const std::string& where, const std::string& why) { return {id, Severity::kError, where, why}; }

Status checkFinite(const PolygonMesh& mesh, const std::string& where) {
  size_t bad = 0, first = 0;
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const double sum = mesh.positions[v].x + mesh.positions[v].y + mesh.positions[v].z +
                       (mesh.uvs.empty() ? 0.0 : mesh.uvs[v].x + mesh.uvs[v].y) + mesh.normals[v].x + mesh.normals[v].y + mesh.normals[v].z;
    if (!std::isfinite(sum) && bad++ == 0) first = v;
  }
  if (bad == 0) return {};
  return refuse(issue_id::kTileNonFinite, where + ": vertex " + std::to_string(first),
                std::to_string(bad) + " of " + std::to_string(mesh.positions.size()) + " vertices hold values that are not finite; repair the mesh");
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
  double period = 1;  // of the file's units
  bool swap = false;
  glm::dvec2 flip{1, 1};
};

Result<Lattice> findLattice(const PolygonMesh& mesh, const std::string& where) {
  const auto along_u = periodAlong(mesh, 0), along_v = periodAlong(mesh, 1);
  if (!along_u || !along_v)
    return refuse(issue_id::kTileUv, where, std::string("the borders at ") + (along_u ? "v" : "u") +
                      " = 0 and 1 do not match: every vertex on one needs its counterpart on the other, one period of texture coordinates and of space apart");
  Lattice lattice;
  lattice.swap = std::abs(along_u->x) < std::abs(along_u->y);
  const glm::dvec3 x = lattice.swap ? *along_v : *along_u, y = lattice.swap ? *along_u : *along_v;
  lattice.period = std::abs(x.x);
  lattice.flip = glm::sign(glm::dvec2(x.x, y.y));
  const double off = std::max({std::abs(x.y), std::abs(x.z), std::abs(y.x), std::abs(y.z)});
  if (lattice.period == 0 || off > 10 * kMatch * lattice.period)
    return refuse(issue_id::kTileUv, where, "u and v do not run along the tile's sides: the tile must lie flat (xz plane in glTF, xy plane in OBJ) with its sides along the axes");
  if (std::abs(std::abs(y.y) - lattice.period) > 10 * kMatch * lattice.period)
    return refuse(issue_id::kTileGeometry, where, "the period is not square (" + std::to_string(lattice.period) + " x " + std::to_string(std::abs(y.y)) + "); repeat or scale the tile until it is");
  return lattice;
}

// Period 1, parameters along x and y, the surface centred over its parameters.
void applyLattice(const Lattice& lattice, PolygonMesh& mesh) {
  glm::dvec2 centre(0);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    mesh.positions[v] /= lattice.period;
    if (lattice.swap) std::swap(mesh.uvs[v].x, mesh.uvs[v].y);
    mesh.uvs[v] *= lattice.flip;
    centre += (glm::dvec2(mesh.positions[v]) - mesh.uvs[v]) / double(mesh.positions.size());
  }
  for (glm::dvec3& position : mesh.positions) position -= glm::dvec3(centre, 0);
}

std::vector<glm::uvec3> triangulate(const PolygonMesh& mesh) {
  std::vector<glm::uvec3> triangles;
  size_t first = 0;
  for (const int size : mesh.face_sizes) {
    for (size_t k = 2; k < size_t(size); ++k) triangles.push_back({mesh.corners[first], mesh.corners[first + k - 1], mesh.corners[first + k]});
    first += size_t(size);
  }
  return triangles;
}

// Texture coordinates for a mesh without any, as the file would have had them.
Status makeUvs(PolygonMesh& mesh, const std::string& where) {
  const auto triangles = triangulate(mesh);
  const auto period = findPeriod(mesh.positions, triangles, where);
  if (!period) return period.issue();
  std::vector<glm::dvec3> positions;
  for (const glm::dvec3& p : mesh.positions) positions.push_back(p / glm::dvec3(*period, period->x));
  auto made = parameterizeTorus(positions, triangles, where);
  if (!made) return made.issue();
  mesh.uvs = std::move(made->params);
  return {};
}

// Area-weighted over the triangles around each point of the periodic surface, for vertices that have none.
void completeNormals(Tile& tile) {
  const auto same = weldVertices(tile.positions, {1, 1, 0}, 1e-6);
  std::vector<glm::dvec3> sum(tile.positions.size(), glm::dvec3(0));
  for (const glm::uvec3& t : tile.triangles) {
    const glm::dvec3 face = glm::cross(tile.positions[t.y] - tile.positions[t.x], tile.positions[t.z] - tile.positions[t.x]);
    for (int k = 0; k < 3; ++k) sum[same[t[k]]] += face;
  }
  for (size_t v = 0; v < tile.normals.size(); ++v) {
    if (glm::length(tile.normals[v]) < 0.1) tile.normals[v] = sum[same[v]];
    const double length = glm::length(tile.normals[v]);
    tile.normals[v] = length > 0 ? tile.normals[v] / length : glm::dvec3(0, 0, 1);
  }
}

// Facing up on the whole, and whether P.xy is p itself.
Status orient(Tile& tile, const std::string& where) {
  double up = 0, deviation = 0;
  for (const glm::uvec3& t : tile.triangles)
    up += glm::cross(tile.positions[t.y] - tile.positions[t.x], tile.positions[t.z] - tile.positions[t.x]).z;
  if (up <= 0) return refuse(issue_id::kTileGeometry, where, "the surface faces down on the whole; turn it over, or reverse its triangles");
  for (size_t v = 0; v < tile.positions.size(); ++v) {
    const glm::dvec2 d = glm::abs(glm::dvec2(tile.positions[v]) - tile.params[v]);
    deviation = std::max({deviation, d.x, d.y});
  }
  tile.identity_parameterization = deviation < 1e-6;
  if (tile.identity_parameterization)
    for (size_t v = 0; v < tile.positions.size(); ++v) tile.positions[v] = {tile.params[v], tile.positions[v].z};
  return {};
}

Result<PolygonMesh> readMesh(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return std::tolower(c); });
  if (extension == ".gltf" || extension == ".glb") return readGltfMesh(path);
  if (extension == ".obj") return readObjMesh(path);
  return refuse(issue_id::kOption, path.string(), "is neither builtin:NAME nor a .gltf, .glb or .obj file");
}

Result<Tile> tileFromFile(const fs::path& path, const TileOptions& options) {
  const std::string where = path.string();
  auto mesh = readMesh(path);
  if (!mesh) return mesh.issue();
  if (mesh->face_sizes.empty()) return refuse(issue_id::kTileGeometry, where, "no faces; a tile needs a surface");
  if (const Status status = checkFinite(*mesh, where); !status) return status.issue();
  if (mesh->uvs.empty())
    if (const Status status = makeUvs(*mesh, where); !status) return status.issue();
  const auto lattice = findLattice(*mesh, where);
  if (!lattice) return lattice.issue();
  applyLattice(*lattice, *mesh);
  if (options.subdivide > 0) {
    auto refined = subdivideMesh(*mesh, {1, 1}, options.subdivide, where);
    if (!refined) return refined.issue();
    *mesh = std::move(*refined);
  }
  Tile tile;
  tile.name = path.stem().string();
  tile.triangles = triangulate(*mesh);
  tile.positions = std::move(mesh->positions);
  tile.normals = std::move(mesh->normals);
  tile.params = std::move(mesh->uvs);
  tile.brdfs = std::move(mesh->brdfs);
  completeNormals(tile);
  tile.charts = findCharts(tile);
  if (const Status status = orient(tile, where); !status) return status.issue();
  return finishTile(std::move(tile), where);
}

}  // namespace

Result<Tile> loadTile(const std::string& name_or_path, const TileOptions& options) {
  constexpr std::string_view kBuiltin = "builtin:";
  if (!name_or_path.starts_with(kBuiltin)) return tileFromFile(name_or_path, options);
  if (options.subdivide > 0) return refuse(issue_id::kOption, "--subdivide", "is for cages from files; builtin tiles are fine already");
  return builtinTile(name_or_path.substr(kBuiltin.size()));
}

}  // namespace loden::importer
