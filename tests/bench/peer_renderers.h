// Renderers of small geometry that engines use, to compare Loden with, each written as its author would. They
// draw no cast shadows, since such shaders usually do not.
#pragma once

#include <memory>

#include "importer/btf/baked_output.h"
#include "tests/bench/tile_renderers.h"

namespace loden::bench {

// The material with its surface maps resampled: from maps over the parameter domain to maps over x, of what
// rays from straight above meet, as a normal-mapped plane needs them. If the parameterization is the
// identity, the maps stay as they are.
Material seenFromAbove(Material material, const importer::TileTracer& tracer);

// The heights of a tile that is a height field (identity parameterization) as a mip-mapped texture of 16
// bits.
class HeightMap {
 public:
  explicit HeightMap(const GeometryImage& geometry);
  void bind(const runtime::GlProgram& program) const;  // to the texture unit kFreeUnit
  uint64_t bytes() const { return bytes_; }

 private:
  runtime::GlTexture texture_;
  glm::vec2 range_{0};  // depth that the map's 1 stands for, tile periods along x and y per slope
  uint64_t bytes_ = 0;
};

// Parallax occlusion mapping: linear steps down the view ray until it is below the height map, then
// bisections between the last two steps. The surface maps of `material` are read where they end.
TileRenderer marchRenderer(const runtime::Device& device, const std::string& name, int steps, int bisections,
                           const Material& material, std::shared_ptr<const HeightMap> heights);

// Cone step mapping (Dummer 2006). A texel of the cone map holds the depth, and the width of the widest empty
// cone above it. The march takes `steps` steps down the view ray, each to where the ray leaves the cone of
// the texel below.
TileRenderer coneRenderer(const runtime::Device& device, int steps, const Material& material);

// Draws one colour, the one that `color` holds at the time of drawing.
TileRenderer constantRenderer(const runtime::Device& device, const Material& material,
                              std::shared_ptr<const glm::vec3> color);

// Draws the full BTF table (BtfTable) of a bake over Bonn's directions. The bake's size must be a power of
// two, since the table's mips are means of 2 x 2 texels.
TileRenderer tableRenderer(const runtime::Device& device, const Material& material,
                           const importer::BakedOutput& baked);

}  // namespace loden::bench
