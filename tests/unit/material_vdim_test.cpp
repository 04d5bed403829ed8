// Geometry image, its tracer and the indirection lookups on surfaces with known answers: a tilted-wave height
// field, and waves that lean over until they overhang.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <latch>
#include <optional>
#include <random>
#include <thread>

#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "material/model/vdim.h"
#include "material/system/threads.h"
#include "tests/unit/material_fixtures.h"

namespace loden {
namespace {

constexpr double kTau = 2 * kPi;

// P(p) of a wave of height h along x whose crests lean by `lean` (tile periods); overhangs for large lean.
glm::dvec3 wavePoint(glm::dvec2 p, double height, double lean) {
  const double phase = kTau * 2 * p.x, crest = 0.5 + 0.5 * std::cos(phase);
  return {p.x + lean * (crest - 0.5), p.y, -height * (1 - crest)};
}

GeometryImage waveImage(int side, double height, double lean) {
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
std::vector<View> randomViews(int count, double theta_max_degrees) {
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

// Every lookup finds the point where the ray of lengths meets the wave, whatever the period's aspect.
TEST(VdimOnRectangles, HitsLieOnTheRayOfLengthsAndOnTheSurface) {
  for (const float aspect : {0.5f, 1.6f}) {
    GeometryImage image = waveImage(96, 0.15, 0);
    image.aspect = aspect;
    const VdimAtlas atlas = buildVdimAtlas(image, {});
    const GeometryTracer tracer(image, Interpolation::kCubic);
    const VdimMaps maps{.paper = nullptr, .atlas = &atlas, .tracer = &tracer};
    const glm::dvec2 length = 1.0 / periodsPerLength(aspect);  // of a period
    for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault, Lookup::kQuality}) {
      int off = 0;
      for (const View& view : randomViews(300, 70)) {
        const auto hit = vdimLookup<double>(maps, lookup, view.x, view.wo);
        const glm::dvec2 moved = (glm::dvec2(hit.position) - view.x) * length;
        EXPECT_NEAR(moved.x, view.wo.x / view.wo.z * hit.position.z, 1e-9);
        EXPECT_NEAR(moved.y, view.wo.y / view.wo.z * hit.position.z, 1e-9);
        const double surface = wavePoint(glm::dvec2(hit.position), 0.15, 0).z;
        // The first hit: nothing of the wave stands over the ray before it.
        bool first = std::abs(surface - hit.position.z) < 3e-3;
        for (double s = 0.02; s < 0.98; s += 0.02) {
          const glm::dvec2 at = view.x + s * (glm::dvec2(hit.position) - view.x);
          first = first && wavePoint(at, 0.15, 0).z < s * hit.position.z + 3e-3;
        }
        off += !first;
      }
      EXPECT_LE(off, lookup == Lookup::kQuality ? 0 : 12);
    }
    for (const View& view : randomViews(100, 70)) {
      const auto hit = tracer.traceView(view.x, view.wo);
      ASSERT_TRUE(hit);
      const auto point = surfaceAt(image, hit->p);
      // The wave's slope along x, in lengths.
      const double slope = 0.15 / 2 * kTau * 2 * std::sin(kTau * 2 * hit->p.x) / length.x;
      EXPECT_NEAR(point.normal.x / point.normal.z, slope, 0.08);
      EXPECT_NEAR(glm::length(point.normal), 1, 1e-9);
      EXPECT_GT(glm::dot(hit->normal, point.normal), 0.99);
      EXPECT_FALSE(tracer.occluded(hit->position + glm::dvec3(0, 0, 1e-6), view.wo));
    }
  }
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

TEST(Vdim, DirectionGridRoundTrips) {
  for (double v = 0.03; v < 1; v += 0.09)
    for (double u = 0.03; u < 1; u += 0.09) {
      const glm::dvec2 back = vdimSquareFromView(vdimViewFromSquare({u, v}));
      EXPECT_NEAR(back.x, u, 2e-5);  // of the polynomial that stands for the arc tangent
      EXPECT_NEAR(back.y, v, 2e-5);
    }
}

// The published map of a tile without relief.
PaperVdim flatPaperVdim() {
  PaperVdim vdim;
  vdim.side = 8, vdim.zeniths = 4, vdim.azimuths = 8;
  vdim.reference = Texture::make(TexelFormat::kRG16Snorm, TextureShape::kArray2D, 8, 8, 1);
  vdim.packed = Texture::make(TexelFormat::kRGBA16Snorm, TextureShape::kArray2D, 64, 32, 1);
  return vdim;
}

class VdimOnWaves : public testing::TestWithParam<double> {};

struct LookupCounts {
  int converged = 0, wrong = 0, fetches = 0;
};
LookupCounts countLookups(const GeometryImage& image, Lookup lookup, const std::vector<View>& views) {
  const GeometryTracer tracer(image);
  const VdimAtlas atlas = buildVdimAtlas(image, {});
  LookupCounts counts;
  for (const View& view : views) {
    const auto truth = tracer.traceView(view.x, view.wo);
    const VdimHit<double> hit = vdimLookup<double>({.atlas = &atlas}, lookup, view.x, view.wo);
    counts.converged += hit.converged;
    counts.fetches += hit.fetches;
    counts.wrong += glm::length(hit.p - truth->p) > 1.0 / 64;
    EXPECT_TRUE(std::isfinite(hit.p.x + hit.p.y + hit.position.z));
  }
  return counts;
}

TEST_P(VdimOnWaves, DefaultLookupAgreesWithTheTracer) {
  const auto views = randomViews(4000, 85);
  const LookupCounts counts = countLookups(waveImage(128, 0.15, GetParam()), Lookup::kDefault, views);
  EXPECT_GE(counts.converged, 0.98 * double(views.size()));
  EXPECT_LE(counts.wrong, 0.03 * double(views.size()));  // the goals of the default lookup, on smooth waves
  EXPECT_LE(counts.fetches, 12 * static_cast<int>(views.size()));
}

TEST_P(VdimOnWaves, FastLookupMissesMoreForFewerFetches) {
  const auto views = randomViews(4000, 85);
  const LookupCounts counts = countLookups(waveImage(128, 0.15, GetParam()), Lookup::kFast, views);
  EXPECT_LE(counts.wrong, 0.07 * double(views.size()));  // the goals of the fast lookup, on smooth waves
  EXPECT_LE(counts.fetches, 6 * static_cast<int>(views.size()));
}

// Each lookup by its name, with the fetches that it is said to take.
TEST_P(VdimOnWaves, EveryLookupIsOneFunctionsParameter) {
  const GeometryImage image = waveImage(128, 0.15, GetParam());
  const VdimAtlas atlas = buildVdimAtlas(image, {});
  const GeometryTracer tracer(image, Interpolation::kCubic);
  const PaperVdim paper = flatPaperVdim();
  const VdimMaps maps{&paper, &atlas, &tracer};
  const auto views = randomViews(2000, 85);
  for (const Lookup lookup : kLookups) {
    EXPECT_EQ(lookupNamed(lookupName(lookup)), lookup);
    EXPECT_EQ(maps.serve(lookup), lookup != Lookup::kNone);
    double fetches = 0, off = 0;
    for (const View& view : views) {
      const VdimHit<double> hit = vdimLookup(maps, lookup, view.x, view.wo),
                            none = vdimLookup({}, lookup, view.x, view.wo);
      EXPECT_EQ(none.p, view.x);
      EXPECT_EQ(none.fetches, 0);
      fetches += hit.fetches;
      const auto truth = tracer.traceView(view.x, view.wo);
      ASSERT_TRUE(truth);
      off += glm::length(hit.p - truth->p);
      if (lookup != Lookup::kQuality) continue;
      EXPECT_TRUE(hit.converged);
      EXPECT_LE(glm::length(hit.position - wavePoint(hit.p, 0.15, GetParam())),
                1e-4);  // the wave itself: 16 bits of it, and a cubic between
    }
    const double n = double(views.size()), texel = 1.0 / 64;
    SCOPED_TRACE(lookupName(lookup));
    switch (lookup) {
      case Lookup::kNone:
      case Lookup::kQuality:
        EXPECT_EQ(fetches, 0);
        break;
      case Lookup::kPaper:
        EXPECT_EQ(fetches, 2 * n);
        break;
      case Lookup::kFast:
        EXPECT_LE(fetches, 6 * n);
        EXPECT_LE(off / n, 0.9 * texel);
        break;
      case Lookup::kDefault:
        EXPECT_LE(fetches, 12 * n);
        EXPECT_LE(off / n, 0.4 * texel);
    }
  }
  EXPECT_EQ(lookupNamed("best"), std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(Lean, VdimOnWaves, testing::Values(0.0, 0.1, 0.35));

TEST(Vdim, FlatTileIsTheIdentity) {
  const GeometryImage image = waveImage(16, 0, 0);
  const VdimAtlas atlas = buildVdimAtlas(image, {16, 8});
  for (const View& view : randomViews(200, 85)) {
    const VdimHit<float> hit =
        vdimLookup<float>({.atlas = &atlas}, Lookup::kDefault, glm::vec2(view.x), glm::vec3(view.wo));
    EXPECT_NEAR(hit.p.x, view.x.x, 2e-6);
    EXPECT_NEAR(hit.p.y, view.x.y, 2e-6);
  }
}

// Codes of a 16 x 16 texel, 9 x 9 direction atlas of depths that are more than one of 255 away from the ray's
// first hit; every ray must have one.
int wrongDepths(const GeometryImage& image, const Texture& depth, double range_z) {
  const GeometryTracer tracer(image);
  const auto* codes = reinterpret_cast<const uint8_t*>(depth.data.data());
  int wrong = 0;
  for (int layer = 0; layer < 81; ++layer) {
    const glm::dvec3 wo = vdimViewFromSquare((glm::dvec2(layer % 9, layer / 9) + 0.5) / 9.0);
    for (int k = 0; k < 256; ++k) {
      const auto hit = tracer.traceView((glm::dvec2(k % 16, k / 16) + 0.5) / 16.0, wo);
      EXPECT_TRUE(hit.has_value());
      wrong += !hit || std::abs(255 * (1 + hit->position.z / range_z) - codes[256 * layer + k]) > 1;
    }
  }
  return wrong;
}

// The depth buffer against rays, but for rays that graze an edge.
TEST(Vdim, AtlasHoldsTheDepthsOfFirstHits) {
  for (const double lean : {0.0, 0.35}) {
    const GeometryImage image = waveImage(64, 0.2, lean);
    const VdimAtlas atlas = buildVdimAtlas(image, {16, 9});
    EXPECT_LE(wrongDepths(image, atlas.depth, double(atlas.geometry.range.z)), 81 * 256 / 1000) << lean;
  }
}

// Slivers of a wall, seen from the side many periods long, are drawn row by row; nothing of them may be left
// out.
TEST(Vdim, AtlasHoldsTheDepthsOfDeepWalls) {
  constexpr int kSide = 32;
  std::vector<glm::dvec3> positions;
  for (int t = 0; t < kSide * kSide; ++t)
    positions.emplace_back((t % kSide + 0.5) / kSide, (t / kSide + 0.5) / kSide,
                           (t % kSide + t / kSide / 2) % kSide < 16 ? 0 : -1.5);
  const GeometryImage image =
      encodeGeometryImage(kSide, positions, std::vector<uint16_t>(positions.size(), 1), true);
  EXPECT_LE(wrongDepths(image, buildVdimDepth(image, {16, 9}), double(image.range.z)), 81 * 256 / 500)
      << "rays that graze an edge";
}

TEST(Vdim, AtlasDoesNotDependOnThreads) {
  const GeometryImage image = waveImage(64, 0.15, 0.35);
  const VdimAtlas one = buildVdimAtlas(image, {16, 8}), many = buildVdimAtlas(image, {16, 8}, onThreads(7));
  EXPECT_EQ(one.depth.data, many.depth.data);
  EXPECT_EQ(one.volume.data, many.volume.data);
}

TEST(Vdim, BuildingStopsBetweenDirections) {
  constexpr VdimAtlasSize kLarge{4, 256};  // seconds of work
  const GeometryImage image = waveImage(128, 0.15, 0.35);
  std::stop_source stop;
  Texture depth;
  std::latch begun(1);
  std::thread builder([&] {
    begun.count_down();
    depth = buildVdimDepth(image, kLarge, onThreads(2, stop.get_token()));
  });
  begun.wait();
  stop.request_stop();
  builder.join();
  int built = 0;  // every texel of a whole layer lies above the deepest point, code 0
  for (int layer = 0; layer < depth.depth; ++layer) built += depth.data[size_t(layer) * 16] != std::byte{0};
  EXPECT_LT(built, depth.depth / 2);
}

TEST(Vdim, HugeCoordinatesKeepTheirFraction) {
  const GeometryImage image = waveImage(64, 0.15, 0.2);
  const VdimAtlas atlas = buildVdimAtlas(image, {16, 8});
  const glm::dvec3 wo = glm::normalize(glm::dvec3(1, 0.4, 0.7));
  for (double x = 0.05; x < 1; x += 0.1) {
    const auto near = vdimLookup<double>({.atlas = &atlas}, Lookup::kDefault, {x, 0.3}, wo);
    const auto far = vdimLookup<double>({.atlas = &atlas}, Lookup::kDefault, {x + 1e5, 0.3 - 1e5}, wo);
    EXPECT_NEAR(far.p.x - 1e5, near.p.x, 1e-6);
    EXPECT_NEAR(far.p.y + 1e5, near.p.y, 1e-6);
  }
}

TEST(Vdim, GrazingAndDegenerateViewsStayFinite) {
  const GeometryImage image = waveImage(32, 0.2, 0.35);
  const VdimAtlas atlas = buildVdimAtlas(image, {16, 8});
  for (const glm::vec3 wo :
       {glm::vec3(0, 0, 1), glm::vec3(1, 0, 1e-7f), glm::vec3(-0.70710678f, 0.70710678f, 0),
        glm::vec3(1e-8f, 0, 1), glm::vec3(0, -1, 0)}) {
    for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault}) {
      const auto hit = vdimLookup<float>({.atlas = &atlas}, lookup, glm::vec2(0.4f, 0.9f), wo);
      EXPECT_TRUE(std::isfinite(hit.p.x) && std::isfinite(hit.p.y) && std::isfinite(hit.position.z));
    }
  }
}

TEST(PaperVdim, ReturnsStoredViewsExactly) {
  // A single texel whose displacement is known in closed form: direction = azimuth, distance = tan-like.
  PaperVdim vdim;
  vdim.side = 1, vdim.zeniths = 8, vdim.azimuths = 32;
  vdim.range = {1, 1};
  vdim.reference = Texture::make(TexelFormat::kRG16Snorm, TextureShape::kArray2D, 1, 1, 1);
  vdim.packed = Texture::make(TexelFormat::kRGBA16Snorm, TextureShape::kArray2D, 32, 8, 1);
  for (int z = 0; z < 8; ++z)
    for (int a = 0; a < 32; ++a) {
      const double phi = kTau * a / 31;
      storeTexel(vdim.packed, 0, a, z, 0, {std::cos(phi), std::sin(phi), 0.1 * z, 0});
    }
  for (int z = 0; z < 8; ++z)
    for (int a = 0; a < 31; ++a) {
      const glm::dvec3 wo = directionFromSpherical({kThetaMax * z / 7, kTau * a / 31});
      const glm::dvec2 p = vdimLookup<double>({.paper = &vdim}, Lookup::kPaper, {0.5, 0.5}, wo).p;
      EXPECT_NEAR(p.x, 0.5 + (z == 0 ? 0 : 0.1 * z * std::cos(kTau * a / 31)), 1e-4);
      EXPECT_NEAR(p.y, 0.5 + (z == 0 ? 0 : 0.1 * z * std::sin(kTau * a / 31)), 1e-4);
    }
}

// The wave tile bent around a cylinder, of which the world's straight rays are followed in small steps.
class WaveCylinder : public testing::Test {
 protected:
  // Tile periods; the axis is across the waves, so that rays leave along valleys.
  static constexpr double kHeight = 0.3, kCurvature = 0.25, kRadius = 1 / kCurvature;
  static constexpr double kTexel = 1.0 / 64;
  const GeometryImage image_ = waveImage(128, kHeight, 0);
  const VdimAtlas atlas_ = buildVdimAtlas(image_, {});
  const LocalSurface<double> surface_{glm::dmat2(0, 0, 0, kCurvature), glm::dmat2(1)};

  // Of a point, seen from the point of the surface that is looked at: x along the cylinder, y around it, z
  // over it.
  static glm::dvec3 unbent(const glm::dvec3& p) {
    return {p.x, kRadius * std::atan2(p.y, kRadius + p.z), std::hypot(p.y, kRadius + p.z) - kRadius};
  }
  static double below(glm::dvec2 x, const glm::dvec3& p) {  // how far a point is below the wave
    const glm::dvec3 q = unbent(p);
    return wavePoint({x.x + q.x, x.y + q.y}, kHeight, 0).z - q.z;
  }
  // The first point of the ray below the wave; none: it has left.
  static std::optional<glm::dvec2> firstHit(const View& view) {
    for (double along = 0; along > -4; along -= 0.001) {
      const glm::dvec3 point = view.wo * along;
      if (below(view.x, point) >= 0) return view.x + glm::dvec2(unbent(point));
      if (unbent(point).z > 0.01) return std::nullopt;
    }
    return std::nullopt;
  }
  struct Counts {
    int seen = 0, straight_off = 0, bent_off = 0, lost = 0, by = 0, by_found = 0;
  };
  Counts count(int samples, double theta_min_degrees) const {
    Counts n;
    for (const View& view : randomViews(samples, 85)) {
      if (view.wo.z > std::cos(theta_min_degrees * kPi / 180)) continue;
      const auto truth = firstHit(view);
      const auto bent = vdimLookup({.atlas = &atlas_}, Lookup::kDefault, view.x, view.wo, surface_);
      if (!truth) {
        n.by += 1, n.by_found += !bent.missed;
        continue;
      }
      const auto straight = vdimLookup({.atlas = &atlas_}, Lookup::kDefault, view.x, view.wo);
      const auto off = [&](const VdimHit<double>& found) {
        return glm::distance(glm::dvec2(found.position), *truth) > kTexel;
      };
      n.seen += 1, n.lost += bent.missed, n.straight_off += off(straight), n.bent_off += off(bent);
    }
    return n;
  }
};

// What the lookup finds lies on the bent tile, on the straight ray of the world, and nothing is before it.
TEST_F(WaveCylinder, LookupFollowsTheRay) {
  const Counts n = count(4000, 0);
  ASSERT_GT(n.by, 50);
  // Of rays that turn in the lower half of the relief the lookup never says that they go by.
  EXPECT_LT(n.by_found, n.by / 3) << "of " << n.by << " rays that go by";
  EXPECT_LT(n.lost, n.seen / 200) << "of " << n.seen << " rays that meet the tile";
  // A texel of 64 off: the second-order model of the bend, and what the search loses on a plane already.
  EXPECT_LT(n.bent_off, n.seen / 20) << "of " << n.seen;
  EXPECT_LT(n.bent_off * 5, n.straight_off)
      << "of " << n.seen << "; bent " << n.bent_off << ", straight " << n.straight_off;
}

// There a ray runs over a tile or more, and no straight ray from where it comes in is near all of it.
TEST_F(WaveCylinder, LookupFollowsGrazingRays) {
  const Counts n = count(20000, 75);
  ASSERT_GT(n.seen, 1000);
  EXPECT_LT(n.bent_off, n.seen / 10) << "of " << n.seen;
  EXPECT_LT(n.bent_off * 3, n.straight_off)
      << "of " << n.seen << "; bent " << n.bent_off << ", straight " << n.straight_off;
  // Rays that come close to the surface without meeting it are told apart by the search's own tolerances.
  EXPECT_LT(n.lost, n.seen / 200) << "of " << n.seen << " rays that meet the tile";
  EXPECT_LT(n.by_found, n.by / 20) << "of " << n.by << " rays that go by";
}

// Around the cylinder along a valley .3 deep a ray at 80 degrees turns at .06 and leaves; along a crest it
// stops at once, across the waves at a flank.
TEST_F(WaveCylinder, LookupTellsRaysThatGoByFromRaysThatMeetTheTile) {
  for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault})
    for (const double theta : {80.0, 82.5, 85.0}) {
      const double sine = std::sin(theta * kPi / 180), cosine = std::cos(theta * kPi / 180);
      for (const double side : {-1.0, 1.0}) {
        const glm::dvec3 around(0, side * sine, cosine);
        EXPECT_TRUE(vdimLookup({.atlas = &atlas_}, lookup, {0.25, 0.4}, around, surface_).missed) << theta;
        const auto crest = vdimLookup({.atlas = &atlas_}, lookup, {0.5, 0.4}, around, surface_);
        EXPECT_TRUE(crest.converged) << theta;
        EXPECT_NEAR(crest.position.y, 0.4, kTexel) << theta;
      }
      // Bent most where it goes half along, half across.
      const View oblique{{0.2, 0.4}, {sine * std::sqrt(0.5), sine * std::sqrt(0.5), cosine}};
      const auto truth = firstHit(oblique);
      ASSERT_TRUE(truth);
      const auto found = vdimLookup({.atlas = &atlas_}, lookup, oblique.x, oblique.wo, surface_);
      EXPECT_TRUE(found.converged) << theta;
      EXPECT_LT(glm::distance(glm::dvec2(found.position), *truth), kTexel) << theta;
    }
}

// Seeds are read where the straight rays that stand for the bent one would come in, far from x.
TEST_F(WaveCylinder, LookupRepeatsWithTheTile) {
  for (const View& view : randomViews(500, 85)) {
    const glm::dvec2 x = glm::round(view.x * 1024.0) / 1024.0;  // so that sums are exact
    const auto near = vdimLookup({.atlas = &atlas_}, Lookup::kDefault, x, view.wo, surface_);
    const auto far =
        vdimLookup({.atlas = &atlas_}, Lookup::kDefault, x + glm::dvec2(64, -32), view.wo, surface_);
    EXPECT_EQ(near.missed, far.missed);
    EXPECT_EQ(near.height, far.height);
    EXPECT_TRUE(std::isfinite(near.position.x) && std::isfinite(near.position.y) &&
                std::isfinite(near.position.z));
  }
}

// Stretched texture coordinates: twice as many periods per length along x move the hit twice as far.
TEST(VdimLookup, FollowsStretchedCoordinates) {
  const GeometryImage image = waveImage(64, 0.1, 0);
  const VdimAtlas atlas = buildVdimAtlas(image, {});
  const LocalSurface<double> stretched{glm::dmat2(0), glm::dmat2(2, 0, 0, 1)};
  for (const View& view : randomViews(200, 60)) {
    const auto found = vdimLookup({.atlas = &atlas}, Lookup::kDefault, view.x, view.wo, stretched);
    if (!found.converged) continue;
    const glm::dvec2 slope(view.wo.x / view.wo.z, view.wo.y / view.wo.z);
    EXPECT_NEAR(found.offset.x, 2 * slope.x * found.position.z, 1e-9);
    EXPECT_NEAR(found.offset.y, slope.y * found.position.z, 1e-9);
    EXPECT_NEAR(found.position.z, surfaceAt(image, found.p).position.z, 1e-3);
  }
}

}  // namespace
}  // namespace loden
