// Measures the scale of texture coordinates on surfaces, from which follows how many periods of a tile of
// known length fit into one unit of texture coordinates.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace loden {

// Collects triangles one by one; all results are weighted by their areas.
class UvSurvey {
 public:
  // Adds a triangle; positions in metres, world. Triangles without area, on the surface or in texture
  // coordinates, do not count.
  void add(const std::array<glm::dvec3, 3>& positions, const std::array<glm::dvec2, 3>& uvs);
  bool empty() const { return triangles_.empty(); }

  // Metres along the surface per unit of u, and per unit of v; medians.
  glm::dvec2 metresPerUnit() const;

  // How much larger or smaller than intended a pattern appears in its worst direction, as a factor >= 1, if a
  // unit of u is taken for metres_per_unit.x and a unit of v for metres_per_unit.y.
  struct Stretch {
    double most = 1;   // factor that only 2 % of the area exceeds
    double share = 0;  // share of the area whose factor exceeds kStrong
  };
  static constexpr double kStrong = 2;
  Stretch stretch(const glm::dvec2& metres_per_unit) const;

 private:
  struct Triangle {
    double area = 0;
    double uu = 0, uv = 0, vv = 0;  // products of dP/du and dP/dv, square metres
  };
  std::vector<Triangle> triangles_;
};

// Tile periods per unit of u and v (FlatBtfBinding::scale) with which one period is `period` metres along x
// and `aspect` times that along y, on a surface of metres_per_unit and with the pattern turned by `rotation`
// radians. Nothing for tiles that are not square and are turned by other than right angles, since one scale
// per axis cannot do that.
std::optional<glm::dvec2> scaleForPeriod(const glm::dvec2& metres_per_unit, double period, double aspect,
                                         double rotation);
// Metres of one period along x and along y that such a scale gives; the inverse of scaleForPeriod.
glm::dvec2 periodOfScale(const glm::dvec2& metres_per_unit, const glm::dvec2& scale, double rotation);

// The metres of a length with its unit, such as "2cm", "15mm" or "0.3m"; nothing for any other text, or for
// 0.
std::optional<double> lengthFromText(const char* text);

}  // namespace loden
