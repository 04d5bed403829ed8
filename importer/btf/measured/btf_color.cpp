#include "importer/btf/measured/btf_color.h"

#include <cmath>

namespace loden::importer::btf {
namespace {

constexpr double kEpsilon = 1e-5;

glm::dvec3 rgbFromYuv(const glm::dvec3& yuv) {
  return {yuv.x + 1.13983 * yuv.z, yuv.x - 0.39465 * yuv.y - 0.5806 * yuv.z, yuv.x + 2.03211 * yuv.y};
}

double signedExp(double x) {
  return x == 0 ? 0 : std::copysign(std::exp(std::abs(x) + std::log(kEpsilon)), x);
}

}  // namespace

bool isSupported(int32_t model) {
  switch (static_cast<ColorModel>(model)) {
    case ColorModel::kRgb:
    case ColorModel::kYuv:
    case ColorModel::kPca:
    case ColorModel::kYCoCg:
    case ColorModel::kLogY:
    case ColorModel::kLogYuv:
    case ColorModel::kLogYuvRatio:
    case ColorModel::kLogRgb:
      return true;
  }
  return false;
}

std::string colorModelName(int32_t model) {
  switch (model) {
    case 2:
      return "Lab";
    case 5:
      return "spectral";
    case 6:
      return "linear spectral";
    default:
      return "which is unknown";
  }
}

glm::dvec3 ColorTransform::rgb(const glm::dvec3& s) const {
  switch (model) {
    case ColorModel::kRgb:
      return s;
    case ColorModel::kYuv:
      return rgbFromYuv(s);
    case ColorModel::kPca: {
      glm::dvec3 out = mean;
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) out[column] += s[row] * matrix[row * 3 + column];
      return out;
    }
    case ColorModel::kYCoCg:
      return {s.x + s.y - s.z, s.x + s.z, s.x - s.y - s.z};
    case ColorModel::kLogY:
      return rgbFromYuv({std::exp(s.x) - kEpsilon, s.y, s.z});
    case ColorModel::kLogYuv:
      return rgbFromYuv({std::exp(s.x) - kEpsilon, signedExp(s.y), signedExp(s.z)});
    case ColorModel::kLogYuvRatio: {
      const double y = std::exp(s.x) - kEpsilon;
      return rgbFromYuv({y, s.y * (y + kEpsilon), s.z * (y + kEpsilon)});
    }
    case ColorModel::kLogRgb:
      return glm::exp(s) - kEpsilon;
  }
  return s;
}

}  // namespace loden::importer::btf
