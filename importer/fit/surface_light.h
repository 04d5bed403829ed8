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
