// Silhouettes of a relief on bent surfaces against the traced tile.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "importer/bake/bake.h"
#include "importer/cook/cook.h"
#include "importer/trace/trace.h"
#include "material/asset/asset.h"
#include "runtime/frame/frame.h"
#include "runtime/gl/device.h"
#include "runtime/gl/gl_target.h"
#include "runtime/gl/material/material_system.h"
#include "runtime/scene/mesh_analytic.h"
#include "runtime/shader/shader_library.h"

namespace loden::runtime {
namespace {

constexpr int kSide = 160;                 // pixels
constexpr glm::vec3 kBackground{0, 0, 1};  // no tile under white light is as blue
constexpr double kLeastIou = 0.98;

// Some .5 m away, past the right border: a texel of a tile of 64 covers about a pixel.
const Camera kCamera{{0.75, -0.45, 0.05}, {0.45, 0.05, 0}, {0, 0, 1}, 40};

Material cookedSurface(const importer::Tile& tile) {
  std::string folder = (std::filesystem::temp_directory_path() / "loden_silhouette_XXXXXX").string();
  EXPECT_NE(::mkdtemp(folder.data()), nullptr);
  importer::BakeOptions options;
  options.size = 16;
  options.geometry_size = 128;
  options.directions = concentricDirections(3);
  options.maps = {.btf = true, .flat = false, .vdim = false, .surface = true};
  options.vdims = {};
  options.quiet = true;
  EXPECT_TRUE(importer::bake(tile, "silhouette", folder, options).ok());
  importer::CookOptions cook;
  cook.quiet = true;
  auto material = importer::cook(*importer::BakedOutput::open(folder), cook);
  EXPECT_TRUE(material.ok()) << (material.ok() ? "" : material.issue().text);
  std::filesystem::remove_all(folder);
  return std::move(*material);
}

// Whether something is seen, from the bottom row on.
std::vector<bool> drawnMask(const Material& material, SurfaceKind kind, bool relief) {
  auto device = Device::create({});
  EXPECT_TRUE(device.ok());
  auto materials = MaterialSystem::create(**device, {});
  EXPECT_TRUE(materials.ok());
  ShaderLibrary shaders(**device, {});
  Scene scene = analyticScene(kind, {}, {0, -1, 0}, material.aspect);
  scene.assets[0].embedded = std::move(*serializeAsset(material));
  scene.assets[0].name = "silhouette";
  auto renderer = FrameRenderer::create(**device, shaders, **materials, scene);
  EXPECT_TRUE(renderer.ok());
  FrameSettings settings;
  settings.parallax_depth = relief;
  settings.tone = ToneCurve::kClip;
  settings.sky_ambient = settings.ground_ambient = glm::vec3(1);
  settings.background = kBackground;
  const RenderTarget target = *makeRenderTarget({kSide, kSide}, ColorFormat::kLinear32, "silhouette");
  (*renderer)->prepare(makeView(kCamera, target.size), settings);
  (*materials)->finishLoading();
  EXPECT_TRUE((*renderer)->draw({target.framebuffer.name(), target.size}).ok());
  std::vector<bool> mask;
  for (const glm::vec4& pixel : readLinear(target)) mask.push_back(glm::vec3(pixel) != kBackground);
  return mask;
}

std::vector<bool> tracedMask(const importer::Tile& tile, SurfaceKind kind) {
  importer::TraceOptions options;
  options.surface = kind;
  options.camera = kCamera;
  options.width = options.height = kSide;
  options.quiet = true;
  const auto picture = importer::trace(tile, options);
  EXPECT_TRUE(picture.ok());
  std::vector<bool> mask;
  for (int y = kSide - 1; y >= 0; --y)
    for (int x = 0; x < kSide; ++x) mask.push_back(picture->at(x, y).a >= 0.5f);
  return mask;
}

double intersectionOverUnion(const std::vector<bool>& a, const std::vector<bool>& b) {
  int both = 0, either = 0;
  for (size_t i = 0; i < a.size(); ++i) both += a[i] && b[i], either += a[i] || b[i];
  return double(both) / either;
}

class Silhouette : public ::testing::TestWithParam<const char*> {};

TEST_P(Silhouette, IsThatOfTheTracedTile) {
  const auto tile = importer::builtinTile(GetParam());
  ASSERT_TRUE(tile.ok());
  const Material material = cookedSurface(*tile);
  for (const SurfaceKind kind : {SurfaceKind::kCylinder, SurfaceKind::kSphere}) {
    const char* name = kind == SurfaceKind::kSphere ? "sphere" : "cylinder";
    const std::vector<bool> traced = tracedMask(*tile, kind);
    const double relief = intersectionOverUnion(drawnMask(material, kind, true), traced),
                 mesh = intersectionOverUnion(drawnMask(material, kind, false), traced);
    std::printf("%s on a %s: intersection over union of the masks %.4f, of the bare mesh's %.4f\n",
                GetParam(), name, relief, mesh);
    EXPECT_GE(relief, kLeastIou) << name;
    // On sponge's sphere both are alike: a ray that just touches the tile may go either way.
    const double pixel = 1.5 / double(std::count(traced.begin(), traced.end(), true));
    EXPECT_GE(relief, mesh - pixel) << name;
    EXPECT_GT(std::count(traced.begin(), traced.end(), false), std::ptrdiff_t(traced.size()) / 4)
        << "the silhouette is out of view";
  }
}

INSTANTIATE_TEST_SUITE_P(Tiles, Silhouette, ::testing::Values("button", "sponge"),
                         [](const auto& of) { return std::string(of.param); });

}  // namespace
}  // namespace loden::runtime
