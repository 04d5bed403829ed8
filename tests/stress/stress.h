// What the tests of numerical stability share: how long they run, and the numbers that they leave for
// RESULTS.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <string>
#include <vector>

namespace loden::stress {

// How much a test does: `quick` among the tests, `long_run` in `./loden.sh stress`, which sets
// LODEN_STRESS_LONG.
int64_t amount(int64_t quick, int64_t long_run);

// Prints what was measured, the number, and its bound. If the environment sets LODEN_STRESS_RECORD, adds
// these and the command as a row to the file of that name.
void record(const std::string& what, double number, const std::string& bound);
void recordText(const std::string& what, const std::string& number, const std::string& bound);
// The number in two digits, such as "1.5e-07".
std::string shortNumber(double number);

// Counts errors by powers of two: how many are up to 1/2, 1, 2, 4 ... 64 units, and how many are more.
class Histogram {
 public:
  void add(double error);
  double largest() const { return largest_; }
  int64_t count() const { return count_; }
  // Share of the values whose error is at most `unit`, a power of two from 1/2 to 64.
  double shareUpTo(double unit) const;
  // The shares and the largest error as a text: "<=.5: 93.1 %, <=1: 5 %, ...; most 3.1".
  std::string text() const;

 private:
  static constexpr int kBins = 9;
  int64_t bins_[kBins] = {}, count_ = 0;
  double largest_ = 0;
};

// The distance from |value| to the next float.
inline double ulpOf(double value) {
  const float f = std::max(std::abs(static_cast<float>(value)), std::numeric_limits<float>::min());
  return double(std::nextafter(f, std::numeric_limits<float>::infinity())) - double(f);
}

// The float that is so many floats above, or below, the value.
inline float above(float value, int ulps = 1) {
  for (int k = 0; k < ulps; ++k) value = std::nextafter(value, std::numeric_limits<float>::infinity());
  return value;
}
inline float below(float value, int ulps = 1) {
  for (int k = 0; k < ulps; ++k) value = std::nextafter(value, -std::numeric_limits<float>::infinity());
  return value;
}

// Whether all components are finite and none is negative.
template <class T>
bool blackOrLight(const glm::vec<3, T>& value) {
  for (int c = 0; c < 3; ++c)
    if (!(value[c] >= 0) || !std::isfinite(value[c])) return false;
  return true;
}
// The largest magnitude of a component.
template <class T>
double largestOf(const glm::vec<3, T>& value) {
  return std::max({std::abs(double(value.x)), std::abs(double(value.y)), std::abs(double(value.z))});
}

// A direction to test. It is valid if light can come, or an eye can look, along it: all components are finite
// and z is above 0.
struct EdgeDirection {
  std::string name;
  glm::vec3 w;
  bool valid = true;  // if not, black has to be shown
  bool unit = true;   // of unit length up to the rounding of float
};
// Directions along the normal, horizontal, just above and below the horizon, zero with both signs, not of
// unit length, not finite; and on and beside the seams of every map of directions: azimuths at multiples of
// 45 degrees, rows of theta, the last row, and theta_max, the limit of lookups.
std::vector<EdgeDirection> edgeDirections(float theta_max);

// Coordinates in tile periods: whole numbers up to 1e5 of both signs, and borders and centres of texels,
// `side` to the period, each with its neighbours one ulp below and above.
std::vector<float> edgeCoordinates(int side);

// Levels of detail: not a number, infinite, every value of `borders` with its neighbours, and beyond the
// last.
std::vector<float> edgeLevels(const std::vector<float>& borders);

}  // namespace loden::stress
