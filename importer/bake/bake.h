// Bakes a tile: BTF, Flat-BTF, VDIM and surface maps into a folder (FBTF section 3).
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
  double period = 0;                                 // of the tile in x, metres; 0: not known
  int size = 64;                                     // reference texels per side
  int flat_size = 0;                                 // 0: as size
  int surface_size = 0;                              // of the surface maps; 0: twice the size
  int geometry_size = 0;                             // 0: max(128, size)
  DirectionSet directions;                           // empty: bonn81
  std::vector<glm::ivec2> vdims{{16, 16}, {8, 32}};  // latlong, zeniths x azimuths
  std::vector<int> concentric_vdims;                 // depths on the runtime's own grid, directions per side
  int supersample = 2;                               // samples per texel side
  int bounces = 0;                                   // 0: direct light and cast shadows
  FillMethod fill = FillMethod::kPushPull;           // of texels that a view does not see
  TexelMethod texels = TexelMethod::kMean;           // of those that it sees
  BakeMaps maps;
  bool resume = false;        // keep what an interrupted run has finished
  int shard = 0, shards = 1;  // this process does views v with v % shards == shard
  int threads = 0;            // 0: all
  bool quiet = false;
};

struct BakeReport {
  BakeManifest manifest;
  bool complete = false;  // bake.json is written: no other shard has work left
  uint64_t rays = 0;
  double seconds = 0;
  uint64_t misses = 0;  // rays that should have met the tile and did not
};

// Same bytes for the same input at any number of threads, shards and resumptions. `tile_name` goes into the
// manifest. Files are written to a temporary name and renamed; bake.json comes last, by the shard that finds
// everything complete.
Result<BakeReport> bake(const Tile& tile, const std::string& tile_name, const std::filesystem::path& folder,
                        const BakeOptions& options);

}  // namespace loden::importer
