#include "tests/bench/plane_view.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "importer/base/parallel.h"
#include "material/model/geometry_image.h"

namespace loden::bench {

const glm::dvec3 kPlaneLights[kMostLights] = {
    glm::normalize(glm::dvec3(0.5, 0.3, 0.8)), glm::normalize(glm::dvec3(-0.3, 0.5, 0.8)),
    glm::normalize(glm::dvec3(-0.5, -0.3, 0.6)), glm::normalize(glm::dvec3(0.3, -0.5, 1.0))};

namespace {

glm::dmat2 turned(double angle) {
  return {{std::cos(angle), std::sin(angle)}, {-std::sin(angle), std::cos(angle)}};
}

}  // namespace

glm::dmat2 periodsOf(const PlaneView& view) {
  const double lengths = view.pixels * std::exp2(view.lambda) / view.texels;
  const glm::dvec2 scale = periodsPerLength(view.aspect);
  const glm::dmat2 across(lengths / std::cos(glm::radians(view.degrees)), 0, 0, lengths);
  return glm::dmat2(scale.x, 0, 0, scale.y) * turned(view.turn) * across;
}

glm::dvec2 cornerOf(const PlaneView& view) {
  PlaneView straight = view;
  straight.turn = 0;
  return view.shift + (periodsOf(straight) - periodsOf(view)) * glm::dvec2(0.5);
}

glm::dvec2 onPlane(const PlaneView& view, glm::dvec2 uv) {
  return cornerOf(view) + periodsOf(view) * uv;
}

glm::dvec3 towardsEye(const PlaneView& view, glm::dvec2 uv) {
  const double theta = glm::radians(view.degrees) + kSpread * (uv.x - 0.5);
  const glm::dvec3 wo = view.degrees == 0
                            ? glm::dvec3(uv - 0.5, 0.4)
                            : glm::dvec3(std::sin(theta), kSpread * (uv.y - 0.5), std::cos(theta));
  return glm::normalize(glm::dvec3(turned(view.turn) * glm::dvec2(wo), wo.z));
}

double askedLambda(const PlaneView& view) {
  const glm::dmat2 pixel = periodsOf(view) / double(view.pixels);
  const double across = glm::length(pixel[0]), along = glm::length(pixel[1]);
  return std::log2(std::max(std::min(across, along), std::max(across, along) / 2) * view.texels);
}

std::vector<glm::vec3> tracedPicture(const importer::TileTracer& tracer, const PlaneView& view, int samples,
                                     int lights) {
  const int pixels = view.pixels;
  const glm::dmat2 periods = periodsOf(view);
  const glm::dvec2 corner = cornerOf(view);
  std::vector<glm::vec3> picture(size_t(pixels) * size_t(pixels));
  importer::parallelFor(size_t(pixels), 0, [&](size_t j) {
    const importer::FlushDenormals flush;
    std::vector<glm::dvec2> x(size_t(samples) * size_t(samples));
    std::vector<std::optional<importer::TileHit>> hits(x.size());
    for (int i = 0; i < pixels; ++i) {
      const glm::dvec2 pixel(i, double(j));
      const glm::dvec3 wo = towardsEye(view, (pixel + 0.5) / double(pixels));
      for (int s = 0; s < samples * samples; ++s) {
        const glm::dvec2 inside = (glm::dvec2(s % samples, s / samples) + 0.4871) / double(samples);
        x[size_t(s)] = corner + periods * ((pixel + inside) / double(pixels));
      }
      tracer.intersectViews(x, wo, hits);
      glm::dvec3 sum(0);
      for (const auto& hit : hits)
        for (int light = 0; hit && light < lights; ++light)
          sum += importer::shadeHit(tracer, *hit, kPlaneLights[light], wo, 0, 0);
      picture[j * size_t(pixels) + size_t(i)] = glm::vec3(sum / double(samples * samples * lights));
    }
  });
  return picture;
}

}  // namespace loden::bench
