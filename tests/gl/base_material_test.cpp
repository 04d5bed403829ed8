// glTF's own materials, by the colours of pixels.
#include <gtest/gtest.h>

#include <cmath>

#include "material/model/color.h"
#include "material/model/directions.h"
#include "runtime/frame/frame.h"
#include "runtime/scene/image_write.h"
#include "runtime/scene/reflections.h"
#include "tests/gl/gl_fixture.h"
#include "tests/unit/gltf_builder.h"

namespace loden::test {
namespace {

using namespace runtime;

constexpr glm::u8vec4 kRed(255, 0, 0, 255), kGreen(0, 255, 0, 255), kBlue(0, 0, 255, 255),
    kWhite(255, 255, 255, 255);
const Json kNearest{{"magFilter", 9728}, {"minFilter", 9728}};

class BaseMaterialTest : public GlTest {
 protected:
  static FrameSettings plainSettings() {
    FrameSettings settings;
    settings.shadows = false;
    settings.tone = ToneCurve::kClip;
    settings.sky_ambient = settings.ground_ambient = settings.background = glm::vec3(0);
    return settings;
  }

  // Linear colours; the camera looks along -z at the square from -1 to 1, which fills the picture.
  std::vector<glm::vec4> draw(GltfBuilder& builder, const FrameSettings& settings = plainSettings()) {
    const Result<Scene> scene = builder.load();
    EXPECT_TRUE(scene.ok()) << scene.issue().where << ": " << scene.issue().text;
    if (!scene) return std::vector<glm::vec4>(size_t(kSide) * kSide);
    for (const Issue& note : scene->notes) ADD_FAILURE() << note.where << ": " << note.text;
    return draw(*scene, settings);
  }
  std::vector<glm::vec4> draw(const Scene& scene, const FrameSettings& settings = plainSettings()) {
    auto materials = makeMaterials();
    ShaderLibrary shaders(*device, {});
    auto renderer = FrameRenderer::create(*device, shaders, *materials, scene);
    EXPECT_TRUE(renderer.ok());
    Camera camera;
    camera.position = {0, 0, 10};
    camera.target = {0, 0, 0};
    camera.up = {0, 1, 0};
    camera.fov_degrees = 2 * std::atan(0.1) * 180 / kPi;
    const RenderTarget target = *makeRenderTarget({kSide, kSide}, ColorFormat::kLinear32, "base material");
    (*renderer)->prepare(makeView(camera, target.size), settings);
    materials->finishLoading();
    const Status status = (*renderer)->draw({target.framebuffer.name(), target.size});
    EXPECT_TRUE(status.ok()) << status.issue().text;
    return readLinear(target);
  }
  // At texture coordinates (u, v) of the square.
  static glm::vec4 at(const std::vector<glm::vec4>& pixels, float u, float v) {
    return pixels[size_t((1 - v) * kSide) * kSide + size_t(u * kSide)];
  }
  static void expectColor(const glm::vec4& pixel, const glm::vec3& color, float tolerance = 2e-3f) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], color[c], tolerance) << c;
  }
  static Json lightsOf(const Json& light) { return {{"KHR_lights_punctual", {{"lights", {light}}}}}; }
  // A sun that shines from this rotation of +z.
  static void addSun(GltfBuilder& builder, const Json& rotation = {0, 0, 0, 1}) {
    builder.json["extensions"] = lightsOf({{"type", "directional"}, {"intensity", kPi}});
    builder.node({{"rotation", rotation}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  }

  static constexpr int kSide = 32;
};

TEST_F(BaseMaterialTest, TexturesStandUprightAndDecodeSrgb) {
  GltfBuilder builder;
  const int texture = builder.texture({2, 2}, {kRed, kGreen, kBlue, {128, 64, 255, 255}}, kNearest);
  builder.node({{"mesh", builder.square(builder.material(unlit(texture)))}});
  const auto pixels = draw(builder);
  expectColor(at(pixels, 0.25f, 0.25f), {1, 0, 0});
  expectColor(at(pixels, 0.75f, 0.25f), {0, 1, 0});
  expectColor(at(pixels, 0.25f, 0.75f), {0, 0, 1});
  expectColor(at(pixels, 0.75f, 0.75f),
              {float(linearFromSrgb(128 / 255.0)), float(linearFromSrgb(64 / 255.0)), 1});
}

TEST_F(BaseMaterialTest, SamplersWrapAsTheySay) {
  struct Case {
    int wrap;
    bool red_beyond;  // at u = 1.25, where the picture is red on the left and green on the right
  };
  for (const Case& c : {Case{10497, true}, Case{33648, false}, Case{33071, false}}) {
    GltfBuilder builder;
    Json sampler = kNearest;
    sampler["wrapS"] = sampler["wrapT"] = c.wrap;
    Json material = unlit(builder.texture({2, 1}, {kRed, kGreen}, sampler));
    const Json uvs{{"TEXCOORD_0", builder.floats({0, 1, 2, 1, 2, 0, 0, 0}, "VEC2")}};
    builder.node({{"mesh", builder.square(builder.material(material), uvs)}});
    const auto pixels = draw(builder);
    expectColor(at(pixels, 0.1f, 0.5f), {1, 0, 0});
    expectColor(at(pixels, 0.6f, 0.5f), c.red_beyond ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0));
    expectColor(at(pixels, 0.9f, 0.5f), c.wrap == 33648 ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0));
  }
}

TEST_F(BaseMaterialTest, MagnifiesLinearlyUnlessToldOtherwise) {
  GltfBuilder builder;
  const Json clamped{{"wrapS", 33071}, {"wrapT", 33071}};
  builder.node(
      {{"mesh", builder.square(builder.material(unlit(builder.texture({2, 1}, {kRed, kGreen}, clamped))))}});
  const glm::vec4 middle = at(draw(builder), 0.5f, 0.5f);
  EXPECT_GT(middle.r, 0.4f);
  EXPECT_GT(middle.g, 0.4f);
}

TEST_F(BaseMaterialTest, TextureTransformsMoveTurnAndScale) {
  GltfBuilder builder;
  Json material = unlit(builder.texture({2, 2}, {kRed, kGreen, kBlue, kWhite}, kNearest));
  Json& info = material["pbrMetallicRoughness"]["baseColorTexture"];
  // A quarter turn counter-clockwise where v points down: (u, v) -> (v, -u), moved back into the square.
  info["extensions"]["KHR_texture_transform"] = {{"rotation", kPi / 2}, {"offset", {0, 1}}};
  builder.node({{"mesh", builder.square(builder.material(material))}});
  const auto pixels = draw(builder);
  expectColor(at(pixels, 0.25f, 0.25f), {0, 0, 1});
  expectColor(at(pixels, 0.75f, 0.25f), {1, 0, 0});
  expectColor(at(pixels, 0.25f, 0.75f), {1, 1, 1});
  expectColor(at(pixels, 0.75f, 0.75f), {0, 1, 0});
}

TEST_F(BaseMaterialTest, TexturesChooseTheirSetOfCoordinates) {
  for (const int set : {0, 1, 2, 3}) {
    GltfBuilder builder;
    Json material = unlit(builder.texture({2, 1}, {kRed, kGreen}, kNearest));
    material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = set;
    Json attributes;
    for (int k = 0; k < 4; ++k) {
      const float u = k == set ? 0.75f : 0.25f;
      attributes["TEXCOORD_" + std::to_string(k)] =
          builder.floats({u, 0.5f, u, 0.5f, u, 0.5f, u, 0.5f}, "VEC2");
    }
    builder.node({{"mesh", builder.square(builder.material(material), attributes)}});
    expectColor(at(draw(builder), 0.5f, 0.5f), {0, 1, 0});
  }
}

TEST_F(BaseMaterialTest, VertexColoursMultiplyTheBaseColour) {
  GltfBuilder builder;
  Json material = unlit(builder.texture({1, 1}, {kWhite}));
  material["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 1, 1, 1};
  const std::vector<uint8_t> codes{255, 128, 0, 255, 255, 128, 0, 255, 255, 128, 0, 255, 255, 128, 0, 255};
  const Json colors{{"COLOR_0", builder.bytesOf(codes, "VEC4", true)}};
  builder.node({{"mesh", builder.square(builder.material(material), colors)}});
  expectColor(at(draw(builder), 0.5f, 0.5f), {0.5f, 128 / 255.0f, 0});
}

TEST_F(BaseMaterialTest, MaskCutsOutDepthToo) {
  GltfBuilder builder;
  Json mask = unlit(builder.texture({2, 1}, {{255, 0, 0, 100}, {255, 0, 0, 140}}, kNearest));
  mask["alphaMode"] = "MASK";
  builder.node({{"mesh", builder.square(builder.material(mask))}, {"translation", {0, 0, 0.1}}});
  builder.node({{"mesh", builder.square(builder.material(unlit(builder.texture({1, 1}, {kGreen}))))}});
  for (const bool prepass : {true, false}) {
    FrameSettings settings = plainSettings();
    settings.depth_prepass = prepass;
    const auto pixels = draw(builder, settings);
    expectColor(at(pixels, 0.25f, 0.5f), {0, 1, 0});
    expectColor(at(pixels, 0.75f, 0.5f), {1, 0, 0});
  }
}

TEST_F(BaseMaterialTest, BlendsFromBackToFrontWhateverTheOrderInTheFile) {
  for (const bool near_first : {true, false}) {
    GltfBuilder builder;
    const auto blended = [&](glm::u8vec4 code, float z) {
      Json material = unlit(builder.texture({1, 1}, {code}));
      material["alphaMode"] = "BLEND";
      builder.node({{"mesh", builder.square(builder.material(material))}, {"translation", {0, 0, z}}});
    };
    blended({255, 0, 0, 51}, near_first ? 0.2f : 0.1f);
    blended({255, 0, 0, 51}, near_first ? 0.1f : 0.2f);
    builder.json["images"][near_first ? 1 : 0]["uri"] = "other.png";
    ASSERT_TRUE(
        writePng(builder.folder() / "other.png", std::vector<glm::u8vec4>{{0, 255, 0, 51}}, {1, 1}).ok());
    builder.node({{"mesh", builder.square(builder.material(unlit(builder.texture({1, 1}, {kBlue}))))}});
    expectColor(at(draw(builder), 0.5f, 0.5f), {0.2f, 0.16f, 0.64f});
  }
}

TEST_F(BaseMaterialTest, OpaqueIgnoresAlpha) {
  GltfBuilder builder;
  builder.node(
      {{"mesh", builder.square(builder.material(unlit(builder.texture({1, 1}, {{255, 0, 0, 10}}))))}});
  expectColor(at(draw(builder), 0.5f, 0.5f), {1, 0, 0});
}

TEST_F(BaseMaterialTest, BacksAreSeenOfTwoSidedMaterialsOnly) {
  for (const bool two_sided : {true, false}) {
    GltfBuilder builder;
    Json material{{"doubleSided", two_sided}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}};
    builder.node({{"mesh", builder.square(builder.material(material))}, {"rotation", {0, 1, 0, 0}}});
    addSun(builder);
    const glm::vec4 pixel = at(draw(builder), 0.5f, 0.5f);
    if (two_sided)
      EXPECT_GT(pixel.r, 0.8f) << "lit from the side of the viewer";
    else
      expectColor(pixel, {0, 0, 0});
  }
}

// A Lambert surface facing a sun of irradiance pi is its albedo, less what is reflected.
TEST_F(BaseMaterialTest, RoughDielectricFacingTheSunIsNearlyLambert) {
  GltfBuilder builder;
  const Json pbr{{"metallicFactor", 0}, {"roughnessFactor", 1}, {"baseColorFactor", {0.5, 0.25, 1, 1}}};
  builder.node({{"mesh", builder.square(builder.material({{"pbrMetallicRoughness", pbr}}))}});
  addSun(builder);
  // (1 - .04) albedo + .04 / 4: the lobe of roughness 1 is 1 / (4 pi) head-on.
  expectColor(at(draw(builder), 0.5f, 0.5f), glm::vec3(0.5f, 0.25f, 1) * 0.96f + 0.01f, 4e-3f);
}

TEST_F(BaseMaterialTest, NormalTexturesTiltTowardsURightAndVUp) {
  const auto lit = [&](glm::u8vec4 code, const Json& sun) {
    GltfBuilder builder;
    const Json material{{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
                        {"normalTexture", {{"index", builder.texture({1, 1}, {code})}}}};
    builder.node({{"mesh", builder.square(builder.material(material))}});
    addSun(builder, sun);
    return at(draw(builder), 0.5f, 0.5f).r;
  };
  const float c = std::cos(0.4f), s = std::sin(0.4f);
  const Json from_right{0, s, 0, c}, from_left{0, -s, 0, c}, from_above{-s, 0, 0, c}, from_below{s, 0, 0, c};
  const glm::u8vec4 right(218, 128, 218, 255), up(128, 218, 218, 255), flat(128, 128, 255, 255);
  EXPECT_GT(lit(right, from_right), lit(flat, from_right) + 0.1f);
  EXPECT_LT(lit(right, from_left), lit(flat, from_left) - 0.3f);
  EXPECT_GT(lit(up, from_above), lit(flat, from_above) + 0.1f);
  EXPECT_LT(lit(up, from_below), lit(flat, from_below) - 0.3f);
}

TEST_F(BaseMaterialTest, EmissiveTexturesGlowAndOcclusionDarkensWhatIsAround) {
  GltfBuilder builder;
  const Json material{{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {0, 0, 0, 1}}}},
                      {"extensions",
                       {{"KHR_materials_specular", {{"specularFactor", 0}}},
                        {"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}},
                      {"emissiveFactor", {1, 0.5, 1}},
                      {"emissiveTexture", {{"index", builder.texture({1, 1}, {{255, 255, 0, 255}})}}}};
  builder.node({{"mesh", builder.square(builder.material(material))}});
  expectColor(at(draw(builder), 0.5f, 0.5f), {4, 2, 0});

  GltfBuilder occluded;
  const Json texture{{"index", occluded.texture({1, 1}, {{102, 0, 0, 255}})}, {"strength", 0.5}};
  occluded.node({{"mesh", occluded.square(occluded.material({{"occlusionTexture", texture}}))}});
  FrameSettings settings = plainSettings();
  settings.sky_ambient = settings.ground_ambient = glm::vec3(float(kPi));
  const float with = at(draw(occluded, settings), 0.5f, 0.5f).r;
  occluded.json["materials"][0].erase("occlusionTexture");
  EXPECT_NEAR(with / at(draw(occluded, settings), 0.5f, 0.5f).r, 0.7f, 0.01f);
}

FrameSettings whiteFurnace() {
  FrameSettings settings;
  settings.tone = ToneCurve::kClip;
  const Panorama white{16, 8, std::vector<glm::vec3>(128, glm::vec3(1))};
  settings.reflections = std::make_shared<const ReflectionMap>(makeReflectionMap(white, glm::mat3(1)));
  return settings;
}

// Under light of 1 all around a white surface that keeps all light is 1.
TEST_F(BaseMaterialTest, WhiteFurnaceLosesNothing) {
  const FrameSettings settings = whiteFurnace();
  for (const float metallic : {0.0f, 1.0f})
    for (const float roughness : {0.0f, 0.3f, 0.6f, 1.0f})
      for (const float tilt : {0.0f, 0.5f}) {  // half of an angle
        GltfBuilder builder;
        const Json pbr{{"metallicFactor", metallic}, {"roughnessFactor", roughness}};
        builder.node({{"mesh", builder.square(builder.material({{"pbrMetallicRoughness", pbr}}))},
                      {"rotation", {0, std::sin(tilt), 0, std::cos(tilt)}}});
        const glm::vec4 pixel = at(draw(builder, settings), 0.5f, 0.5f);
        EXPECT_NEAR(pixel.g, 1.0f, 0.03f) << metallic << " " << roughness << " " << tilt;
      }
}

// Sheen and clear coat take from what lies below what they reflect themselves.
TEST_F(BaseMaterialTest, LayersAddNoEnergy) {
  const FrameSettings settings = whiteFurnace();
  for (const char* layer : {"KHR_materials_sheen", "KHR_materials_clearcoat"})
    for (const float roughness : {0.2f, 0.8f})
      for (const float tilt : {0.0f, 0.6f}) {
        GltfBuilder builder;
        const Json parameters{{"sheenColorFactor", {1, 1, 1}},
                              {"sheenRoughnessFactor", roughness},
                              {"clearcoatFactor", 1},
                              {"clearcoatRoughnessFactor", roughness}};
        const Json material{{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.9}}},
                            {"extensions", {{layer, parameters}}}};
        builder.node({{"mesh", builder.square(builder.material(material))},
                      {"rotation", {0, std::sin(tilt), 0, std::cos(tilt)}}});
        const glm::vec4 pixel = at(draw(builder, settings), 0.5f, 0.5f);
        EXPECT_NEAR(pixel.g, 1.0f, 0.05f) << layer << " " << roughness << " " << tilt;
      }
}

TEST_F(BaseMaterialTest, MirrorShowsTheEnvironmentTheRightWayRound) {
  // Red from +x, green from above, blue from the viewer's side; panoramas have z up, the world y.
  Panorama panorama{256, 128, {}};
  for (int row = 0; row < panorama.height; ++row)
    for (int column = 0; column < panorama.width; ++column) {
      const glm::dvec3 w = panoramaDirection(panorama, column, row);
      panorama.pixels.push_back(glm::max(glm::vec3(w.x, w.z, -w.y), 0.0f));
    }
  const glm::mat3 y_up(glm::vec3(1, 0, 0), glm::vec3(0, 0, -1), glm::vec3(0, 1, 0));
  FrameSettings settings = plainSettings();
  settings.reflections = std::make_shared<const ReflectionMap>(makeReflectionMap(panorama, y_up));
  const auto mirrored = [&](const Json& rotation) {
    GltfBuilder builder;
    builder.node(
        {{"mesh", builder.square(builder.material({{"pbrMetallicRoughness", {{"roughnessFactor", 0}}}}))},
         {"rotation", rotation}});
    return at(draw(builder, settings), 0.5f, 0.5f);
  };
  const float c = std::cos(float(kPi) / 8), s = std::sin(float(kPi) / 8);  // an eighth of a turn
  expectColor(mirrored({0, 0, 0, 1}), {0, 0, 1}, 0.05f);
  expectColor(mirrored({0, s, 0, c}), {1, 0, 0}, 0.05f);
  expectColor(mirrored({-s, 0, 0, c}), {0, 1, 0}, 0.05f);
}

TEST_F(BaseMaterialTest, SpecularAndIorSetTheReflectance) {
  FrameSettings settings = whiteFurnace();
  const auto reflected = [&](const Json& extensions) {
    GltfBuilder builder;
    const Json pbr{{"metallicFactor", 0}, {"roughnessFactor", 0}, {"baseColorFactor", {0, 0, 0, 1}}};
    builder.node({{"mesh", builder.square(builder.material(
                               {{"pbrMetallicRoughness", pbr}, {"extensions", extensions}}))}});
    return at(draw(builder, settings), 0.5f, 0.5f);
  };
  expectColor(reflected(Json::object()), glm::vec3(0.04f), 0.003f);
  expectColor(reflected({{"KHR_materials_ior", {{"ior", 2}}}}), glm::vec3(1 / 9.0f), 0.005f);
  expectColor(reflected({{"KHR_materials_specular", {{"specularFactor", 0}}}}), glm::vec3(0), 0.003f);
  expectColor(reflected({{"KHR_materials_specular", {{"specularColorFactor", {1, 0.5, 0}}}}}),
              {0.04f, 0.02f, 0}, 0.003f);
}

}  // namespace
}  // namespace loden::test
