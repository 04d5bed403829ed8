// What all parts of a bake share, and the parts; not installed.
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

// Odd events and work done, counted from all threads.
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

// Where sample k of supersample^2 lies in its texel, in [0,1)^2: the centre of its cell, a little beside it
// and unequally in x and y, so that samples fall on no edge or diagonal of a regular mesh.
glm::dvec2 samplePosition(int k, int supersample);

// Indirect light of one path per sample, added to values[light] (white units).
void addIndirect(const BakeScene& scene, const TileHit& hit, const glm::dvec3& wo, uint64_t seed,
                 glm::vec3* values);

// The points of the surface that a side x side map over p stands for.
struct TexelPoints {
  std::vector<std::vector<ParamSample>> located;  // [k][texel]: under sample k of supersample^2
  // [texel]: the point nearest to the texel's centre where the surface overlaps the texel and lies under none
  // of its samples (coverParams), so that every texel with some surface has a value of it. Whole texels and
  // not the cells of single samples are looked at: those that are met have their share of the texel's area as
  // it is, and more points at the border would outweigh it.
  std::vector<ParamSample> between;
};
TexelPoints locateTexels(const Tile& tile, int side, int supersample);

// Chart that each texel of a side x side map over p belongs to, gutters included; empty if there is one
// chart.
std::vector<uint16_t> ownersOf(const Tile& tile, int side, const TexelPoints& points);

class SurfaceSamples;

// One view of the BTF, as the atlas image of all lights (3 channels).
Image bakeBtfView(const BakeScene& scene, const SurfaceSamples& surface, int view);

// One view of the Flat-BTF (FBTF 3.3).
struct FlatView {
  Image atlas;                 // 3 channels, holes filled
  std::vector<float> visible;  // [flat texel], share of the texel's surface that the view sees
};
FlatView bakeFlatView(const BakeScene& scene, const SurfaceSamples& surface, int view);

// p - x at the texel centres for every view of a latlong map (FBTF 3.4), as the image of baked_output.h.
Image bakeVdim(const BakeScene& scene, glm::ivec2 zeniths_azimuths);
// z of the first hit at the texel centres for every view of the grid of `directions` x `directions`,
// likewise.
Image bakeConcentricVdim(const BakeScene& scene, int directions);

// Geometry image and surface maps over p.
struct SurfaceImages {
  Image geometry, normal, diffuse, specular;
  Image ggx;  // f0 and alpha; empty unless the tile's lobes are GGX
};
SurfaceImages bakeSurface(const BakeScene& scene);

}  // namespace loden::importer
