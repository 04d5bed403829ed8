// Textures of an engine's own and of glTF's materials, streamed within the budget of the materials.
#include <epoxy/gl.h>

#include <cmath>

#include "material/base/issues.h"
#include "material/model/directions.h"
#include "runtime/frame/frame.h"
#include "runtime/shader/shader_library.h"
#include "tests/gl/gl_fixture.h"
#include "tests/unit/material_fixtures.h"
#include "tests/unit/textured_square.h"

namespace loden::test {
namespace {

using namespace runtime;

// The same as a texture that nobody streams.
GlTexture wholeTexture(const ImageTexture& image) {
  const Texture& t = *image.mips;
  GlTexture texture = makeTexture(GL_TEXTURE_2D, "whole");
  const bool mipmapped = image.min_filter == GL_LINEAR_MIPMAP_LINEAR;
  glTextureStorage2D(texture.name(), mipmapped ? t.mips : 1, GL_SRGB8_ALPHA8, t.width, t.height);
  for (int mip = 0; mip < (mipmapped ? t.mips : 1); ++mip)
    glTextureSubImage2D(texture.name(), mip, 0, 0, t.mipWidth(mip), t.mipHeight(mip), GL_RGBA,
                        GL_UNSIGNED_BYTE, t.data.data() + t.mipOffset(mip));
  glTextureParameteri(texture.name(), GL_TEXTURE_WRAP_S, GLint(image.wrap_s));
  glTextureParameteri(texture.name(), GL_TEXTURE_WRAP_T, GLint(image.wrap_t));
  glTextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, GLint(image.min_filter));
  glTextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, GLint(image.mag_filter));
  return texture;
}

class TextureStreamingTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    makeScreen();
  }
  void TearDown() override {
    dropScreen();
    GlTest::TearDown();
  }
  // In the current context.
  void makeScreen() {
    program_ = *compileProgram({"texture.vert", R"(
layout(location = 0) out vec2 x;
void main() {
  x = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
  gl_Position = vec4(x * 2.0 - 1.0, 0.0, 1.0);
})"},
                               {"texture.frag", R"(
layout(location = 0) in vec2 x;
layout(location = 0) out vec4 color;
layout(location = 0) uniform float periods;
layout(binding = 0) uniform sampler2D image;
void main() { color = texture(image, x * periods); })"},
                               {}, "texture");
    target_ = *makeRenderTarget({kSide, kSide}, ColorFormat::kLinear32, "texture");
    array_ = makeVertexArray("texture");
  }
  void dropScreen() { program_.reset(), array_.reset(), target_ = {}; }
  // A square of kSide pixels that shows the texture so many times along each side.
  std::vector<glm::vec4> draw(uint32_t texture, float periods) {
    glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer.name());
    glViewport(0, 0, kSide, kSide);
    glUseProgram(program_.name());
    glUniform1f(0, periods);
    glBindVertexArray(array_.name());
    glBindTextureUnit(0, texture);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return readLinear(target_);
  }
  TextureId load(MaterialSystem& system, const ImageTexture& image) {
    const Result<TextureId> id = system.loadTexture(image);
    EXPECT_TRUE(id.ok());
    return *id;
  }
  using GlTest::load;
  static double meanDifference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i)
      for (int c = 0; c < 3; ++c) sum += std::abs(double(a[i][c]) - double(b[i][c]));
    return sum / double(3 * a.size());
  }
  static double largestDifference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
    double largest = 0;
    for (size_t i = 0; i < a.size(); ++i)
      for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(double(a[i][c]) - double(b[i][c])));
    return largest;
  }
  static constexpr int kSide = 64;  // pixels

 private:
  GlProgram program_;
  RenderTarget target_;
  GlVertexArray array_;
};

TEST_F(TextureStreamingTest, LooksLikeTheWholeTextureWhereverItIsDemandedForTheView) {
  for (const bool mipmapped : {true, false}) {
    const ImageTexture image = imageTexture(noiseImage({512, 512}, 1), mipmapped);
    const GlTexture whole = wholeTexture(image);
    for (const float periods : {0.05f, 0.25f, 0.9f, 1.5f, 4.0f, 11.0f}) {
      auto system = makeMaterials();
      const TextureId id = load(*system, image);
      const float lambda = std::log2(512 * periods / kSide);
      system->demand(id, mipmapped ? std::max(lambda, 0.0f) : 0);
      system->finishLoading();
      // Of fewer texels the place in a texel is computed anew, which rounds floats differently.
      const double rounding = mipmapped && lambda >= 1 ? 1e-6 : 0;
      EXPECT_LE(largestDifference(draw(system->textureName(id), periods), draw(whole.name(), periods)),
                rounding)
          << periods;
      if (mipmapped && lambda > 1) {
        EXPECT_LT(system->stats().texture_bytes, uint64_t(512 * 512 * 4)) << "no more than is seen";
      }
    }
  }
}

TEST_F(TextureStreamingTest, CountsWhatIsResident) {
  auto system = makeMaterials();
  const TextureId id = load(*system, imageTexture(noiseImage({256, 256}, 2)));
  EXPECT_EQ(system->stats().textures, 1);
  EXPECT_EQ(system->stats().materials, 0);
  uint64_t all = 0;
  for (const PartStats& part : system->parts(id)) all += part.bytes;
  EXPECT_EQ(system->stats().total_bytes, all);
  system->demand(id, 1);
  system->finishLoading();
  uint64_t resident = 0;
  for (const PartStats& part : system->parts(id)) resident += part.resident ? part.bytes : 0;
  EXPECT_EQ(system->stats().texture_bytes, resident);
  EXPECT_EQ(system->stats().resident_bytes, resident);
  EXPECT_EQ(system->residentLambda(id), 1);
  EXPECT_FALSE(system->parts(id).back().resident);
  system->unload(id);
  system->update(0);
  EXPECT_EQ(system->stats().textures, 0);
  EXPECT_EQ(system->stats().texture_bytes, 0u);
  EXPECT_EQ(system->stats().total_bytes, 0u);
}

TEST_F(TextureStreamingTest, KeepsTheBudgetAndTheUploadBoundOnEveryFrame) {
  std::vector<ImageTexture> images;
  for (uint32_t seed = 0; seed < 4; ++seed)
    images.push_back(imageTexture(noiseImage({512, 256}, seed), seed != 3));
  for (const uint64_t budget : {0u, 90u << 10, 400u << 10, 1u << 20, 8u << 20}) {
    auto system = makeMaterials({.budget_bytes = budget, .upload_bytes_per_frame = 20 << 10});
    std::vector<TextureId> ids;
    for (const ImageTexture& image : images) ids.push_back(load(*system, image));
    for (int frame = 0; frame < 400; ++frame) {
      const size_t seen = size_t(frame) / 100;
      system->demand(ids[seen], 0);
      if (frame % 3 != 0) system->demand(ids[(seen + 1) % 4], 1.5f);
      system->update(1.0f / 60);
      ASSERT_LE(system->stats().resident_bytes, budget);
      ASSERT_LE(system->stats().texture_bytes, system->stats().resident_bytes);
      ASSERT_LE(system->stats().uploaded_last_frame, (20u << 10) + 512 * 4);
    }
    for (const TextureId id : ids) system->demand(id, 0);
    system->finishLoading();
    EXPECT_EQ(system->stats().failed_parts, 0u);
  }
}

TEST_F(TextureStreamingTest, ShowsTheFinestMipThatTheBudgetHolds) {
  for (const bool mipmapped : {true, false}) {
    const ImageTexture image = imageTexture(noiseImage({512, 512}, 3), mipmapped);
    const GlTexture whole = wholeTexture(image);
    double before = 1;
    const auto wanted = draw(whole.name(), 0.12f);
    for (const uint64_t kib : {1u, 30u, 200u, 600u, 2500u}) {
      auto system = makeMaterials({.budget_bytes = kib << 10});
      const TextureId id = load(*system, image);
      system->demand(id, 0);
      system->finishLoading();
      const double difference = meanDifference(draw(system->textureName(id), 0.12f), wanted);
      EXPECT_LT(difference, before) << kib << " KiB";
      before = difference;
    }
    EXPECT_EQ(before, 0);
  }
}

TEST_F(TextureStreamingTest, FadesInWithoutAPop) {
  auto system = makeMaterials();
  const TextureId id = load(*system, imageTexture(noiseImage({256, 256}, 4)));
  std::vector<glm::vec4> before = draw(system->textureName(id), 0.3f);
  const std::vector<glm::vec4> first = before;
  double largest = 0;
  int frames = 0;
  for (; frames < 4000 && system->residentLambda(id) > 0; ++frames) {
    system->demand(id, 0);
    system->update(1.0f / 60);
    const std::vector<glm::vec4> now = draw(system->textureName(id), 0.3f);
    largest = std::max(largest, meanDifference(before, now));
    before = now;
  }
  EXPECT_GT(frames, 100) << "8 levels at 4 a second";
  EXPECT_LT(largest, 0.12 * meanDifference(first, before));
}

// With a budget for one of the two in full, which takes 1.8 MB.
TEST_F(TextureStreamingTest, ComesBackAfterAnEviction) {
  const ImageTexture images[] = {imageTexture(noiseImage({512, 512}, 5)),
                                 imageTexture(noiseImage({512, 512}, 6))};
  constexpr uint64_t kBudget = 2000 << 10;
  auto system = makeMaterials({.budget_bytes = kBudget});
  const TextureId ids[] = {load(*system, images[0]), load(*system, images[1])};
  std::vector<glm::vec4> pictures[2];
  for (int visit = 0; visit < 6; ++visit) {
    const size_t seen = size_t(visit % 2);
    for (int frame = 0; frame < 60; ++frame) {
      system->demand(ids[seen], 0);
      system->update(1.0f / 60);
      ASSERT_LE(system->stats().resident_bytes, kBudget);
    }
    system->finishLoading();
    const auto picture = draw(system->textureName(ids[seen]), 0.1f);
    EXPECT_EQ(largestDifference(picture, draw(wholeTexture(images[seen]).name(), 0.1f)), 0);
    if (visit < 2) pictures[seen] = picture;
    EXPECT_TRUE(picture == pictures[seen]);
    EXPECT_GT(system->residentLambda(ids[1 - seen]), 0);
  }
  EXPECT_GE(system->stats().evicted_parts, 5u);
}

TEST_F(TextureStreamingTest, ReleasesWhatNobodySees) {
  auto system = makeMaterials();
  const TextureId id = load(*system, imageTexture(noiseImage({512, 512}, 7)));
  system->demand(id, 0);
  system->finishLoading();
  const uint64_t whole = system->stats().texture_bytes;
  for (int frame = 0; frame < 300; ++frame) system->update(1.0f / 60);
  EXPECT_LT(system->stats().texture_bytes, 64u << 10);
  EXPECT_GT(system->stats().texture_bytes, 0u) << "the floor stays";
  system->demand(id, 0);
  system->finishLoading();
  EXPECT_EQ(system->stats().texture_bytes, whole);
}

// What is too coarse by more levels gets the room, whatever it is.
TEST_F(TextureStreamingTest, SharesTheBudgetWithMaterials) {
  Material source = fusedMaterial();
  for (Band& band : source.bands)
    band.table =
        noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kVolume, 25, 36, 25 * band.quads(), 1, 3);
  constexpr uint64_t kBudget = 700 << 10;  // of 1.8 MB for the texture alone
  struct Share {
    uint64_t texture = 0, material = 0;
  };
  const auto shareAt = [&](float material_lambda, float texture_lambda) {
    auto system = makeMaterials({.budget_bytes = kBudget});
    const MaterialId material = load(*system, source);
    const TextureId texture = load(*system, imageTexture(noiseImage({512, 512}, 8)));
    for (int frame = 0; frame < 100; ++frame) {
      system->demand(material, material_lambda);
      system->demand(texture, texture_lambda);
      system->update(1.0f / 60);
      EXPECT_LE(system->stats().resident_bytes, kBudget);
    }
    system->finishLoading();
    const MaterialStats& stats = system->stats();
    return Share{stats.texture_bytes, stats.resident_bytes - stats.texture_bytes};
  };
  const Share both = shareAt(0, 0), texture = shareAt(8, 0), material = shareAt(0, 8);
  EXPECT_GT(both.texture, 0u);
  EXPECT_GT(both.material, 0u);
  EXPECT_LT(material.texture, both.texture) << "the tail";
  EXPECT_LE(texture.material, both.material);
  EXPECT_GE(texture.texture, both.texture);
  EXPECT_GE(material.material, both.material);
}

TEST_F(TextureStreamingTest, SurvivesALossAtEveryFrameOfLoading) {
  const ImageTexture image = imageTexture(noiseImage({256, 256}, 9));
  auto system = makeMaterials({.upload_bytes_per_frame = 16 << 10});
  const TextureId id = load(*system, image);
  std::vector<glm::vec4> reference;
  for (int frames = 0; frames < 30; frames += 3) {
    for (int frame = 0; frame < frames; ++frame) {
      system->demand(id, 0);
      system->update(0.02f);
    }
    const TextureId passing = load(*system, image);
    dropScreen();
    system->contextLost();
    device->releaseCurrent();
    EXPECT_EQ(system->stats().texture_bytes, 0u);
    system->demand(id, 0);
    system->update(0.02f);
    system->finishLoading();
    const auto refused = system->loadTexture(image);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.issue().id, issue_id::kGlContext);
    system->unload(passing);
    ASSERT_TRUE(device->recreate().ok());
    ASSERT_TRUE(system->contextRestored().ok());
    makeScreen();
    system->demand(id, 0);
    system->finishLoading();
    const auto picture = draw(system->textureName(id), 0.2f);
    if (reference.empty()) reference = picture;
    EXPECT_TRUE(picture == reference) << "after a loss behind frame " << frames;
  }
  EXPECT_EQ(system->stats().failed_parts, 0u);
}

// Squares of 2 m that stand 10 m from each other along x, each with a texture of its own that it shows unlit.
Scene squares(int count, int side) {
  Scene scene;
  scene.meshes.push_back(texturedSquare(2));
  for (int i = 0; i < count; ++i) {
    scene.images.push_back(noiseImage({side, side}, 40 + uint32_t(i)));
    SceneMaterial material;
    material.unlit = true;
    material.texture(TextureRole::kBaseColor).image = i;
    scene.materials.push_back(material);
    Instance instance;
    instance.material = i;
    instance.world_from_local[3] = glm::vec4(10 * i, 0, 0, 1);
    scene.instances.push_back(instance);
  }
  return scene;
}

class SceneTextures : public GlTest {
 protected:
  // Of the square with this index, which fills the picture at 1 m per 32 pixels, from `distance` times as
  // far.
  static View viewOf(int square, double distance) {
    Camera camera;
    camera.target = {10 * square, 0, 0};
    camera.position = camera.target + glm::dvec3(0, 0, 10 * distance);
    camera.up = {0, 1, 0};
    camera.fov_degrees = 2 * std::atan(0.1) * 180 / kPi;
    return makeView(camera, {kSide, kSide});
  }
  static FrameSettings settings() {
    FrameSettings settings;
    settings.tone = ToneCurve::kClip;
    settings.shadows = false;
    return settings;
  }
  static std::vector<glm::u8vec4> draw(FrameRenderer& renderer, const RenderTarget& target) {
    const Status status = renderer.draw({target.framebuffer.name(), target.size});
    EXPECT_TRUE(status.ok());
    return readCodes(target);
  }
  static constexpr int kSide = 64;
};

TEST_F(SceneTextures, DemandWhatTheViewReads) {
  auto materials = makeMaterials();
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, squares(2, 256));
  ASSERT_TRUE(renderer.ok());
  EXPECT_EQ(materials->stats().textures, 2);
  for (const double distance : {1.0, 2.0, 8.0}) {
    (*renderer)->prepare(viewOf(1, distance), settings());
    const auto& demands = (*renderer)->stats().textures;
    ASSERT_EQ(demands.size(), 1u) << "the other is out of view";
    EXPECT_EQ(demands[0].name, "noise 41");
    const double exact = 2 + std::log2(distance);  // 256 texels on 64 pixels
    EXPECT_LE(demands[0].lambda, exact + 1e-4);
    EXPECT_GT(demands[0].lambda, exact - 0.1);
  }
  // Half as large in the world: as many texels on half the pixels.
  Scene small = squares(1, 256);
  for (int axis = 0; axis < 3; ++axis) small.instances[0].world_from_local[axis] *= 0.5f;
  auto other = FrameRenderer::create(*device, shaders, *materials, small);
  ASSERT_TRUE(other.ok());
  (*other)->prepare(viewOf(0, 1), settings());
  EXPECT_NEAR((*other)->stats().textures.at(0).lambda, 3, 0.1);
  // What shows a Loden material needs none; without mipmaps all is read from wherever.
  Scene nearest = squares(1, 256);
  nearest.materials[0].texture(TextureRole::kBaseColor).sampler.mips = MipFilter::kNone;
  auto third = FrameRenderer::create(*device, shaders, *materials, nearest);
  ASSERT_TRUE(third.ok());
  (*third)->prepare(viewOf(0, 8), settings());
  EXPECT_EQ((*third)->stats().textures.at(0).lambda, 0);
}

// From near first, after which all mips are there, and from far at once.
TEST_F(SceneTextures, OfAPartShowTheSameAsAll) {
  const RenderTarget target = *makeRenderTarget({kSide, kSide}, ColorFormat::kSrgb8, "squares");
  const Scene scene = squares(1, 512);
  ShaderLibrary shaders(*device, {});
  for (const double distance : {1.0, 1.7, 5.0}) {
    std::vector<std::vector<glm::u8vec4>> pictures;
    std::vector<uint64_t> bytes;
    for (const double first : {0.01, distance}) {
      auto materials = makeMaterials({.release_seconds = 1e6f});
      auto renderer = FrameRenderer::create(*device, shaders, *materials, scene);
      ASSERT_TRUE(renderer.ok());
      for (const double from : {first, distance}) {
        (*renderer)->prepare(viewOf(0, from), settings());
        materials->finishLoading();
      }
      pictures.push_back(draw(**renderer, target));
      bytes.push_back(materials->stats().texture_bytes);
    }
    EXPECT_TRUE(pictures[0] == pictures[1]) << distance;
    EXPECT_GT(bytes[0], bytes[1]);
  }
}

TEST_F(SceneTextures, ComeAndGoWithTheViewWithinTheBudget) {
  const RenderTarget target = *makeRenderTarget({kSide, kSide}, ColorFormat::kSrgb8, "squares");
  constexpr uint64_t kBudget = 600 << 10;  // one of six in full, and the tails of the others
  auto materials = makeMaterials({.budget_bytes = kBudget});
  ShaderLibrary shaders(*device, {});
  auto renderer = FrameRenderer::create(*device, shaders, *materials, squares(6, 256));
  ASSERT_TRUE(renderer.ok());
  std::vector<std::vector<glm::u8vec4>> pictures(6);
  for (int visit = 0; visit < 12; ++visit) {
    const int square = visit % 6;
    uint64_t detail = 0;
    for (int frame = 0; frame < 60; ++frame) {
      (*renderer)->prepare(viewOf(square, 0.2), settings());
      detail = (*renderer)->detailRevision();
      materials->update(1.0f / 30);
      ASSERT_LE(materials->stats().resident_bytes, kBudget);
      if (frame == 3 && visit < 6) {
        EXPECT_NE((*renderer)->detailRevision(), detail) << "has to be drawn again";
      }
    }
    materials->finishLoading();
    (*renderer)->prepare(viewOf(square, 0.2), settings());
    const auto picture = draw(**renderer, target);
    EXPECT_EQ((*renderer)->stats().textures.at(0).resident, 0);
    if (visit < 6)
      pictures[size_t(square)] = picture;
    else
      EXPECT_TRUE(picture == pictures[size_t(square)]) << square;
  }
  EXPECT_GT(materials->stats().evicted_parts, 10u);
}

// A mask that stands out of view between the sun and a ground.
TEST_F(SceneTextures, ThrowShadowsOfMasksThatAreOutOfView) {
  Scene scene;
  scene.meshes.push_back(texturedSquare(2));
  scene.images.push_back(noiseImage({256, 256}, 50));
  for (size_t i = 0; i < scene.images[0].pixels.size(); ++i)
    scene.images[0].pixels[i].a = (i / 32 + i / (32 * 256)) % 2 ? 255 : 0;
  SceneMaterial mask;
  mask.alpha_mode = AlphaMode::kMask;
  mask.double_sided = true;
  mask.texture(TextureRole::kBaseColor).image = 0;
  SceneMaterial ground;
  ground.metallic = 0;
  scene.materials = {ground, mask};
  Instance floor, sheet;
  floor.material = 0;
  sheet.material = 1;
  sheet.world_from_local[3].z = 12;  // behind the camera
  scene.instances = {floor, sheet};
  Light sun;
  sun.kind = LightKind::kSun;
  sun.direction = {0, 0, -1};
  scene.lights.push_back(sun);
  FrameSettings lit = settings();
  lit.shadows = true;
  const RenderTarget target = *makeRenderTarget({kSide, kSide}, ColorFormat::kSrgb8, "shadow");
  ShaderLibrary shaders(*device, {});
  std::vector<glm::u8vec4> expected;
  for (const bool waits : {true, false}) {
    auto materials = makeMaterials({.upload_bytes_per_frame = 32 << 10, .fade_levels_per_frame = 1});
    auto renderer = FrameRenderer::create(*device, shaders, *materials, scene);
    ASSERT_TRUE(renderer.ok());
    std::vector<glm::u8vec4> picture;
    for (int frame = 0; frame < (waits ? 1 : 50); ++frame) {
      (*renderer)->prepare(viewOf(0, 1), lit);
      waits ? materials->finishLoading() : materials->update(0.25f);
      picture = draw(**renderer, target);
    }
    if (waits)
      expected = picture;
    else
      EXPECT_TRUE(picture == expected);
  }
  int dark = 0;
  for (const glm::u8vec4& code : expected) dark += code.r < 128;
  EXPECT_NEAR(dark, kSide * kSide / 2, kSide * kSide / 8) << "half of the sheet is cut out";
}

}  // namespace
}  // namespace loden::test
