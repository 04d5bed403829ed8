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
// phi in [0, 2 pi); the pole has phi 0.
Spherical sphericalFromDirection(const glm::dvec3& w);

// One ring of a measured set: all samples at one theta, equally spaced in phi.
struct Ring {
  double theta = 0;      // radians
  int count = 0;         // samples
  double first_phi = 0;  // radians
};

enum class DirectionSetKind : uint32_t { kBonn81 = 1, kUbo151 = 2, kConcentric = 3, kList = 4 };

// Samples in the order in which data is stored: ring by ring from the pole for the measured sets,
// row by row of the square for a concentric grid.
struct DirectionSet {
  DirectionSetKind kind = DirectionSetKind::kList;
  int side = 0;                     // of a concentric grid, else 0
  std::vector<glm::dvec3> samples;  // unit
  int size() const { return static_cast<int>(samples.size()); }
};

// The 81 of Bonn's UBO2003 and ATRIUM sets: theta 0, 15 .. 75 degrees, 1, 6, 12, 18, 20, 24 samples.
DirectionSet bonn81Directions();
// The 151 of UBO2014.
DirectionSet ubo151Directions();
// n x n equal-area cells of the hemisphere (Shirley and Chiu's concentric map), up to theta_max.
DirectionSet concentricDirections(int n, double theta_max = 85.0 * kPi / 180.0);
// "bonn81", "ubo151" or "NxN"; nothing if the name is none of these.
std::optional<DirectionSet> directionsByName(std::string_view name);
std::string directionsName(const DirectionSet& set);

const std::vector<Ring>& bonn81Rings();
const std::vector<Ring>& ubo151Rings();

// The direction, at most theta_max (radians) from the normal, at its own azimuth.
template <class T>
glm::vec<3, T> clampTheta(const glm::vec<3, T>& w, T theta_max);

// (phi / 2 pi, theta / theta_max), 0..1: where a direction stands in any lat-long grid up to theta_max.
template <class T>
glm::vec<2, T> gridPosition(const glm::vec<3, T>& w, T theta_max);

// Square [0,1]^2 <-> directions above the plane, the normal in the middle and what is parallel to the plane
// at the edges; no trigonometry (the hemioct map of Cigolle et al. 2014). w.z below 0 counts as 0.
template <class T>
glm::vec<2, T> squareFromDirection(const glm::vec<3, T>& w);
template <class T>
glm::vec<3, T> directionFromSquare(glm::vec<2, T> square);

// Index of the nearest sample by angle; ties go to the lower index.
int nearestDirection(const DirectionSet& set, const glm::dvec3& w);

// Index of the nearest sample for many directions at once (LBTF 3.4, step 1): a side x side image over
// w.xy in [-1, 1]^2 (orthographic), each texel the nearest sample to its centre. Row-major, x fastest.
// Built where it is used and never stored: CPU and GPU read the same image, so they agree everywhere.
std::vector<uint8_t> nearestDirectionLookup(const DirectionSet& set, int side);
inline constexpr int kNearestLookupSide = 256;

// Square [0,1]^2 <-> disk of radius 1 (Shirley and Chiu 1997), continuous, area preserving.
template <class T>
glm::vec<2, T> diskFromSquare(glm::vec<2, T> square);
template <class T>
glm::vec<2, T> squareFromDisk(glm::vec<2, T> disk);

}  // namespace loden
