// Sets of sampled directions, and the maps between directions and tables.
// A direction is a unit vector in the tangent frame of the reference plane, z along its normal, pointing
// away from the surface; theta is measured from z, phi from x towards y; both in radians.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace loden {

inline constexpr double kPi = 3.14159265358979323846;

struct Spherical {
  double theta = 0, phi = 0;  // radians
};
glm::dvec3 directionFromSpherical(Spherical s);
// The spherical coordinates of a direction; phi is in [0, 2 pi), and 0 at the pole.
Spherical sphericalFromDirection(const glm::dvec3& w);

// One ring of a measured set of directions: all samples at one theta, equally spaced in phi.
struct Ring {
  double theta = 0;      // radians
  int count = 0;         // samples
  double first_phi = 0;  // radians
};

enum class DirectionSetKind : uint32_t { kBonn81 = 1, kUbo151 = 2, kConcentric = 3, kList = 4 };

// A set of sampled directions, in the order in which data is stored: for measured sets ring by ring from the
// pole, for a concentric grid row by row of the square.
struct DirectionSet {
  DirectionSetKind kind = DirectionSetKind::kList;
  int side = 0;                     // cells per side of a concentric grid; 0 for other kinds
  std::vector<glm::dvec3> samples;  // unit
  int size() const { return static_cast<int>(samples.size()); }
};

// The 81 directions of Bonn University's UBO2003 and ATRIUM data sets: theta 0, 15 .. 75 degrees with 1, 6,
// 12, 18, 20, 24 samples.
DirectionSet bonn81Directions();
// The 151 directions of Bonn University's UBO2014 data set.
DirectionSet ubo151Directions();
// The centres of n x n equal-area cells of the hemisphere up to theta_max (Shirley and Chiu's concentric
// map).
DirectionSet concentricDirections(int n, double theta_max = 85.0 * kPi / 180.0);
// The set of this name: "bonn81", "ubo151" or "NxN"; nothing for any other name.
std::optional<DirectionSet> directionsByName(std::string_view name);
std::string directionsName(const DirectionSet& set);

const std::vector<Ring>& bonn81Rings();
const std::vector<Ring>& ubo151Rings();

// The direction w, moved at constant azimuth to at most theta_max (radians) from the normal.
template <class T>
glm::vec<3, T> clampTheta(const glm::vec<3, T>& w, T theta_max);

// The position of a direction in any lat-long grid up to theta_max: (phi / 2 pi, theta / theta_max), each
// 0..1.
template <class T>
glm::vec<2, T> gridPosition(const glm::vec<3, T>& w, T theta_max);

// The map between the square [0,1]^2 and the directions above the plane (the hemioct map of Cigolle et al.
// 2014). The normal is in the middle, and directions parallel to the plane are at the edges. It needs no
// trigonometry. w.z below 0 counts as 0.
template <class T>
glm::vec<2, T> squareFromDirection(const glm::vec<3, T>& w);
template <class T>
glm::vec<3, T> directionFromSquare(glm::vec<2, T> square);

// The index of the sample nearest to w by angle; of equally near ones the lowest index.
int nearestDirection(const DirectionSet& set, const glm::dvec3& w);

// The index of the nearest sample for many directions at once (LBTF 3.4, step 1), as a side x side image over
// w.xy in [-1, 1]^2 (orthographic projection). Each texel holds the sample nearest to its centre. Row-major,
// x fastest. The image is built where it is used and never stored; CPU and GPU read the same image, so that
// they agree everywhere.
std::vector<uint8_t> nearestDirectionLookup(const DirectionSet& set, int side);
inline constexpr int kNearestLookupSide = 256;

// The map between the square [0,1]^2 and the disk of radius 1 (Shirley and Chiu 1997), which is continuous
// and preserves area.
template <class T>
glm::vec<2, T> diskFromSquare(glm::vec<2, T> square);
template <class T>
glm::vec<2, T> squareFromDisk(glm::vec<2, T> disk);

}  // namespace loden
