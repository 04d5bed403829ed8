#include "runtime/scene/scene.h"

#include <limits>
#include <numeric>
#include <type_traits>

namespace loden::runtime {

Bounds boundsOf(const Mesh& mesh) {
  if (mesh.vertices.empty()) return {};
  Bounds bounds{mesh.vertices[0].position, mesh.vertices[0].position};
  for (const Vertex& vertex : mesh.vertices) {
    bounds.min = glm::min(bounds.min, vertex.position);
    bounds.max = glm::max(bounds.max, vertex.position);
  }
  return bounds;
}

namespace {

// Calls `change` on everything that a mesh has per vertex.
template <class Change>
void forEachStream(Mesh& mesh, const Change& change) {
  change(mesh.vertices);
  for (auto& set : mesh.uv_sets)
    if (!set.empty()) change(set);
  if (!mesh.colors.empty()) change(mesh.colors);
  if (!mesh.influences.empty()) change(mesh.influences);
  for (MorphTarget& target : mesh.targets)
    for (auto* deltas : {&target.positions, &target.normals, &target.tangents})
      if (!deltas->empty()) change(*deltas);
}

}  // namespace

void appendCopies(Mesh& mesh, std::span<const uint32_t> sources) {
  forEachStream(mesh, [&](auto& values) {
    values.reserve(values.size() + sources.size());
    for (const uint32_t source : sources) values.push_back(values[source]);
  });
}

void separateTriangles(Mesh& mesh) {
  forEachStream(mesh, [&](auto& values) {
    std::remove_reference_t<decltype(values)> separate;
    separate.reserve(mesh.indices.size());
    for (const uint32_t index : mesh.indices) separate.push_back(values[index]);
    values = std::move(separate);
  });
  std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
}

Bounds transformed(const Bounds& bounds, const glm::mat4& transform) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Bounds result{glm::vec3(kInfinity), glm::vec3(-kInfinity)};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 local((corner & 1) ? bounds.max.x : bounds.min.x,
                          (corner & 2) ? bounds.max.y : bounds.min.y,
                          (corner & 4) ? bounds.max.z : bounds.min.z);
    const glm::vec3 world(transform * glm::vec4(local, 1));
    result.min = glm::min(result.min, world);
    result.max = glm::max(result.max, world);
  }
  return result;
}

}  // namespace loden::runtime
