#include "material/model/uv_survey.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

namespace loden {
namespace {

struct Weighted {
  double value = 0, weight = 0;
};

// The value below which `share` of the weight lies.
double quantile(std::vector<Weighted> values, double share) {
  std::sort(values.begin(), values.end(),
            [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double total = 0, below = 0;
  for (const Weighted& one : values) total += one.weight;
  for (const Weighted& one : values)
    if ((below += one.weight) >= share * total) return one.value;
  return values.empty() ? 0 : values.back().value;
}

}  // namespace

void UvSurvey::add(const std::array<glm::dvec3, 3>& positions, const std::array<glm::dvec2, 3>& uvs) {
  const glm::dvec3 e1 = positions[1] - positions[0], e2 = positions[2] - positions[0];
  const glm::dvec2 d1 = uvs[1] - uvs[0], d2 = uvs[2] - uvs[0];
  const double area = 0.5 * glm::length(glm::cross(e1, e2)), determinant = d1.x * d2.y - d2.x * d1.y;
  if (!(area > 0) || !(std::abs(determinant) > 0)) return;
  const glm::dvec3 along_u = (e1 * d2.y - e2 * d1.y) / determinant,
                   along_v = (e2 * d1.x - e1 * d2.x) / determinant;
  const Triangle triangle{area, glm::dot(along_u, along_u), glm::dot(along_u, along_v),
                          glm::dot(along_v, along_v)};
  if (std::isfinite(triangle.uu + triangle.vv)) triangles_.push_back(triangle);
}

glm::dvec2 UvSurvey::metresPerUnit() const {
  std::vector<Weighted> along_u, along_v;
  for (const Triangle& triangle : triangles_) {
    along_u.push_back({std::sqrt(triangle.uu), triangle.area});
    along_v.push_back({std::sqrt(triangle.vv), triangle.area});
  }
  return {quantile(std::move(along_u), 0.5), quantile(std::move(along_v), 0.5)};
}

UvSurvey::Stretch UvSurvey::stretch(const glm::dvec2& metres_per_unit) const {
  std::vector<Weighted> values;
  double total = 0, strong = 0;
  for (const Triangle& triangle : triangles_) {
    const double a = triangle.uu / (metres_per_unit.x * metres_per_unit.x),
                 b = triangle.uv / (metres_per_unit.x * metres_per_unit.y),
                 c = triangle.vv / (metres_per_unit.y * metres_per_unit.y);
    const double root = std::hypot(0.5 * (a - c), b), middle = 0.5 * (a + c);
    const double most = std::sqrt(middle + root), least = std::sqrt(std::max(middle - root, 0.0));
    const double value = std::min(std::max(most, 1 / least), 1e6);
    values.push_back({value, triangle.area});
    total += triangle.area;
    if (value > kStrong) strong += triangle.area;
  }
  if (values.empty()) return {};
  return {quantile(std::move(values), 0.98), strong / total};
}

std::optional<glm::dvec2> scaleForPeriod(const glm::dvec2& metres_per_unit, double period, double aspect,
                                         double rotation) {
  constexpr double kHardly = 1e-6;
  glm::dvec2 tile(period, period * aspect);
  if (std::abs(aspect - 1) > kHardly) {
    const double c = std::abs(std::cos(rotation)), s = std::abs(std::sin(rotation));
    if (std::min(c, s) > kHardly) return {};
    if (c < s) std::swap(tile.x, tile.y);
  }
  return metres_per_unit / tile;
}

glm::dvec2 periodOfScale(const glm::dvec2& metres_per_unit, const glm::dvec2& scale, double rotation) {
  const double c = std::cos(rotation), s = std::sin(rotation);
  const glm::dmat2 x_from_uv = glm::dmat2(c, s, -s, c) * glm::dmat2(scale.x, 0, 0, scale.y);
  const glm::dmat2 uv_from_x = glm::inverse(x_from_uv);
  return {glm::length(metres_per_unit * uv_from_x[0]), glm::length(metres_per_unit * uv_from_x[1])};
}

std::optional<double> lengthFromText(const char* text) {
  double value = 0;
  int used = 0;
  if (std::sscanf(text, "%lf%n", &value, &used) != 1 || !(value > 0) || !(value < 1e6)) return {};
  const std::string unit = text + used;
  for (const auto& [name, metres] : {std::pair{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1.0}})
    if (unit == name) return value * metres;
  return {};
}

}  // namespace loden
