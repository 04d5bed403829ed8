// The frame renderer's engine manners: it leaves GL state alone and draws the same after a lost context.
#include "runtime/frame/frame.h"

#include <epoxy/gl.h>

#include "material/base/issues.h"
#include "runtime/scene/mesh_analytic.h"
#include "shaders/scene_shared.h"
#include "tests/gl/gl_fixture.h"
#include "tests/gl/gl_state_dump.h"
#include "tests/unit/material_fixtures.h"

namespace loden::test {
namespace {

using namespace runtime;

using FrameTest = GlTest;

// A plane with a fused material under a sun with a shadow map, and a point light.
Scene planeScene(const Material& material = fusedMaterial()) {
  Scene scene = analyticScene(SurfaceKind::kPlane, {}, glm::normalize(glm::vec3(0.3f, 0.2f, 1)));
  Result<std::vector<std::byte>> bytes = serializeAsset(material);
  scene.assets[0].embedded = std::move(*bytes);
  scene.assets[0].name = "fused";
  Light lamp;
  lamp.position = {0, 0, 2};
  lamp.intensity = glm::vec3(2);
  scene.lights.push_back(lamp);
  return scene;
}

View viewOf(glm::ivec2 size) {
  Camera camera;
  camera.position = {1, -2, 2};
  camera.target = {1, 1, 0};
  return makeView(camera, size);
}

TEST_F(FrameTest, EveryPublicCallLeavesGlStateAsFound) {
  disturbGlState();
  const GlState before = dumpGlState();
  const auto expectUnchanged = [&](const char* call) {
    for (const std::string& name : differences(before, dumpGlState()))
      ADD_FAILURE() << call << " changed " << name;
  };
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, planeScene());
  ASSERT_TRUE(renderer.ok()) << renderer.issue().text;
  expectUnchanged("create");
  const RenderTarget target = *makeRenderTarget({64, 48}, ColorFormat::kSrgb8, "frame");
  for (const int samples : {1, 4}) {
    FrameSettings settings;
    settings.samples = samples;
    (*renderer)->prepare(viewOf(target.size), settings);
    expectUnchanged("prepare");
    materials->finishLoading();
    expectUnchanged("finishLoading");
    const Status status = (*renderer)->draw({target.framebuffer.name(), target.size});
    ASSERT_TRUE(status.ok()) << status.issue().text;
    expectUnchanged("draw");
  }
  renderer->reset();
  expectUnchanged("destruction");
}

TEST_F(FrameTest, DrawsThePlaneWithItsMaterial) {
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, planeScene());
  ASSERT_TRUE(renderer.ok());
  const RenderTarget target = *makeRenderTarget({64, 48}, ColorFormat::kLinear32, "frame");
  (*renderer)->prepare(viewOf(target.size), {});
  materials->finishLoading();
  ASSERT_TRUE((*renderer)->draw({target.framebuffer.name(), target.size}).ok());
  EXPECT_EQ((*renderer)->stats().visible_objects, 1);
  EXPECT_EQ(shaders.stats().compiled, 2) << "one depth and one shading program: nothing else is needed";
  for (const glm::vec4& pixel : readLinear(target)) ASSERT_TRUE(std::isfinite(pixel.x + pixel.y + pixel.z));
}

std::vector<glm::vec4> picture(FrameRenderer& renderer, MaterialSystem& materials) {
  const RenderTarget target = *makeRenderTarget({64, 48}, ColorFormat::kLinear32, "frame");
  renderer.prepare(viewOf(target.size), {});
  materials.finishLoading();
  EXPECT_TRUE(renderer.draw({target.framebuffer.name(), target.size}).ok());
  return readLinear(target);
}

std::vector<glm::vec4> pictureWith(FrameRenderer& renderer, MaterialSystem& materials, const View& view,
                                   const FrameSettings& settings) {
  const RenderTarget target = *makeRenderTarget(view.size, ColorFormat::kLinear32, "frame");
  renderer.prepare(view, settings);
  materials.finishLoading();
  EXPECT_TRUE(renderer.draw({target.framebuffer.name(), target.size}).ok());
  return readLinear(target);
}

double meanOf(const std::vector<glm::vec4>& pixels, int channel) {
  double sum = 0;
  for (const glm::vec4& pixel : pixels) sum += double(pixel[channel]);
  return sum / double(pixels.size());
}

TEST_F(FrameTest, HeatMapsTellNearTermFromMean) {
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, planeScene());
  ASSERT_TRUE(renderer.ok());
  FrameSettings settings;
  settings.heat = HeatMap::kTerms;
  settings.lambda = 30.0f;
  const auto far = pictureWith(**renderer, *materials, viewOf({64, 48}), settings);
  EXPECT_GT(meanOf(far, 2), 0.2) << "the mean alone";
  settings.heat = HeatMap::kFetches;
  const auto few = pictureWith(**renderer, *materials, viewOf({64, 48}), settings);
  settings.lambda = 1.5f;  // where both bands show
  const auto many = pictureWith(**renderer, *materials, viewOf({64, 48}), settings);
  EXPECT_GT(meanOf(many, 1) - meanOf(many, 2), meanOf(few, 1) - meanOf(few, 2) + 0.05)
      << "greener, and less blue";
}

// Heights in waves, and normals that tell places apart.
Material waves() {
  constexpr int kSide = 64;
  Material material = surfaceMaterial();
  material.stored_vdim.reset();
  material.aspect = 1;
  material.side = kSide;
  std::vector<glm::dvec3> positions;
  for (int t = 0; t < kSide * kSide; ++t) {
    const glm::dvec2 p((t % kSide + 0.5) / kSide, (t / kSide + 0.5) / kSide);
    positions.emplace_back(p, -0.1 + 0.1 * std::sin(2 * kPi * p.x) * std::cos(2 * kPi * p.y));
  }
  material.geometry = encodeGeometryImage(kSide, positions, std::vector<uint16_t>(positions.size(), 1), true);
  Texture& normal = material.surface->normal;
  for (int mip = 0; mip < normal.mips; ++mip)
    for (int y = 0; y < normal.mipHeight(mip); ++y)
      for (int x = 0; x < normal.mipWidth(mip); ++x) {
        const glm::dvec2 p((x + 0.5) / normal.mipWidth(mip), (y + 0.5) / normal.mipHeight(mip));
        const glm::dvec3 n(std::sin(2 * kPi * p.x), std::sin(2 * kPi * p.y), 2);
        storeTexel(normal, mip, x, y, 0, glm::vec4(glm::normalize(n), 0));
      }
  return material;
}

double distanceOf(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += double(glm::distance(glm::vec3(a[i]), glm::vec3(b[i])));
  return sum / double(a.size());
}

TEST_F(FrameTest, ParallaxOcclusionFindsWhatTheLookupFinds) {
  const Scene scene = planeScene(waves());
  const View view = viewOf({64, 48});
  FrameSettings settings;
  settings.shadows = false;
  settings.lambda = 0.0f;
  settings.visibility = Visibility::kNone;
  ShaderLibrary shaders(*device, {});
  auto materials = makeMaterials();
  auto renderer = FrameRenderer::create(*device, shaders, *materials, scene);
  ASSERT_TRUE(renderer.ok());
  const auto found = pictureWith(**renderer, *materials, view, settings);
  settings.parallax_occlusion = true;
  const auto marched = pictureWith(**renderer, *materials, view, settings);
  settings.parallax_occlusion = false;
  settings.base_materials_only = true;
  const auto base = pictureWith(**renderer, *materials, view, settings);
  MaterialSystemOptions none;
  none.lookup = Lookup::kNone;
  auto flat_materials = *MaterialSystem::create(*device, none);
  auto flat = FrameRenderer::create(*device, shaders, *flat_materials, scene);
  ASSERT_TRUE(flat.ok());
  settings.base_materials_only = false;
  const double without = distanceOf(pictureWith(**flat, *flat_materials, view, settings), found);
  EXPECT_GT(without, 0.005) << "parallax shows here at all";
  EXPECT_LT(distanceOf(marched, found), 0.1 * without);
  settings.parallax_occlusion = true;
  settings.heat = HeatMap::kFetches;
  const auto march_heat = pictureWith(**renderer, *materials, view, settings);
  settings.parallax_occlusion = false;
  EXPECT_GT(distanceOf(march_heat, marched), 0.1) << "a heat map, not the look";
  EXPECT_GT(distanceOf(march_heat, pictureWith(**renderer, *materials, view, settings)), 0.01)
      << "of the march's fetches, not of the lookup's";
  settings.parallax_occlusion = true;
  settings.heat = HeatMap::kNone;
  EXPECT_EQ(pictureWith(**flat, *flat_materials, view, settings), base)
      << "without heights that the shader may read: glTF's own material";
}

TEST_F(FrameTest, ParallaxOcclusionAsksForTheNearTermFarAway) {
  Material material = nearMaterial();
  material.aspect = 1;
  material.geometry = waves().geometry;
  ShaderLibrary shaders(*device, {});
  auto materials = makeMaterials();
  auto renderer = FrameRenderer::create(*device, shaders, *materials, planeScene(material));
  ASSERT_TRUE(renderer.ok());
  FrameSettings settings;
  settings.lambda = material.surface->fade_end + 1;
  (*renderer)->prepare(viewOf({64, 48}), settings);
  EXPECT_EQ((*renderer)->stats().demands.at(0).lambda, *settings.lambda);
  settings.parallax_occlusion = true;
  (*renderer)->prepare(viewOf({64, 48}), settings);
  EXPECT_EQ((*renderer)->stats().demands.at(0).lambda, material.surface->fade_begin);
}

TEST_F(FrameTest, DressesTheSceneAnew) {
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  Scene scene = planeScene();
  auto renderer = FrameRenderer::create(*device, shaders, *materials, scene);
  ASSERT_TRUE(renderer.ok());
  const auto before = pictureWith(**renderer, *materials, viewOf({64, 48}), {});
  scene.materials[0].flat_btf->scale = {3, 3};
  ASSERT_TRUE((*renderer)->dress(scene, poseAt(scene, nullptr, 0)).ok());
  EXPECT_NE(pictureWith(**renderer, *materials, viewOf({64, 48}), {}), before);
  scene.materials[0].flat_btf->scale = {1, 1};
  ASSERT_TRUE((*renderer)->dress(scene, poseAt(scene, nullptr, 0)).ok());
  EXPECT_EQ(pictureWith(**renderer, *materials, viewOf({64, 48}), {}), before);
  scene.materials[0].flat_btf.reset();
  ASSERT_TRUE((*renderer)->dress(scene, poseAt(scene, nullptr, 0)).ok());
  (*renderer)->prepare(viewOf({64, 48}), {});
  EXPECT_TRUE((*renderer)->stats().demands.empty()) << "nothing wears the asset";
}

// The whole picture's pixels, drawn in two parts.
TEST_F(FrameTest, PartsMakeUpThePicture) {
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, planeScene());
  ASSERT_TRUE(renderer.ok());
  const View view = viewOf({64, 48});
  const auto whole = pictureWith(**renderer, *materials, view, {});
  const auto left = pictureWith(**renderer, *materials, partOf(view, {0, 0}, {32, 48}), {}),
             right = pictureWith(**renderer, *materials, partOf(view, {32, 0}, {64, 48}), {});
  double difference = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const glm::vec4 part = x < 32 ? left[size_t(y * 32 + x)] : right[size_t(y * 32 + x - 32)];
      difference += double(glm::distance(part, whole[size_t(y * 64 + x)]));
    }
  EXPECT_LT(difference / (64 * 48), 2e-3) << "but for what derivatives round";
}

// A plate above a white floor, both glTF's own materials, under a panorama with one lamp overhead.
TEST_F(FrameTest, EnvironmentsCastShadowsAndShowBehind) {
  Scene scene;
  Mesh square = analyticMesh(analyticSurface(SurfaceKind::kPlane));
  scene.meshes = {square};
  SceneMaterial white;
  white.metallic = 0;
  white.double_sided = true;
  scene.materials = {white};
  Instance floor, plate;
  floor.material = plate.material = 0;
  plate.world_from_local = glm::mat4(0.4f);
  plate.world_from_local[3] = {0, 0, 0.3f, 1};
  scene.instances = {floor, plate};
  Panorama panorama{64, 32, std::vector<glm::vec3>(64 * 32, glm::vec3(0.2f))};
  for (int i = 0; i < 64 * 2; ++i) panorama.pixels[size_t(i)] = glm::vec3(60);
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, scene);
  ASSERT_TRUE(renderer.ok());
  FrameSettings settings;
  settings.tone = ToneCurve::kNeutral;
  settings.exposure = 0.3f;
  settings.environment = projectPanorama(panorama, 2);
  ASSERT_FALSE(settings.environment->suns.empty());
  settings.reflections = std::make_shared<const ReflectionMap>(makeReflectionMap(panorama, glm::mat3(1)));
  const auto lit = pictureWith(**renderer, *materials, viewOf({64, 48}), settings);
  settings.environment_shadows = true;
  settings.shadow_width = 4;
  const auto shadowed = pictureWith(**renderer, *materials, viewOf({64, 48}), settings);
  EXPECT_LT(meanOf(shadowed, 1), meanOf(lit, 1) - 0.01);
  double brighter = 0;
  for (size_t i = 0; i < lit.size(); ++i) brighter = std::max(brighter, double(shadowed[i].y - lit[i].y));
  EXPECT_LT(brighter, 1e-3) << "shadows take light away";
  settings.sky_level = 0.0f;
  const auto sky = pictureWith(**renderer, *materials, viewOf({64, 48}), settings);
  // The neutral curve below 0.08: 6.25 x^2.
  EXPECT_NEAR(double(sky.back().y), 6.25 * 0.06 * 0.06, 0.004) << "the panorama at its top right corner";
}

// LBTF 3.4, step 2. In a narrow view straight on the distance is nearly one all over the picture.
TEST_F(FrameTest, DistanceRuleIsLogarithmOfDistanceWhateverTheTilt) {
  Material material = fusedMaterial();
  material.side = 16;
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, planeScene(material));
  ASSERT_TRUE(renderer.ok());
  const RenderTarget target = *makeRenderTarget({48, 48}, ColorFormat::kLinear32, "frame");
  constexpr float kDistance = 6;
  const auto draw = [&](glm::vec3 from, LambdaRule rule, std::optional<float> lambda) {
    Camera camera;
    camera.position = glm::normalize(from) * kDistance, camera.target = {0, 0, 0}, camera.up = {0, 1, 0},
    camera.fov_degrees = 8;
    FrameSettings settings;
    settings.lambda_rule = rule, settings.lambda = lambda;
    (*renderer)->prepare(makeView(camera, target.size), settings);
    materials->finishLoading();
    EXPECT_TRUE((*renderer)->draw({target.framebuffer.name(), target.size}).ok());
    return readLinear(target);
  };
  const auto difference = [](const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
    float sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += glm::distance(glm::vec3(a[i]), glm::vec3(b[i]));
    return sum / float(a.size());
  };
  const float pixel = 2 * kDistance * std::tan(glm::radians(4.0f)) / 48 /
                      float(AnalyticSurface::kTilePeriod);  // tile periods
  const float lambda = std::log2(pixel * float(material.side));
  ASSERT_GT(lambda, 0.5f);
  ASSERT_LT(lambda, 2.0f) << "the levels behind look too much alike";
  for (const glm::vec3 from : {glm::vec3(0, 0, 1), glm::vec3(0, -3, 1)}) {
    const auto by_distance = draw(from, LambdaRule::kDistance, {}),
               asked_for = draw(from, LambdaRule::kFootprint, lambda);
    EXPECT_LT(difference(by_distance, asked_for), from.y == 0 ? 1e-3f : 0.02f)
        << "pixels lie 5 % of the distance apart where the plane is tilted";
    EXPECT_GT(difference(by_distance, draw(from, LambdaRule::kFootprint, lambda + 1)), 5e-3f)
        << "the picture shows the level";
  }
  EXPECT_LT(
      difference(draw({0, 0, 1}, LambdaRule::kDistance, {}), draw({0, 0, 1}, LambdaRule::kFootprint, {})),
      1e-3f);
  EXPECT_GT(
      difference(draw({0, -3, 1}, LambdaRule::kDistance, {}), draw({0, -3, 1}, LambdaRule::kFootprint, {})),
      5e-3f);
}

TEST_F(FrameTest, DrawsTheSameWhateverStateItFinds) {
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, planeScene());
  ASSERT_TRUE(renderer.ok());
  const std::vector<glm::vec4> expected = picture(**renderer, *materials);
  for (const GLenum state :
       {GL_DEPTH_CLAMP, GL_RASTERIZER_DISCARD, GL_COLOR_LOGIC_OP, GL_PRIMITIVE_RESTART,
        GL_SAMPLE_ALPHA_TO_COVERAGE, GL_POLYGON_OFFSET_FILL, GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE7,
        GL_SAMPLE_MASK, GL_SAMPLE_COVERAGE, GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST}) {
    glEnable(state);
    glLogicOp(GL_INVERT);
    glPrimitiveRestartIndex(1);
    glPolygonOffset(100, 1000);
    glSampleMaski(0, 0);
    glSampleCoverage(0, GL_FALSE);
    glScissor(0, 0, 1, 1);
    glBlendFunc(GL_ZERO, GL_ONE);
    glStencilFunc(GL_NEVER, 0, 0);
    EXPECT_TRUE(picture(**renderer, *materials) == expected) << std::hex << state;
    glDisable(state);
  }
  glDepthRange(0.5, 0.5);
  EXPECT_TRUE(picture(**renderer, *materials) == expected) << "depth range";
  glDepthRange(0, 1);
  glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
  EXPECT_TRUE(picture(**renderer, *materials) == expected) << "clip control, as for reversed depth";
  glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  GLuint sampler = 0;  // without depth comparison
  glCreateSamplers(1, &sampler);
  for (GLuint unit = 0; unit <= SCENE_UNIT_SHADOW; ++unit) glBindSampler(unit, sampler);
  EXPECT_TRUE(picture(**renderer, *materials) == expected) << "samplers";
  glDeleteSamplers(1, &sampler);
}

// Several samples change silhouettes, not what the target can hold.
TEST_F(FrameTest, KeepsBrightnessAboveOneWithSeveralSamples) {
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, planeScene());
  ASSERT_TRUE(renderer.ok());
  FrameSettings settings;
  settings.tone = ToneCurve::kClip;
  settings.background = glm::vec3(4, 0.001f, 2);
  Camera away;
  away.position = {0, 0, 2};
  away.target = {0, 0, 4};
  for (const ColorFormat format : {ColorFormat::kLinear32, ColorFormat::kSrgb8, ColorFormat::kLinear16}) {
    const RenderTarget target = *makeRenderTarget({16, 16}, format, "frame");
    std::vector<glm::vec4> pixels[2];
    for (const int samples : {1, 4}) {
      settings.samples = samples;
      (*renderer)->prepare(makeView(away, target.size), settings);
      ASSERT_TRUE((*renderer)->draw({target.framebuffer.name(), target.size}).ok());
      pixels[samples / 4] = readLinear(target);
    }
    EXPECT_TRUE(pixels[0] == pixels[1]) << int(format);
  }
}

TEST_F(FrameTest, SaysWhereATargetCannotBe) {
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, planeScene());
  ASSERT_TRUE(renderer.ok());
  const RenderTarget target = *makeRenderTarget({16, 16}, ColorFormat::kSrgb8, "frame");
  FrameSettings settings;
  settings.samples = 4;
  (*renderer)->prepare(viewOf(target.size), settings);
  EXPECT_TRUE((*renderer)->draw({target.framebuffer.name(), {0, 0}}).ok()) << "a minimised window";
  const Status huge = (*renderer)->draw({target.framebuffer.name(), {1 << 20, 1 << 20}});
  ASSERT_FALSE(huge.ok());
  EXPECT_EQ(huge.issue().id, issue_id::kMemory);
  while (glGetError() != GL_NO_ERROR) {
  }
  messages.clear();  // the driver says so too
  EXPECT_TRUE((*renderer)->draw({target.framebuffer.name(), target.size}).ok()) << "and goes on";
}

TEST_F(FrameTest, LightsAMeshThatItsTransformFlattens) {
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  Scene scene = planeScene();  // in z = 0 already
  auto whole = FrameRenderer::create(*device, shaders, *materials, scene);
  for (Instance& instance : scene.instances) instance.world_from_local[2] = glm::vec4(0);
  auto flat = FrameRenderer::create(*device, shaders, *materials, scene);
  ASSERT_TRUE(whole.ok() && flat.ok());
  EXPECT_TRUE(picture(**flat, *materials) == picture(**whole, *materials));
}

TEST_F(FrameTest, UnloadsItsMaterials) {
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  Scene scene = planeScene();
  for (int again = 0; again < 2; ++again) {
    auto renderer = FrameRenderer::create(*device, shaders, *materials, scene);
    ASSERT_TRUE(renderer.ok());
    EXPECT_EQ(materials->stats().materials, 1);
    renderer->reset();
    EXPECT_EQ(materials->stats().materials, 0);
  }
  scene.assets.push_back(scene.assets[0]);
  scene.assets[1].embedded.resize(10);
  EXPECT_FALSE(FrameRenderer::create(*device, shaders, *materials, scene).ok());
  EXPECT_EQ(materials->stats().materials, 0) << "the first asset of a scene whose second one is broken";
}

}  // namespace
}  // namespace loden::test
