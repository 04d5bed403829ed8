// A global parameterization of a closed periodic surface (a torus): mean value coordinates (Floater 2003)
// with the lattice shift of every edge that crosses the tile's border, then evened out by area. All weights
// are positive, so no triangle flips (Gortler, Gotsman and Thurston 2006).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "importer/mesh/periodic_mesh.h"
#include "material/base/result.h"

namespace loden::importer {

// How even the map is. Areas are surface area per parameter area, relative to their mean.
struct ParameterizationQuality {
  int flipped = 0;                                // triangles
  double area_cv = 0, area_p5 = 1, area_p95 = 1;  // coefficient of variation, percentiles; by parameter area
  int iterations = 0;                             // of the equalisation
};

struct Parameterization {
  std::vector<glm::dvec2> params;  // per vertex, unwrapped, P(p + n) = P(p) + (n, 0)
  ParameterizationQuality quality;
};

// The period (x, y; in the mesh's units) at which the mesh's borders meet each other; an Issue kTileUv if
// they do not.
Result<glm::dvec2> findPeriod(std::span<const glm::dvec3> positions, std::span<const glm::uvec3> triangles,
                              const std::string& where);

// Positions with period 1 in x and y. Refuses, with the vertex or triangle named, what is no torus: open or
// non-manifold edges, several components, handles, degenerate triangles.
Result<Parameterization> parameterizeTorus(std::span<const glm::dvec3> positions,
                                           std::span<const glm::uvec3> triangles, const MeshName& name);

ParameterizationQuality measureParameterization(std::span<const glm::dvec3> positions,
                                                std::span<const glm::dvec2> params,
                                                std::span<const glm::uvec3> triangles);

}  // namespace loden::importer
