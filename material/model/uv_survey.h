// How large texture coordinates are on surfaces, and with that how many periods of a tile go into one unit of
// them: what lays a tile of known length out in metres.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace loden {

// Triangles go in one after the other; what comes out is weighted by their areas.
class UvSurvey {
 public:
  // Positions in metres, world. Triangles without area, on the surface or in texture coordinates, do not
  // count.
  void add(const std::array<glm::dvec3, 3>& positions, const std::array<glm::dvec2, 3>& uvs);
  bool empty() const { return triangles_.empty(); }

  // Metres along the surface per unit of u, and of v: the medians.
  glm::dvec2 metresPerUnit() const;

  // How much larger or smaller than it is meant to be a pattern comes out in its worst direction, if a unit
  // of u is taken for metres_per_unit.x and one of v for metres_per_unit.y.
  struct Stretch {
    double most = 1;   // only 2 % of the area has more
    double share = 0;  // of the area that has more than kStrong
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

// Tile periods per unit of u and v (FlatBtfBinding::scale), with which one period is `period` metres along x
// and `aspect` times that along y on a surface of metres_per_unit, the pattern turned by `rotation` radians.
// None for tiles that are not square and turned by other than right angles: a scale per axis does not do it.
std::optional<glm::dvec2> scaleForPeriod(const glm::dvec2& metres_per_unit, double period, double aspect,
                                         double rotation);
// Metres of one period along x and along y, with such a scale.
glm::dvec2 periodOfScale(const glm::dvec2& metres_per_unit, const glm::dvec2& scale, double rotation);

// Metres of a length with its unit: "2cm", "15mm", "0.3m"; none of anything else, or of 0.
std::optional<double> lengthFromText(const char* text);

}  // namespace loden
