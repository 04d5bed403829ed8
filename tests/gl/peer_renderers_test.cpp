// The renderers that Loden is compared with: that each finds what its method promises, against rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/bench/geometry_peers.h"

namespace loden::bench {
namespace {

constexpr int kTexels = 64, kPixels = 64;

// How far, in texels, the parameters that a renderer sees are from those that rays meet.
struct Off {
  double median = 0, over_one = 0;  // texels; share of pixels
  double unseen = 0;                // share of pixels that nothing was drawn at
};

class PeerRenderers : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    tile = new importer::Tile(require(importer::builtinTile("pulli", 128)));
    tracer = new importer::TileTracer(*tile);
    device = makeDevice().release();
    screen = new FullScreen({kPixels, kPixels});
  }
  static void TearDownTestSuite() {
    delete screen;
    delete device;
    delete tracer;
    delete tile;
  }

  // Maps of noise, which the test does not look at, on the tile's heights.
  static Material material() {
    constexpr int kSide = 2 * kTexels;
    std::vector<glm::dvec3> positions;
    for (int t = 0; t < kSide * kSide; ++t) {
      const glm::dvec2 p = (glm::dvec2(t % kSide, t / kSide) + 0.5) / double(kSide);
      positions.emplace_back(p, tracer->intersectView(p, {0, 0, 1})->position.z);
    }
    Material noise = surfaceMaterial(1);
    noise.geometry = encodeGeometryImage(kSide, positions, std::vector<uint16_t>(positions.size(), 1), true);
    return noise;
  }

  static PlaneView viewAt(double degrees) {
    PlaneView view{kPixels, kTexels, tile->aspect};
    view.degrees = degrees, view.turn = 0.3, view.shift = {0.21, -0.13};
    return view;
  }

  static Off off(TileRenderer renderer, const PlaneView& view) {
    renderer.defines.push_back("SHOW_PARAMETER 1");
    const RendererPrograms programs = compileRenderer(*screen, renderer, std::span(&view, 1), 1);
    drawRenderer(*screen, renderer, programs.plain, view);
    const std::vector<glm::vec4> pixels = screen->read();
    std::vector<double> distances;
    Off result;
    for (size_t k = 0; k < pixels.size(); ++k) {
      const glm::dvec2 uv = (glm::dvec2(double(k % kPixels), double(k / kPixels)) + 0.5) / double(kPixels);
      const auto hit = tracer->intersectView(onPlane(view, uv), towardsEye(view, uv));
      if (!hit) continue;
      if (pixels[k].w == 0) {
        result.unseen += 1.0 / double(pixels.size());
        continue;
      }
      glm::dvec2 apart = glm::dvec2(pixels[k]) - hit->p;
      apart -= glm::round(apart);
      distances.push_back(glm::length(apart) * kTexels);
      if (distances.back() > 1) result.over_one += 1.0 / double(pixels.size());
    }
    std::nth_element(distances.begin(), distances.begin() + ptrdiff_t(distances.size() / 2), distances.end());
    result.median = distances[distances.size() / 2];
    return result;
  }

  static const importer::Tile* tile;
  static const importer::TileTracer* tracer;
  static runtime::Device* device;
  static FullScreen* screen;
};

const importer::Tile* PeerRenderers::tile;
const importer::TileTracer* PeerRenderers::tracer;
runtime::Device* PeerRenderers::device;
FullScreen* PeerRenderers::screen;

void expectCloserThan(const Off& off, double median, double over_one, const char* what) {
  SCOPED_TRACE(what);
  std::printf("%s: median %.3f texels, %.2f %% over one, %.2f %% unseen\n", what, off.median,
              100 * off.over_one, 100 * off.unseen);
  EXPECT_LT(off.median, median);
  EXPECT_LT(off.over_one, over_one);
  EXPECT_LT(off.unseen, 0.002);  // pixels whose centre lies on the seam of two triangles or prisms
}

// Without any search the picture is off by several texels, so that the bounds below say something.
TEST_F(PeerRenderers, WithoutParallax_SeesOtherParameters) {
  const Off flat = off(lodenRenderer(*device, "flat", "", material(), Lookup::kNone), viewAt(45));
  EXPECT_GT(flat.median, 2);
}

TEST_F(PeerRenderers, March_FindsTheHeightMap) {
  const Material m = material();
  const auto heights = std::make_shared<const HeightMap>(m.geometry);
  for (const double degrees : {0.0, 45.0})
    expectCloserThan(off(marchRenderer(*device, "march", 32, 6, m, heights), viewAt(degrees)), 0.2, 0.02,
                     "relief mapping");
}

TEST_F(PeerRenderers, Cones_NeverStepThroughTheSurface) {
  for (const double degrees : {0.0, 45.0})
    expectCloserThan(off(coneRenderer(*device, 32, material()), viewAt(degrees)), 0.2, 0.05, "cone stepping");
}

TEST_F(PeerRenderers, Shell_GoesOnInTheNextPrism) {
  const Material m = material();
  const auto heights = std::make_shared<const HeightMap>(m.geometry);
  for (const double degrees : {0.0, 45.0})
    expectCloserThan(off(shellRenderer(*device, 32, 6, m, heights), viewAt(degrees)), 0.2, 0.02, "shell");
}

TEST_F(PeerRenderers, Mesh_IsTheTile) {
  for (const double degrees : {0.0, 45.0}) {
    PlaneView view = viewAt(degrees);
    view.lambda = -1;  // where the mesh has the cells of the tile that is traced
    expectCloserThan(off(meshRenderer(*device, "builtin:pulli", material()), view), 0.1, 0.01,
                     "displaced mesh");
  }
}

}  // namespace
}  // namespace loden::bench
