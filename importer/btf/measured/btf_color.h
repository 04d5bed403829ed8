// Colour models of DFMF files: decorrelated channels to linear RGB.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>

namespace loden::importer::btf {

enum class ColorModel : int32_t {
  kRgb = 0,
  kYuv = 1,
  kPca = 3,  // x * matrix + mean
  kYCoCg = 4,
  kLogY = 9,          // Y = exp(y) - eps; U and V as they are
  kLogYuv = 10,       // the same Y; U and V = sign * exp(|x| + log eps)
  kLogYuvRatio = 11,  // the same Y; U and V stored divided by Y + eps. What UBO2014 uses
  kLogRgb = 12,
};

bool isSupported(int32_t model);
// For messages: the models that are known but not supported have names, too.
std::string colorModelName(int32_t model);

struct ColorTransform {
  ColorModel model = ColorModel::kRgb;
  glm::dvec3 mean{0};
  double matrix[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major
  glm::dvec3 rgb(const glm::dvec3& stored) const;
};

}  // namespace loden::importer::btf
