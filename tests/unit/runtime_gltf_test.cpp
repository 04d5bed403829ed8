// The glTF loader on good and on hostile files.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "material/base/issues.h"
#include "runtime/scene/gltf_guard.h"
#include "runtime/scene/gltf_scene.h"

namespace loden::runtime {
namespace {

namespace fs = std::filesystem;

// A folder of its own per test.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("loden_gltf_" + std::to_string(::getpid()))) {
    fs::remove_all(path_);
    fs::create_directories(path_ / "scene");
  }
  ~Folder() { fs::remove_all(path_); }
  fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

template <class T>
void append(std::string& bytes, std::initializer_list<T> values) {
  for (const T& value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// Positions (3 x vec3), UVs (3 x vec2), indices (3 x u16, padded): 36 + 24 + 8 bytes.
std::string triangleBuffer(float x1 = 1, uint16_t last_index = 2, float u1 = 1) {
  std::string bytes;
  append<float>(bytes, {0, 0, 0, x1, 0, 0, 0, 1, 0});
  append<float>(bytes, {0, 0, u1, 0, 0, 1});
  append<uint16_t>(bytes, {0, 1, last_index, 0});
  return bytes;
}

// What a document is made of; each test changes one part.
struct Document {
  std::string uri = "scene.bin";
  std::string accessors =
      R"([{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
          {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},
          {"bufferView":2,"componentType":5123,"count":3,"type":"SCALAR"}])";
  std::string views =
      R"([{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},
          {"buffer":0,"byteOffset":60,"byteLength":8}])";
  std::string meshes =
      R"([{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"material":0}]}])";
  std::string materials = R"([{"name":"cloth"}])";
  std::string nodes = R"([{"mesh":0}])";
  std::string scene_nodes = "[0]";
  std::string rest;  // further members, with a leading comma

  std::string json() const {
    return R"({"asset":{"version":"2.0"},"buffers":[{"uri":")" + uri +
           R"(","byteLength":68}],"bufferViews":)" + views + R"(,"accessors":)" + accessors +
           R"(,"meshes":)" + meshes + R"(,"materials":)" + materials + R"(,"nodes":)" + nodes +
           R"(,"scenes":[{"nodes":)" + scene_nodes + "}]" + rest + "}";
  }
};

Result<Scene> load(const Document& document, const std::string& buffer = triangleBuffer()) {
  const Folder folder;
  folder.write("scene/scene.bin", buffer);
  folder.write("outside.bin", buffer);
  return loadGltfScene(folder.write("scene/scene.gltf", document.json()));
}

void expectIssue(const Result<Scene>& scene, int id, const std::string& place = {}) {
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.issue().id, id) << scene.issue().where << ": " << scene.issue().text;
  EXPECT_NE(scene.issue().where.find(place), std::string::npos) << scene.issue().where;
}

TEST(GltfScene, LoadsATriangleAndCompletesIt) {
  const Result<Scene> scene = load({});
  ASSERT_TRUE(scene.ok()) << scene.issue().text;
  ASSERT_EQ(scene->meshes.size(), 1u);
  ASSERT_EQ(scene->instances.size(), 1u);
  for (const Vertex& vertex : scene->meshes[0].vertices) {
    EXPECT_EQ(vertex.normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(vertex.tangent, glm::vec4(1, 0, 0, 1));
  }
  EXPECT_EQ(scene->materials[0].name, "cloth");
}

TEST(GltfScene, MirroredUvsGiveANegativeSign) {
  const Result<Scene> scene = load({}, triangleBuffer(1, 2, -1));
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(scene->meshes[0].vertices[0].tangent, glm::vec4(-1, 0, 0, -1));
}

TEST(GltfScene, DegenerateUvsLeaveTheFrameToTheShader) {
  const Result<Scene> scene = load({}, triangleBuffer(1, 2, 0));
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(scene->meshes[0].vertices[0].tangent.w, 0);
}

TEST(GltfScene, ReadsExtensionLightsAndCamera) {
  Document document;
  document.materials =
      R"([{"name":"cloth","extensions":{"LODEN_materials_flat_btf":{"asset":0,"scale":[8,4],"rotation":0.5}}}])";
  document.nodes =
      R"([{"mesh":0,"translation":[1,2,3],"children":[1,2]},{"camera":0},
          {"extensions":{"KHR_lights_punctual":{"light":0}}}])";
  document.rest =
      R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}}],
         "extensions":{"LODEN_materials_flat_btf":{"assets":[{"uri":"cloth%20one.loden"}]},
                       "KHR_lights_punctual":{"lights":[{"type":"point","intensity":5,"color":[1,0.5,0],"range":7}]}})";
  const Result<Scene> scene = load(document);
  ASSERT_TRUE(scene.ok()) << scene.issue().where << scene.issue().text;
  ASSERT_TRUE(scene->materials[0].flat_btf);
  EXPECT_EQ(scene->materials[0].flat_btf->scale, glm::vec2(8, 4));
  EXPECT_FLOAT_EQ(scene->materials[0].flat_btf->rotation, 0.5f);
  EXPECT_EQ(scene->assets.at(0).path.filename(), "cloth one.loden");
  ASSERT_EQ(scene->cameras.size(), 1u);
  EXPECT_EQ(glm::vec3(scene->cameras[0].world_from_camera[3]), glm::vec3(1, 2, 3));
  ASSERT_EQ(scene->lights.size(), 1u);
  EXPECT_EQ(scene->lights[0].intensity, glm::vec3(5, 2.5, 0));
  EXPECT_EQ(scene->lights[0].position, glm::vec3(1, 2, 3));
}

TEST(GltfScene, ReadsAnEmbeddedAsset) {
  Document document;
  document.rest =
      R"(,"extensions":{"LODEN_materials_flat_btf":{"assets":[{"bufferView":2,"mimeType":"application/vnd.loden"}]}})";
  const Result<Scene> scene = load(document);
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(scene->assets.at(0).embedded.size(), 8u);
}

TEST(GltfScene, RejectsNestingThatWouldOverflowTheParser) {
  Document document;
  document.rest = R"(,"extras":)" + std::string(20000, '[') + std::string(20000, ']');
  expectIssue(load(document), issue_id::kGltfDepth, "byte ");
}

TEST(GltfScene, BracketsInsideStringsAreNoNesting) {
  Document document;
  document.rest = R"(,"extras":{"text":")" + std::string(500, '[') + R"(\"[["})";
  EXPECT_TRUE(load(document).ok());
}

TEST(GltfScene, SaysInOneLineWhatIsNoGltf) {
  const Folder folder;
  const std::string whole = Document().json();
  for (const size_t bytes : {whole.size() - 1, whole.size() / 2, size_t(5)}) {
    const Result<Scene> scene = loadGltfScene(folder.write("cut.gltf", whole.substr(0, bytes)));
    expectIssue(scene, issue_id::kGltfParse);
    EXPECT_EQ(scene.issue().text.find_first_of("\r\n"), std::string::npos) << scene.issue().text;
  }
}

TEST(GltfScene, RejectsFilesOutsideItsFolder) {
  Document document;
  for (const auto& [uri, id] : {std::pair{"../outside.bin", issue_id::kGltfPath},
                                {"%2e%2e/outside.bin", issue_id::kGltfPath},
                                {"a/../../outside.bin", issue_id::kGltfPath},
                                {"/etc/passwd", issue_id::kUriAbsolute},
                                {"file:///etc/passwd", issue_id::kUriAbsolute}}) {
    document.uri = uri;
    expectIssue(load(document), id);
  }
}

TEST(GltfScene, RejectsLinksThatLeadOutside) {
  const Folder folder;
  folder.write("outside.bin", triangleBuffer());
  fs::create_symlink(folder.path() / "outside.bin", folder.path() / "scene/scene.bin");
  expectIssue(loadGltfScene(folder.write("scene/scene.gltf", Document().json())), issue_id::kGltfPath);
}

TEST(GltfScene, RejectsAnAssetOutsideItsFolder) {
  Document document;
  document.rest = R"(,"extensions":{"LODEN_materials_flat_btf":{"assets":[{"uri":"../secret.loden"}]}})";
  expectIssue(load(document), issue_id::kGltfPath, "assets[0]");
}

TEST(GltfScene, RejectsAccessorsLargerThanTheirView) {
  Document document;
  document.accessors.replace(document.accessors.find("\"count\":3"), 9, "\"count\":1000000");
  expectIssue(load(document), issue_id::kAccessorRange, "meshes[0].primitives[0]");
  document = {};
  document.accessors.replace(document.accessors.find("\"bufferView\":0"), 14,
                             "\"bufferView\":0,\"byteOffset\":4294967295");
  expectIssue(load(document), issue_id::kAccessorRange);
}

TEST(GltfScene, RejectsViewsLargerThanTheirBuffer) {
  Document document;
  document.views.replace(document.views.find("36"), 2, "4294967295");
  expectIssue(load(document), issue_id::kViewRange);
}

TEST(GltfScene, RejectsIndicesBeyondTheVertices) {
  expectIssue(load({}, triangleBuffer(1, 3)), issue_id::kIndexRange, "indices");
}

TEST(GltfScene, RejectsPositionsThatAreNotFinite) {
  expectIssue(load({}, triangleBuffer(std::numeric_limits<float>::quiet_NaN())), issue_id::kAttributeFinite,
              "POSITION");
}

TEST(GltfScene, RejectsWrongTypesAndMissingPositions) {
  Document document;
  document.accessors.replace(document.accessors.find("VEC3"), 4, "VEC2");
  expectIssue(load(document), issue_id::kAttributeComponents, "POSITION");
  document = {};
  document.meshes = R"([{"primitives":[{"attributes":{"TEXCOORD_0":1}}]}])";
  expectIssue(load(document), issue_id::kNoPosition, "primitives[0]");
}

TEST(GltfScene, RejectsNodeLoopsAndSharedNodes) {
  Document document;
  document.nodes = R"([{"children":[1]},{"children":[0]}])";
  expectIssue(load(document), issue_id::kGltfNode, "nodes[0]");
  document.nodes = R"([{"children":[2]},{"children":[2]},{"mesh":0}])";
  document.scene_nodes = "[0,1]";
  expectIssue(load(document), issue_id::kGltfNode, "nodes[2]");
  document.nodes = R"([{"mesh":9}])";
  document.scene_nodes = "[0]";
  expectIssue(load(document), issue_id::kNodeMesh, "nodes[0]");
}

TEST(GltfScene, FollowsVeryDeepNodeChains) {
  Document document;
  constexpr int kNodes = 50000;
  document.nodes = "[";
  for (int i = 0; i < kNodes; ++i) document.nodes += R"({"children":[)" + std::to_string(i + 1) + "]},";
  document.nodes += R"({"mesh":0}])";
  const Result<Scene> scene = load(document);
  ASSERT_TRUE(scene.ok());
  EXPECT_EQ(scene->instances.size(), 1u);
}

TEST(GltfScene, RefusesUnknownRequiredExtensions) {
  Document document;
  document.rest = R"(,"extensionsRequired":["KHR_draco_mesh_compression"])";
  expectIssue(load(document), issue_id::kGltfRequired, "extensionsRequired");
}

TEST(GltfScene, RejectsBadExtensionObjects) {
  const std::string assets = R"(,"extensions":{"LODEN_materials_flat_btf":{"assets":[{"uri":"a.loden"}]}})";
  for (const auto& [object, id] : {std::pair{R"({"asset":1})", issue_id::kMaterialAsset},
                                   {R"({})", issue_id::kMaterialAsset},
                                   {R"({"asset":0,"scale":[0,1]})", issue_id::kMaterialScale},
                                   {R"({"asset":0,"scale":[1]})", issue_id::kMaterialScale},
                                   {R"({"asset":-1})", issue_id::kMaterialAsset},
                                   {R"({"asset":0,"texCoord":99})", issue_id::kTexCoord}}) {
    Document document;
    document.rest = assets;
    document.materials = R"([{"extensions":{"LODEN_materials_flat_btf":)" + std::string(object) + "}}]";
    expectIssue(load(document), id, "materials[0]");
  }
  Document document;
  document.rest =
      R"(,"extensions":{"LODEN_materials_flat_btf":{"assets":[{"uri":"a.loden","bufferView":0}]}})";
  expectIssue(load(document), issue_id::kAssetSource, "assets[0]");
}

TEST(GltfScene, RejectsTruncationAtEveryByteOfABinaryFile) {
  const std::string json = Document().json() + "  ";
  const std::string padded = json.substr(0, json.size() / 4 * 4);
  const std::string buffer = triangleBuffer();
  std::string glb = "glTF";
  append<uint32_t>(glb, {2, static_cast<uint32_t>(28 + padded.size() + buffer.size()),
                         static_cast<uint32_t>(padded.size()), 0x4E4F534A});
  glb += padded;
  append<uint32_t>(glb, {static_cast<uint32_t>(buffer.size()), 0x004E4942});
  glb += buffer;
  const Folder folder;
  folder.write("scene/scene.bin", buffer);
  ASSERT_TRUE(loadGltfScene(folder.write("scene/whole.glb", glb)).ok());
  for (size_t size = 0; size < glb.size(); size += 7)
    EXPECT_FALSE(loadGltfScene(folder.write("scene/cut.glb", glb.substr(0, size))).ok()) << size;
}

TEST(GltfScene, MissingFileNamesTheFile) {
  const Result<Scene> scene = loadGltfScene("/nowhere/scene.gltf");
  expectIssue(scene, issue_id::kCannotOpen, "/nowhere/scene.gltf");
}

}  // namespace
}  // namespace loden::runtime
