// Bakes a tile: ray traces its BTF, Flat-BTF, VDIM and surface maps into a folder (FBTF section 3).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "importer/btf/baked_output.h"
#include "importer/btf/fill_method.h"
#include "importer/tile/tile.h"

namespace loden::importer {

struct BakeMaps {
  bool btf = true, flat = true, vdim = true, surface = true;
};

struct BakeOptions {
  double period = 0;        // the tile's period in x, metres; 0: not known
  int size = 64;            // reference texels per side
  int flat_size = 0;        // texels per side of the Flat-BTF; 0: as size
  int surface_size = 0;     // texels per side of the surface maps; 0: twice the size
  int geometry_size = 0;    // texels per side of the geometry image; 0: max(128, size), or twice that
  DirectionSet directions;  // lights and views; empty: bonn81
  // VDIMs to write: lat-long maps of zeniths x azimuths.
  std::vector<glm::ivec2> vdims{{16, 16}, {8, 32}};
  // VDIMs to write: depth maps on the runtime's own grid of directions, by directions per side.
  std::vector<int> concentric_vdims;
  int supersample = 2;  // samples per texel along each side
  int bounces = 0;      // reflections of light within the tile; 0: direct light and cast shadows only
  FillMethod fill = FillMethod::kPushPull;  // for texels of the Flat-BTF that a view does not see
  TexelMethod texels = TexelMethod::kMean;  // for texels of the Flat-BTF that a view sees
  BakeMaps maps;
  bool resume = false;        // keeps the files that an interrupted run has finished
  int shard = 0, shards = 1;  // this process bakes the views v with v % shards == shard
  int threads = 0;            // 0: as many as there are cores
  bool quiet = false;
};

struct BakeReport {
  BakeManifest manifest;
  bool complete = false;  // bake.json is written, which means that no other shard has work left
  uint64_t rays = 0;
  double seconds = 0;
  uint64_t misses = 0;  // rays that should have met the tile and did not
};

// Bakes the tile into the folder. The files have the same bytes for the same input, at any number of threads,
// shards and resumptions. `tile_name` is recorded in the manifest. Files are written under a temporary name
// and renamed. bake.json is written last, by the shard that finds everything complete.
Result<BakeReport> bake(const Tile& tile, const std::string& tile_name, const std::filesystem::path& folder,
                        const BakeOptions& options);

}  // namespace loden::importer
