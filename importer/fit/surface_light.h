// What light meets the tile's own surface, point by point, and the shadow map of the near term that is fitted
// to it (material/model/surface_maps.h).
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "importer/fit/pca.h"
#include "material/model/geometry_image.h"

namespace loden::importer {

// Means over the surface of each texel of p, texels x directions: of max(N.L, 0), and of its product with
// what the rest of the tile lets through.
struct SurfaceLight {
  Matrix open, lit;
};

// By rays from points x points places a texel of side x side; directions lie above the plane. Texels without
// surface take the mean of their neighbours that have some, step by step, and what is left lies open, flat.
// An empty image is such a plane. Deterministic at any number of threads.
SurfaceLight surfaceLight(const GeometryImage& image, int side, std::span<const glm::dvec3> directions,
                          int points, int threads);

// What the tile itself sends to its surface: irradiance over pi (white units, mean over each texel of p) by
// light from wi that was reflected 1 to `bounces` times, as wi.z (c0 + c1 wi.z + c2 wi.x + c3 wi.y). Texels x
// 12: c0 .. c3 of red, of green and of blue. `lit`: SurfaceLight's, by `directions` of equal solid angle,
// whose polynomial is the closest one in the mean square; `albedo`: of each texel, diffuse. Since light adds
// up, the exchange among texels (Goral et al. 1984) is computed for the coefficients and not light by light
// (Sloan et al. 2002). Deterministic at any number of threads.
Matrix indirectLight(const GeometryImage& image, int side, const Matrix& lit,
                     std::span<const glm::dvec3> directions, std::span<const glm::vec3> albedo, int bounces,
                     int points, int threads);
inline constexpr int kIndirectTerms = 4;

// The directions at the texels of a shadow table of side x side, row by row; those beyond the lookup's
// kThetaMax are moved to it, where rays still leave the tile.
std::vector<glm::dvec3> shadowDirections(int side);

// weights (texels x k, as 8-bit codes of -1..1 will give them back) and basis (directions x k) with
// clamp(weights basis^T, 0, 1) close to the share of light that the rest of the tile keeps away, 1 - lit /
// open. Errors weigh by `open`: where the surface faces away the share may be anything, as the reflectance is
// 0 there. So may it beyond 0 and 1 where there is light or shadow: whether light comes is 0 or 1 with an
// edge between, which no sum of few products is, but a clamped one only has to be right along the edge.
// Alternating least squares over the samples that are not yet beyond the end where they belong.
Factors fitShadow(const SurfaceLight& light, int components, int threads);

}  // namespace loden::importer
