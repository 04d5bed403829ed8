// Building blocks of the builtin tiles. Not installed.
#pragma once

#include <functional>
#include <string>

#include "importer/tile/tile.h"

namespace loden::importer {

// A surface over the parameter torus: position(p + n) = position(p) + (n, 0).
struct TorusSurface {
  std::function<glm::dvec3(glm::dvec2 p)> position;
  std::function<LocalBrdf(glm::dvec2 p, const glm::dvec3& position)> brdf;
  bool identity_parameterization = false;
  double aspect = 1;  // aspect of the period; positions are tile coordinates
};
// The tile of a surface as one chart, a grid of resolution x resolution cells over p.
Tile gridTile(const std::string& name, int resolution, const TorusSurface& surface);

// A surface over (u, v) in [0,1]^2 that is a chart of its own. Its lengths have the period 1 along x and the
// tile's aspect along y.
struct Sheet {
  std::function<glm::dvec3(glm::dvec2 uv)> position;
  std::function<LocalBrdf(glm::dvec2 uv, const glm::dvec3& position)> brdf;
  glm::ivec2 cells{16, 16};
  // Lines of u, and of v, across which the normal jumps; they lie between cells.
  std::vector<double> creases[2];
  double density = 1;  // parameter length per length, for surfaces that need more or fewer texels
};

// A tile of sheets, in the order in which they are added.
class SheetTile {
 public:
  explicit SheetTile(const std::string& name, double aspect = 1);
  void add(const Sheet& sheet);
  // The tile with packed charts and positions in tile coordinates; finishTile (importer/tile/polygon_mesh.h)
  // must still be called.
  Tile take();

 private:
  Tile tile_;
  uint16_t charts_ = 0;
};

// A point on a tube of round section around an axis, at `angle` (radians, 0 on the side of `up`) and at `t`
// along the axis.
glm::dvec3 tubePoint(const std::function<glm::dvec3(double t)>& axis, double t, double angle, double radius,
                     const glm::dvec3& up = {0, 0, 1});

// The builtin tiles, for which finishTile must still be called. `resolution`: cells per side of a period.
Tile weaveTile(int resolution);  // separate yarns, one chart each
// Yarns that interlock in many charts, over a ground; its period is not square.
Tile stockinetteTile(int resolution);
Tile fibresTile(int resolution);    // loose fibres over a weave
Tile ringsTile(int resolution);     // polished metal beside cloth
Tile shinglesTile(int resolution);  // sharp overhangs; half as high as wide
Tile leatherTile(int resolution);   // deep holes
Tile bricksTile(int resolution);    // textures, some bricks polished; two thirds as high as wide

}  // namespace loden::importer
