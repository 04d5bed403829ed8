#include "material/model/directions.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "material/base/check.h"

namespace loden {
namespace {

constexpr double radians(double degrees) {
  return degrees * kPi / 180.0;
}

DirectionSet setFromRings(DirectionSetKind kind, const std::vector<Ring>& rings) {
  DirectionSet set{kind, 0, {}};
  for (const Ring& ring : rings)
    for (int k = 0; k < ring.count; ++k)
      set.samples.push_back(directionFromSpherical({ring.theta, ring.first_phi + 2 * kPi * k / ring.count}));
  return set;
}

}  // namespace

glm::dvec3 directionFromSpherical(Spherical s) {
  const double sine = std::sin(s.theta);
  return {sine * std::cos(s.phi), sine * std::sin(s.phi), std::cos(s.theta)};
}

Spherical sphericalFromDirection(const glm::dvec3& w) {
  const double sine = std::hypot(w.x, w.y);
  if (sine < 1e-12) return {w.z >= 0 ? 0.0 : kPi, 0.0};
  double phi = std::atan2(w.y, w.x);
  if (phi < 0) phi += 2 * kPi;
  if (phi >= 2 * kPi) phi = 0;
  return {std::atan2(sine, w.z), phi};
}

const std::vector<Ring>& bonn81Rings() {
  static const std::vector<Ring> kRings = {{0, 1, 0},
                                           {radians(15), 6, 0},
                                           {radians(30), 12, 0},
                                           {radians(45), 18, 0},
                                           {radians(60), 20, 0},
                                           {radians(75), 24, 0}};
  return kRings;
}

const std::vector<Ring>& ubo151Rings() {
  static const std::vector<Ring> kRings = {{0, 1, 0},
                                           {radians(11), 6, radians(15)},
                                           {radians(23.5), 12, 0},
                                           {radians(30), 12, radians(15)},
                                           {radians(37.5), 12, 0},
                                           {radians(45), 18, 0},
                                           {radians(52.5), 18, radians(7.5)},
                                           {radians(60), 24, 0},
                                           {radians(67.5), 24, radians(7.5)},
                                           {radians(75), 24, 0}};
  return kRings;
}

DirectionSet bonn81Directions() {
  return setFromRings(DirectionSetKind::kBonn81, bonn81Rings());
}
DirectionSet ubo151Directions() {
  return setFromRings(DirectionSetKind::kUbo151, ubo151Rings());
}

DirectionSet concentricDirections(int n, double theta_max) {
  LODEN_CHECK_LT(0, n);
  DirectionSet set{DirectionSetKind::kConcentric, n, {}};
  const double cap = 1 - std::cos(theta_max);  // solid angle of the cap over 2 pi
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const glm::dvec2 disk = diskFromSquare(glm::dvec2((i + 0.5) / n, (j + 0.5) / n));
      const double radius = std::hypot(disk.x, disk.y);
      const double theta = std::acos(std::clamp(1 - cap * radius * radius, -1.0, 1.0));
      set.samples.push_back(directionFromSpherical({theta, radius > 0 ? std::atan2(disk.y, disk.x) : 0.0}));
    }
  return set;
}

std::optional<DirectionSet> directionsByName(std::string_view name) {
  if (name == "bonn81") return bonn81Directions();
  if (name == "ubo151") return ubo151Directions();
  int n = 0, m = 0;
  const char* end = name.data() + name.size();
  const auto first = std::from_chars(name.data(), end, n);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != 'x') return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, m);
  // 16 x 16 is the largest grid whose indices fit the 8-bit nearest-direction image.
  if (second.ec != std::errc() || second.ptr != end || n != m || n < 1 || n > 16) return std::nullopt;
  return concentricDirections(n);
}

std::string directionsName(const DirectionSet& set) {
  switch (set.kind) {
    case DirectionSetKind::kBonn81:
      return "bonn81";
    case DirectionSetKind::kUbo151:
      return "ubo151";
    case DirectionSetKind::kConcentric:
      return std::to_string(set.side) + "x" + std::to_string(set.side);
    case DirectionSetKind::kList:
      break;
  }
  return "list of " + std::to_string(set.size());
}

int nearestDirection(const DirectionSet& set, const glm::dvec3& w) {
  LODEN_CHECK_LT(0, set.size());
  int best = 0;
  double best_cosine = -2;
  for (int k = 0; k < set.size(); ++k) {
    const double cosine = glm::dot(set.samples[k], w);
    if (cosine > best_cosine + 1e-12) best = k, best_cosine = cosine;
  }
  return best;
}

std::vector<uint8_t> nearestDirectionLookup(const DirectionSet& set, int side) {
  LODEN_CHECK_LE(set.size(), 256);
  std::vector<uint8_t> image(static_cast<size_t>(side) * side);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      glm::dvec2 xy = glm::dvec2(2 * (i + 0.5) / side - 1, 2 * (j + 0.5) / side - 1);
      const double radius = glm::length(xy);
      if (radius > 1) xy /= radius;
      const double z = std::sqrt(std::max(0.0, 1 - glm::dot(xy, xy)));
      image[static_cast<size_t>(j) * side + i] = static_cast<uint8_t>(nearestDirection(set, {xy, z}));
    }
  return image;
}

template <class T>
glm::vec<2, T> squareFromDirection(const glm::vec<3, T>& w) {
  const T scale = T(0.5) / (std::abs(w.x) + std::abs(w.y) + std::max(w.z, T(0)));
  return glm::vec<2, T>(w.x + w.y, w.x - w.y) * scale + T(0.5);
}

template <class T>
glm::vec<3, T> directionFromSquare(glm::vec<2, T> square) {
  const glm::vec<2, T> s = square * T(2) - T(1);
  const T x = (s.x + s.y) / T(2), y = (s.x - s.y) / T(2);
  return glm::normalize(glm::vec<3, T>(x, y, std::max(T(1) - std::abs(x) - std::abs(y), T(0))));
}

template <class T>
glm::vec<2, T> diskFromSquare(glm::vec<2, T> square) {
  const T a = 2 * square.x - 1, b = 2 * square.y - 1;
  if (a == 0 && b == 0) return {0, 0};
  T radius, phi;
  if (std::abs(a) > std::abs(b)) {
    radius = a;
    phi = T(kPi / 4) * (b / a);
  } else {
    radius = b;
    phi = T(kPi / 2) - T(kPi / 4) * (a / b);
  }
  return {radius * std::cos(phi), radius * std::sin(phi)};
}

template <class T>
glm::vec<2, T> squareFromDisk(glm::vec<2, T> disk) {
  const T radius = std::sqrt(disk.x * disk.x + disk.y * disk.y);
  if (radius == 0) return {T(0.5), T(0.5)};
  T phi = std::atan2(disk.y, disk.x);
  if (phi < T(-kPi / 4)) phi += T(2 * kPi);
  T a, b;
  if (phi < T(kPi / 4)) {
    a = radius;
    b = phi * a / T(kPi / 4);
  } else if (phi < T(3 * kPi / 4)) {
    b = radius;
    a = -(phi - T(kPi / 2)) * b / T(kPi / 4);
  } else if (phi < T(5 * kPi / 4)) {
    a = -radius;
    b = (phi - T(kPi)) * a / T(kPi / 4);
  } else {
    b = -radius;
    a = -(phi - T(3 * kPi / 2)) * b / T(kPi / 4);
  }
  return {(a + 1) / 2, (b + 1) / 2};
}

template glm::vec<2, float> diskFromSquare(glm::vec<2, float>);
template glm::vec<2, double> diskFromSquare(glm::vec<2, double>);
template glm::vec<2, float> squareFromDirection(const glm::vec<3, float>&);
template glm::vec<2, double> squareFromDirection(const glm::vec<3, double>&);
template glm::vec<3, float> directionFromSquare(glm::vec<2, float>);
template glm::vec<3, double> directionFromSquare(glm::vec<2, double>);
template glm::vec<2, float> squareFromDisk(glm::vec<2, float>);
template glm::vec<2, double> squareFromDisk(glm::vec<2, double>);

template <class T>
glm::vec<3, T> clampTheta(const glm::vec<3, T>& w, T theta_max) {
  const T cosine = std::cos(theta_max);
  if (w.z >= cosine) return w;
  const T sine = std::sqrt(w.x * w.x + w.y * w.y);
  const T scale = std::sin(theta_max) / std::max(sine, T(1e-6));
  return {w.x * scale, w.y * scale, cosine};
}

template glm::vec3 clampTheta(const glm::vec3&, float);
template glm::dvec3 clampTheta(const glm::dvec3&, double);

template <class T>
glm::vec<2, T> gridPosition(const glm::vec<3, T>& w, T theta_max) {
  const T theta = std::acos(std::clamp(w.z, T(-1), T(1)));
  T phi = w.x == 0 && w.y == 0 ? T(0) : std::atan2(w.y, w.x);
  if (phi < 0) phi += T(2 * kPi);
  return {phi / T(2 * kPi), std::min(theta / theta_max, T(1))};
}

template glm::vec2 gridPosition(const glm::vec3&, float);
template glm::dvec2 gridPosition(const glm::dvec3&, double);

}  // namespace loden
