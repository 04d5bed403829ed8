// Nodes, skins and morph targets in motion, and scenes of many instances, by the colours of pixels.
#include <gtest/gtest.h>

#include <cmath>

#include "material/model/directions.h"
#include "runtime/frame/frame.h"
#include "tests/gl/gl_fixture.h"
#include "tests/unit/gltf_builder.h"
#include "tests/unit/material_fixtures.h"

namespace loden::test {
namespace {

using namespace runtime;

constexpr int kSide = 32;

class SceneMotionTest : public GlTest {
 protected:
  void begin(GltfBuilder& builder) {
    Result<Scene> loaded = builder.load();
    ASSERT_TRUE(loaded.ok()) << loaded.issue().where << ": " << loaded.issue().text;
    for (const Issue& note : loaded->notes) ADD_FAILURE() << note.where << ": " << note.text;
    begin(std::move(*loaded));
  }
  void begin(Scene loaded) {
    scene_ = std::move(loaded);
    renderer_.reset();
    materials_ = makeMaterials();
    shaders_ = std::make_unique<ShaderLibrary>(*device, ShaderLibraryOptions{});
    auto made = FrameRenderer::create(*device, *shaders_, *materials_, scene_);
    ASSERT_TRUE(made.ok()) << made.issue().text;
    renderer_ = std::move(*made);
  }
  void pose(double seconds) { renderer_->pose(scene_, poseAt(scene_, &scene_.animations.at(0), seconds)); }

  // Linear colours of [-1, 1]^2 in the plane z = 0, seen along -z; first row at the bottom.
  std::vector<glm::vec4> draw() {
    Camera camera;
    camera.position = {0, 0, 10}, camera.target = {0, 0, 0}, camera.up = {0, 1, 0};
    camera.fov_degrees = 2 * std::atan(0.1) * 180 / kPi;
    FrameSettings settings;
    settings.tone = ToneCurve::kClip;
    settings.sky_ambient = settings.ground_ambient = settings.background = glm::vec3(0);
    const RenderTarget target = *makeRenderTarget({kSide, kSide}, ColorFormat::kLinear32, "motion");
    renderer_->prepare(makeView(camera, target.size), settings);
    materials_->finishLoading();
    EXPECT_TRUE(renderer_->draw({target.framebuffer.name(), target.size}).ok());
    return readLinear(target);
  }
  float red(float x, float y) {
    return draw()[size_t((0.5f + y / 2) * kSide) * kSide + size_t((0.5f + x / 2) * kSide)].r;
  }
  void TearDown() override {
    renderer_.reset();
    materials_.reset();
    shaders_.reset();
    GlTest::TearDown();
  }

  Scene scene_;
  std::unique_ptr<MaterialSystem> materials_;
  std::unique_ptr<ShaderLibrary> shaders_;
  std::unique_ptr<FrameRenderer> renderer_;
};

int redMaterial(GltfBuilder& builder) {
  Json material{{"extensions", {{"KHR_materials_unlit", Json::object()}}}};
  material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0, 0, 1};
  return builder.material(material);
}

void animate(GltfBuilder& builder, int node, const char* path, const std::vector<float>& times,
             const std::vector<float>& values, const char* type, const char* interpolation = "LINEAR") {
  Json& animation = builder.json["animations"][0];
  animation["samplers"].push_back({{"input", builder.floats(times, "SCALAR")},
                                   {"output", builder.floats(values, type)},
                                   {"interpolation", interpolation}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

TEST_F(SceneMotionTest, NodesMoveTheirChildren) {
  GltfBuilder builder;
  const int square = builder.square(redMaterial(builder));
  builder.json["nodes"] = {{{"children", {1}}}, {{"mesh", square}, {"scale", {0.25, 0.25, 1}}}};
  builder.json["scenes"][0]["nodes"] = {0};
  animate(builder, 0, "translation", {0, 2}, {-0.5f, 0, 0, 0.5f, 0, 0}, "VEC3");
  begin(builder);
  for (const float seconds : {0.0f, 1.0f, 2.0f, 9.0f}) {
    pose(seconds);
    const float x = std::min(seconds, 2.0f) / 2 - 0.5f;
    EXPECT_EQ(red(x, 0), 1) << seconds;
    EXPECT_EQ(red(x > 0 ? x - 0.4f : x + 0.4f, 0), 0) << seconds;
  }
}

TEST_F(SceneMotionTest, InterpolatesStepsAndCubicSplines) {
  GltfBuilder builder;
  const int material = redMaterial(builder);
  builder.node({{"mesh", builder.square(material)}, {"scale", {0.2, 0.2, 1}}});
  animate(builder, 0, "translation", {0, 1}, {-0.5f, 0, 0, 0.5f, 0, 0}, "VEC3", "STEP");
  begin(builder);
  pose(0.9);
  EXPECT_EQ(red(-0.5f, 0), 1);
  // Slopes of zero at both ends: a quarter of the way in time is 5/32 in space.
  builder.json.erase("animations");
  animate(builder, 0, "translation", {0, 1}, {0, 0, 0, -0.5f, 0, 0, 0, 0, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0},
          "VEC3", "CUBICSPLINE");
  begin(builder);
  const ScenePose quarter = poseAt(scene_, &scene_.animations[0], 0.25);
  EXPECT_NEAR(quarter.world_from_node[0][3].x, -0.5f + 5 / 32.0f, 1e-5);
}

TEST_F(SceneMotionTest, RotationsTakeTheShortWay) {
  GltfBuilder builder;
  builder.node({{"mesh", builder.square(redMaterial(builder))}});
  const float s = std::sin(0.5f), c = std::cos(0.5f);
  animate(builder, 0, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, -s, -c}, "VEC4");
  begin(builder);
  const ScenePose half = poseAt(scene_, &scene_.animations[0], 0.5);
  EXPECT_NEAR(half.world_from_node[0][0].x, std::cos(0.5f), 1e-5);
}

TEST_F(SceneMotionTest, MorphTargetsMoveVerticesAndNormals) {
  GltfBuilder builder;
  const int mesh = builder.square(redMaterial(builder));
  Json& primitive = builder.json["meshes"][0]["primitives"][0];
  const std::vector<float> shrink{0.8f, 0.8f, 0, -0.8f, 0.8f, 0, -0.8f, -0.8f, 0, 0.8f, -0.8f, 0};
  primitive["targets"] = {{{"POSITION", builder.floats(shrink, "VEC3")}}};
  builder.json["meshes"][0]["weights"] = {1};
  builder.node({{"mesh", mesh}});
  animate(builder, 0, "weights", {0, 1}, {0, 1}, "SCALAR");
  begin(builder);
  EXPECT_EQ(red(0.9f, 0.9f), 0) << "the mesh's own weight counts before an animation";
  EXPECT_EQ(red(0, 0), 1);
  pose(0);
  EXPECT_EQ(red(0.9f, 0.9f), 1);
  pose(0.5);
  EXPECT_EQ(red(0.9f, 0.9f), 0);
  EXPECT_EQ(red(0.5f, 0.5f), 1);
}

// Two joints: the right half of the square hangs on the second.
int skinnedSquare(GltfBuilder& builder, int material) {
  const Json attributes{
      {"JOINTS_0", builder.bytesOf({0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, "VEC4", false)},
      {"WEIGHTS_0", builder.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4")}};
  return builder.square(material, attributes);
}
void addSkin(GltfBuilder& builder, int mesh) {
  // The mesh's own node is turned away, which a skin ignores.
  builder.node({{"mesh", mesh}, {"skin", 0}, {"translation", {50, 0, 0}}});
  builder.node({{"name", "left"}});
  builder.node({{"name", "right"}, {"translation", {1, 0, 0}}});
  std::vector<float> inverse(32, 0);
  for (size_t joint = 0; joint < 2; ++joint)
    for (size_t i = 0; i < 4; ++i) inverse[16 * joint + 5 * i] = 1;
  inverse[16 + 12] = -1;
  builder.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", builder.floats(inverse, "MAT4")}}};
}

TEST_F(SceneMotionTest, SkinsFollowTheirJoints) {
  GltfBuilder builder;
  addSkin(builder, skinnedSquare(builder, redMaterial(builder)));
  animate(builder, 2, "translation", {0, 1}, {1, 0, 0, -0.5f, 0, 0}, "VEC3");
  begin(builder);
  EXPECT_EQ(red(0.9f, 0), 1) << "at rest the mesh is as it was made";
  EXPECT_EQ(red(-0.9f, 0), 1);
  pose(1);
  EXPECT_EQ(red(0.9f, 0), 0) << "its right border is now at -0.5";
  EXPECT_EQ(red(-0.3f, 0), 0);
  EXPECT_EQ(red(-0.9f, 0), 1);
  const Bounds bounds = renderer_->bounds();
  EXPECT_NEAR(bounds.max.x, -0.5f, 1e-5);
  EXPECT_NEAR(bounds.min.x, -1, 1e-5);
}

// A Loden material on a skin that turns as a whole looks like one whose node turns: frames follow the skin.
TEST_F(SceneMotionTest, FramesOfLodenMaterialsFollowTheSkin) {
  const float s = std::sin(0.3f), c = std::cos(0.3f);
  const auto picture = [&](bool skinned) {
    GltfBuilder builder;
    builder.json["extensionsUsed"] = {"LODEN_materials_flat_btf"};
    const std::vector<std::byte> asset = *serializeAsset(fusedMaterial());
    const int view = builder.view({reinterpret_cast<const char*>(asset.data()), asset.size()});
    builder.json["extensions"] = {
        {"LODEN_materials_flat_btf",
         {{"assets", {{{"bufferView", view}, {"mimeType", "application/vnd.loden"}}}}}},
        {"KHR_lights_punctual", {{"lights", {{{"type", "directional"}, {"intensity", 3}}}}}}};
    const int material = builder.material({{"extensions", {{"LODEN_materials_flat_btf", {{"asset", 0}}}}}});
    if (skinned) {
      addSkin(builder, skinnedSquare(builder, material));
      for (const int joint : {1, 2}) builder.json["nodes"][size_t(joint)]["rotation"] = {0, s, 0, c};
      builder.json["nodes"][2]["translation"] = {c * c - s * s, 0, -2 * s * c};
    } else {
      builder.node({{"mesh", builder.square(material)}, {"rotation", {0, s, 0, c}}});
    }
    builder.node(
        {{"rotation", {0.2, 0.1, 0, 0.97}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    begin(builder);
    return draw();
  };
  const auto turned = picture(false), skinned = picture(true);
  double difference = 0, light = 0;
  for (size_t i = 0; i < turned.size(); ++i) {
    difference += double(glm::distance(turned[i], skinned[i]));
    light += double(turned[i].g);
  }
  EXPECT_GT(light / double(turned.size()), 0.05);
  EXPECT_LT(difference / double(turned.size()), 2e-3) << "deformed surfaces are always taken for curved ones";
}

TEST_F(SceneMotionTest, RejectsJointsThatTheSkinHasNot) {
  GltfBuilder builder;
  addSkin(builder, skinnedSquare(builder, redMaterial(builder)));
  builder.json["skins"][0]["joints"] = {1};
  const Result<Scene> scene = builder.load();
  ASSERT_FALSE(scene.ok());
  EXPECT_NE(scene.issue().where.find("skins[0]"), std::string::npos);
}

TEST_F(SceneMotionTest, InstancesStandWhereTheirAttributesSay) {
  GltfBuilder builder;
  const Json attributes{{"TRANSLATION", builder.floats({-0.5f, 0, 0, 0.5f, 0, 0}, "VEC3")},
                        {"SCALE", builder.floats({0.1f, 0.1f, 1, 0.3f, 0.3f, 1}, "VEC3")}};
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  builder.node({{"mesh", builder.square(redMaterial(builder))},
                {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
  begin(builder);
  EXPECT_EQ(red(-0.5f, 0), 1);
  EXPECT_EQ(red(-0.5f, 0.2f), 0);
  EXPECT_EQ(red(0.5f, 0.2f), 1);
  EXPECT_EQ(red(0, 0), 0);
}

TEST_F(SceneMotionTest, VariantsChooseOtherMaterials) {
  GltfBuilder builder;
  const int plain = builder.material({{"extensions", {{"KHR_materials_unlit", Json::object()}}},
                                      {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0, 0, 1}}}}});
  const int red_material = redMaterial(builder);
  const int mesh = builder.square(plain);
  builder.json["meshes"][size_t(mesh)]["primitives"][0]["extensions"]["KHR_materials_variants"] = {
      {"mappings", {{{"material", red_material}, {"variants", {1}}}}}};
  builder.json["extensions"]["KHR_materials_variants"] = {
      {"variants", {{{"name", "dull"}}, {{"name", "loud"}}}}};
  builder.node({{"mesh", mesh}});
  const std::filesystem::path path = builder.write();
  for (const auto& [variant, shown] :
       {std::pair("", 0.5f), std::pair("dull", 0.5f), std::pair("loud", 1.0f)}) {
    Result<Scene> scene = loadGltfScene(path, {variant});
    ASSERT_TRUE(scene.ok());
    EXPECT_EQ(scene->variants, (std::vector<std::string>{"dull", "loud"}));
    begin(std::move(*scene));
    EXPECT_NEAR(red(0, 0), shown, 1e-3) << variant;
  }
  const Result<Scene> unknown = loadGltfScene(path, {"blue"});
  ASSERT_FALSE(unknown.ok());
  EXPECT_NE(unknown.issue().text.find("dull, loud"), std::string::npos);
}

}  // namespace
}  // namespace loden::test
