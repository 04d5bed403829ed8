#include "material/model/environment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "material/base/check.h"
#include "material/model/directions.h"

namespace loden {
namespace {

constexpr double kSunCosine = 0.965925826289068;  // of 15 degrees
constexpr double kSunContrast = 2, kSunShare = 0.03;

double luminance(const glm::dvec3& c) {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

// Pixels that are usable, each with its solid angle.
struct Pixel {
  glm::dvec3 direction, radiance;
  double solid_angle;
};

std::vector<Pixel> usablePixels(const Panorama& panorama) {
  std::vector<Pixel> pixels;
  pixels.reserve(panorama.pixels.size());
  for (int row = 0; row < panorama.height; ++row) {
    const double top = std::cos(kPi * row / panorama.height),
                 bottom = std::cos(kPi * (row + 1) / panorama.height);
    const double solid_angle = 2 * kPi / panorama.width * (top - bottom);
    for (int column = 0; column < panorama.width; ++column) {
      glm::dvec3 c(panorama.pixels[size_t(row) * panorama.width + column]);
      for (int k = 0; k < 3; ++k) c[k] = std::isfinite(c[k]) ? std::max(c[k], 0.0) : 0.0;
      pixels.push_back({panoramaDirection(panorama, column + 0.5, row + 0.5), c, solid_angle});
    }
  }
  return pixels;
}

double totalLuminance(const std::vector<Pixel>& pixels) {
  double sum = 0;
  for (const Pixel& p : pixels) sum += luminance(p.radiance) * p.solid_angle;
  return sum;
}

// Of the luminances, by solid angle.
double medianLuminance(const std::vector<Pixel>& pixels) {
  std::vector<std::pair<double, double>> sorted;
  for (const Pixel& p : pixels) sorted.emplace_back(luminance(p.radiance), p.solid_angle);
  std::sort(sorted.begin(), sorted.end());
  double below = 0;
  for (const auto& [value, solid_angle] : sorted)
    if ((below += solid_angle) >= 2 * kPi) return value;
  return 0;
}

// What of the pixel stands out above `floor`.
glm::dvec3 excess(const Pixel& pixel, double floor) {
  const double y = luminance(pixel.radiance);
  return y > floor ? pixel.radiance * (1 - floor / y) : glm::dvec3(0);
}

// The middle of what stands out around `start`.
glm::dvec3 excessCentre(const std::vector<Pixel>& pixels, double floor, const glm::dvec3& start) {
  glm::dvec3 sum(0);
  for (const Pixel& p : pixels)
    if (glm::dot(p.direction, start) > kSunCosine)
      sum += p.direction * (luminance(excess(p, floor)) * p.solid_angle);
  return glm::length(sum) > 0 ? glm::normalize(sum) : start;
}

// Takes the strongest light out of the pixels; none if nothing stands out.
bool takeSun(std::vector<Pixel>& pixels, double floor, double least, EnvironmentSun& sun) {
  const auto brightest = std::max_element(pixels.begin(), pixels.end(), [](const Pixel& a, const Pixel& b) {
    return luminance(a.radiance) < luminance(b.radiance);
  });
  glm::dvec3 centre = brightest->direction;
  for (int step = 0; step < 4; ++step) centre = excessCentre(pixels, floor, centre);
  glm::dvec3 irradiance(0), moment(0);
  for (const Pixel& p : pixels) {
    if (glm::dot(p.direction, centre) <= kSunCosine) continue;
    const glm::dvec3 light = excess(p, floor) * p.solid_angle;
    irradiance += light;
    moment += p.direction * luminance(light);
  }
  if (!(luminance(irradiance) >= least)) return false;
  for (Pixel& p : pixels)
    if (glm::dot(p.direction, centre) > kSunCosine) p.radiance -= excess(p, floor);
  sun = {glm::vec3(glm::normalize(moment)), glm::vec3(irradiance / kPi)};
  return true;
}

// Projection onto the orthogonal functions 1, w and w w^T - I/3.
EnvironmentLight project(const std::vector<Pixel>& pixels) {
  glm::dvec3 mean(0);
  std::array<glm::dvec3, 3> first{glm::dvec3(0), glm::dvec3(0), glm::dvec3(0)};
  std::array<glm::dmat3, 3> second{glm::dmat3(0), glm::dmat3(0), glm::dmat3(0)};
  for (const Pixel& p : pixels) {
    const glm::dvec3 light = p.radiance * (p.solid_angle / (4 * kPi));
    const glm::dmat3 traceless = glm::outerProduct(p.direction, p.direction) - glm::dmat3(1.0 / 3);
    mean += light;
    for (int c = 0; c < 3; ++c) {
      first[c] += light[c] * p.direction;
      second[c] += light[c] * traceless;
    }
  }
  EnvironmentLight light;
  light.constant = glm::vec3(mean);
  for (int c = 0; c < 3; ++c) {
    light.linear[c] = glm::vec3(3.0 * first[c]);      // the mean of (w.a)^2 is a.a / 3
    light.quadratic[c] = glm::mat3(7.5 * second[c]);  // the mean of (w.Aw)^2 is 2/15 A:A for traceless A
  }
  return light;
}

}  // namespace

glm::vec3 radianceFrom(const EnvironmentLight& light, const glm::vec3& w) {
  glm::vec3 sum = light.constant;
  for (int c = 0; c < 3; ++c) sum[c] += glm::dot(light.linear[c], w) + glm::dot(w, light.quadratic[c] * w);
  return sum;
}

EnvironmentLight rotated(const EnvironmentLight& light, const glm::mat3& new_from_old) {
  EnvironmentLight result = light;
  for (int c = 0; c < 3; ++c) {
    result.linear[c] = new_from_old * light.linear[c];
    result.quadratic[c] = new_from_old * light.quadratic[c] * glm::transpose(new_from_old);
  }
  return result;
}

EnvironmentLight skyLight(const glm::vec3& sky, const glm::vec3& ground, const glm::vec3& up) {
  // The irradiance of a + b.w is pi a + 2 pi / 3 b.n.
  constexpr float pi = static_cast<float>(kPi);
  EnvironmentLight light;
  light.constant = (sky + ground) / (2 * pi);
  for (int c = 0; c < 3; ++c) light.linear[c] = up * (0.75f * (sky[c] - ground[c]) / pi);
  return light;
}

glm::dvec3 panoramaDirection(const Panorama& panorama, double column, double row) {
  const double phi = kPi * (1 - 2 * column / panorama.width);
  return directionFromSpherical({kPi * row / panorama.height, phi});
}

glm::vec3 panoramaPixel(const Panorama& panorama, const glm::dvec3& w) {
  const Spherical s = sphericalFromDirection(w);
  const double turn = 0.5 - s.phi / (2 * kPi);
  const int column = static_cast<int>((turn - std::floor(turn)) * panorama.width);
  const int row = static_cast<int>(s.theta / kPi * panorama.height);
  return panorama.pixels[size_t(std::clamp(row, 0, panorama.height - 1)) * panorama.width +
                         std::clamp(column, 0, panorama.width - 1)];
}

Environment projectPanorama(const Panorama& panorama, int suns) {
  LODEN_CHECK_EQ(panorama.pixels.size(), size_t(panorama.width) * panorama.height);
  std::vector<Pixel> pixels = usablePixels(panorama);
  Environment environment;
  const double total = totalLuminance(pixels);
  const double floor = kSunContrast * medianLuminance(pixels);
  EnvironmentSun sun;
  while (total > 0 && int(environment.suns.size()) < suns && takeSun(pixels, floor, kSunShare * total, sun))
    environment.suns.push_back(sun);
  environment.light = project(pixels);
  return environment;
}

HemisphereLight hemisphereLight(const EnvironmentLight& light, const glm::mat3& frame) {
  HemisphereLight result;
  for (int c = 0; c < 3; ++c) {
    const glm::vec3 l = light.linear[c] * frame;
    const glm::mat3 m = glm::transpose(frame) * light.quadratic[c] * frame;
    const float flat = 0.5f * (m[0][0] + m[1][1]);  // x^2 and y^2 are (1 - z^2) / 2 and +-(x^2 - y^2) / 2
    const float squared = m[2][2] - flat;           // of z^2
    result.c[0][c] = light.constant[c] + flat - 0.3f * squared;
    result.c[1][c] = l.z + 1.2f * squared;
    result.c[2][c] = l.x + 16.0f / 15 * m[0][2];
    result.c[3][c] = l.y + 16.0f / 15 * m[1][2];
    result.c[4][c] = 2 * m[0][1];
    result.c[5][c] = 0.5f * (m[0][0] - m[1][1]);
  }
  return result;
}

}  // namespace loden
