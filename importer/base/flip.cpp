#include "importer/base/flip.h"

#include <algorithm>
#include <cmath>

#include "material/base/check.h"
#include "material/model/directions.h"

namespace loden::importer {
namespace {

using Plane = std::vector<double>;

struct Planes {
  int width = 0, height = 0;
  Plane c[3];
};

// sRGB primaries, D65, with the constants that the authors use, so that white has exactly Y = 1.
constexpr double kXyzFromRgb[3][3] = {{10135552. / 24577794., 8788810. / 24577794., 4435075. / 24577794.},
                                      {2613072. / 12288897., 8788810. / 12288897., 887015. / 12288897.},
                                      {1425072. / 73733382., 8788810. / 73733382., 70074185. / 73733382.}};
const glm::dvec3 kWhite{kXyzFromRgb[0][0] + kXyzFromRgb[0][1] + kXyzFromRgb[0][2], 1,
                        kXyzFromRgb[2][0] + kXyzFromRgb[2][1] + kXyzFromRgb[2][2]};

glm::dmat3 xyzFromRgbMatrix() {
  glm::dmat3 m;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) m[column][row] = kXyzFromRgb[row][column];
  return m;
}

// YCxCz, the opponent space that is filtered, and back.
glm::dvec3 yccFromXyz(const glm::dvec3& xyz) {
  const glm::dvec3 n = xyz / kWhite;
  return {116 * n.y - 16, 500 * (n.x - n.y), 200 * (n.y - n.z)};
}

glm::dvec3 xyzFromYccz(const glm::dvec3& ycc) {
  const double y = (ycc.x + 16) / 116;
  return glm::dvec3(y + ycc.y / 500, y, y - ycc.z / 200) * kWhite;
}

glm::dvec3 labFromXyz(const glm::dvec3& xyz) {
  constexpr double kDelta = 6.0 / 29.0;
  const auto f = [&](double t) {
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29.0;
  };
  const glm::dvec3 n = xyz / kWhite;
  return {116 * f(n.y) - 16, 500 * (f(n.x) - f(n.y)), 200 * (f(n.y) - f(n.z))};
}

// Colours look less colourful where it is dark (Hunt effect).
glm::dvec3 huntAdjusted(const glm::dvec3& lab) {
  return {lab.x, lab.y * 0.01 * lab.x, lab.z * 0.01 * lab.x};
}

double hyab(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 d = a - b;
  return std::abs(d.x) + std::hypot(d.y, d.z);
}

using Kernel = std::vector<double>;  // 2 * radius + 1 taps

Kernel gaussian(int radius, double minus_exponent) {
  Kernel kernel;
  for (int x = -radius; x <= radius; ++x) kernel.push_back(std::exp(-minus_exponent * x * x));
  return kernel;
}

double sumOf(const Kernel& kernel) {
  double sum = 0;
  for (const double tap : kernel) sum += tap;
  return sum;
}

// sum_y sum_x in(x, y) horizontal(x) vertical(y), edges repeated.
Plane convolved(const Plane& in, int width, int height, const Kernel& horizontal, const Kernel& vertical) {
  const int radius = static_cast<int>(horizontal.size() / 2);
  Plane rows(in.size()), out(in.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (int k = -radius; k <= radius; ++k)
        sum += horizontal[k + radius] * in[size_t(y) * width + std::clamp(x + k, 0, width - 1)];
      rows[size_t(y) * width + x] = sum;
    }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (int k = -radius; k <= radius; ++k)
        sum += vertical[k + radius] * rows[size_t(std::clamp(y + k, 0, height - 1)) * width + x];
      out[size_t(y) * width + x] = sum;
    }
  return out;
}

Planes opponentPlanes(std::span<const glm::vec3> rgb, int width, int height) {
  Planes planes{width, height, {}};
  for (Plane& plane : planes.c) plane.resize(rgb.size());
  const glm::dmat3 xyz_from_rgb = xyzFromRgbMatrix();
  for (size_t i = 0; i < rgb.size(); ++i) {
    const glm::dvec3 ycc = yccFromXyz(xyz_from_rgb * glm::clamp(glm::dvec3(rgb[i]), 0.0, 1.0));
    for (int c = 0; c < 3; ++c) planes.c[c][i] = ycc[c];
  }
  return planes;
}

// Spatial filters: contrast sensitivity of the eye, a sum of Gaussians per channel: a sqrt(pi / b) exp(-pi^2
// x^2 / b).
Planes filteredByContrast(const Planes& in, double ppd) {
  struct Term {
    double a, b;
  };
  static const std::vector<Term> kTerms[3] = {{{1, 0.0047}}, {{1, 0.0053}}, {{34.1, 0.04}, {13.5, 0.025}}};
  constexpr double kWidest = 0.04;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(kWidest / (2 * kPi * kPi)) * ppd));
  Planes out{in.width, in.height, {}};
  for (int c = 0; c < 3; ++c) {
    out.c[c].assign(in.c[c].size(), 0);
    double norm = 0;
    for (const Term& term : kTerms[c]) {
      const Kernel kernel = gaussian(radius, kPi * kPi / (term.b * ppd * ppd));
      const double weight = term.a * std::sqrt(kPi / term.b);
      norm += weight * sumOf(kernel) * sumOf(kernel);
      const Plane part = convolved(in.c[c], in.width, in.height, kernel, kernel);
      for (size_t i = 0; i < part.size(); ++i) out.c[c][i] += weight * part[i];
    }
    for (double& value : out.c[c]) value /= norm;
  }
  return out;
}

// Colour pipeline: what is seen, as Hunt-adjusted Lab.
std::vector<glm::dvec3> perceivedColors(const Planes& opponent, double ppd) {
  const Planes filtered = filteredByContrast(opponent, ppd);
  const glm::dmat3 xyz_from_rgb = xyzFromRgbMatrix();
  const glm::dmat3 rgb_from_xyz = glm::inverse(xyz_from_rgb);
  std::vector<glm::dvec3> lab(opponent.c[0].size());
  for (size_t i = 0; i < lab.size(); ++i) {
    const glm::dvec3 xyz = xyzFromYccz({filtered.c[0][i], filtered.c[1][i], filtered.c[2][i]});
    const glm::dvec3 rgb = glm::clamp(rgb_from_xyz * xyz, 0.0, 1.0);
    lab[i] = huntAdjusted(labFromXyz(xyz_from_rgb * rgb));
  }
  return lab;
}

// The colour difference, compressed and mapped to [0, 1]: 0.4 of the largest distance takes 0.95 of the
// range.
double remappedColorDifference(double distance) {
  static const double kLargest = [] {
    const glm::dmat3 m = xyzFromRgbMatrix();
    const glm::dvec3 green = huntAdjusted(labFromXyz(m * glm::dvec3(0, 1, 0)));
    const glm::dvec3 blue = huntAdjusted(labFromXyz(m * glm::dvec3(0, 0, 1)));
    return std::pow(hyab(green, blue), 0.7);
  }();
  constexpr double kKneeAt = 0.4, kKneeValue = 0.95;
  const double compressed = std::pow(distance, 0.7), knee = kKneeAt * kLargest;
  if (compressed < knee) return kKneeValue / knee * compressed;
  return kKneeValue + (compressed - knee) / (kLargest - knee) * (1 - kKneeValue);
}

void normalizeSigned(Kernel& kernel) {
  double positive = 0, negative = 0;
  for (const double tap : kernel) (tap > 0 ? positive : negative) += tap;
  for (double& tap : kernel) tap /= tap > 0 ? positive : -negative;
}

struct Features {
  Plane edges, points;
};

// Feature pipeline: edges and points, by first and second derivatives of a Gaussian 0.082 degrees wide.
Features detectFeatures(const Planes& opponent, double ppd) {
  const double sigma = 0.5 * 0.082 * ppd;
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  Kernel smooth = gaussian(radius, 1 / (2 * sigma * sigma));
  Kernel first = smooth, second = smooth;
  for (int x = -radius; x <= radius; ++x) {
    first[x + radius] *= -x;
    second[x + radius] *= x * x / (sigma * sigma) - 1;
  }
  normalizeSigned(first);
  normalizeSigned(second);
  const double norm = sumOf(smooth);
  for (double& tap : smooth) tap /= norm;

  Plane gray(opponent.c[0].size());
  for (size_t i = 0; i < gray.size(); ++i) gray[i] = (opponent.c[0][i] + 16) / 116;
  const auto magnitude = [&](const Kernel& kernel) {
    Plane x = convolved(gray, opponent.width, opponent.height, kernel, smooth);
    const Plane y = convolved(gray, opponent.width, opponent.height, smooth, kernel);
    for (size_t i = 0; i < x.size(); ++i) x[i] = std::hypot(x[i], y[i]);
    return x;
  };
  return {magnitude(first), magnitude(second)};
}

}  // namespace

FlipError flip(std::span<const glm::vec3> reference, std::span<const glm::vec3> test, int width, int height,
               double pixels_per_degree) {
  LODEN_CHECK_EQ(reference.size(), size_t(width) * height);
  LODEN_CHECK_EQ(test.size(), reference.size());
  const Planes planes_r = opponentPlanes(reference, width, height),
               planes_t = opponentPlanes(test, width, height);
  const auto colors_r = perceivedColors(planes_r, pixels_per_degree),
             colors_t = perceivedColors(planes_t, pixels_per_degree);
  const Features features_r = detectFeatures(planes_r, pixels_per_degree);
  const Features features_t = detectFeatures(planes_t, pixels_per_degree);

  FlipError error;
  error.pixels.reserve(reference.size());
  for (size_t i = 0; i < reference.size(); ++i) {
    const double color = remappedColorDifference(hyab(colors_r[i], colors_t[i]));
    const double feature = std::max(std::abs(features_r.edges[i] - features_t.edges[i]),
                                    std::abs(features_r.points[i] - features_t.points[i]));
    const double value =
        std::pow(color, 1 - std::sqrt(feature / std::sqrt(2.0)));  // colour and feature differences joined
    error.mean += value;
    error.max = std::max(error.max, value);
    error.pixels.push_back(static_cast<float>(value));
  }
  error.mean /= std::max<size_t>(1, reference.size());
  return error;
}

}  // namespace loden::importer
