// Computes which light reaches the tile's own surface, point by point, and fits the shadow map of the near
// term to it (material/model/surface_maps.h).
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "importer/fit/pca.h"
#include "material/model/geometry_image.h"

namespace loden::importer {

// Means over the surface of each texel of p, texels x directions: `open` of max(N.L, 0), and `lit` of
// max(N.L, 0) times the visibility of the light past the rest of the tile.
struct SurfaceLight {
  Matrix open, lit;
};

// Traces SurfaceLight by rays from points x points places per texel of side x side; directions lie above the
// plane. Texels without surface take the mean of neighbours that have some, step by step; if none has any,
// they are those of an open, flat surface. An empty image stands for such a plane. Deterministic at any
// number of threads.
SurfaceLight surfaceLight(const GeometryImage& image, int side, std::span<const glm::dvec3> directions,
                          int points, int threads);

// The light that the tile itself sends to its surface: irradiance over pi (white units, mean over each texel
// of p) by light from wi that was reflected 1 to `bounces` times, as the polynomial wi.z (c0 + c1 wi.z + c2
// wi.x + c3 wi.y). The result is texels x 12: c0 .. c3 of red, of green and of blue. `lit` is
// SurfaceLight::lit for `directions` of equal solid angle; its closest polynomial in the mean square is used.
// `albedo` is the diffuse albedo of each texel. Since light adds up, the exchange among texels (Goral et al.
// 1984) is computed for the coefficients and not light by light (Sloan et al. 2002). Deterministic at any
// number of threads.
Matrix indirectLight(const GeometryImage& image, int side, const Matrix& lit,
                     std::span<const glm::dvec3> directions, std::span<const glm::vec3> albedo, int bounces,
                     int points, int threads);
inline constexpr int kIndirectTerms = 4;

// The directions at the texels of a shadow table of side x side, row by row. Those beyond kThetaMax are moved
// to it, where rays still leave the tile.
std::vector<glm::dvec3> shadowDirections(int side);

// The shadow map's weights (texels x k, as 8-bit codes of -1..1 will give them back) and basis (directions x
// k): clamp(weights basis^T, 0, 1) is close to the share of light that the rest of the tile keeps away, 1 -
// lit / open. Errors are weighted by `open`: where the surface faces away the share may be anything, since
// the reflectance is 0 there. The unclamped product may also be anything beyond 0 or 1 where the share is 0
// or 1. The share is 0 or 1 with an edge between, which no sum of few products is, but a clamped sum only has
// to be right along the edge. The fit is alternating least squares over the samples that are not yet beyond
// the end where they belong.
Factors fitShadow(const SurfaceLight& light, int components, int threads);

}  // namespace loden::importer
