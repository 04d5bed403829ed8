// What the glTF loader reads beside plain triangles, and how it takes damage to it.
#include <gtest/gtest.h>

#include <cmath>

#include "material/base/issues.h"
#include "runtime/scene/animation.h"
#include "tests/unit/gltf_builder.h"

namespace loden::test {
namespace {

using namespace runtime;

// A square whose positions come from this accessor.
Result<Scene> withPositions(GltfBuilder& builder, const Json& accessor) {
  builder.node({{"mesh", builder.square(builder.material(Json::object()))}});
  const Json& primitive = builder.json["meshes"][0]["primitives"][0];
  builder.json["accessors"][primitive["attributes"]["POSITION"].get<size_t>()] = accessor;
  return builder.load();
}

TEST(GltfFeatures, SparseAccessorsReplaceElements) {
  GltfBuilder builder;
  const int base = builder.view(std::string(48, '\0'));
  const float raised[3] = {1, 2, 3};
  const int values = builder.view({reinterpret_cast<const char*>(raised), sizeof raised});
  const int indices = builder.view(std::string("\x02", 1));
  Json accessor{{"bufferView", base},
                {"componentType", 5126},
                {"count", 4},
                {"type", "VEC3"},
                {"sparse",
                 {{"count", 1},
                  {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                  {"values", {{"bufferView", values}}}}}};
  for (const bool has_view : {true, false}) {
    if (!has_view) accessor.erase("bufferView");  // zeros
    GltfBuilder again;
    again.json = builder.json;
    again.bytes = builder.bytes;
    const Result<Scene> scene = withPositions(again, accessor);
    ASSERT_TRUE(scene.ok()) << scene.issue().where << ": " << scene.issue().text;
    EXPECT_EQ(scene->meshes[0].vertices[2].position, glm::vec3(1, 2, 3));
    EXPECT_EQ(scene->meshes[0].vertices[1].position, glm::vec3(0));
  }
  accessor["sparse"]["count"] = 5;
  EXPECT_EQ(withPositions(builder, accessor).issue().id, issue_id::kSparseCount);
}

TEST(GltfFeatures, SparseIndicesBeyondTheElementsAreRefused) {
  GltfBuilder builder;
  const int values = builder.view(std::string(12, '\0')), indices = builder.view(std::string("\x04", 1));
  const Result<Scene> scene =
      withPositions(builder, {{"componentType", 5126},
                              {"count", 4},
                              {"type", "VEC3"},
                              {"sparse",
                               {{"count", 1},
                                {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                {"values", {{"bufferView", values}}}}}});
  ASSERT_FALSE(scene.ok());
  EXPECT_NE(scene.issue().text.find("sparse index"), std::string::npos);
}

TEST(GltfFeatures, AccessorsWithoutAViewAskForNoEndlessMemory) {
  GltfBuilder builder;
  const Result<Scene> scene =
      withPositions(builder, {{"componentType", 5126}, {"count", 4000000000u}, {"type", "VEC3"}});
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.issue().id, issue_id::kGltfAccessor);
}

TEST(GltfFeatures, InterleavedAndQuantizedPositions) {
  GltfBuilder builder;
  std::string bytes;
  for (int i = 0; i < 4; ++i) {
    const int16_t element[6] = {int16_t(32767 * (i & 1)), int16_t(32767 * (i >> 1)), -32767, 0, 77, 77};
    bytes.append(reinterpret_cast<const char*>(element), sizeof element);
  }
  const int view = builder.view(bytes);
  builder.json["bufferViews"][size_t(view)]["byteStride"] = 12;
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const Result<Scene> scene = withPositions(
      builder,
      {{"bufferView", view}, {"componentType", 5122}, {"normalized", true}, {"count", 4}, {"type", "VEC3"}});
  ASSERT_TRUE(scene.ok()) << scene.issue().text;
  EXPECT_EQ(scene->meshes[0].vertices[1].position, glm::vec3(1, 0, -1));
  EXPECT_EQ(scene->meshes[0].vertices[3].position, glm::vec3(1, 1, -1));
}

TEST(GltfFeatures, StripsAndFansBecomeTriangles) {
  for (const int mode : {5, 6}) {
    GltfBuilder builder;
    // A square's corners in the order of the mode.
    const std::vector<float> strip{-1, -1, 0, 1, -1, 0, -1, 1, 0, 1, 1, 0},
        fan{-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
    builder.node(
        {{"mesh",
          builder.mesh({{"mode", mode},
                        {"attributes", {{"POSITION", builder.floats(mode == 5 ? strip : fan, "VEC3")}}}})}});
    const Result<Scene> scene = builder.load();
    ASSERT_TRUE(scene.ok());
    ASSERT_EQ(scene->meshes[0].indices.size(), 6u);
    for (const Vertex& vertex : scene->meshes[0].vertices)
      EXPECT_EQ(vertex.normal, glm::vec3(0, 0, 1)) << "both triangles face the same way";
  }
}

TEST(GltfFeatures, MeshesWithoutNormalsAreFlat) {
  GltfBuilder builder;
  const Json attributes{{"POSITION", builder.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3")}};
  builder.node({{"mesh", builder.mesh({{"attributes", attributes},
                                       {"indices", builder.shorts({0, 1, 2, 0, 3, 1}, "SCALAR")}})}});
  const Result<Scene> scene = builder.load();
  ASSERT_TRUE(scene.ok());
  ASSERT_EQ(scene->meshes[0].vertices.size(), 6u);
  EXPECT_EQ(scene->meshes[0].vertices[0].normal, glm::vec3(0, 0, 1));
  EXPECT_EQ(scene->meshes[0].vertices[3].normal, glm::vec3(0, 1, 0));
}

TEST(GltfFeatures, ImagesThatCannotBeReadAreNotedAndLeftOut) {
  for (const char* uri : {"missing.png", "../outside.png", "/etc/passwd", "scene.bin"}) {
    GltfBuilder builder;
    builder.json["images"] = {{{"uri", uri}}};
    builder.json["textures"] = {{{"source", 0}}};
    const Json texture{{"index", 0}};
    builder.node(
        {{"mesh", builder.square(builder.material({{"pbrMetallicRoughness", {{"baseColorTexture", texture}}},
                                                   {"emissiveTexture", texture}}))}});
    const Result<Scene> scene = builder.load();
    ASSERT_TRUE(scene.ok()) << scene.issue().text;
    ASSERT_EQ(scene->notes.size(), 1u) << "once, though two textures show it";
    EXPECT_EQ(scene->notes[0].id, issue_id::kImage);
    EXPECT_NE(scene->notes[0].where.find("images[0]"), std::string::npos);
    EXPECT_EQ(scene->materials[0].texture(TextureRole::kBaseColor).image, -1);
  }
}

TEST(GltfFeatures, ImagesInViewsBeyondTheirBufferAreNoted) {
  GltfBuilder builder;
  builder.json["images"] = {{{"bufferView", 0}, {"mimeType", "image/png"}}};
  builder.json["textures"] = {{{"source", 0}}};
  const int view = builder.view("not much");
  builder.json["bufferViews"][size_t(view)]["byteLength"] = 4000000;
  builder.node({{"mesh", builder.square(builder.material(
                             {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}))}});
  const Result<Scene> scene = builder.load();
  ASSERT_TRUE(scene.ok()) << scene.issue().text;
  EXPECT_EQ(scene->notes.size(), 1u);
}

TEST(GltfFeatures, NamesWhatIsNotDrawn) {
  GltfBuilder builder;
  builder.json["extensionsUsed"] = {"KHR_materials_transmission", "KHR_materials_sheen", "VENDOR_thing"};
  builder.node({{"mesh", builder.square(builder.material(Json::object()))}});
  const Result<Scene> scene = builder.load();
  ASSERT_TRUE(scene.ok());
  ASSERT_EQ(scene->notes.size(), 2u);
  EXPECT_NE(scene->notes[0].text.find("KHR_materials_transmission"), std::string::npos);
  EXPECT_NE(scene->notes[1].text.find("VENDOR_thing"), std::string::npos);
  builder.json["extensionsRequired"] = {"KHR_materials_transmission"};
  EXPECT_EQ(builder.load().issue().id, issue_id::kGltfRequired);
}

TEST(GltfFeatures, RefusesAnimationsThatDoNotFit) {
  struct Case {
    std::vector<float> times, values;
  };
  for (const Case& c : {Case{{0, 1}, {0, 0, 0}}, Case{{1, 0}, {0, 0, 0, 0, 0, 0}},
                        Case{{0, 0}, {0, 0, 0, 0, 0, 0}}, Case{{0, NAN}, {0, 0, 0, 0, 0, 0}}}) {
    GltfBuilder builder;
    builder.node({{"mesh", builder.square(builder.material(Json::object()))}});
    builder.json["animations"] = {
        {{"samplers",
          {{{"input", builder.floats(c.times, "SCALAR")}, {"output", builder.floats(c.values, "VEC3")}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
    const Result<Scene> scene = builder.load();
    ASSERT_FALSE(scene.ok());
    EXPECT_NE(scene.issue().where.find("animations[0]"), std::string::npos) << scene.issue().where;
  }
}

TEST(GltfFeatures, RefusesMoreInstancesThanAreBearable) {
  GltfBuilder builder;
  builder.json["accessors"] = {{{"componentType", 5126}, {"count", 2000000}, {"type", "VEC3"}}};
  const Json instancing{{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 0}}}}}};
  builder.node({{"mesh", builder.square(builder.material(Json::object()))}, {"extensions", instancing}});
  const Result<Scene> scene = builder.load();
  ASSERT_FALSE(scene.ok());
  EXPECT_NE(scene.issue().text.find("instances"), std::string::npos);
}

// Whatever a material says, the loader answers with a scene or an issue, and its numbers can be used.
TEST(GltfFeatures, OddMaterialsLeaveUsableNumbers) {
  const Json odd[] = {-1, 2, 1e300, "x", nullptr, Json::array(), Json::object(), {1, 2}, {1e300, -1, 0, 7}};
  for (const Json& value : odd)
    for (const char* extension : {"KHR_materials_sheen", "KHR_materials_clearcoat", "KHR_materials_specular",
                                  "KHR_materials_ior", "KHR_materials_emissive_strength"}) {
      GltfBuilder builder;
      Json parameters;
      for (const char* name :
           {"sheenColorFactor", "sheenRoughnessFactor", "sheenColorTexture", "clearcoatFactor",
            "clearcoatNormalTexture", "specularFactor", "specularColorFactor", "ior", "emissiveStrength"})
        parameters[name] = value;
      const int material =
          builder.material({{"extensions", {{extension, parameters}}}, {"emissiveFactor", {1, 1, 1}}});
      builder.node({{"mesh", builder.square(material)}});
      const Result<Scene> scene = builder.load();
      if (!scene) continue;
      const SceneMaterial& m = scene->materials[0];
      for (const float number : {m.sheen_color.r, m.sheen_roughness, m.clearcoat, m.specular,
                                 m.specular_color.g, m.ior, m.emissive.r, m.clearcoat_normal_scale})
        EXPECT_TRUE(std::isfinite(number)) << extension << " " << value;
    }
}

}  // namespace
}  // namespace loden::test
