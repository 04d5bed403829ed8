// Parallax-correct depth: what a tile's relief hides, shows and shadows, against the relief's own geometry.
#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "material/model/directions.h"
#include "runtime/frame/frame.h"
#include "runtime/scene/mesh_analytic.h"
#include "tests/gl/gl_fixture.h"
#include "tests/unit/material_fixtures.h"

namespace loden::test {
namespace {

using namespace runtime;

constexpr float kPeriod = 0.125f, kDepth = 0.1f * kPeriod;  // metres
constexpr glm::ivec2 kSize{96, 96};
constexpr glm::vec3 kBackground{0, 0, 1};  // as nothing in the scenes

// Ridges along y: high where fract(x) < .5, 0.1 periods lower elsewhere. White and matte.
Material ridges() {
  constexpr int kSide = 64;
  Material material = surfaceMaterial();
  material.stored_vdim.reset();
  material.aspect = 1;
  material.side = kSide;
  material.value_scale = float(1 / kPi);
  std::vector<glm::dvec3> positions;
  for (int t = 0; t < kSide * kSide; ++t) {
    const glm::dvec2 p((t % kSide + 0.5) / kSide, (t / kSide + 0.5) / kSide);
    positions.emplace_back(p, p.x < 0.5 ? 0.0 : -0.1);
  }
  material.geometry = encodeGeometryImage(kSide, positions, std::vector<uint16_t>(positions.size(), 1), true);
  const auto fill = [](Texture& texture, const glm::vec4& value) {
    for (int mip = 0; mip < texture.mips; ++mip)
      for (int y = 0; y < texture.mipHeight(mip); ++y)
        for (int x = 0; x < texture.mipWidth(mip); ++x) storeTexel(texture, mip, x, y, 0, value);
  };
  fill(material.surface->normal, {0, 0, 1, 0});
  fill(material.surface->color, {1, 1, 1, 0});
  return material;
}

// A horizontal white chip, 2 half sizes long.
void addChip(Scene& scene, const glm::vec3& centre, const glm::vec2& half) {
  Mesh mesh;
  mesh.name = "chip";
  for (const glm::vec2 c : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)})
    mesh.vertices.push_back({centre + glm::vec3(c * half, 0), {0, 0, 1}, {1, 0, 0, 1}, c});
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.bounds = boundsOf(mesh);
  scene.meshes.push_back(mesh);
  SceneMaterial material;
  material.base_color = {1, 0, 0, 1};
  material.metallic = 0;
  scene.materials.push_back(material);
  scene.instances.push_back({"chip", 1, 1, glm::mat4(1)});
}

double meanDifference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += double(glm::length(glm::vec3(a[i]) - glm::vec3(b[i])));
  return sum / double(a.size());
}

class Relief : public GlTest {
 protected:
  Scene sceneUnder(const glm::vec3& to_sun, SurfaceKind kind = SurfaceKind::kPlane) {
    Scene scene = analyticScene(kind, {}, glm::normalize(to_sun));
    scene.assets[0].embedded = std::move(*serializeAsset(ridges()));
    scene.assets[0].name = "ridges";
    return scene;
  }

  // Seen from 1 m above x = centre; pixels are 1.8 mm wide.
  std::vector<glm::vec4> picture(const Scene& scene, bool shadows, float centre, bool depth_prepass = true,
                                 bool shell = false) {
    auto materials = makeMaterials();
    ShaderLibrary shaders(*device, {});
    auto renderer = FrameRenderer::create(*device, shaders, *materials, scene);
    EXPECT_TRUE(renderer.ok());
    FrameSettings settings;
    settings.parallax_depth = true;
    settings.shell = shell;
    settings.shadows = shadows;
    settings.depth_prepass = depth_prepass;
    settings.tone = ToneCurve::kClip;
    settings.sky_ambient = settings.ground_ambient = glm::vec3(0);
    settings.background = kBackground;
    Camera camera;
    camera.position = {centre, 0, 1};
    camera.target = {centre, 0, 0};
    camera.up = {0, 1, 0};
    camera.fov_degrees = 10;
    const RenderTarget target = *makeRenderTarget(kSize, ColorFormat::kLinear32, "relief");
    (*renderer)->prepare(makeView(camera, target.size), settings);
    materials->finishLoading();
    EXPECT_TRUE((*renderer)->draw({target.framebuffer.name(), target.size}).ok());
    centre_ = centre;
    return readLinear(target);
  }
  // Of a point of the plane z = 0.
  glm::ivec2 pixelAt(glm::vec2 at) const {
    const float scale = float(kSize.y) / (2 * std::tan(float(5 * kPi / 180)));
    return glm::ivec2(glm::floor(glm::vec2(kSize) * 0.5f + (at - glm::vec2(centre_, 0)) * scale));
  }
  // Smallest and largest green of the pixels over a rectangle of the plane.
  std::pair<float, float> range(const std::vector<glm::vec4>& pixels, glm::vec2 low, glm::vec2 high) const {
    float least = 1e9f, most = -1e9f;
    const glm::ivec2 a = pixelAt(low), b = pixelAt(high);
    for (int y = a.y; y <= b.y; ++y)
      for (int x = a.x; x <= b.x; ++x) {
        least = std::min(least, pixels[size_t(y) * kSize.x + x].g);
        most = std::max(most, pixels[size_t(y) * kSize.x + x].g);
      }
    return {least, most};
  }

 private:
  float centre_ = 0;
};

TEST_F(Relief, DoesNotShadowItself) {
  for (const glm::vec3& to_sun :
       {glm::vec3(0.02f, 0.01f, 1), glm::vec3(1, 0.2f, 1), glm::vec3(-1, -1, 0.6f)}) {
    const Scene scene = sceneUnder(to_sun);
    const auto lit = picture(scene, false, 0), shadowed = picture(scene, true, 0);
    float off = 0;
    for (size_t i = 0; i < lit.size(); ++i) off = std::max(off, std::abs(lit[i].g - shadowed[i].g));
    EXPECT_LT(off, 1e-3f) << "its own shadows are part of the material";
  }
}

// A chip that lies in a valley, below the reference plane: it is seen, and the sun reaches it.
TEST_F(Relief, ShowsAndLightsWhatLiesInAValley) {
  Scene scene = sceneUnder({0.02f, 0, 1});
  const glm::vec2 valley(0.75f * kPeriod, 0);
  addChip(scene, {valley, -0.5f * kDepth}, {0.015f, 0.015f});
  const auto lit = picture(scene, false, valley.x), shadowed = picture(scene, true, valley.x);
  const auto [least, most] = range(shadowed, valley - 0.01f, valley + 0.01f);
  const auto [lit_least, lit_most] = range(lit, valley - 0.01f, valley + 0.01f);
  EXPECT_LT(most, 0.2f) << "the red chip, not the white tile";
  EXPECT_GT(lit_least, 0);
  EXPECT_NEAR(least, lit_least, 1e-3f);
  EXPECT_NEAR(most, lit_most, 1e-3f);
  // Under the ridge beside it, it would be hidden.
  Scene hidden = sceneUnder({0.02f, 0, 1});
  addChip(hidden, {0.25f * kPeriod, 0, -0.5f * kDepth}, {0.015f, 0.015f});
  const auto covered = picture(hidden, true, 0.25f * kPeriod);
  EXPECT_GT(range(covered, {0.25f * kPeriod - 0.01f, -0.01f}, {0.25f * kPeriod + 0.01f, 0.01f}).first, 0.5f);
}

// The pre-pass meets the relief where the shading pass does: nothing hides itself, and what is hidden stays
// so.
TEST_F(Relief, LooksTheSameWithoutADepthPrePass) {
  Scene scene = sceneUnder({0.3f, 0.2f, 1});
  addChip(scene, {0.75f * kPeriod, 0, -0.5f * kDepth}, {0.08f, 0.01f});  // partly under ridges
  const auto with = picture(scene, true, 0.75f * kPeriod),
             without = picture(scene, true, 0.75f * kPeriod, false);
  float off = 0;
  for (size_t i = 0; i < with.size(); ++i) off = std::max(off, glm::distance(with[i], without[i]));
  EXPECT_LT(off, 1e-5f);
}

// The same ridges as a fused material: the relief is seen as far as the flat band is, which arrives after the
// geometry.
Material fusedRidges() {
  const Material surface = ridges();
  Material material = fusedMaterial();
  material.side = surface.side;
  material.geometry = surface.geometry;
  material.atlas = kFirstVdimAtlas;  // nothing refines it later
  material.value_scale = surface.value_scale;
  return material;
}

// The sun's map follows what streams in, level by level, and rests when nothing does.
TEST_F(Relief, KeepsTheShadowMapUpToDateWhileStreaming) {
  Scene scene = sceneUnder({0.02f, 0, 1});
  scene.assets[0].embedded = std::move(*serializeAsset(fusedRidges()));
  addChip(scene, {0.75f * kPeriod, 0, -0.5f * kDepth}, {0.015f, 0.015f});
  auto materials = makeMaterials({.upload_bytes_per_frame = 4096});
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, scene);
  ASSERT_TRUE(renderer.ok());
  FrameSettings settings;
  settings.parallax_depth = true;
  settings.tone = ToneCurve::kClip;
  Camera camera;
  camera.position = {0.75f * kPeriod, 0, 1};
  camera.target = {0.75f * kPeriod, 0, 0};
  camera.up = {0, 1, 0};
  camera.fov_degrees = 10;
  const RenderTarget target = *makeRenderTarget(kSize, ColorFormat::kLinear32, "relief");
  const auto draw = [&](FrameRenderer& with) {
    with.prepare(makeView(camera, target.size), settings);
    materials->update(0.1f);
    EXPECT_TRUE(with.draw({target.framebuffer.name(), target.size}).ok());
    return with.stats().depth_draw_calls;
  };
  const int prepass = 2, all = 4;  // draws: two objects, in the pre-pass and in the map
  uint64_t revision = ~0ull;
  int resting = 0;  // frames; some are drawn while parts arrive and fade in
  for (int frame = 0; frame < 100000 && resting < 20; ++frame) {
    if (frame % 32 == 0) {
      draw(**renderer);
    } else {
      (*renderer)->prepare(makeView(camera, target.size), settings);
      materials->update(0.1f);
    }
    resting =
        materials->stats().parts_resident > 2 && materials->reliefRevision() == revision ? resting + 1 : 0;
    revision = materials->reliefRevision();
    std::this_thread::sleep_for(std::chrono::microseconds(300));
  }
  draw(**renderer);
  EXPECT_EQ(draw(**renderer), prepass) << "redrawn although nothing changes";
  const auto streamed = readLinear(target);
  settings.base_materials_only = true;
  EXPECT_EQ(draw(**renderer), all) << "without the relief it is another map";
  settings.base_materials_only = false;
  settings.lambda = 9;
  EXPECT_EQ(draw(**renderer), all) << "at another level too";
  settings.lambda.reset();
  EXPECT_EQ(draw(**renderer), all);
  EXPECT_TRUE(readLinear(target) == streamed) << "what was drawn while parts arrived is out of date";
}

// At silhouettes of a curved relief some of a fragment's evaluations miss it, and the others show it: what
// stands behind is neither hidden by nothing nor shown through.
TEST_F(Relief, LeavesNoHolesAtCurvedSilhouettes) {
  for (const float side : {0.44f, 0.5f}) {
    Scene scene = sceneUnder({1, 0.1f, 0.6f}, SurfaceKind::kSphere);
    addChip(scene, {0, 0, -3}, {9, 9});
    const auto with = picture(scene, false, side), without = picture(scene, false, side, false);
    int holes = 0, differ = 0, relief = 0;
    for (size_t i = 0; i < with.size(); ++i) {
      holes += glm::vec3(with[i]) == kBackground;
      differ += glm::distance(with[i], without[i]) > 1e-5f;
      relief += with[i].g > 0.05f;
    }
    EXPECT_GT(relief, int(with.size()) / 5) << "the silhouette is out of view";
    EXPECT_EQ(holes, 0);
    EXPECT_EQ(differ, 0) << "from what is drawn without a pre-pass";
  }
}

// The reference surface of a shell lies above its mesh by the depth of the tile: a sphere that is smaller by
// as much has the same picture as a shell.
TEST_F(Relief, TheShellOfASmallerSphereIsTheSphere) {
  const float radius = 24 / (8 * 2 * float(kPi)), depth = ridges().geometry.range.z * kPeriod;
  Scene sphere = sceneUnder({1, 0.1f, 0.6f}, SurfaceKind::kSphere), smaller = sphere;
  smaller.instances[0].world_from_local =
      glm::mat4(glm::mat3(radius / (radius + depth))) * smaller.instances[0].world_from_local;
  smaller.instances[0].world_from_local[3].w = 1;
  addChip(sphere, {0, 0, -3}, {9, 9});
  addChip(smaller, {0, 0, -3}, {9, 9});
  for (const bool shadows : {false, true}) {
    const auto given = picture(sphere, shadows, 0.44f), shell = picture(smaller, shadows, 0.44f, true, true),
               bare = picture(smaller, shadows, 0.44f);
    EXPECT_LT(meanDifference(given, shell), 0.05 * meanDifference(given, bare)) << shadows;
    int outside = 0;
    for (size_t i = 0; i < given.size(); ++i) outside += (given[i].g > 0.05f) != (shell[i].g > 0.05f);
    EXPECT_LE(outside, int(given.size()) / 500) << shadows;
  }
}

// A chip above the tile: its shadow has no gap and lies where geometry puts it, on a ridge and in a valley.
TEST_F(Relief, TakesTheShadowOfWhatStandsAboveIt) {
  const float height = 0.04f, half = 0.02f;
  const glm::vec3 to_sun(1, 0, 1);  // so that shadows lie as far to the left as their casters are high
  for (const float at : {0.25f, 0.75f}) {
    const float z = at < 0.5f ? 0 : -kDepth, shadow = at * kPeriod;
    Scene scene = sceneUnder(to_sun);
    addChip(scene, {shadow + height - z, 0, height}, {half, half});
    const auto pixels = picture(scene, true, shadow);
    const float margin = 0.006f;  // two texels of the shadow map, two pixels
    // Within its own ridge or valley, which is .06 m wide.
    const float inside = half - margin;
    EXPECT_LT(range(pixels, {shadow - inside, -inside}, {shadow + inside, inside}).second, 0.02f)
        << "a gap, z = " << z;
    const float beside = half + margin;
    EXPECT_GT(range(pixels, {shadow - 0.01f, beside}, {shadow + 0.01f, beside + 0.02f}).first, 0.5f)
        << "too long, z = " << z;
    EXPECT_GT(range(pixels, {shadow - half - margin - 0.003f, -0.01f}, {shadow - half - margin, 0.01f}).first,
              0.5f)
        << "too wide, z = " << z;
  }
}

}  // namespace
}  // namespace loden::test
