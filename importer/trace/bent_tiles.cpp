#include "importer/trace/bent_tiles.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "importer/tile/textured_brdf.h"
#include "material/base/check.h"
#include "material/model/directions.h"

namespace loden::importer {
namespace {

constexpr double kLift = 1e-6;  // of ray origins, metres: 10 times the rounding of a float at 1 m

glm::dvec3 bentPosition(const AnalyticSurface& surface, const glm::dvec3& tile_position, int row) {
  const glm::dvec2 st = (glm::dvec2(tile_position) + glm::dvec2(0, row)) / surface.tiles;
  // What a tile lets hang over a pole stays at the pole.
  const double t = surface.kind == SurfaceKind::kSphere ? std::clamp(st.y, 0.0, 1.0) : st.y;
  const SurfaceFrame frame = surfaceFrame(surface, {st.x, t});
  return frame.position + tile_position.z * AnalyticSurface::kTilePeriod * frame.normal;
}

// Normals follow the inverse transpose of the bending's Jacobian, taken by central differences. At a pole,
// where all of s is one point, it has none, and near it the slightest tilt along s, were it the rounding of a
// file's normal, would grow without bound: there normals are bent as at a distance.
glm::dvec3 bentNormal(const AnalyticSurface& surface, const glm::dvec3& position, const glm::dvec3& normal,
                      int row) {
  constexpr double kStep = 1e-5, kFromPole = 0.02;  // tile periods
  glm::dvec3 at = position;
  if (surface.kind == SurfaceKind::kSphere)
    at.y = std::clamp(at.y + row, kFromPole, surface.tiles.y - kFromPole) - row;
  glm::dmat3 jacobian;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0);
    step[axis] = kStep;
    jacobian[axis] = bentPosition(surface, at + step, row) - bentPosition(surface, at - step, row);
  }
  // The transposed cofactor matrix: the inverse transpose without its division, fit for the poles.
  const glm::dmat3 cofactor(glm::cross(jacobian[1], jacobian[2]), glm::cross(jacobian[2], jacobian[0]),
                            glm::cross(jacobian[0], jacobian[1]));
  const glm::dvec3 bent = cofactor * normal;
  const double length = glm::length(bent);
  return length > 0 ? bent / length : normal;
}

}  // namespace

struct BentTiles::Impl {
  struct Row {
    std::vector<glm::vec3> positions, normals;  // per vertex of the tile
    std::vector<glm::uvec3> triangles;
  };
  std::vector<LocalBrdf> brdfs;
  std::vector<TileMaterial> materials;
  std::vector<TexturePoint> texture_points;
  std::vector<glm::dvec3> flat_positions;  // before bending
  std::vector<Row> rows;
  std::vector<glm::dmat3> rotations;  // per column, world from the first column
  RTCDevice device = rtcNewDevice("isa=avx2");
  RTCScene column = nullptr, scene = nullptr;

  ~Impl() {
    rtcReleaseScene(scene);
    rtcReleaseScene(column);
    rtcReleaseDevice(device);
  }
  void bendRows(const Tile& tile, const AnalyticSurface& surface);
  void buildColumn();
  void buildScene(int columns);
  BentHit hitOf(const RTCRayHit& ray) const;
};

void BentTiles::Impl::bendRows(const Tile& tile, const AnalyticSurface& surface) {
  // A tile may stand in any period, and hang over its borders: each row has those of its triangles that lie
  // within the surface's rows; at an end by their centres, at a pole, which closes the surface, by any
  // corner.
  struct Span {
    double low, high;
  };
  const auto spanOf = [&](const glm::uvec3& t) -> Span {
    const double a = tile.positions[t.x].y, b = tile.positions[t.y].y, c = tile.positions[t.z].y;
    if (surface.kind == SurfaceKind::kSphere) return {std::min({a, b, c}), std::max({a, b, c})};
    return {(a + b + c) / 3, (a + b + c) / 3};
  };
  double low = std::numeric_limits<double>::max(), high = -low;
  for (const glm::uvec3& t : tile.triangles)
    low = std::min(low, spanOf(t).low), high = std::max(high, spanOf(t).high);
  const int first = static_cast<int>(std::floor(-high)),
            last = static_cast<int>(std::ceil(surface.tiles.y - low));
  for (int r = first; r <= last; ++r) {
    Row row;
    for (const glm::uvec3& t : tile.triangles)
      if (spanOf(t).high + r > 0 && spanOf(t).low + r < surface.tiles.y) row.triangles.push_back(t);
    if (row.triangles.empty()) continue;
    for (size_t v = 0; v < tile.positions.size(); ++v) {
      row.positions.emplace_back(bentPosition(surface, tile.positions[v], r));
      row.normals.emplace_back(bentNormal(surface, tile.positions[v], tile.normals[v] / tile.perLength(), r));
    }
    rows.push_back(std::move(row));
  }
}

void BentTiles::Impl::buildColumn() {
  column = rtcNewScene(device);
  rtcSetSceneFlags(column, RTC_SCENE_FLAG_ROBUST);
  for (size_t r = 0; r < rows.size(); ++r) {
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(glm::vec3), rows[r].positions.size());
    std::copy(rows[r].positions.begin(), rows[r].positions.end(), static_cast<glm::vec3*>(vertices));
    const auto& triangles = rows[r].triangles;
    void* indices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(glm::uvec3), triangles.size());
    std::copy(triangles.begin(), triangles.end(), static_cast<glm::uvec3*>(indices));
    rtcCommitGeometry(mesh);
    rtcAttachGeometryByID(column, mesh, static_cast<unsigned>(r));
    rtcReleaseGeometry(mesh);
  }
  rtcCommitScene(column);
}

void BentTiles::Impl::buildScene(int columns) {
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  for (int c = 0; c < columns; ++c) {
    const double angle = 2 * kPi * c / columns, cosine = std::cos(angle), sine = std::sin(angle);
    rotations.emplace_back(cosine, sine, 0, -sine, cosine, 0, 0, 0, 1);
    std::array<float, 12> transform{};  // column-major 3 x 4
    for (int i = 0; i < 9; ++i) transform[i] = static_cast<float>(rotations.back()[i / 3][i % 3]);
    RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, column);
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
    rtcCommitGeometry(instance);
    rtcAttachGeometryByID(scene, instance, static_cast<unsigned>(c));
    rtcReleaseGeometry(instance);
  }
  rtcCommitScene(scene);
}

BentHit BentTiles::Impl::hitOf(const RTCRayHit& ray) const {
  const Row& row = rows[ray.hit.geomID];
  const glm::uvec3 triangle = row.triangles[ray.hit.primID];
  const double b[3] = {1.0 - ray.hit.u - ray.hit.v, ray.hit.u, ray.hit.v};
  glm::dvec3 position(0), tile_position(0), normal(0), lift(0), diffuse(0), f0(0);
  double specular = 0, exponent = 0, alpha = 0;
  for (int k = 0; k < 3; ++k) {
    const LocalBrdf& brdf = brdfs[triangle[k]];
    position += b[k] * glm::dvec3(row.positions[triangle[k]]);
    tile_position += b[k] * flat_positions[triangle[k]];
    normal += b[k] * glm::dvec3(row.normals[triangle[k]]);
    diffuse += b[k] * glm::dvec3(brdf.diffuse);
    specular += b[k] * brdf.specular;
    exponent += b[k] * brdf.exponent;
    f0 += b[k] * glm::dvec3(brdf.f0);
    alpha += b[k] * brdf.alpha;
  }
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 vertex_normal(row.normals[triangle[k]]);
    lift -= b[k] * std::min(0.0, glm::dot(position - glm::dvec3(row.positions[triangle[k]]), vertex_normal)) *
            vertex_normal;
  }
  const glm::dvec3 edge1(row.positions[triangle.y] - row.positions[triangle.x]);
  const glm::dvec3 edge2(row.positions[triangle.z] - row.positions[triangle.x]);
  const glm::dvec3 geometric = glm::normalize(glm::cross(edge1, edge2));
  const glm::dmat3& rotation = rotations[ray.hit.instID[0]];
  BentHit hit;
  hit.normal = rotation * glm::normalize(normal);
  hit.geometric_normal = rotation * geometric;
  hit.ray_origin = rotation * (position + lift + kLift * geometric);
  hit.tile_position = tile_position;
  hit.brdf = {glm::vec3(diffuse), static_cast<float>(specular), static_cast<float>(exponent), glm::vec3(f0),
              static_cast<float>(alpha)};
  if (!texture_points.empty()) readTextures(materials, texture_points, triangle, {b[1], b[2]}, hit.brdf);
  return hit;
}

BentTiles::BentTiles(const Tile& tile, const AnalyticSurface& surface) : impl_(std::make_unique<Impl>()) {
  LODEN_CHECK(impl_->device != nullptr);
  impl_->brdfs = tile.brdfs;
  impl_->materials = tile.materials;
  impl_->texture_points = tile.texture_points;
  impl_->flat_positions = tile.positions;
  impl_->bendRows(tile, surface);
  impl_->buildColumn();
  impl_->buildScene(static_cast<int>(surface.tiles.x));
}

BentTiles::~BentTiles() = default;

namespace {

RTCRay rayFrom(const glm::dvec3& origin, const glm::dvec3& direction) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x), ray.org_y = static_cast<float>(origin.y),
  ray.org_z = static_cast<float>(origin.z);
  ray.dir_x = static_cast<float>(direction.x), ray.dir_y = static_cast<float>(direction.y),
  ray.dir_z = static_cast<float>(direction.z);
  ray.tfar = std::numeric_limits<float>::infinity();
  ray.mask = ~0u;
  return ray;
}

}  // namespace

std::optional<BentHit> BentTiles::intersect(const glm::dvec3& origin, const glm::dvec3& direction) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit ray{};
  ray.ray = rayFrom(origin, direction);
  ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return impl_->hitOf(ray);
}

bool BentTiles::occluded(const glm::dvec3& origin, const glm::dvec3& direction) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = rayFrom(origin, direction);
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar < 0;
}

}  // namespace loden::importer
