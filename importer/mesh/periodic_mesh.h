// Neighbourhoods in a mesh that repeats with period 1 in x and y. Not installed.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "material/base/result.h"

namespace loden::importer {

// How messages refer to a mesh: by the numbers and positions in its file.
struct MeshName {
  MeshName(std::string file_) : file(std::move(file_)) {}
  MeshName(const char* file_) : file(file_) {}
  std::string file;
  std::vector<uint32_t> numbers;  // number of each triangle in the file; empty: the triangle's index
  glm::dvec3 unit{1};             // units of the file per unit of a position here
  glm::dvec3 origin{0};           // the origin's position in the file
  uint32_t number(size_t triangle) const {
    return triangle < numbers.size() ? numbers[triangle] : uint32_t(triangle);
  }
};

// The nodes of a mesh: vertices that coincide, also after a shift by whole periods, are one node. Each vertex
// has the period in which it lies.
struct PeriodicNodes {
  std::vector<uint32_t> node;     // per vertex
  std::vector<glm::dvec2> shift;  // per vertex: periods from the position of the node's first vertex
  std::vector<uint32_t> first;    // per node: one of its vertices
};
PeriodicNodes periodicNodes(std::span<const glm::dvec3> positions);

// The neighbour across edge k of a triangle, which goes from its corner k to the next: the triangle that
// shares the edge when it is moved by `shift`.
struct Neighbour {
  static constexpr uint32_t kNone = 0xFFFFFFFFu;  // the edge is open
  uint32_t triangle = kNone;
  glm::ivec2 shift{0};
  bool exists() const { return triangle != kNone; }
};

// All neighbours, at [3 * triangle + k]. Edges of more than two triangles, or of two that face opposite ways,
// are refused, with triangle and position in the message.
Result<std::vector<Neighbour>> findNeighbours(std::span<const glm::dvec3> positions,
                                              std::span<const glm::uvec3> triangles,
                                              const PeriodicNodes& nodes, const MeshName& name);

// The Euler number: nodes - edges + triangles. It is 0 for a torus, and less with handles.
long eulerNumber(const PeriodicNodes& nodes, std::span<const glm::uvec3> triangles,
                 std::span<const Neighbour> neighbours);

// The number of connected pieces of the surface.
size_t countComponents(std::span<const Neighbour> neighbours);

// The name of a triangle in messages: "file: triangle 7 at (0.25, 0.5, 0)", with the position of its centre.
std::string triangleName(const MeshName& name, size_t triangle, std::span<const glm::dvec3> positions,
                         std::span<const glm::uvec3> triangles);

}  // namespace loden::importer
