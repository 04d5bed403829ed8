// A panorama as random lights, and traced pictures under it.

#include <gtest/gtest.h>

#include <cmath>

#include "importer/base/random.h"
#include "importer/trace/panorama_lights.h"
#include "importer/trace/trace.h"
#include "tests/unit/panoramas.h"

namespace loden::importer {
namespace {

using test::panoramaOf;

TEST(PanoramaLights, MeanOfWeightsIsTheIrradiance) {
  // Light (1 + z, 1, 1 + x): irradiance over pi on the plane z = 0 is 1 + 2/3, 1, 1.
  const Panorama panorama =
      panoramaOf(64, [](const glm::dvec3& w) { return glm::vec3(1 + w.z, 1, 1 + w.x); });
  const PanoramaLights lights(panorama);
  glm::dvec3 sum(0);
  constexpr int kSamples = 100000;
  for (int s = 0; s < kSamples; ++s) {
    const LightSample light = lights.sample(uniform(s, 0), uniform(s, 1), uniform(s, 2));
    sum += light.weight * std::max(light.direction.z, 0.0) / double(kSamples);
  }
  // Weights are below 4, so the mean's standard deviation is below 4 / sqrt(kSamples) = .013; three of them.
  EXPECT_NEAR(sum.x, 5.0 / 3, 0.04);
  EXPECT_NEAR(sum.y, 1, 0.04);
  EXPECT_NEAR(sum.z, 1, 0.04);
}

TEST(PanoramaLights, BlackAndBrokenPixelsGiveNoLight) {
  Panorama panorama = panoramaOf(4, [](const glm::dvec3&) { return glm::vec3(0); });
  EXPECT_EQ(PanoramaLights(panorama).sample(0.5, 0.5, 0.5).weight, glm::dvec3(0));
  panorama.pixels[3] = glm::vec3(NAN);
  panorama.pixels[9] = glm::vec3(2);
  const LightSample light = PanoramaLights(panorama).sample(0.999999, 0.5, 0.5);
  EXPECT_TRUE(std::isfinite(light.weight.x) && light.weight.x > 0);
}

TEST(Trace, SumsLightAndEnvironment) {
  const auto tile = builtinTile("sponge");
  ASSERT_TRUE(tile.ok());
  TraceOptions options;
  options.camera.position = {0, -0.2, 0.4};
  options.width = options.height = 12;
  options.samples = 64;
  options.quiet = true;
  const Panorama sky = panoramaOf(32, [](const glm::dvec3&) { return glm::vec3(1); });
  const auto mean = [&](bool light, bool environment) {
    options.light = light ? std::optional(glm::dvec3(0, 0, 1)) : std::nullopt;
    options.environment = environment ? std::optional(sky) : std::nullopt;
    const auto picture = trace(*tile, options);
    EXPECT_TRUE(picture.ok());
    double sum = 0;
    for (const glm::vec4& pixel : picture->pixels) sum += pixel.g;
    return sum / double(picture->pixels.size());
  };
  const double light = mean(true, false), environment = mean(false, true);
  EXPECT_EQ(mean(false, false), 0);
  // The same random numbers in each, but for the order of sums.
  EXPECT_NEAR(mean(true, true), light + environment, 1e-5);
  // In a white furnace nothing is brighter than its surroundings.
  EXPECT_GT(environment, 0.2 * light);
  EXPECT_LT(environment, 1);
}

}  // namespace
}  // namespace loden::importer
