// The colour models of DFMF files, which convert decorrelated channels to linear RGB.
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
  kLogY = 9,          // Y = exp(y) - eps; U and V as they are stored
  kLogYuv = 10,       // Y = exp(y) - eps; U and V = sign * exp(|x| + log eps)
  kLogYuvRatio = 11,  // Y = exp(y) - eps; U and V are stored divided by Y + eps. Used by UBO2014
  kLogRgb = 12,
};

bool isSupported(int32_t model);
// The name of a colour model, for messages; models that are known but not supported have names, too.
std::string colorModelName(int32_t model);

struct ColorTransform {
  ColorModel model = ColorModel::kRgb;
  glm::dvec3 mean{0};
  double matrix[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major
  glm::dvec3 rgb(const glm::dvec3& stored) const;
};

}  // namespace loden::importer::btf
