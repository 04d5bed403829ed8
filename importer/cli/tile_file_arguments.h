// The options of `bake` and `trace` that say how a tile is made from a mesh file. Both commands must get the
// same ones.
#pragma once

#include <string>

#include "importer/cli/command.h"
#include "importer/tile/tile.h"

namespace loden::importer {

class TileFileArguments {
 public:
  void declare(Options& options);
  Result<TileOptions> parse() const;

 private:
  int subdivide_ = 0;
  std::string mesh_period_, ground_;
};

}  // namespace loden::importer
