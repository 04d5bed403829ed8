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

// How many of something: the first in the tests, the second by ./loden.sh stress (LODEN_STRESS_LONG is set).
int64_t amount(int64_t quick, int64_t long_run);

// Prints a number and what it must be, and adds a row to the file that LODEN_STRESS_RECORD names, if it
// does: what was measured, the number, the bound, the command.
void record(const std::string& what, double number, const std::string& bound);
void recordText(const std::string& what, const std::string& number, const std::string& bound);
// "1.5e-07".
std::string shortNumber(double number);

// Counts by powers of two of an error in some unit: up to 1/2, 1, 2, 4 ... 64, and more.
class Histogram {
 public:
  void add(double error);
  double largest() const { return largest_; }
  int64_t count() const { return count_; }
  // Share of the values whose error is at most `unit`, a power of two from 1/2 to 64.
  double shareUpTo(double unit) const;
  // "<=.5: 93.1 %, <=1: 5 %, ...; most 3.1".
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

inline float above(float value, int ulps = 1) {
  for (int k = 0; k < ulps; ++k) value = std::nextafter(value, std::numeric_limits<float>::infinity());
  return value;
}
inline float below(float value, int ulps = 1) {
  for (int k = 0; k < ulps; ++k) value = std::nextafter(value, -std::numeric_limits<float>::infinity());
  return value;
}

// Finite and not negative.
template <class T>
bool blackOrLight(const glm::vec<3, T>& value) {
  for (int c = 0; c < 3; ++c)
    if (!(value[c] >= 0) || !std::isfinite(value[c])) return false;
  return true;
}
template <class T>
double largestOf(const glm::vec<3, T>& value) {
  return std::max({std::abs(double(value.x)), std::abs(double(value.y)), std::abs(double(value.z))});
}

// A direction, and whether light or sight can come along it: all components finite, z above 0.
struct EdgeDirection {
  std::string name;
  glm::vec3 w;
  bool valid = true;  // else what is shown is black
  bool unit = true;   // to float's rounding
};
// Along the normal, horizontal, just above the horizon, below it, zero, signed zeros, not of unit length, not
// finite; on and beside the seams of every map of directions: azimuths at multiples of 45 degrees, rows of
// theta, the last row, the limit of lookups.
std::vector<EdgeDirection> edgeDirections(float theta_max);

// Coordinates in tile periods: whole ones up to 1e5 of both signs, borders and centres of the texels of a
// side, each with its neighbours one ulp below and above.
std::vector<float> edgeCoordinates(int side);

// Levels: not a number, infinite, every value of `borders` with its neighbours, and beyond the last.
std::vector<float> edgeLevels(const std::vector<float>& borders);

}  // namespace loden::stress
