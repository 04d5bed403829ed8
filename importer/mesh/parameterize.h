// A global parameterization of a closed periodic surface (a torus): mean value coordinates (Floater 2003)
// with the lattice shift of every edge that crosses the tile's border, then equalised by area. All weights
// are positive, so that no triangle flips (Gortler, Gotsman and Thurston 2006).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "importer/mesh/periodic_mesh.h"
#include "material/base/result.h"

namespace loden::importer {

// How even the parameterization is. Areas are surface area per parameter area, relative to their mean.
struct ParameterizationQuality {
  int flipped = 0;  // flipped triangles
  // Coefficient of variation, and percentiles by parameter area.
  double area_cv = 0, area_p5 = 1, area_p95 = 1;
  int iterations = 0;  // iterations of the equalisation by area
};

struct Parameterization {
  std::vector<glm::dvec2> params;  // per vertex, unwrapped: P(p + n) = P(p) + (n, 0)
  ParameterizationQuality quality;
};

// The period (x, y; in the mesh's units) at which the mesh's borders meet each other. Issues: kTileUv if they
// do not.
Result<glm::dvec2> findPeriod(std::span<const glm::dvec3> positions, std::span<const glm::uvec3> triangles,
                              const std::string& where);

// The parameterization of positions with period 1 in x and y. A mesh that is not a torus is refused, and the
// message names the vertex or triangle: open or non-manifold edges, several components, handles, degenerate
// triangles.
Result<Parameterization> parameterizeTorus(std::span<const glm::dvec3> positions,
                                           std::span<const glm::uvec3> triangles, const MeshName& name);

ParameterizationQuality measureParameterization(std::span<const glm::dvec3> positions,
                                                std::span<const glm::dvec2> params,
                                                std::span<const glm::uvec3> triangles);

}  // namespace loden::importer
