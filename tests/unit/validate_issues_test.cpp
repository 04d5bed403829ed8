// Every issue that `loden validate --list` prints has an input here or in asset_faults.cpp that provokes it,
// and nothing else.
#include <functional>
#include <set>

#include "importer/base/file_read.h"
#include "importer/gltf/pack.h"
#include "importer/gltf/validate.h"
#include "material/asset/asset.h"
#include "material/base/issue_table.h"
#include "tests/unit/asset_faults.h"
#include "tests/unit/material_fixtures.h"
#include "tests/unit/triangle_scene.h"

namespace loden {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;
namespace id = issue_id;

constexpr const char* kExtension = "LODEN_materials_flat_btf";

// The asset beside the scene.
const std::string& clothBytes() {
  static const std::string bytes = [] {
    const test::Bytes asset = *serializeAsset(test::fusedMaterial());
    return std::string(reinterpret_cast<const char*>(asset.data()), asset.size());
  }();
  return bytes;
}

// A binary glTF of chunks; `length` in place of the true one.
std::string glb(const std::vector<std::pair<std::string, std::string>>& chunks, uint32_t version = 2,
                int longer = 0) {
  const auto number = [](uint32_t value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  std::string body;
  for (const auto& [type, bytes] : chunks) body += number(uint32_t(bytes.size())) + type + bytes;
  return "glTF" + number(version) + number(uint32_t(int(12 + body.size()) + longer)) + body;
}

// A scene with one fault: the text of the file, and its extension.
struct SceneFault {
  int id = 0;
  std::string what, file, extension = ".gltf";
};

class SceneFaults {
 public:
  explicit SceneFaults(Json sound) : sound_(std::move(sound)) {}
  void changed(int id, const char* what, const std::function<void(Json&)>& change) {
    Json scene = sound_;
    change(scene);
    text(id, what, scene.dump());
  }
  void text(int id, const char* what, std::string file, const char* extension = ".gltf") {
    faults.push_back({id, what, std::move(file), extension});
  }
  std::vector<SceneFault> faults;

 private:
  Json sound_;
};

void addDocuments(SceneFaults& list) {
  const std::string json = R"({"asset": {"version": "2.0"}} )";
  list.text(id::kGltfParse, "half an object", "{\"asset\"");
  list.text(id::kGltfParse, "a number that no double holds",
            R"({"asset": {"version": "2.0"}, "scene": 1e999})");
  list.text(id::kGltfDepth, "65 arrays", std::string(65, '[') + std::string(65, ']'));
  list.text(id::kGlbVersion, "1", glb({{"JSON", json}}, 1), ".glb");
  list.text(id::kGlbLength, "one more", glb({{"JSON", json}}, 2, 1), ".glb");
  list.text(id::kGlbTruncated, "4 bytes of 8", glb({{"JSON", json}}, 2, 4) + "BIN ", ".glb");
  std::string longer = glb({{"JSON", json}});
  longer[12] = 127;
  list.text(id::kGlbChunk, "127 bytes", longer, ".glb");
  list.text(id::kGlbNoJson, "BIN first", glb({{std::string("BIN\0", 4), json}}), ".glb");
  list.changed(id::kGltfVersion, "1.0", [](Json& j) { j["asset"]["version"] = "1.0"; });
  list.changed(id::kGltfRequired, "a vendor's", [](Json& j) { j["extensionsRequired"] = {"VENDOR_thing"}; });
  list.changed(id::kGltfType, "a name that is a number", [](Json& j) { j["materials"][0]["name"] = 5; });
  list.changed(id::kGltfType, "a node that is a number", [](Json& j) { j["nodes"][2] = 5; });
}

void addBuffers(SceneFaults& list) {
  const auto uri = [&](int id, const char* text) {
    list.changed(id, text, [&](Json& j) { j["buffers"][0]["uri"] = text; });
  };
  uri(id::kCannotOpen, "none.bin");
  uri(id::kGltfPath, "../scene.bin");
  uri(id::kGltfPath, "%2e%2e/scene.bin");
  uri(id::kUriSyntax, "a%2");
  uri(id::kUriSyntax, "a\\b");
  uri(id::kUriSyntax, "a%00");
  uri(id::kUriAbsolute, "/scene.bin");
  uri(id::kUriAbsolute, "file:scene.bin");
  uri(id::kDataUri, "data:application/octet-stream;base64,AAA?");
  list.changed(id::kMediaType, "none", [](Json& j) {
    j["buffers"].push_back({{"uri", "data:;base64,AAAA"}, {"byteLength", 3}});
  });
  list.changed(id::kBufferSource, "none", [](Json& j) { j["buffers"][0].erase("uri"); });
  list.changed(id::kBufferLength, "none", [](Json& j) { j["buffers"][0].erase("byteLength"); });
  list.changed(id::kBufferShort, "81 of 80", [](Json& j) { j["buffers"][0]["byteLength"] = 81; });
  list.changed(id::kViewBuffer, "1", [](Json& j) { j["bufferViews"][3]["buffer"] = 1; });
  list.changed(id::kViewRange, "13 of 12 bytes", [](Json& j) { j["bufferViews"][3]["byteLength"] = 13; });
  list.changed(id::kViewStride, "4 of 12 bytes", [](Json& j) { j["bufferViews"][0]["byteStride"] = 4; });
  list.changed(id::kViewStride, "256", [](Json& j) { j["bufferViews"][3]["byteStride"] = 256; });
}

void addAccessors(SceneFaults& list) {
  const auto accessor = [&](int id, const char* what, size_t i, const char* member, const Json& value) {
    list.changed(id, what, [&](Json& j) { j["accessors"][i][member] = value; });
  };
  accessor(id::kAccessorType, "VEC5", 3, "type", "VEC5");
  accessor(id::kAccessorComponent, "1", 3, "componentType", 1);
  accessor(id::kAccessorCount, "0", 3, "count", 0);
  accessor(id::kAccessorCount, "2^32 + 1", 3, "count", 4294967297);
  accessor(id::kAccessorView, "4", 3, "bufferView", 4);
  accessor(id::kAccessorRange, "two of one", 3, "count", 2);
  accessor(id::kAccessorRange, "-1", 3, "byteOffset", -1);
  const auto sparse = [&](int id, const char* what, const char* text) {
    accessor(id, what, 0, "sparse", Json::parse(text));
  };
  sparse(id::kSparseCount, "none", R"({"count": 0})");
  sparse(id::kSparseCount, "4 of 3", R"({"count": 4})");
  sparse(id::kSparseIndices, "absent", R"({"count": 1})");
  sparse(id::kSparseIndices, "floats",
         R"({"count": 1, "indices": {"bufferView": 2, "componentType": 5126}})");
  sparse(id::kSparseIndices, "no view",
         R"({"count": 1, "indices": {"bufferView": 9, "componentType": 5123}})");
  sparse(id::kSparseRange, "7 of 3",
         R"({"count": 1, "indices": {"bufferView": 2, "byteOffset": 6, "componentType": 5123}})");
  sparse(id::kSparseValues, "absent", R"({"count": 1, "indices": {"bufferView": 2, "componentType": 5123}})");
}

void addMeshes(SceneFaults& list) {
  const auto primitive = [&](int id, const char* what, const std::function<void(Json&)>& change) {
    list.changed(id, what, [&](Json& j) { change(j["meshes"][0]["primitives"][0]); });
  };
  primitive(id::kPrimitiveMode, "7", [](Json& p) { p["mode"] = 7; });
  list.changed(id::kPrimitiveMaterial, "4", [](Json& j) {
    j["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"material", 4}}}}});
  });
  primitive(id::kNoPosition, "absent", [](Json& p) { p["attributes"].erase("POSITION"); });
  primitive(id::kAttributeAccessor, "a position's", [](Json& p) { p["attributes"]["POSITION"] = 9; });
  primitive(id::kAttributeAccessor, "a normal's", [](Json& p) { p["attributes"]["NORMAL"] = 9; });
  primitive(id::kAttributeComponents, "a normal of two", [](Json& p) { p["attributes"]["NORMAL"] = 1; });
  list.changed(id::kAttributeIntegers, "texture coordinates",
               [](Json& j) { j["accessors"][1]["componentType"] = 5125; });
  list.changed(id::kAttributeCount, "two texture coordinates",
               [](Json& j) { j["accessors"][1]["count"] = 2; });
  list.changed(id::kAttributeFinite, "an infinite position", [](Json& j) {
    j["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 3}}}, {"mode", 5}}}}});
  });
  primitive(id::kIndexAccessor, "9", [](Json& p) { p["indices"] = 9; });
  primitive(id::kIndexType, "positions", [](Json& p) { p["indices"] = 0; });
  list.changed(id::kIndexRange, "1 2 7", [](Json& j) { j["accessors"][2]["byteOffset"] = 2; });
  list.changed(id::kTriangleCorners, "two", [](Json& j) { j["accessors"][2]["count"] = 2; });
  list.changed(id::kSubdivision, "9 levels", [](Json& j) {
    j["meshes"][0]["extras"]["loden_subdivision"] = {{"levels", 9}, {"quads", true}};
  });
}

void addNodes(SceneFaults& list) {
  const auto node = [&](int id, const char* what, const char* member, const Json& value) {
    list.changed(id, what, [&](Json& j) { j["nodes"][2][member] = value; });
  };
  node(id::kNodeMesh, "1", "mesh", 1);
  node(id::kNodeCamera, "0", "camera", 0);
  node(id::kNodeSkin, "0", "skin", 0);
  node(id::kNodeNumbers, "1e300", "translation", {1e300, 0, 0});
  node(id::kNodeLight, "2", "extensions", {{"KHR_lights_punctual", {{"light", 2}}}});
  node(id::kNodeChild, "5", "children", {5});
  node(id::kNodeParents, "two", "children", {1});
  list.changed(id::kNodeLoop, "of two", [](Json& j) {
    j["nodes"].push_back({{"children", {4}}});
    j["nodes"].push_back({{"children", {3}}});
  });
  list.changed(id::kSceneDefault, "3", [](Json& j) { j["scene"] = 3; });
  list.changed(id::kSceneNode, "9", [](Json& j) { j["scenes"][0]["nodes"] = {0, 9}; });
  list.changed(id::kSceneRoot, "a child", [](Json& j) { j["scenes"][0]["nodes"] = {0, 1}; });
  list.changed(id::kSceneRoot, "twice", [](Json& j) { j["scenes"][0]["nodes"] = {0, 0}; });
}

void addExtension(SceneFaults& list) {
  const auto asset = [&](int id, const char* what, const Json& value) {
    list.changed(id, what, [&](Json& j) { j["extensions"][kExtension]["assets"].push_back(value); });
  };
  const auto material = [&](int id, const char* what, const char* member, const Json& value) {
    list.changed(id, what, [&](Json& j) { j["materials"][0]["extensions"][kExtension][member] = value; });
  };
  list.changed(id::kExtensionAssets, "absent", [](Json& j) {
    j["materials"][0].erase("extensions");
    j["extensions"][kExtension] = Json::object();
  });
  asset(id::kAssetSource, "neither", Json::object());
  asset(id::kAssetSource, "both", {{"uri", "cloth.loden"}, {"bufferView", 0}});
  asset(id::kUriAbsolute, "data", {{"uri", "data:application/octet-stream;base64,AAAA"}});
  asset(id::kAssetView, "9", {{"bufferView", 9}, {"mimeType", "application/vnd.loden"}});
  list.changed(id::kAssetMediaType, "a picture's", [](Json& j) {
    j["buffers"].push_back({{"uri", "cloth.loden"}, {"byteLength", clothBytes().size()}});
    j["bufferViews"].push_back({{"buffer", 1}, {"byteLength", clothBytes().size()}});
    j["extensions"][kExtension]["assets"].push_back({{"bufferView", 4}, {"mimeType", "image/png"}});
  });
  material(id::kMaterialAsset, "1", "asset", 1);
  material(id::kMaterialAsset, "2^32", "asset", 4294967296);
  material(id::kMaterialScale, "a zero", "scale", {0, 1});
  material(id::kMaterialScale, "1e300", "scale", {1e300, 1});
  material(id::kMaterialRotation, "text", "rotation", "90");
  material(id::kTexCoord, "16", "texCoord", 16);
  material(id::kTexCoordMissing, "1", "texCoord", 1);
  list.changed(id::kUndeclared, "not at all", [](Json& j) { j.erase("extensionsUsed"); });
  list.changed(id::kUnused, "not at all", [](Json& j) {
    j["materials"][0].erase("extensions");
    j.erase("extensions");
  });
}

std::vector<SceneFault> sceneFaults(const Json& sound) {
  SceneFaults list(sound);
  for (const auto add : {addDocuments, addBuffers, addAccessors, addMeshes, addNodes, addExtension})
    add(list);
  return std::move(list.faults);
}

class ValidateIssues : public test::TriangleScene {
 protected:
  ValidateIssues() { write("cloth.loden", clothBytes()); }

  // The triangle wears the asset beside it.
  static Json soundScene() {
    Json scene = TriangleScene::scene();
    scene["materials"][0]["extensions"][kExtension]["asset"] = 0;
    scene["extensionsUsed"] = {kExtension};
    scene["extensions"][kExtension]["assets"] = {{{"uri", "cloth.loden"}}};
    return scene;
  }

  static std::vector<Issue> issuesOf(const fs::path& file) {
    const auto bytes = importer::readFile(file);
    if (!bytes) return {bytes.issue()};
    return importer::validateAssetBytes(std::as_bytes(std::span(*bytes)), file.string());
  }

  // The ids of the issues, each once; expects that each says where it is.
  static std::set<int> idsOf(const std::vector<Issue>& issues, const std::string& file) {
    std::set<int> ids;
    for (const Issue& issue : issues) {
      ids.insert(issue.id);
      EXPECT_NE(issue.where.find(file), std::string::npos) << issue.where;
      EXPECT_FALSE(issue.text.empty());
    }
    return ids;
  }

  std::vector<Issue> issuesOfScene(const SceneFault& fault) const {
    const auto issues = importer::validateGltf(write("fault" + fault.extension, fault.file));
    return issues ? *issues : std::vector<Issue>{issues.issue()};
  }
};

TEST_F(ValidateIssues, SoundFilesHaveNone) {
  EXPECT_EQ(idsOf(issuesOf(folder_ / "cloth.loden"), ""), std::set<int>());
  EXPECT_EQ(idsOf(*importer::validateGltf(write("sound.gltf", soundScene().dump())), ""), std::set<int>());
}

TEST_F(ValidateIssues, EachHasAnInputThatProvokesItAlone) {
  std::set<int> provoked;
  const auto expect = [&](int id, const std::string& what, const std::vector<Issue>& issues,
                          const std::string& file) {
    SCOPED_TRACE(std::to_string(id) + " " + std::string(issueKind(id)->name) + ": " + what);
    EXPECT_EQ(idsOf(issues, file), std::set<int>{id});
    provoked.insert(id);
  };
  for (const test::AssetFault& fault : test::assetFaults())
    expect(fault.id, fault.what, importer::validateAssetBytes(fault.file, "fault.loden"), "fault.loden");
  for (const SceneFault& fault : sceneFaults(soundScene()))
    expect(fault.id, fault.what, issuesOfScene(fault), "");
  expect(id::kCannotOpen, "a folder", issuesOf(folder_), folder_.string());
  expect(id::kCannotOpen, "a file that is not there", issuesOf(folder_ / "none.loden"), "none.loden");
  // The kernel's view of this process's memory: a regular file whose first page cannot be read.
  expect(id::kCannotRead, "memory that is not mapped", issuesOf("/proc/self/mem"), "/proc/self/mem");

  int listed = 0;
  for (const IssueKind& kind : kIssueKinds) {
    if (kind.found_by != FoundBy::kValidate) continue;
    ++listed;
    EXPECT_TRUE(provoked.contains(kind.id)) << "no input provokes " << kind.id << " " << kind.name;
  }
  for (const int id : provoked) EXPECT_EQ(issueKind(id)->found_by, FoundBy::kValidate) << id;
  EXPECT_GE(listed, 120);
}

}  // namespace
}  // namespace loden
