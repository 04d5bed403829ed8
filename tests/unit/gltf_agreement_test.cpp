// `loden validate` and the runtime's loader agree on what is a scene.
#include <functional>

#include "importer/gltf/pack.h"
#include "material/base/issues.h"
#include "runtime/scene/gltf_scene.h"
#include "tests/unit/triangle_scene.h"

namespace loden {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

class GltfAgreement : public test::TriangleScene {
 protected:
  fs::path write(const Json& json) const { return TriangleScene::write("scene.gltf", json.dump()); }
  static bool isValid(const fs::path& path) {
    const auto issues = importer::validateGltf(path);
    return issues && std::none_of(issues->begin(), issues->end(),
                                  [](const Issue& issue) { return issue.severity == Severity::kError; });
  }
  static bool isLoaded(const fs::path& path) { return runtime::loadGltfScene(path).ok(); }
  // Both refuse it, and the loader's issue is one of those that the validator lists, or one of a whole kind
  // of faults, where the loader does not tell them apart.
  static void expectRefused(const fs::path& path, const std::string& what) {
    const auto issues = importer::validateGltf(path);
    const auto loaded = runtime::loadGltfScene(path);
    EXPECT_FALSE(isValid(path)) << what;
    ASSERT_FALSE(loaded.ok()) << what;
    const int id = loaded.issue().id;
    const bool listed = issues ? std::any_of(issues->begin(), issues->end(),
                                             [&](const Issue& issue) { return issue.id == id; })
                               : issues.issue().id == id;
    const bool kind = id == issue_id::kGltfParse || id == issue_id::kGltfNode;
    EXPECT_TRUE(listed || kind) << what << ": " << id << " " << loaded.issue().text;
  }
};

TEST_F(GltfAgreement, BothTakeWhatIsSound) {
  EXPECT_TRUE(isValid(write(scene())));
  EXPECT_TRUE(isLoaded(write(scene())));
  Json plain = scene();
  plain["meshes"][0]["primitives"][0].erase("indices");
  plain.erase("scene");
  plain["accessors"][0]["byteOffset"] = 0;
  EXPECT_TRUE(isValid(write(plain)));
  EXPECT_TRUE(isLoaded(write(plain)));
  plain.erase("scenes");
  EXPECT_TRUE(isValid(write(plain)));
  EXPECT_TRUE(isLoaded(write(plain)));
  Json embedded = scene();
  embedded["buffers"][0] = {{"uri", "data:application/octet-stream;base64," + std::string(107, 'A') + "="},
                            {"byteLength", 80}};
  EXPECT_TRUE(isValid(write(embedded)));
  EXPECT_TRUE(isLoaded(write(embedded)));
}

TEST_F(GltfAgreement, BothRefuseWhatIsNot) {
  using Change = std::function<void(Json&)>;
  const auto primitive = [](Json& j) -> Json& { return j["meshes"][0]["primitives"][0]; };
  const std::vector<Change> changes{
      [](Json& j) { j["nodes"][0]["children"] = {0}; },
      [](Json& j) { j["nodes"][1]["children"] = {0}; },
      [](Json& j) {
        j["nodes"][0]["children"] = {1, 1};
      },
      [](Json& j) { j["nodes"][0]["children"] = {5}; },
      [](Json& j) {
        j["scenes"][0]["nodes"] = {0, 1};
      },
      [](Json& j) {
        j["scenes"][0]["nodes"] = {0, 0};
      },
      [](Json& j) { j["scenes"][0]["nodes"] = {9}; },
      [](Json& j) { j["scene"] = 3; },
      [](Json& j) { j["nodes"][0]["mesh"] = 1; },
      [](Json& j) { j["nodes"][0]["camera"] = 0; },
      [](Json& j) {
        j["nodes"][0]["translation"] = {1e300, 0, 0};
      },
      [](Json& j) { j["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 2; },
      [&](Json& j) { primitive(j)["material"] = 4; },
      [&](Json& j) { primitive(j)["indices"] = 9; },
      [&](Json& j) { primitive(j)["indices"] = 0; },
      [&](Json& j) { primitive(j)["attributes"]["POSITION"] = 9; },
      [&](Json& j) { primitive(j)["attributes"]["POSITION"] = 1; },
      [&](Json& j) { primitive(j)["attributes"].erase("POSITION"); },
      [&](Json& j) { primitive(j)["attributes"]["NORMAL"] = 3; },
      [](Json& j) { j["accessors"][1]["count"] = 2; },
      [](Json& j) { j["accessors"][2]["count"] = 4; },       // one index is 7, and 4 make no triangles
      [](Json& j) { j["accessors"][2]["byteOffset"] = 2; },  // 1, 2, 7
      [](Json& j) { j["accessors"][2]["count"] = 2; },
      [](Json& j) { j["accessors"][0]["count"] = 30; },
      [](Json& j) { j["accessors"][0]["componentType"] = 1; },
      [](Json& j) {
        j["accessors"][0]["bufferView"] = 3;
        j["accessors"][0]["count"] = 1;
      },  // infinite
      [](Json& j) { j["bufferViews"][0]["buffer"] = 1; },
      [](Json& j) { j["bufferViews"][0]["byteLength"] = 100000; },
      [](Json& j) { j["buffers"][0]["uri"] = "none.bin"; },
      [](Json& j) { j["buffers"][0]["uri"] = "../scene.bin"; },
      [](Json& j) { j["buffers"][0]["uri"] = "data:;base64," + std::string(108, 'A'); },
      [](Json& j) { j["extensionsRequired"] = {"VENDOR_thing"}; },
      [](Json& j) { j["meshes"][0]["extras"]["loden_subdivision"]["levels"] = 9; },
      [](Json& j) { j["extensions"]["LODEN_materials_flat_btf"] = Json::object(); },
  };
  for (size_t k = 0; k < changes.size(); ++k) {
    Json json = scene();
    changes[k](json);
    expectRefused(write(json), std::to_string(k) + ": " + json.dump());
  }
}

TEST_F(GltfAgreement, BothRefuseExtensionsThatAreNotSound) {
  const auto with = [](const Json& extension) {
    Json json = scene();
    json["extensionsUsed"] = {"LODEN_materials_flat_btf"};
    json["extensions"]["LODEN_materials_flat_btf"]["assets"] = {{{"uri", "none.loden"}}};
    json["materials"][0]["extensions"]["LODEN_materials_flat_btf"] = extension;
    return json;
  };
  for (const char* text :
       {R"({})", R"({"asset": 1})", R"({"asset": -1})", R"({"asset": 0.5})", R"({"asset": "0"})",
        R"({"asset": 0, "scale": [0, 0]})", R"({"asset": 0, "scale": [1]})", R"({"asset": 0, "scale": 2})",
        R"({"asset": 0, "scale": [1e300, 1]})", R"({"asset": 0, "texCoord": 16})"}) {
    expectRefused(write(with(Json::parse(text))), text);
  }
}

}  // namespace
}  // namespace loden
