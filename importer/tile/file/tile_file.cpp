// A tile from a mesh file: period, orientation, parameterization, charts.
#include <algorithm>
#include <cmath>

#include "importer/base/repair_log.h"
#include "importer/mesh/weld.h"
#include "importer/tile/charts.h"
#include "importer/tile/file/mesh_repair.h"
#include "importer/tile/file/tile_params.h"
#include "importer/tile/polygon_mesh.h"
#include "importer/tile/tile_tracer.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;

constexpr double kLeastGutter =
    1.0 / 32 -
    1.0 / 256;  // tile periods, as gutterOf counts; charts of files that lie closer are packed anew

Issue refuse(int id, const std::string& where, const std::string& why) {
  return {id, Severity::kError, where, why};
}

bool isFinite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool isFinite(const glm::dvec2& v) {
  return isFinite(glm::dvec3(v, 0));
}

// Nothing of vertex v but its normal, which can be made anew, fails to be finite.
bool isSound(const PolygonMesh& mesh, size_t v) {
  return isFinite(mesh.positions[v]) && (mesh.uvs.empty() || isFinite(mesh.uvs[v])) &&
         (mesh.texture_points.empty() || (isFinite(mesh.texture_points[v].base_color) &&
                                          isFinite(mesh.texture_points[v].metallic_roughness)));
}
bool isFinite(const LocalBrdf& b) {
  return isFinite(glm::dvec3(b.diffuse)) && isFinite(glm::dvec3(b.f0)) && std::isfinite(b.specular) &&
         std::isfinite(b.exponent) && std::isfinite(b.alpha);
}

struct BadVertices {
  size_t count = 0, first = 0;
};
BadVertices findNonFinite(const PolygonMesh& mesh) {
  BadVertices bad;
  for (size_t v = 0; v < mesh.positions.size(); ++v)
    if (!(isSound(mesh, v) && isFinite(mesh.normals[v]) && isFinite(mesh.brdfs[v])) && bad.count++ == 0)
      bad.first = v;
  return bad;
}

// Gives every unsound vertex the mean position and texture coordinates of its sound neighbours in faces,
// where its own are not finite, and the reflectance of one of them; in rounds from the border of a damaged
// area inwards. What has no neighbour stays as it is.
void moveUnsoundVertices(PolygonMesh& mesh) {
  for (bool moved = true; moved;) {
    moved = false;
    std::vector<glm::dvec3> position(mesh.positions.size(), glm::dvec3(0));
    std::vector<glm::dvec2> uv(mesh.positions.size(), glm::dvec2(0));
    std::vector<TexturePoint> on_pictures(mesh.texture_points.size());
    std::vector<int> neighbours(mesh.positions.size(), 0);
    const auto add = [&](uint32_t to, uint32_t from) {
      if (isSound(mesh, to) || !isSound(mesh, from)) return;
      position[to] += mesh.positions[from];
      if (!mesh.uvs.empty()) uv[to] += mesh.uvs[from];
      if (!on_pictures.empty()) {
        on_pictures[to].base_color += mesh.texture_points[from].base_color;
        on_pictures[to].metallic_roughness += mesh.texture_points[from].metallic_roughness;
      }
      if (!isFinite(mesh.brdfs[to])) mesh.brdfs[to] = mesh.brdfs[from];
      ++neighbours[to];
    };
    size_t first = 0;
    for (const int size : mesh.face_sizes) {
      for (int k = 0; k < size; ++k) {
        const uint32_t a = mesh.corners[first + size_t(k)], b = mesh.corners[first + size_t((k + 1) % size)];
        add(a, b), add(b, a);
      }
      first += size_t(size);
    }
    const auto repair = [](auto& value, const auto& sum, int count) {
      if (!isFinite(value)) value = sum / double(count);
    };
    for (size_t v = 0; v < neighbours.size(); ++v) {
      if (neighbours[v] == 0) continue;
      repair(mesh.positions[v], position[v], neighbours[v]);
      if (!mesh.uvs.empty()) repair(mesh.uvs[v], uv[v], neighbours[v]);
      if (!on_pictures.empty()) {
        repair(mesh.texture_points[v].base_color, on_pictures[v].base_color, neighbours[v]);
        repair(mesh.texture_points[v].metallic_roughness, on_pictures[v].metallic_roughness, neighbours[v]);
      }
      moved = true;
    }
  }
}

void repairNonFinite(PolygonMesh& mesh) {
  moveUnsoundVertices(mesh);
  for (glm::dvec3& normal : mesh.normals)
    if (!isFinite(normal)) normal = glm::dvec3(0);  // completeNormals makes it
  for (LocalBrdf& brdf : mesh.brdfs)
    if (!isFinite(brdf)) brdf = LocalBrdf();
}

std::string vertexName(const PolygonMesh& mesh, size_t v) {
  return mesh.lines.empty() ? "vertex " + std::to_string(v)
                            : "the vertex of line " + std::to_string(mesh.lines[v]);
}

Status makeFinite(PolygonMesh& mesh, const std::string& where, RepairLog* repairs) {
  BadVertices bad = findNonFinite(mesh);
  if (bad.count == 0) return {};
  if (repairs) {
    repairs->add(where, bad.count, vertexName(mesh, bad.first));
    repairNonFinite(mesh);
    bad = findNonFinite(mesh);
    if (bad.count == 0) return {};
  }
  return refuse(issue_id::kTileNonFinite, where + ": " + vertexName(mesh, bad.first),
                std::to_string(bad.count) + " of " + std::to_string(mesh.positions.size()) +
                    " vertices hold values that are not finite" +
                    (repairs ? " and have no neighbour to repair them from"
                             : "; repair the mesh, or let --fix-nonfinite do it"));
}

void makeUnit(std::vector<glm::dvec3>& normals) {
  for (glm::dvec3& normal : normals)
    if (const double length = glm::length(normal); length > 0) normal /= length;
}

// Area-weighted over the triangles around each point of the periodic surface, for vertices that have none, or
// the mean of two that cancel.
void completeNormals(Tile& tile) {
  const auto same = weldVertices(tile.positions, {1, 1, 0}, 1e-6);
  const glm::dvec3 per_length = tile.perLength();
  std::vector<glm::dvec3> sum(tile.positions.size(), glm::dvec3(0));
  for (const glm::uvec3& t : tile.triangles) {
    const glm::dvec3 face = per_length * glm::cross(tile.positions[t.y] - tile.positions[t.x],
                                                    tile.positions[t.z] - tile.positions[t.x]);
    for (int k = 0; k < 3; ++k) sum[same[t[k]]] += face;
  }
  for (size_t v = 0; v < tile.normals.size(); ++v) {
    if (glm::length(tile.normals[v]) < 0.1) tile.normals[v] = sum[same[v]];
    const double length = glm::length(tile.normals[v]);
    tile.normals[v] = length > 0 ? tile.normals[v] / length : glm::dvec3(0, 0, 1);
  }
}

// Seen from above, most of the surface shows its front. (Closed pieces face up as much as down.)
bool showsItsFront(const Tile& tile) {
  constexpr int kRays = 24;  // per side, off the edges of regular meshes
  const TileTracer tracer(tile);
  int fronts = 0;
  for (int k = 0; k < kRays * kRays; ++k) {
    const glm::dvec2 x = (glm::dvec2(k % kRays, k / kRays) + glm::dvec2(0.513, 0.478)) / double(kRays);
    const auto hit = tracer.intersectView(x, {0, 0, 1});
    if (!hit) continue;
    const glm::uvec3& t = tile.triangles[hit->triangle];
    fronts +=
        glm::cross(tile.positions[t.y] - tile.positions[t.x], tile.positions[t.z] - tile.positions[t.x]).z > 0
            ? 1
            : -1;
  }
  return fronts > 0;
}

// Authored normals that point into most of the surface would leave it black.
Status checkNormals(const Tile& tile, const std::string& where) {
  size_t against = 0;
  for (const glm::uvec3& t : tile.triangles) {
    const glm::dvec3 front = tile.perLength() * glm::cross(tile.positions[t.y] - tile.positions[t.x],
                                                           tile.positions[t.z] - tile.positions[t.x]);
    against += glm::dot(front, tile.normals[t.x] + tile.normals[t.y] + tile.normals[t.z]) < 0;
  }
  if (2 * against <= tile.triangles.size()) return {};
  return refuse(
      issue_id::kTileGeometry, where,
      "the normals of " + std::to_string(against) + " of " + std::to_string(tile.triangles.size()) +
          " triangles point to their backs; turn the normals over, or leave them out, and they are computed");
}

// Facing up on the whole, and whether P.xy is p itself.
Status orient(Tile& tile, const std::string& where) {
  double deviation = 0;
  if (!showsItsFront(tile))
    return refuse(issue_id::kTileGeometry, where,
                  "the surface faces down on the whole; turn it over, or reverse its triangles");
  if (const Status status = checkNormals(tile, where); !status) return status;
  for (size_t v = 0; v < tile.positions.size(); ++v) {
    const glm::dvec2 d = glm::abs(glm::dvec2(tile.positions[v]) - tile.params[v]);
    deviation = std::max({deviation, d.x, d.y});
  }
  tile.identity_parameterization = deviation < 1e-6;
  if (tile.identity_parameterization)
    for (size_t v = 0; v < tile.positions.size(); ++v)
      tile.positions[v] = {tile.params[v], tile.positions[v].z};
  return {};
}

Result<PolygonMesh> readMesh(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (extension == ".gltf" || extension == ".glb") return readGltfMesh(path);
  if (extension == ".obj") return readObjMesh(path);
  return refuse(issue_id::kOption, path.string(), "is neither builtin:NAME nor a .gltf, .glb or .obj file");
}

Result<Tile> tileFromFile(const fs::path& path, const TileOptions& options) {
  const std::string where = path.string();
  auto mesh = readMesh(path);
  if (!mesh) return mesh.issue();
  if (mesh->face_sizes.empty())
    return refuse(issue_id::kTileGeometry, where, "no faces; a tile needs a surface");
  if (const Status status = makeFinite(*mesh, where, options.repairs.get()); !status) return status.issue();
  makeUnit(mesh->normals);
  if (options.subdivide == 0)  // OpenSubdiv judges cages itself
    if (const Status status = repairMesh(*mesh, where); !status) return status.issue();
  if (mesh->face_sizes.empty())
    return refuse(issue_id::kTileGeometry, where, "all triangles are degenerate: their corners lie on lines");
  const auto origin = giveParams(*mesh, options, where);
  if (!origin) return origin.issue();
  Tile tile;
  tile.name = path.stem().string();
  tile.aspect = mesh->aspect;
  tile.triangles = triangulate(*mesh);
  tile.positions = std::move(mesh->positions);
  tile.normals = std::move(mesh->normals);
  tile.params = std::move(mesh->uvs);
  tile.brdfs = std::move(mesh->brdfs);
  tile.materials = std::move(mesh->materials);
  tile.texture_points = std::move(mesh->texture_points);
  tile.warnings = std::move(mesh->warnings);
  completeNormals(tile);
  tile.charts = findCharts(tile);
  // Own charts lie on one another as yet; the vertices of a file's may be shared.
  if (*origin == ParamOrigin::kCharts) tile.charts = std::move(mesh->charts);
  if (*origin == ParamOrigin::kCharts || (*origin == ParamOrigin::kAtlas && gutterOf(tile) < kLeastGutter))
    packCharts(tile);
  auto finished = finishTile(std::move(tile), where);
  if (!finished) return finished;
  if (const Status status = orient(*finished, where); !status) return status.issue();
  return finished;
}

}  // namespace

Result<Tile> loadTile(const std::string& name_or_path, const TileOptions& options) {
  constexpr std::string_view kBuiltin = "builtin:";
  if (!name_or_path.starts_with(kBuiltin)) return tileFromFile(name_or_path, options);
  if (options.subdivide > 0)
    return refuse(issue_id::kOption, "subdivide", "is for cages from files; builtin tiles are fine already");
  if (options.mesh_period.x > 0 || options.ground)
    return refuse(issue_id::kOption, options.ground ? "ground" : "mesh_period",
                  "is for meshes from files; builtin tiles have what they need");
  return builtinTile(name_or_path.substr(kBuiltin.size()));
}

}  // namespace loden::importer
