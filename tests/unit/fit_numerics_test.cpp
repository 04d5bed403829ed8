// Whole cooks on inputs that break careless numerics: each gives the right answer in every mode.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "importer/cook/modes.h"
#include "material/eval/evaluate.h"
#include "tests/unit/fit_synthetic.h"

namespace loden::importer {
namespace {

struct Cooked {
  const char* mode;
  Material material;
};

// An input of one texel has no mip levels, and the published pyramid none either.
std::vector<Cooked> cookAll(const SyntheticSource& source) {
  std::vector<Cooked> all;
  CookOptions options;
  options.quiet = true;
  const auto add = [&](const char* mode, Result<Material> material) {
    ASSERT_TRUE(material.ok()) << mode << ": " << material.issue().text;
    all.push_back({mode, std::move(*material)});
  };
  options.mode = Mode::kLod;
  add("lod", cookLod(source, options));
  options.preset = Preset::kReference;
  add("lod, reference", cookLod(source, options));
  options.preset = Preset::kSeed;
  options.levels = 1;
  add("lod, seed", cookLod(source, options));
  options = {};
  options.quiet = true;
  options.y_components = 8;
  add("fused", cookFused(
                   source,
                   [&](int side) -> Result<GeometryImage> {
                     if (side == 0) side = 16;
                     std::vector<glm::dvec3> positions;
                     for (int t = 0; t < side * side; ++t)
                       positions.emplace_back((t % side + 0.5) / side, (t / side + 0.5) / side, 0);
                     return encodeGeometryImage(side, positions, std::vector<uint16_t>(positions.size(), 1),
                                                true);
                   },
                   BakedSurface{}, options));
  return all;
}

// The largest error over random texels and pairs of samples, as a share of `white`.
double worst(const Material& material, const SyntheticSource& source, double white) {
  const Evaluator evaluator(material);
  std::mt19937_64 random(7);
  const int side = source.size().x, directions = source.lights().size();
  double most = 0;
  for (int i = 0; i < 400; ++i) {
    const auto texel = static_cast<int>(random() % uint64_t(side * side));
    const glm::dvec2 x = glm::dvec2(texel % side + 0.5, texel / side + 0.5) / double(side);
    const glm::dvec3 wi = source.lights().samples[random() % uint64_t(directions)],
                     wo = source.views().samples[random() % uint64_t(directions)];
    // What is far from white is stored in a unit of its own.
    const double unit = double(material.value_scale) * kPi;
    const glm::dvec3 off =
        unit * evaluator.evaluate(evaluator.findHit(x, 0.0, wo), wi, wo) - source.valueAt(x, wi, wo);
    most = std::max({most, std::abs(off.x), std::abs(off.y), std::abs(off.z)});
    if (!std::isfinite(off.x + off.y + off.z)) return INFINITY;
  }
  return most / white;
}

TEST(Numerics, AllZeroStaysZero) {
  const SyntheticSource source(
      4, bonn81Directions(), [](glm::dvec2, const glm::dvec3&, const glm::dvec3&) { return glm::dvec3(0); });
  for (const Cooked& c : cookAll(source)) EXPECT_LT(worst(c.material, source, 1), 1e-9) << c.mode;
}

TEST(Numerics, ConstantComesBack) {
  const SyntheticSource source(4, bonn81Directions(), [](glm::dvec2, const glm::dvec3&, const glm::dvec3&) {
    return glm::dvec3(0.4, 0.3, 0.2);
  });
  for (const Cooked& c : cookAll(source))
    EXPECT_LT(worst(c.material, source, 1), 1e-4) << c.mode;  // 32-bit mean
}

TEST(Numerics, OneTexelComesBack) {
  const SyntheticSource source(1, bonn81Directions(),
                               [](glm::dvec2, const glm::dvec3& wi, const glm::dvec3& wo) {
                                 return glm::dvec3(0.9, 0.6, 0.3) * (0.5 * wi.z + 0.2 * wi.z * wo.z);
                               });
  for (const Cooked& c : cookAll(source)) {
    // As published the components hold deviations from the images' means, so that of one texel only the
    // fitted Phong and constant chroma are left.
    if (std::string(c.mode) == "lod, seed")
      EXPECT_LT(worst(c.material, source, 1), 0.25);
    else
      EXPECT_LT(worst(c.material, source, 1), 0.02) << c.mode;  // the fused grid of 11 columns and 8 bits
  }
}

// Two pictures times two lobes, far fewer than the components asked for, and half of the texels black.
TEST(Numerics, RankDeficientWithRowsOfZeroComesBack) {
  const SyntheticSource source(
      8, bonn81Directions(), [](glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3& wo) {
        return x.y > 0.5 ? glm::dvec3(0)
                         : glm::dvec3((0.3 + 0.2 * std::sin(2 * kPi * x.x)) * wi.z + 0.2 * x.x * wi.z * wo.z);
      });
  for (const Cooked& c : cookAll(source)) EXPECT_LT(worst(c.material, source, 1), 0.03) << c.mode;
}

// Nothing in the fits knows how bright white is: times 1e-6 or 1e6 the relative error is the same.
TEST(Numerics, ErrorScalesWithTheInput) {
  std::vector<double> reference;
  for (const double scale : {1.0, 1e-6, 1e6}) {
    const SyntheticSource source(
        4, bonn81Directions(), [scale](glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3& wo) {
          return scale * glm::dvec3(0.8, 0.7, 0.5) * (0.3 + 0.2 * std::sin(2 * kPi * x.x + 3 * wo.x)) * wi.z;
        });
    const std::vector<Cooked> all = cookAll(source);
    for (size_t i = 0; i < all.size(); ++i) {
      const double error = worst(all[i].material, source, scale);
      if (scale == 1)
        reference.push_back(error);
      else
        EXPECT_NEAR(error, reference[i], 0.02 * reference[i] + 1e-6) << all[i].mode << " at " << scale;
    }
  }
}

// 1e-6 to 1e6 in one input: right to the precision of the stored format, relative to the largest value.
TEST(Numerics, TwelveDecadesInOneInput) {
  const SyntheticSource source(4, bonn81Directions(),
                               [](glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3&) {
                                 return glm::dvec3(std::pow(10.0, -6 + 12 * (x.x - 0.125) / 0.75) * wi.z);
                               });
  for (const Cooked& c : cookAll(source)) EXPECT_LT(worst(c.material, source, 1e6), 0.02) << c.mode;
}

}  // namespace
}  // namespace loden::importer
