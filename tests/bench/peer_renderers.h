// What engines draw meso-geometry with, each as its author would: peers of Loden's renderers in a benchmark.
// They have no cast shadows, as such shaders usually have not.
#pragma once

#include <memory>

#include "importer/btf/baked_output.h"
#include "tests/bench/tile_renderers.h"

namespace loden::bench {

// Surface maps over the parameter domain, made maps of what rays from straight above meet: those of a
// normal-mapped plane. The same where the parameterization is the identity.
Material seenFromAbove(Material material, const importer::TileTracer& tracer);

// The heights of a tile that is a height field (identity parameterization) as a mip-mapped texture of 16
// bits.
class HeightMap {
 public:
  explicit HeightMap(const GeometryImage& geometry);
  void bind(const runtime::GlProgram& program) const;  // to kFreeUnit
  uint64_t bytes() const { return bytes_; }

 private:
  runtime::GlTexture texture_;
  glm::vec2 range_{0};  // depth that the map's 1 stands for, tile periods along x and y per slope
  uint64_t bytes_ = 0;
};

// Linear steps down the view ray until it is below the height map, then bisections between the last two; the
// surface maps of `material` are read there.
TileRenderer marchRenderer(const runtime::Device& device, const std::string& name, int steps, int bisections,
                           const Material& material, std::shared_ptr<const HeightMap> heights);

// The cone map of the same (Dummer 2006): per texel the depth and the width of the widest empty cone above
// it. `steps` steps down the view ray, each to where it leaves the cone of the texel below.
TileRenderer coneRenderer(const runtime::Device& device, int steps, const Material& material);

// One colour, as it is when drawn.
TileRenderer constantRenderer(const runtime::Device& device, const Material& material,
                              std::shared_ptr<const glm::vec3> color);

// The whole table of a bake over Bonn's directions whose size is a power of two, as its mips are 2 x 2 means.
TileRenderer tableRenderer(const runtime::Device& device, const Material& material,
                           const importer::BakedOutput& baked);

}  // namespace loden::bench
