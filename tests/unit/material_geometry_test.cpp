// Geometry image, its packed form and its tracer on surfaces with known answers.

#include <gtest/gtest.h>

#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "tests/unit/material_fixtures.h"
#include "tests/unit/waves.h"

namespace loden {
namespace {

using namespace test;  // NOLINT: waves are what all of this file is about

TEST(GeometryImage, KeepsPositionsWithinItsQuantisation) {
  const GeometryImage image = waveImage(64, 0.1, 0.2);
  EXPECT_FALSE(image.identity_parameterization);
  for (int i = -70; i < 140; i += 13)
    for (int j = -70; j < 140; j += 17) {
      const Patch<double> patch = fetchPatch<double>(image, i, j);
      const glm::dvec3 expected = wavePoint({(i + 0.5) / 64, (j + 0.5) / 64}, 0.1, 0.2);
      // Half a code of 16 bits over a range of .4 tile periods.
      EXPECT_NEAR(patch.p00.x, expected.x, 4e-6);
      EXPECT_NEAR(patch.p00.y, expected.y, 4e-6);
      EXPECT_NEAR(patch.p00.z, expected.z, 4e-6);
      EXPECT_EQ(patch.chart, 1u);
    }
}

// The bound of material/FORMAT.md is inclusive.
TEST(GeometryImage, APointFourPeriodsAway_IsAValidAsset) {
  constexpr int kSide = 8;
  std::vector<glm::dvec3> points;
  for (int t = 0; t < kSide * kSide; ++t)
    points.emplace_back((t % kSide + 0.5) / kSide + 2, (t / kSide + 0.5) / kSide - 2,
                        -4.0 * t / (kSide * kSide - 1));
  Material material = test::surfaceMaterial();
  material.aspect = 1;
  material.geometry =
      encodeGeometryImage(kSide, points, std::vector<uint16_t>(points.size(), uint16_t(1)), false);
  EXPECT_EQ(material.geometry.range, glm::vec3(4));
  EXPECT_TRUE(serializeAsset(material).ok());
  points.back().z = -4.001;
  material.geometry =
      encodeGeometryImage(kSide, points, std::vector<uint16_t>(points.size(), uint16_t(1)), false);
  const auto refused = serializeAsset(material);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.issue().id, issue_id::kGeometryRange);
}

TEST(GeometryImage, PatchesDoNotBridgeCharts) {
  std::vector<glm::dvec3> points;
  std::vector<uint16_t> charts;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) {
      points.emplace_back((i + 0.5) / 8, (j + 0.5) / 8, -0.1);
      charts.push_back(i == 7 ? 0 : i < 4 ? 1 : 2);
    }
  const GeometryImage image = encodeGeometryImage(8, points, charts, true);
  EXPECT_EQ(fetchPatch<float>(image, 2, 2).chart, 1u);
  EXPECT_EQ(fetchPatch<float>(image, 3, 2).chart, 0u);  // across charts 1 and 2
  EXPECT_EQ(fetchPatch<float>(image, 4, 2).chart, 2u);
  EXPECT_EQ(fetchPatch<float>(image, 6, 2).chart, 0u);  // into the gutter
}

TEST(PackedGeometry, KeepsPositionsWithinItsSteps) {
  const GeometryImage image = waveImage(64, 0.1, 0.2);
  const PackedGeometry packed = packGeometry(image);
  for (int i = -70; i < 140; i += 13)
    for (int j = -70; j < 140; j += 17) {
      const glm::dvec3 exact = fetchPatch<double>(image, i, j).p10,
                       near = fetchPatch<double>(packed, i, j).p10;
      EXPECT_NEAR(near.x, exact.x, image.range.x / 2044 + 1e-9);  // half a step
      EXPECT_NEAR(near.y, exact.y, image.range.y / 2044 + 1e-9);
      EXPECT_NEAR(near.z, exact.z, image.range.z / 4094 + 1e-9);
    }
}

TEST(PackedGeometry, KeepsHeightFieldsExactly) {
  const GeometryImage image = waveImage(64, 0.1, 0);
  const PackedGeometry packed = packGeometry(image);
  for (int i = -70; i < 140; i += 13) {
    const glm::dvec3 exact = fetchPatch<double>(image, i, 5).p01, near = fetchPatch<double>(packed, i, 5).p01;
    EXPECT_NEAR(near.z, exact.z, 1e-12);
    EXPECT_EQ(near.x, exact.x);
  }
}

TEST(PackedGeometry, KnowsWhichPatchesExist) {
  std::vector<glm::dvec3> points;
  std::vector<uint16_t> charts;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) {
      points.emplace_back((i + 0.5) / 8 + 0.01 * i, (j + 0.5) / 8, -0.1);
      charts.push_back(i == 7 ? 0 : i < 4 ? 1 : 2);
    }
  for (const bool identity : {false, true}) {
    const GeometryImage image = encodeGeometryImage(8, points, charts, identity);
    const PackedGeometry packed = packGeometry(image);
    for (int i = 0; i < 8; ++i)
      EXPECT_EQ(fetchPatch<float>(packed, i, 2).chart != 0,
                identity || fetchPatch<float>(image, i, 2).chart != 0);  // heights have no holes
  }
}

TEST(GeometryTracer, MeetsAHeightFieldWhereItsEquationSays) {
  const double height = 0.2;
  const GeometryTracer tracer(waveImage(256, height, 0));
  for (const View& view : randomViews(2000, 85)) {
    const auto hit = tracer.traceView(view.x, view.wo);
    ASSERT_TRUE(hit);
    const double expected = wavePoint(glm::dvec2(hit->position), height, 0).z;
    EXPECT_NEAR(hit->position.z, expected,
                2e-4);  // chords of 256 segments over two waves: h (pi / 128)^2 / 2
    // Nothing above the surface was passed: march the ray at a fine step.
    for (double z = 0; z > hit->position.z + 1e-3; z -= 1e-3) {
      const glm::dvec2 at = view.x + glm::dvec2(view.wo) / view.wo.z * z;
      ASSERT_GT(z, wavePoint(at, height, 0).z - 5e-4);
    }
  }
}

// Mean distance along z between what a coarse image's rays meet and the wave itself.
double waveError(const GeometryTracer& tracer, double height) {
  double sum = 0;
  const auto views = randomViews(1000, 60);
  for (const View& view : views) {
    const auto hit = tracer.traceView(view.x, view.wo);
    EXPECT_TRUE(hit);
    if (hit) sum += std::abs(hit->position.z - wavePoint(glm::dvec2(hit->position), height, 0).z);
  }
  return sum / double(views.size());
}

TEST(GeometryTracer, CubicIsNearerToASmoothSurface) {
  const GeometryImage image = waveImage(32, 0.2, 0);
  const double linear = waveError(GeometryTracer(image), 0.2),
               cubic = waveError(GeometryTracer(image, Interpolation::kCubic), 0.2);
  EXPECT_LE(cubic, linear / 3) << linear;  // measured a fifth
}

// Two charts side by side: a cubic that reached across would bend both towards each other.
TEST(GeometryTracer, CubicDoesNotReachAcrossCharts) {
  std::vector<glm::dvec3> points;
  std::vector<uint16_t> charts;
  for (int t = 0; t < 16 * 16; ++t) {
    const glm::dvec2 p((t % 16 + 0.5) / 16, (t / 16 + 0.5) / 16);
    points.emplace_back(p, t % 16 < 8 ? -0.1 : -0.3);
    charts.push_back(t % 16 < 8 ? 1 : 2);
  }
  const GeometryTracer tracer(encodeGeometryImage(16, points, charts, true), Interpolation::kCubic);
  for (double x = 0.04; x < 0.46; x += 0.01) {
    EXPECT_NEAR(tracer.traceView({x, 0.3}, {0, 0, 1})->position.z, -0.1, 1e-5);
    EXPECT_NEAR(tracer.traceView({x + 0.5, 0.3}, {0, 0, 1})->position.z, -0.3, 1e-5);
  }
  EXPECT_FALSE(tracer.traceView({0.5, 0.3}, {0, 0, 1}));
}

// Curved charts side by side. Inside a chart, where patches at its border meet others, no ray may fall
// through.
TEST(GeometryTracer, CubicHasNoSlitsInsideACurvedChart) {
  constexpr int kSide = 16;
  const auto height = [](glm::dvec2 p) {
    return -0.2 - 0.15 * std::sin(kTau * 2 * p.x) * std::sin(kTau * 2 * p.y);
  };
  std::vector<glm::dvec3> points;
  std::vector<uint16_t> charts;
  for (int t = 0; t < kSide * kSide; ++t) {
    const glm::dvec2 p((t % kSide + 0.5) / kSide, (t / kSide + 0.5) / kSide);
    points.emplace_back(p, height(p));
    charts.push_back(t % kSide < 8 ? 1 : 2);
  }
  const GeometryTracer tracer(encodeGeometryImage(kSide, points, charts, true), Interpolation::kCubic);
  int inside = 0;
  for (const View& view : randomViews(20000, 60)) {
    const glm::dvec2 slope = glm::dvec2(view.wo) / view.wo.z;
    // Where it meets the waves, raised and lowered by more than 16 texels have them wrong; rays that graze
    // are left out.
    const auto meets = [&](double raised) {
      double z = 0;
      while (z > height(view.x + slope * z) + raised) z -= 1e-3;
      return view.x + slope * z;
    };
    const glm::dvec2 p = meets(0);
    if (glm::length(meets(0.01) - meets(-0.01)) > 1.0 / kSide) continue;
    const double column = glm::fract(p.x) * kSide - 0.5;
    if (std::fmod(column, 8) < 0.4 || std::fmod(column, 8) > 6.6) continue;  // between the charts
    ++inside;
    const auto hit = tracer.traceView(view.x, view.wo);
    ASSERT_TRUE(hit);
    EXPECT_LE(glm::length(hit->p - p), 0.5 / kSide) << view.x.x << " " << view.x.y;
  }
  EXPECT_GT(inside, 10000);
}

TEST(GeometryTracer, IsPeriodic) {
  const GeometryTracer tracer(waveImage(64, 0.15, 0.2));
  for (const View& view : randomViews(300, 85)) {
    const auto a = tracer.traceView(view.x, view.wo),
               b = tracer.traceView(view.x + glm::dvec2(-1, 3), view.wo);
    ASSERT_TRUE(a && b);
    EXPECT_NEAR(a->p.x - 1, b->p.x, 1e-7);
    EXPECT_NEAR(a->p.y + 3, b->p.y, 1e-7);
  }
}

TEST(GeometryTracer, OccludedAgreesWithTheView) {
  // A point that the view ray met first sees the viewer; a point just below it does not.
  const GeometryTracer tracer(waveImage(128, 0.2, 0.3));
  for (const View& view : randomViews(500, 80)) {
    const auto hit = tracer.traceView(view.x, view.wo);
    ASSERT_TRUE(hit);
    EXPECT_FALSE(tracer.occluded(hit->position + 1e-6 * hit->normal, view.wo));
    EXPECT_TRUE(tracer.occluded(hit->position - 1e-4 * view.wo, view.wo));
  }
}

}  // namespace
}  // namespace loden
