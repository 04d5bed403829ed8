// Finds vertices of a mesh that are the same point. Meshes in files repeat vertices where normals or texture
// coordinates differ, and a periodic tile repeats its border one period further on.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace loden::importer {

// [vertex]: the lowest index of a vertex within `tolerance` of it in each coordinate. A coordinate with a
// positive `period` counts modulo that period; 0: not periodic.
std::vector<uint32_t> weldVertices(std::span<const glm::dvec3> positions, const glm::dvec3& period,
                                   double tolerance);

}  // namespace loden::importer
