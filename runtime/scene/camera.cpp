#include "runtime/scene/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "material/base/check.h"
#include "material/model/directions.h"

namespace loden::runtime {
namespace {

// Distance of a point to a box; 0 inside.
float distanceTo(const Bounds& box, const glm::vec3& point) {
  return glm::length(point - glm::clamp(point, box.min, box.max));
}

// x as a function of a triangle's plane.
struct TriangleUvs {
  float most = 0, least = 0;  // singular values: tile periods per metre
  float area = 0;             // square metres
  // What a square pixel's footprint is judged by.
  float density() const { return std::max(least, 0.5f * most); }
};

// `x_of` returns x at the vertex of that index.
template <class XOf>
TriangleUvs triangleUvs(const Mesh& mesh, size_t first_index, const XOf& x_of, const glm::mat3& linear) {
  const auto index = [&](size_t k) { return mesh.indices[first_index + k]; };
  const auto position = [&](size_t k) { return mesh.vertices[index(k)].position; };
  const glm::vec3 e1 = linear * (position(1) - position(0)), e2 = linear * (position(2) - position(0));
  const glm::vec2 d1 = x_of(index(1)) - x_of(index(0)), d2 = x_of(index(2)) - x_of(index(0));
  const float area2 = glm::length(glm::cross(e1, e2)), length1 = glm::length(e1);
  if (!(area2 > 1e-20f) || !(length1 > 0)) return {};
  // Orthonormal frame of the plane with e1 along its first axis: e1 = (a, 0), e2 = (b, c).
  const float a = length1, b = glm::dot(e1, e2) / a, c = area2 / a;
  const glm::vec2 column1 = d1 / a, column2 = (d2 - column1 * b) / c;
  const float sum = glm::dot(column1, column1) + glm::dot(column2, column2);
  const float det = column1.x * column2.y - column2.x * column1.y;
  const float root = std::sqrt(std::max(sum * sum - 4 * det * det, 0.0f));
  return {std::sqrt(0.5f * (sum + root)), std::sqrt(std::max(0.5f * (sum - root), 0.0f)), 0.5f * area2};
}

// Tile coordinates, but for their rotation.
auto tileCoordinates(const Mesh& mesh, const FlatBtfBinding& binding) {
  return [&](uint32_t index) { return mesh.vertices[index].uv * binding.scale; };
}

// The density that only 2 % of the area falls below; `fallback` if there are no triangles.
float densityOfNearlyAll(std::vector<TriangleUvs>& triangles, float fallback) {
  float total = 0, below = 0;
  for (const TriangleUvs& uvs : triangles) total += uvs.area;
  std::sort(triangles.begin(), triangles.end(),
            [](const TriangleUvs& a, const TriangleUvs& b) { return a.density() < b.density(); });
  for (const TriangleUvs& uvs : triangles)
    if ((below += uvs.area) >= 0.02f * total) return uvs.density();
  return fallback;
}

glm::dvec3 hermite(const glm::dvec3& p0, const glm::dvec3& m0, const glm::dvec3& p1, const glm::dvec3& m1,
                   double u) {
  const double u2 = u * u, u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * p0 + (u3 - 2 * u2 + u) * m0 + (3 * u2 - 2 * u3) * p1 + (u3 - u2) * m1;
}

}  // namespace

View makeView(const Camera& camera, glm::ivec2 size, DepthRange depth) {
  const double fov = camera.fov_degrees * kPi / 180, aspect = double(size.x) / size.y;
  const glm::dmat4 clip_from_camera = glm::perspective(fov, aspect, depth.near_plane, depth.far_plane);
  const glm::dmat4 camera_from_world = glm::lookAt(camera.position, camera.target, camera.up);
  const double tangent = std::tan(fov / 2);
  View view;
  view.clip_from_world = glm::mat4(clip_from_camera * camera_from_world);
  view.position = glm::vec3(camera.position);
  view.size = size;
  view.pixel_angle = static_cast<float>(2 * tangent / size.y);
  view.edge_cosine = static_cast<float>(1 / std::sqrt(1 + tangent * tangent * (1 + aspect * aspect)));
  return view;
}

View partOf(const View& view, glm::ivec2 from, glm::ivec2 to) {
  return partOf(view, from, to, to - from);
}

View partOf(const View& view, glm::ivec2 from, glm::ivec2 to, glm::ivec2 size) {
  const glm::dvec2 whole(view.size), extent(to - from);
  const glm::dvec2 scale = whole / extent, middle = (glm::dvec2(from) + 0.5 * extent) / whole * 2.0 - 1.0;
  const glm::dmat4 part =
      glm::scale(glm::dmat4(1), glm::dvec3(scale, 1)) * glm::translate(glm::dmat4(1), glm::dvec3(-middle, 0));
  View result = view;
  result.clip_from_world = glm::mat4(part * glm::dmat4(view.clip_from_world));
  result.size = size;
  result.pixel_angle = view.pixel_angle * static_cast<float>(extent.y / size.y);
  return result;
}

Camera cameraFromScene(const SceneCamera& camera) {
  const glm::dmat4 m(camera.world_from_camera);
  Camera result;
  result.position = glm::dvec3(m[3]);
  result.target = result.position - glm::normalize(glm::dvec3(m[2]));
  result.up = glm::normalize(glm::dvec3(m[1]));
  result.fov_degrees = camera.fov_y * 180 / kPi;
  return result;
}

Frustum frustumOf(const glm::mat4& clip_from_world) {
  const glm::mat4 rows = glm::transpose(clip_from_world);
  Frustum frustum{rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1],
                  rows[3] - rows[1], rows[3] + rows[2], rows[3] - rows[2]};
  for (glm::vec4& plane : frustum) plane /= glm::length(glm::vec3(plane));
  return frustum;
}

bool intersects(const Frustum& frustum, const Bounds& world) {
  return std::all_of(frustum.begin(), frustum.end(), [&](const glm::vec4& plane) {
    const glm::vec3 n(plane);
    const glm::vec3 farthest = glm::mix(world.min, world.max, glm::vec3(glm::greaterThan(n, glm::vec3(0))));
    return glm::dot(n, farthest) + plane.w >= 0;
  });
}

FacingCone facingCone(const Mesh& mesh, const glm::mat4& world_from_local) {
  const glm::mat3 linear(world_from_local);
  const float side = glm::determinant(linear) < 0 ? -1.0f : 1.0f;  // mirrored meshes show their other winding
  std::vector<glm::vec3> normals;
  glm::vec3 sum(0);
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const auto corner = [&](size_t k) { return mesh.vertices[mesh.indices[i + k]].position; };
    const glm::vec3 normal =
        side * glm::cross(linear * (corner(1) - corner(0)), linear * (corner(2) - corner(0)));
    const float length = glm::length(normal);
    if (!(length > 1e-20f)) continue;
    normals.push_back(normal / length);
    sum += normal;
  }
  FacingCone cone;
  if (!(glm::length(sum) > 1e-12f)) return cone;
  cone.axis = glm::normalize(sum);
  cone.angle = 0;
  for (const glm::vec3& normal : normals)
    cone.angle = std::max(cone.angle, std::acos(std::clamp(glm::dot(normal, cone.axis), -1.0f, 1.0f)));
  return cone;
}

bool facesAway(const FacingCone& cone, const Bounds& world, const glm::vec3& eye) {
  const glm::vec3 to_eye = eye - world.centre();
  const float distance = glm::length(to_eye), radius = world.radius();
  if (!(distance > radius)) return false;
  // Seen from anywhere in the box, the eye lies within asin(radius / distance) of where its centre sees it.
  const float between = std::acos(std::clamp(glm::dot(to_eye, cone.axis) / distance, -1.0f, 1.0f));
  return between > static_cast<float>(kPi / 2) + cone.angle + std::asin(radius / distance) + 1e-3f;
}

float uvDensity(const Mesh& mesh, const FlatBtfBinding& binding, const glm::mat4& world_from_local) {
  std::vector<TriangleUvs> triangles;
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const TriangleUvs uvs = triangleUvs(mesh, i, tileCoordinates(mesh, binding), glm::mat3(world_from_local));
    if (uvs.density() > 0 && std::isfinite(uvs.density())) triangles.push_back(uvs);
  }
  return densityOfNearlyAll(triangles, 1);
}

float texelDensity(const Mesh& mesh, const TextureUse& use, glm::ivec2 size) {
  const std::vector<glm::vec2>& uvs = mesh.uv_sets[size_t(use.tex_coord)];
  if (uvs.empty()) return 0;
  const auto texels = [&](uint32_t index) {
    const glm::vec2 uv = uvs[index];
    return glm::vec2(glm::dot(glm::vec2(use.image_u), uv), glm::dot(glm::vec2(use.image_v), uv)) *
           glm::vec2(size);
  };
  std::vector<TriangleUvs> triangles;
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const TriangleUvs triangle = triangleUvs(mesh, i, texels, glm::mat3(1));
    if (triangle.area > 0 && std::isfinite(triangle.density())) triangles.push_back(triangle);
  }
  return densityOfNearlyAll(triangles, 0);
}

// The largest sum of a row of A^T A is no smaller than its largest eigenvalue.
float mostStretch(const glm::mat3& linear) {
  const glm::mat3 square = glm::transpose(linear) * linear;
  float most = 0;
  for (int k = 0; k < 3; ++k)
    most = std::max(most, std::abs(square[k].x) + std::abs(square[k].y) + std::abs(square[k].z));
  return std::sqrt(most);
}

bool isPlain(const Mesh& mesh, const FlatBtfBinding& binding, const glm::mat4& world_from_local,
             float density) {
  constexpr float kStretch = 0.01f;  // relative
  constexpr float kCurvature = 0.01f,
                  kNoise = 1e-4f;  // tilt of the normal per tile period, and of normals as stored
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const TriangleUvs uvs = triangleUvs(mesh, i, tileCoordinates(mesh, binding), glm::mat3(world_from_local));
    if (!(uvs.area > 0)) continue;
    if (!(std::abs(uvs.most - density) <= kStretch * density &&
          std::abs(uvs.least - density) <= kStretch * density))
      return false;
    const Vertex& first = mesh.vertices[mesh.indices[i]];
    for (size_t k = 1; k < 3; ++k) {
      const Vertex& other = mesh.vertices[mesh.indices[i + k]];
      const float periods = glm::length((other.uv - first.uv) * binding.scale);
      if (!(glm::length(other.normal - first.normal) <= kCurvature * periods + kNoise)) return false;
    }
  }
  return true;
}

float demandLambda(const View& view, const Bounds& world, float periods_per_metre, int side) {
  const float depth = std::max(distanceTo(world, view.position) * view.edge_cosine, 1e-4f);
  return std::max(std::log2(depth * view.pixel_angle * periods_per_metre * static_cast<float>(side)), 0.0f);
}

CameraPath::CameraPath(std::vector<Key> keys, Camera base) : keys_(std::move(keys)), base_(base) {
  LODEN_CHECK(!keys_.empty());
}

Camera CameraPath::at(double seconds) const {
  const double t = keys_.front().t + std::clamp(seconds, 0.0, duration());
  const auto after =
      std::upper_bound(keys_.begin(), keys_.end(), t, [](double v, const Key& key) { return v < key.t; });
  const size_t i = after == keys_.begin() ? 0 : std::min<size_t>(after - keys_.begin() - 1, keys_.size() - 1);
  Camera camera = base_;
  camera.position = keys_[i].position;
  camera.target = keys_[i].target;
  if (i + 1 >= keys_.size()) return camera;

  const Key &k0 = keys_[i], &k1 = keys_[i + 1];
  const double step = k1.t - k0.t, u = (t - k0.t) / step;
  const auto slope = [&](size_t k, auto member) {
    const Key &before = keys_[k > 0 ? k - 1 : 0], &next = keys_[std::min(k + 1, keys_.size() - 1)];
    return (next.*member - before.*member) / (next.t - before.t) * step;
  };
  camera.position =
      hermite(k0.position, slope(i, &Key::position), k1.position, slope(i + 1, &Key::position), u);
  camera.target = hermite(k0.target, slope(i, &Key::target), k1.target, slope(i + 1, &Key::target), u);
  return camera;
}

}  // namespace loden::runtime
