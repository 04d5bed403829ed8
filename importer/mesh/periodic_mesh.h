// The neighbourhoods of a mesh that repeats with period 1 in x and y; not installed.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "material/base/result.h"

namespace loden::importer {

// How messages speak of a mesh: in the numbers and places of its file.
struct MeshName {
  MeshName(std::string file_) : file(std::move(file_)) {}
  MeshName(const char* file_) : file(file_) {}
  std::string file;
  std::vector<uint32_t> numbers;  // per triangle; empty: as they come
  glm::dvec3 unit{1};             // of the file, of a position here
  glm::dvec3 origin{0};           // in the file
  uint32_t number(size_t triangle) const {
    return triangle < numbers.size() ? numbers[triangle] : uint32_t(triangle);
  }
};

// Vertices that coincide, also one period on, are one node; each corner knows which period it stands in.
struct PeriodicNodes {
  std::vector<uint32_t> node;     // per vertex
  std::vector<glm::dvec2> shift;  // per vertex: periods from the node's first vertex
  std::vector<uint32_t> first;    // per node: a vertex of it
};
PeriodicNodes periodicNodes(std::span<const glm::dvec3> positions);

// Across edge k of a triangle, from its corner k to the next: the triangle that shares it when moved by
// `shift`.
struct Neighbour {
  static constexpr uint32_t kNone = 0xFFFFFFFFu;  // the edge is open
  uint32_t triangle = kNone;
  glm::ivec2 shift{0};
  bool exists() const { return triangle != kNone; }
};

// [3 * triangle + k]. Refuses edges of more than two triangles, or of two that face opposite ways, with
// triangle and position named.
Result<std::vector<Neighbour>> findNeighbours(std::span<const glm::dvec3> positions,
                                              std::span<const glm::uvec3> triangles,
                                              const PeriodicNodes& nodes, const MeshName& name);

// Nodes - edges + triangles: 0 for a torus, less with handles.
long eulerNumber(const PeriodicNodes& nodes, std::span<const glm::uvec3> triangles,
                 std::span<const Neighbour> neighbours);

// Connected pieces of the surface.
size_t countComponents(std::span<const Neighbour> neighbours);

// "file: triangle 7 at (0.25, 0.5, 0)", the position its centre.
std::string triangleName(const MeshName& name, size_t triangle, std::span<const glm::dvec3> positions,
                         std::span<const glm::uvec3> triangles);

}  // namespace loden::importer
