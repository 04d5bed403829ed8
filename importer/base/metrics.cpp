#include "importer/base/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "material/base/check.h"
#include "material/model/color.h"

namespace loden::importer {

void ErrorSums::add(const glm::dvec3& reference, const glm::dvec3& test) {
  const glm::dvec3 rgb = test - reference;
  const glm::dvec3 ycc = yccFromRgb(rgb);
  squares_ += ycc * ycc;
  absolutes_ += glm::abs(ycc);
  rgb_squares_ += glm::dot(rgb, rgb);
  const double lab = glm::distance(labFromRgb(reference), labFromRgb(test));
  lab_sum_ += lab;
  lab_max_ = std::max(lab_max_, lab);
  ++count_;
}

void ErrorSums::add(std::span<const glm::vec3> reference, std::span<const glm::vec3> test) {
  LODEN_CHECK_EQ(reference.size(), test.size());
  for (size_t i = 0; i < reference.size(); ++i) add(glm::dvec3(reference[i]), glm::dvec3(test[i]));
}

void ErrorSums::merge(const ErrorSums& other) {
  count_ += other.count_;
  squares_ += other.squares_;
  absolutes_ += other.absolutes_;
  rgb_squares_ += other.rgb_squares_;
  lab_sum_ += other.lab_sum_;
  lab_max_ = std::max(lab_max_, other.lab_max_);
}

double ErrorSums::psnr() const {
  if (rgb_squares_ == 0) return std::numeric_limits<double>::infinity();
  return -10 * std::log10(rgb_squares_ / (3 * static_cast<double>(count_)));
}

ChannelError ErrorSums::channel(int c) const {
  if (!count_) return {};
  const double n = static_cast<double>(count_), mse = squares_[c] / n;
  return {mse, std::sqrt(mse), absolutes_[c] / n};
}

}  // namespace loden::importer
