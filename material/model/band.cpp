#include "material/model/band.h"

#include <algorithm>
#include <cmath>

namespace loden {

template <class T>
T windowWeight(const Window& window, T lambda) {
  const T in = (lambda - T(window.in_begin)) / (T(window.in_end) - T(window.in_begin));
  const T out = (T(window.out_end) - lambda) / (T(window.out_end) - T(window.out_begin));
  return std::clamp(in, T(0), T(1)) * std::clamp(out, T(0), T(1));
}

template float windowWeight(const Window&, float);
template double windowWeight(const Window&, double);

template <class T>
T quadShare(const Band& band, int quad, T lambda) {
  if (quad == 0) return T(1);
  const QuadLevels& levels = band.quad_levels[size_t(quad)];
  return std::clamp(std::min(lambda - T(levels.begin), T(levels.end) - lambda), T(0), T(1));
}

template float quadShare(const Band&, int, float);
template double quadShare(const Band&, int, double);

DirectionGrid tableGrid(const Band& band, float theta_max) {
  return {static_cast<int>(std::lround(std::sqrt(double(std::max(band.table.height, 0))))), band.table.width,
          theta_max};
}

}  // namespace loden
