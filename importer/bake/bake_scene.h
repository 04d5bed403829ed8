// The steps of a bake, and the data that they share. Not installed.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "importer/bake/push_pull.h"
#include "importer/base/image_file.h"
#include "importer/btf/baked_files.h"
#include "importer/btf/baked_output.h"
#include "importer/tile/param_map.h"
#include "importer/tile/tile.h"
#include "importer/tile/tile_texture.h"
#include "importer/tile/tile_tracer.h"

namespace loden::importer {

// Counts of work and of unusual events, added up by all threads.
struct BakeCounters {
  std::atomic<uint64_t> rays{0};
  std::atomic<uint64_t> misses{0};  // view rays that met nothing
};

struct BakeScene {
  const TileTracer& tracer;
  const BakeManifest& manifest;
  BakeCounters& counters;

  const std::vector<glm::dvec3>& directions() const { return manifest.directions.samples; }
};

// The position in [0,1)^2 of sample k of supersample^2 in its texel: near the centre of its cell, moved by
// unequal small amounts in x and y, so that samples fall on no edge or diagonal of a regular mesh.
glm::dvec2 samplePosition(int k, int supersample);

// Adds the indirect light of one path per sample to values[light], in white units.
void addIndirect(const BakeScene& scene, const TileHit& hit, const glm::dvec3& wo, uint64_t seed,
                 glm::vec3* values);

// The points of the tile's surface that the texels of a side x side map over p represent.
struct TexelPoints {
  std::vector<std::vector<ParamSample>> located;  // [k][texel]: the point under sample k of supersample^2
  // [texel]: for a texel that the surface overlaps, but with none of its samples, the point of the surface
  // nearest to the texel's centre (coverParams). So every texel with some surface has a value of it. This is
  // decided for whole texels and not for the cells of single samples: samples that hit already represent the
  // right share of the texel's area, and additional points at the border would get too much weight.
  std::vector<ParamSample> between;
};
TexelPoints locateTexels(const Tile& tile, int side, int supersample);

// The chart that each texel of a side x side map over p belongs to, gutters included; empty if there is one
// chart.
std::vector<uint16_t> ownersOf(const Tile& tile, int side, const TexelPoints& points);

class SurfaceSamples;

// One view of the BTF: an atlas with the image of each light (3 channels).
Image bakeBtfView(const BakeScene& scene, const SurfaceSamples& surface, int view);

// One view of the Flat-BTF (FBTF 3.3).
struct FlatView {
  Image atlas;                 // 3 channels, holes filled
  std::vector<float> visible;  // [flat texel]: share of the texel's surface that the view sees
};
FlatView bakeFlatView(const BakeScene& scene, const SurfaceSamples& surface, int view);

// p - x at the texel centres for every view of a lat-long map (FBTF 3.4), in the layout of
// importer/btf/baked_output.h.
Image bakeVdim(const BakeScene& scene, glm::ivec2 zeniths_azimuths);
// z of the first hit at the texel centres for every view of the grid of `directions` x `directions`, in the
// layout of importer/btf/baked_output.h.
Image bakeConcentricVdim(const BakeScene& scene, int directions);

// The geometry image and the surface maps, over p.
struct SurfaceImages {
  Image geometry, normal, diffuse, specular;
  Image ggx;  // f0 and alpha; empty unless the tile has GGX lobes
};
SurfaceImages bakeSurface(const BakeScene& scene);

}  // namespace loden::importer
