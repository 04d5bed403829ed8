// The reflectance of textured surfaces. Not installed.
#pragma once

#include <span>

#include "importer/tile/tile.h"

namespace loden::importer {

// The reflectance at a material's texture coordinates.
LocalBrdf brdfAt(const TileMaterial& material, glm::dvec2 base_color, glm::dvec2 metallic_roughness);

// Replaces `brdf`, which was interpolated from the vertices, by that of the textures, if there are any, at
// the weights (1 - b.x - b.y, b.x, b.y) of a triangle's corners.
void readTextures(std::span<const TileMaterial> materials, std::span<const TexturePoint> points,
                  const glm::uvec3& corners, glm::dvec2 b, LocalBrdf& brdf);

}  // namespace loden::importer
