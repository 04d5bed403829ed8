// The atlas and the indirection lookups on surfaces with known answers.

#include <gtest/gtest.h>

#include <algorithm>
#include <latch>
#include <thread>

#include "material/system/threads.h"
#include "tests/unit/waves.h"

namespace loden {
namespace {

using namespace test;  // NOLINT: waves are what all of this file is about

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

// Crests that lean so far that much of the surface lies under itself: a search may begin on the underside.
TEST(Vdim, FoldsAreSearchedOnTheirUpperSide) {
  const auto views = randomViews(4000, 75);
  for (const double height : {0.05, 0.15})
    for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault}) {
      const LookupCounts counts = countLookups(waveImage(128, height, 0.8), lookup, views);
      EXPECT_LE(counts.wrong, 0.005 * double(views.size())) << height << ", " << lookupName(lookup);
    }
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
// Round pores with steep walls.
GeometryImage poreImage(int side) {
  std::vector<glm::dvec3> points;
  for (int t = 0; t < side * side; ++t) {
    const glm::dvec2 p = (glm::dvec2(t % side, t / side) + 0.5) / double(side);
    const double radius = glm::length(glm::fract(4.0 * p) - 0.5) / 4;
    points.emplace_back(p, -0.2 * (1 - glm::smoothstep(0.06, 0.11, radius)));
  }
  return encodeGeometryImage(side, points, std::vector<uint16_t>(points.size(), 1), true);
}

// The march's steps are parts of the period where the image is finer than it has to be.
TEST(Vdim, AFinerHeightFieldIsNearerAndTakesNoMoreFetches) {
  const GeometryImage truth = poreImage(512);
  const GeometryTracer tracer(truth);
  const std::vector<View> views = randomViews(2000, 75);
  for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault}) {
    double error[2] = {}, fetches[2] = {};
    for (const int finer : {0, 1}) {
      const GeometryImage image = poreImage(128 << finer);
      const VdimAtlas atlas = buildVdimAtlas(image, {});
      VdimMaps maps;
      maps.atlas = &atlas;
      for (const View& view : views) {
        const auto hit = vdimLookup<double>(maps, lookup, view.x, view.wo);
        const glm::dvec2 off = hit.p - tracer.traceView(view.x, view.wo)->p;
        error[finer] += std::min(glm::length(off - glm::round(off)), 0.02);
        fetches[finer] += hit.fetches;
      }
    }
    EXPECT_LT(error[1], 0.8 * error[0]);
    EXPECT_LT(fetches[1], 1.03 * fetches[0]);
  }
}

// Where effortsAreOne says so, kFast and kDefault find the same by the same fetches; elsewhere they do not.
TEST(Vdim, EffortsAreOneOverWideFootprints) {
  for (const int side : {64, 192}) {
    const VdimAtlas atlas = buildVdimAtlas(waveImage(side, 0.12, 0.5), {16, 12});
    const VdimMaps maps{.paper = nullptr, .atlas = &atlas};
    bool found[2] = {};
    for (const double footprint : {0.01, 0.03, 0.06, 0.12, 0.25}) {
      const bool one = effortsAreOne(side, footprint);
      found[one] = true;
      bool differs = false;
      for (const View& view : randomViews(100, 80)) {
        const auto surface = LocalSurface<double>::flat(1);
        const auto fast = vdimLookup(maps, Lookup::kFast, view.x, view.wo, surface, footprint),
                   usual = vdimLookup(maps, Lookup::kDefault, view.x, view.wo, surface, footprint);
        differs = differs || fast.p != usual.p || fast.fetches != usual.fetches;
      }
      EXPECT_EQ(differs, !one) << side << " " << footprint;
    }
    EXPECT_TRUE(found[false] && found[true]) << side;
  }
}

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

}  // namespace
}  // namespace loden
