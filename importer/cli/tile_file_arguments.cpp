#include "importer/cli/tile_file_arguments.h"

#include <cmath>

#include "importer/cli/output.h"
#include "material/base/issues.h"

namespace loden::importer {

void TileFileArguments::declare(Options& options) {
  options.integer("--subdivide", subdivide_, "OpenSubdiv levels, if the tile is a coarse cage", 0, 6);
  options.text("--mesh-period", mesh_period_,
               "X,Y: where the mesh repeats, in the file's units, if its borders do not say so");
  options.text("--ground", ground_,
               "Put a plane under a mesh that has gaps, so far below its lowest point, in the file's units");
}

Result<TileOptions> TileFileArguments::parse() const {
  const auto refuse = [](const std::string& option, const std::string& why) {
    return Issue{issue_id::kOption, Severity::kError, option, why};
  };
  TileOptions options;
  options.subdivide = subdivide_;
  if (!mesh_period_.empty()) {
    const auto sides = parseNumbers("--mesh-period", mesh_period_, 2);
    if (!sides) return sides.issue();
    options.mesh_period = {(*sides)[0], (*sides)[1]};
    if (!((*sides)[0] > 0 && (*sides)[1] > 0 && std::isfinite((*sides)[0] + (*sides)[1])))
      return refuse("--mesh-period", "'" + mesh_period_ + "' is not X,Y, two lengths above 0");
  }
  if (!ground_.empty()) {
    const auto depth = parseNumbers("--ground", ground_, 1);
    if (!depth) return depth.issue();
    if (!((*depth)[0] >= 0 && std::isfinite((*depth)[0])))
      return refuse("--ground", "'" + ground_ + "' is not a depth of 0 or more");
    options.ground = (*depth)[0];
  }
  return options;
}

}  // namespace loden::importer
