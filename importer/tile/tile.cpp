#include "importer/tile/tile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "importer/mesh/weld.h"
#include "importer/tile/polygon_mesh.h"
#include "material/base/issues.h"
#include "material/model/geometry_image.h"

namespace loden::importer {
namespace {

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool finite(const glm::dvec2& v) {
  return std::isfinite(v.x) && std::isfinite(v.y);
}

bool finiteVertex(const Tile& tile, size_t v) {
  const LocalBrdf& brdf = tile.brdfs[v];
  return finite(tile.positions[v]) && finite(tile.normals[v]) && finite(tile.params[v]) &&
         finite(glm::dvec3(brdf.diffuse)) && std::isfinite(brdf.specular) && std::isfinite(brdf.exponent) &&
         finite(glm::dvec3(brdf.f0)) && std::isfinite(brdf.alpha) &&
         (tile.texture_points.empty() ||
          (finite(tile.texture_points[v].base_color) && finite(tile.texture_points[v].metallic_roughness)));
}

Status checkFinite(const Tile& tile, const std::string& where) {
  size_t bad = 0, first = 0;
  for (size_t v = 0; v < tile.positions.size(); ++v)
    if (!finiteVertex(tile, v) && bad++ == 0) first = v;
  if (bad == 0) return {};
  return Issue{issue_id::kTileNonFinite, Severity::kError, where + ": vertex " + std::to_string(first),
               std::to_string(bad) + " of " + std::to_string(tile.positions.size()) +
                   " vertices hold values that are not finite; repair the mesh"};
}

Status checkIndices(const Tile& tile, const std::string& where) {
  if (tile.triangles.empty())
    return Issue{issue_id::kTileGeometry, Severity::kError, where, "no triangles; a tile needs a surface"};
  for (size_t t = 0; t < tile.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (tile.triangles[t][k] >= tile.positions.size())
        return Issue{issue_id::kTileGeometry, Severity::kError, where + ": triangle " + std::to_string(t),
                     "vertex " + std::to_string(tile.triangles[t][k]) + " does not exist"};
  return {};
}

// Without triangles that have no area or repeat an earlier one: they hold no surface, and no normal.
void dropEmptyTriangles(Tile& tile) {
  const auto same = weldVertices(tile.positions, glm::dvec3(0), 1e-9);
  std::set<std::array<uint32_t, 3>> seen;
  size_t kept = 0;
  for (size_t t = 0; t < tile.triangles.size(); ++t) {
    const glm::uvec3& v = tile.triangles[t];
    const glm::dvec3 a = tile.positions[v.x], b = tile.positions[v.y], c = tile.positions[v.z];
    if (glm::length(glm::cross(b - a, c - a)) < 1e-16) continue;
    std::array<uint32_t, 3> corners{same[v.x], same[v.y], same[v.z]};
    std::sort(corners.begin(), corners.end());
    if (!seen.insert(corners).second) continue;
    tile.charts[kept] = tile.charts[t];
    tile.triangles[kept++] = v;
  }
  tile.triangles.resize(kept);
  tile.charts.resize(kept);
}

// Without vertices of no triangle: where they lie means nothing.
void dropUnusedVertices(Tile& tile) {
  std::vector<uint8_t> used(tile.positions.size(), 0);
  for (const glm::uvec3& t : tile.triangles)
    for (int k = 0; k < 3; ++k) used[t[k]] = 1;
  std::vector<uint32_t> vertex_of(used.size());
  uint32_t kept = 0;
  for (size_t v = 0; v < used.size(); ++v)
    if (used[v]) vertex_of[v] = kept++;
  const auto compact = [&](auto& stream) {
    if (stream.empty()) return;
    for (size_t v = 0; v < used.size(); ++v)
      if (used[v]) stream[vertex_of[v]] = stream[v];
    stream.resize(kept);
  };
  compact(tile.positions), compact(tile.normals), compact(tile.params), compact(tile.brdfs);
  compact(tile.texture_points);
  for (glm::uvec3& t : tile.triangles)
    for (int k = 0; k < 3; ++k) t[k] = vertex_of[t[k]];
}

}  // namespace

glm::dvec3 Tile::perLength() const {
  return {periodsPerLength(aspect), 1};
}

Result<Tile> finishTile(Tile tile, const std::string& where) {
  if (const Status status = checkFinite(tile, where); !status) return status.issue();
  if (const Status status = checkIndices(tile, where); !status) return status.issue();
  dropEmptyTriangles(tile);
  if (tile.triangles.empty())
    return Issue{issue_id::kTileGeometry, Severity::kError, where,
                 "all triangles are degenerate: their corners lie on lines"};
  dropUnusedVertices(tile);
  double top = tile.positions[0].z;
  for (const glm::dvec3& position : tile.positions) top = std::max(top, position.z);
  for (glm::dvec3& position : tile.positions) position.z -= top;
  return tile;
}

}  // namespace loden::importer
