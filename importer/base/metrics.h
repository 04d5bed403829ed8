// Differences between linear RGB values, in the colour spaces of material/model/color.h. White Lambert lit
// from above is 1.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace loden::importer {

struct ChannelError {
  double mse = 0, rmse = 0, mae = 0;  // white = 1
};

// Sums of errors over pairs of values. Merging sums in a fixed order gives results that do not depend on the
// number of threads.
class ErrorSums {
 public:
  void add(const glm::dvec3& reference, const glm::dvec3& test);
  void add(std::span<const glm::vec3> reference, std::span<const glm::vec3> test);
  void merge(const ErrorSums& other);

  uint64_t count() const { return count_; }
  ChannelError y() const { return channel(0); }
  ChannelError cb() const { return channel(1); }
  ChannelError cr() const { return channel(2); }
  double labMean() const { return count_ ? lab_sum_ / static_cast<double>(count_) : 0; }  // CIE76 distance
  double labMax() const { return lab_max_; }
  // 10 log10(1 / mean square over R, G, B); infinite if equal.
  double psnr() const;

 private:
  ChannelError channel(int c) const;
  uint64_t count_ = 0;
  glm::dvec3 squares_{0}, absolutes_{0};  // sums for Y, Cb, Cr
  double rgb_squares_ = 0;                // summed over the three channels
  double lab_sum_ = 0, lab_max_ = 0;
};

}  // namespace loden::importer
