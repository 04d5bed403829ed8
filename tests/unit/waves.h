// Surfaces with known answers: a wave as a height field, and a wave that leans over until it overhangs.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "material/model/vdim.h"

namespace loden::test {

inline constexpr double kTau = 2 * kPi;

// The position at p of a wave along x. Its crests lean by `lean` tile periods; they overhang if that is
// large.
inline glm::dvec3 wavePoint(glm::dvec2 p, double height, double lean) {
  const double phase = kTau * 2 * p.x, crest = 0.5 + 0.5 * std::cos(phase);
  return {p.x + lean * (crest - 0.5), p.y, -height * (1 - crest)};
}

inline GeometryImage waveImage(int side, double height, double lean) {
  std::vector<glm::dvec3> points;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i)
      points.push_back(wavePoint({(i + 0.5) / side, (j + 0.5) / side}, height, lean));
  return encodeGeometryImage(side, points, std::vector<uint16_t>(points.size(), 1), lean == 0);
}

struct View {
  glm::dvec2 x;
  glm::dvec3 wo;
};
inline std::vector<View> randomViews(int count, double theta_max_degrees) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<View> views;
  for (int k = 0; k < count; ++k) {
    const double z = 1 - unit(random) * (1 - std::cos(theta_max_degrees * kPi / 180)),
                 phi = kTau * unit(random);
    const double sine = std::sqrt(1 - z * z);
    views.push_back(
        {{4 * unit(random) - 2, 4 * unit(random) - 2}, {sine * std::cos(phi), sine * std::sin(phi), z}});
  }
  return views;
}

}  // namespace loden::test
