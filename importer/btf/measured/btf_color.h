// Colour models of DFMF files: decorrelated channels to linear RGB.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace loden::importer::btf {

enum class ColorModel : int32_t {
  kRgb = 0,
  kYuv = 1,
  kPca = 3,           // x * matrix + mean
  kLogYuvRatio = 11,  // Y = exp(y) - eps; U and V stored divided by Y + eps
  kLogRgb = 12,
  kLogY = 9,     // Y alone is a logarithm
  kLogAll = 10,  // sign * exp(|x| + log eps), then YUV
};

bool isSupported(int32_t model);

struct ColorTransform {
  ColorModel model = ColorModel::kRgb;
  glm::dvec3 mean{0};
  double matrix[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major
  glm::dvec3 rgb(const glm::dvec3& stored) const;
};

}  // namespace loden::importer::btf
