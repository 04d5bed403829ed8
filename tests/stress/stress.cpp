#include "tests/stress/stress.h"

#include <errno.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "material/model/directions.h"
#include "material/model/vdim.h"

namespace loden::stress {
namespace {

const float kInfinity = std::numeric_limits<float>::infinity();
const float kNan = std::numeric_limits<float>::quiet_NaN();

std::string commandOfThisTest() {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  std::string command = program_invocation_short_name;
  if (test) command += std::string(" --gtest_filter=") + test->test_suite_name() + "." + test->name();
  return command;
}

glm::vec3 unit(double theta, double phi) {
  return glm::vec3(directionFromSpherical({theta, phi}));
}

}  // namespace

int64_t amount(int64_t quick, int64_t long_run) {
  return std::getenv("LODEN_STRESS_LONG") ? long_run : quick;
}

std::string shortNumber(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", number);
  return text;
}

void recordText(const std::string& what, const std::string& number, const std::string& bound) {
  std::printf("  %s: %s (%s)\n", what.c_str(), number.c_str(), bound.c_str());
  const char* path = std::getenv("LODEN_STRESS_RECORD");
  if (!path) return;
  std::ofstream(path, std::ios::app) << "| " << what << " | " << number << " | " << bound << " | `"
                                     << commandOfThisTest() << "` |\n";
}

void record(const std::string& what, double number, const std::string& bound) {
  recordText(what, shortNumber(number), bound);
}

void Histogram::add(double error) {
  int bin = 0;
  for (double unit = 0.5; bin + 1 < kBins && !(error <= unit); unit *= 2) ++bin;
  ++bins_[bin], ++count_;
  largest_ = std::isnan(error) ? INFINITY : std::max(largest_, error);
}

double Histogram::shareUpTo(double unit) const {
  int64_t sum = 0;
  double limit = 0.5;
  for (int bin = 0; bin < kBins && limit <= unit; ++bin, limit *= 2) sum += bins_[bin];
  return count_ > 0 ? double(sum) / double(count_) : 1;
}

std::string Histogram::text() const {
  std::string all;
  double limit = 0.5;
  for (int bin = 0; bin < kBins; ++bin, limit *= 2) {
    if (bins_[bin] == 0) continue;
    const bool last = bin + 1 == kBins;
    all += last ? ">" : "<=";
    all += shortNumber(last ? limit / 2 : limit) + ": ";
    all += shortNumber(100 * double(bins_[bin]) / double(count_)) + " %, ";
  }
  return all + "most " + shortNumber(largest_);
}

std::vector<EdgeDirection> edgeDirections(float theta_max) {
  std::vector<EdgeDirection> all;
  const auto add = [&](const char* name, glm::vec3 w, bool valid = true, bool unit = true) {
    all.push_back({name, w, valid, unit});
  };
  add("normal", {0, 0, 1});
  add("normal, signed zeros", {-0.0f, -0.0f, 1});
  add("normal, signed zero", {0, -0.0f, 1});
  add("normal, tiny x", {1e-30f, 0, 1});
  add("normal, tiny negative y", {0, -1e-8f, 1});
  add("normal, one ulp", {0, 0, below(1.0f)}, true, true);
  for (const float z : {0.0f, -0.0f}) {
    add("horizontal", {1, 0, z}, false);
    add("horizontal", {-1, -0.0f, z}, false);
    add("horizontal", {0, -1, z}, false);
    add("horizontal", {std::sqrt(0.5f), -std::sqrt(0.5f), z}, false);
  }
  for (const float z : {1e-45f, std::numeric_limits<float>::min(), 1e-20f, 6e-8f, 1e-4f}) {
    add("just above the horizon", {1, 0, z});
    add("just above the horizon", {-0.6f, -0.8f, z});
    add("just below the horizon", {0, -1, -z}, false);
  }
  add("below", {0, 0, -1}, false);
  add("below", {0.6f, 0, -0.8f}, false);
  add("zero", {0, 0, 0}, false);
  add("zero, signed", {-0.0f, 0, -0.0f}, false);
  for (const float scale : {1e-6f, 0.5f, 2.0f, 1e6f})
    add("not of unit length", scale * glm::vec3(0.36f, -0.48f, 0.8f), true, false);
  for (const float bad : {kNan, kInfinity, -kInfinity})
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec3 w(0.36f, -0.48f, 0.8f);
      w[axis] = bad;
      add("not finite", w, false);
    }
  add("too long to square", glm::vec3(1e25f, 1e25f, 1e25f), false);
  // Seams. In float a unit vector of these angles lies on one side or the other: neighbours on both.
  std::vector<double> thetas{1e-8, 1e-7, 1e-6, 1e-4};
  for (int row = 1; row <= 5; ++row) thetas.push_back(double(theta_max) * row / 5);
  thetas.push_back(kThetaMax);
  for (const double theta : thetas)
    for (int eighth = 0; eighth < 8; ++eighth)
      for (const double off : {-3e-7, -1e-8, 0.0, 1e-8, 3e-7})
        add("seam of azimuth", unit(theta, kPi / 4 * eighth + off));
  for (const double row : thetas)
    for (const double off : {-2e-7, -6e-8, 6e-8, 2e-7})
      if (row + off > 0) add("seam of theta", unit(row + off, 0.3));
  return all;
}

std::vector<float> edgeCoordinates(int side) {
  std::vector<float> all;
  const auto add = [&](float x) { all.insert(all.end(), {below(x), x, above(x)}); };
  for (const float x : {0.0f, -0.0f, 1.0f, 1e3f, 1e5f, 0.3f, 1000.3f, 1e-30f, 1e7f, 3e9f, 1e30f}) {
    add(x);
    add(-x);
  }
  for (int k = 1; k < side; ++k) {
    add(float(k) / float(side));
    add((float(k) + 0.5f) / float(side));
  }
  add(0.5f / float(side));
  return all;
}

std::vector<float> edgeLevels(const std::vector<float>& borders) {
  std::vector<float> all{kNan, -kNan, -kInfinity, kInfinity, -1e30f, 1e30f, -1e4f, 1e4f, 2e4f, 3e4f};
  for (const float border : borders) all.insert(all.end(), {below(border), border, above(border)});
  return all;
}

}  // namespace loden::stress
