// UVs as scenes have them: mirrored, far from the origin, without tangents. The picture must not care.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "runtime/frame/frame.h"
#include "runtime/scene/mesh_analytic.h"
#include "tests/gl/gl_fixture.h"
#include "tests/unit/material_fixtures.h"

namespace loden::test {
namespace {

using namespace runtime;

constexpr glm::ivec2 kSize(96, 64);

class SceneUvTest : public GlTest {
 protected:
  static Scene planeScene(glm::vec3 to_light) {
    Scene scene = analyticScene(SurfaceKind::kPlane, {}, glm::normalize(to_light));
    scene.assets[0].embedded = *serializeAsset(fusedMaterial());
    scene.assets[0].name = "fused";
    return scene;
  }

  // Linear colours, first row at the bottom; the camera looks along +y, x to the right.
  std::vector<glm::vec4> draw(const Scene& scene, float camera_x = 0) {
    auto materials = makeMaterials();
    ShaderLibrary shaders(*device, {});
    auto renderer = FrameRenderer::create(*device, shaders, *materials, scene);
    EXPECT_TRUE(renderer.ok());
    Camera camera;
    camera.position = {camera_x, -0.6, 0.5};
    camera.target = {camera_x, 0, 0};
    FrameSettings settings;
    settings.shadows = false;
    settings.tone = ToneCurve::kClip;
    const RenderTarget target = *makeRenderTarget(kSize, ColorFormat::kLinear32, "uv test");
    (*renderer)->prepare(makeView(camera, kSize), settings);
    materials->finishLoading();
    EXPECT_TRUE((*renderer)->draw({target.framebuffer.name(), kSize}).ok());
    return readLinear(target);
  }

  // Mean over pixels of the largest difference of a channel: a few pixels on texel borders may switch sides.
  static double meanDifference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) {
      const glm::vec4 d = glm::abs(a[i] - b[i]);
      sum += std::max({d.x, d.y, d.z});
    }
    return sum / double(a.size());
  }
  static double contrast(const std::vector<glm::vec4>& a) {
    return meanDifference(a, std::vector<glm::vec4>(a.size(), a[a.size() / 2]));
  }
};

TEST_F(SceneUvTest, HugeOffsetsDrawTheSame) {
  const Scene plain = planeScene({0.3f, 0.2f, 1});
  Scene far = plain;
  for (Vertex& vertex : far.meshes[0].vertices) vertex.uv += glm::vec2(100000, -32768);
  const auto expected = draw(plain);
  ASSERT_GT(contrast(expected), 0.01);
  EXPECT_LT(meanDifference(expected, draw(far)), 1e-4);
}

TEST_F(SceneUvTest, FrameFromDerivativesEqualsTheTangents) {
  const Scene plain = planeScene({0.3f, 0.2f, 1});
  Scene bare = plain;
  for (Vertex& vertex : bare.meshes[0].vertices) vertex.tangent = {1, 0, 0, 0};
  EXPECT_LT(meanDifference(draw(plain), draw(bare)), 1e-3);
}

TEST_F(SceneUvTest, MirroredUvsMirrorThePicture) {
  const Scene plain = planeScene({0.3f, 0.2f, 1});
  Scene mirrored = planeScene({-0.3f, 0.2f, 1});
  for (Vertex& vertex : mirrored.meshes[0].vertices) vertex.uv.x = -vertex.uv.x;
  computeTangents(mirrored.meshes[0]);
  ASSERT_EQ(mirrored.meshes[0].vertices[0].tangent, glm::vec4(-1, 0, 0, -1));
  const auto expected = draw(plain);
  auto actual = draw(mirrored);
  for (int y = 0; y < kSize.y; ++y)
    std::reverse(actual.begin() + y * kSize.x, actual.begin() + (y + 1) * kSize.x);
  EXPECT_LT(meanDifference(expected, actual), 1e-3);
}

TEST_F(SceneUvTest, MirroringTransformsMirrorThePicture) {
  const Scene plain = planeScene({0.3f, 0.2f, 1});
  Scene mirrored = planeScene({-0.3f, 0.2f, 1});
  mirrored.instances[0].world_from_local[0][0] = -1;
  const auto expected = draw(plain);
  auto actual = draw(mirrored);
  for (int y = 0; y < kSize.y; ++y)
    std::reverse(actual.begin() + y * kSize.x, actual.begin() + (y + 1) * kSize.x);
  EXPECT_LT(meanDifference(expected, actual), 1e-3);
}

// A mesh squeezed by its transform is the squeezed mesh. That rays follow stretched coordinates at all is
// what VdimLookup.FollowsStretchedCoordinates and the parity of curved materials show.
TEST_F(SceneUvTest, NonUniformScaleEqualsStretchedUvs) {
  Scene scaled = planeScene({0.3f, 0.2f, 1}), stretched = planeScene({0.3f, 0.2f, 1});
  scaled.instances[0].world_from_local[0][0] = 0.5f;
  for (Vertex& vertex : stretched.meshes[0].vertices) vertex.position.x *= 0.5f;
  stretched.meshes[0].bounds = boundsOf(stretched.meshes[0]);
  const auto expected = draw(stretched);
  ASSERT_GT(contrast(expected), 0.01);
  EXPECT_LT(meanDifference(expected, draw(scaled)), 1e-4);
  EXPECT_GT(meanDifference(expected, draw(planeScene({0.3f, 0.2f, 1}))), 1e-3);
}

TEST_F(SceneUvTest, RotationAndScaleMatchRotatedUvs) {
  Scene bound = planeScene({0.3f, 0.2f, 1});
  bound.materials[0].flat_btf->scale = {2, 2};
  bound.materials[0].flat_btf->rotation = 0.5f;
  Scene baked = planeScene({0.3f, 0.2f, 1});
  for (Vertex& vertex : baked.meshes[0].vertices) {
    const glm::vec2 uv = 2.0f * vertex.uv;
    vertex.uv = {std::cos(0.5f) * uv.x - std::sin(0.5f) * uv.y,
                 std::sin(0.5f) * uv.x + std::cos(0.5f) * uv.y};
  }
  computeTangents(baked.meshes[0]);
  EXPECT_LT(meanDifference(draw(bound), draw(baked)), 1e-3);
}

}  // namespace
}  // namespace loden::test
