// `loden pack` and `loden validate` on scenes.
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/cli/loden_fixture.h"

namespace loden::test {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kExtension = "LODEN_materials_flat_btf";

ToolRun packTo(const ScratchFolder& scratch, const std::string& out, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{"pack",    scratch / "scene.gltf", "--material", "Cloth",
                                     "--asset", sharedAsset(),          "-o",         scratch / out};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return loden(arguments);
}

uint32_t u32At(const std::string& bytes, size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

std::string glbOf(const std::string& json_text, const std::string& bin) {
  std::string json = json_text, out = "glTF";
  json.append((4 - json.size() % 4) % 4, ' ');
  const auto add = [&out](uint32_t value) { out.append(reinterpret_cast<const char*>(&value), 4); };
  add(2);
  add(static_cast<uint32_t>(12 + 8 + json.size() + 8 + bin.size()));
  add(static_cast<uint32_t>(json.size()));
  out += "JSON" + json;
  add(static_cast<uint32_t>(bin.size()));
  return out + std::string("BIN\0", 4) + bin;
}

// Of text without damage.
std::string decodedBase64(const std::string& text) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bits, bytes;
  for (const char c : text.substr(0, text.find('=')))
    for (int bit = 5; bit >= 0; --bit) bits += alphabet.find(c) >> bit & 1 ? '1' : '0';
  for (size_t i = 0; i + 8 <= bits.size(); i += 8)
    bytes += static_cast<char>(std::stoi(bits.substr(i, 8), nullptr, 2));
  return bytes;
}

// `loden validate` finds the scene invalid and says this number.
void expectIssue(const std::string& scene, int id) {
  const ToolRun run = loden({"validate", scene, "--format", "json"});
  EXPECT_EQ(run.exit_code, 3) << run.err;
  const Json json = Json::parse(run.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << run.out;
  bool found = false;
  for (const Json& issue : json["issues"]) found |= issue["id"] == id;
  EXPECT_TRUE(found) << id << " in " << run.out;
}

TEST(Pack, ByUri_KeepsEverythingElse) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  const ToolRun run = packTo(scratch, "packed.gltf", {"--scale", "8,4", "--rotation", "90"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  Json packed = Json::parse(fileText(scratch / "packed.gltf"));
  const Json before = Json::parse(fileText(scratch / "scene.gltf"));
  const Json extension = packed["materials"][0]["extensions"][kExtension];
  EXPECT_EQ(extension["asset"], 0);
  EXPECT_EQ(extension["scale"], Json({8.0, 4.0}));
  EXPECT_NEAR(extension["rotation"].get<double>(), 1.5707963, 1e-6);
  EXPECT_EQ(packed["extensions"][kExtension]["assets"][0]["uri"], "material.loden");
  EXPECT_TRUE(std::filesystem::exists(scratch / "material.loden"));
  EXPECT_TRUE(packed["materials"][0]["pbrMetallicRoughness"].contains("baseColorFactor"));
  EXPECT_EQ(packed["extensionsUsed"], Json({"VENDOR_thing", kExtension}));
  EXPECT_FALSE(packed.contains("extensionsRequired"));
  packed["materials"][0] = before["materials"][0];
  packed["extensionsUsed"] = before["extensionsUsed"];
  packed.erase("extensions");
  EXPECT_EQ(packed, before);
  EXPECT_EQ(loden({"validate", scratch / "packed.gltf"}).exit_code, 0);
}

TEST(Pack, OneScale_StandsForBothAxes) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  const ToolRun run = packTo(scratch, "packed.gltf", {"--scale", "4"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json packed = Json::parse(fileText(scratch / "packed.gltf"));
  EXPECT_EQ(packed["materials"][0]["extensions"][kExtension]["scale"], Json({4.0, 4.0}));

  for (const std::string wrong : {"four", "4,", "4,4,4"}) {
    const ToolRun refused = packTo(scratch, "refused.gltf", {"--scale", wrong});
    EXPECT_EQ(refused.exit_code, 1) << wrong << ": " << refused.err;
    EXPECT_NE(refused.err.find("--scale"), std::string::npos) << refused.err;
  }
}

TEST(Pack, ByPeriod_MeasuresTheTextureCoordinates) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  const ToolRun run = packTo(scratch, "packed.gltf", {"--period", "2cm", "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json report = Json::parse(run.out);
  EXPECT_NEAR(report["period"][0].get<double>(), 0.02, 1e-6);
  EXPECT_NEAR(report["period"][1].get<double>(), 0.02, 1e-6);
  EXPECT_NEAR(report["uv_stretch"].get<double>(), 1, 1e-6);
  const Json packed = Json::parse(fileText(scratch / "packed.gltf"));
  EXPECT_EQ(packed["materials"][0]["extensions"][kExtension]["scale"], Json({50.0, 50.0}));

  const ToolRun both = packTo(scratch, "b.gltf", {"--period", "2cm", "--scale", "2,2"});
  EXPECT_EQ(both.exit_code, 1) << both.err;
  const ToolRun without_unit = packTo(scratch, "c.gltf", {"--period", "2"});
  EXPECT_EQ(without_unit.exit_code, 1) << without_unit.err;
}

TEST(Pack, WithoutPeriod_SaysHowLargeATileComesOut) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  const ToolRun run = packTo(scratch, "packed.gltf");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("a tile is 1 m x 1 m"), std::string::npos) << run.out;
  EXPECT_NE(run.err.find("--period"), std::string::npos) << run.err;
}

TEST(Pack, FittedFallback_LeavesNothingOfTheOldLook) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  const ToolRun cook =
      loden({"cook", sharedBake(), "-o", scratch / "surface.loden", "--mode", "surface", "-q"});
  ASSERT_EQ(cook.exit_code, 0) << cook.err;
  Json scene = Json::parse(fileText(scratch / "scene.gltf"));
  scene["materials"][0] = Json::parse(R"({"name": "Cloth", "doubleSided": true, "alphaMode": "BLEND",
      "emissiveFactor": [1, 1, 1], "pbrMetallicRoughness": {"metallicFactor": 1},
      "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1}, "VENDOR_thing": {"x": 1}}})");
  writeText(scratch / "scene.gltf", scene.dump());
  const ToolRun run =
      loden({"pack", scratch / "scene.gltf", "--material", "Cloth", "--asset", scratch / "surface.loden",
             "--period", "10cm", "--fit-fallback", "-o", scratch / "packed.gltf"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json packed = Json::parse(fileText(scratch / "packed.gltf"));
  const Json material = packed["materials"][0];
  for (const char* gone : {"alphaMode", "emissiveFactor"}) EXPECT_FALSE(material.contains(gone)) << gone;
  EXPECT_FALSE(material["extensions"].contains("KHR_materials_clearcoat"));
  EXPECT_TRUE(material["extensions"].contains("VENDOR_thing"));
  EXPECT_EQ(material["doubleSided"], true);
  EXPECT_EQ(material["pbrMetallicRoughness"]["metallicFactor"], 0.0);
  for (const Json& use : {material["pbrMetallicRoughness"]["baseColorTexture"], material["normalTexture"]})
    EXPECT_EQ(use["extensions"]["KHR_texture_transform"]["scale"], Json({10.0, 10.0}));
  EXPECT_EQ(loden({"validate", scratch / "packed.gltf"}).exit_code, 0);
}

TEST(Pack, Twice_SharesTheAsset) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  ASSERT_EQ(packTo(scratch, "a.gltf").exit_code, 0);
  const ToolRun run = loden({"pack", scratch / "a.gltf", "--material", "Other", "--asset",
                             scratch / "material.loden", "-o", scratch / "b.gltf"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json packed = Json::parse(fileText(scratch / "b.gltf"));
  EXPECT_EQ(packed["extensions"][kExtension]["assets"].size(), 1u);
  EXPECT_EQ(packed["extensionsUsed"].size(), 2u);
}

TEST(Pack, EmbeddedInGlb_IsAlignedAndValid) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  Json scene = Json::parse(fileText(scratch / "scene.gltf"));
  scene["buffers"][0].erase("uri");
  writeText(scratch / "scene.glb", glbOf(scene.dump(), fileText(scratch / "scene.bin")));
  const ToolRun run = loden({"pack", scratch / "scene.glb", "--material", "Cloth", "--asset", sharedAsset(),
                             "-o", scratch / "out.glb", "--embed"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string bytes = fileText(scratch / "out.glb");
  EXPECT_EQ(u32At(bytes, 8), bytes.size());
  EXPECT_EQ(u32At(bytes, 12) % 4, 0u);
  const Json packed = Json::parse(bytes.substr(20, u32At(bytes, 12)));
  const Json asset = packed["extensions"][kExtension]["assets"][0];
  EXPECT_EQ(asset["mimeType"], "application/vnd.loden");
  const Json view = packed["bufferViews"][asset["bufferView"].get<size_t>()];
  const size_t begin = 20 + u32At(bytes, 12) + 8 + view["byteOffset"].get<size_t>();
  EXPECT_TRUE(bytes.substr(begin, view["byteLength"].get<size_t>()) == fileText(sharedAsset()));
  EXPECT_EQ(loden({"validate", scratch / "out.glb"}).exit_code, 0);
  // Fewer bytes than the first buffer declares: the asset is cut off, and with fewer still the mesh.
  for (const size_t left : {begin + 100, begin - 40}) {
    writeText(scratch / "cut.glb",
              glbOf(packed.dump(), bytes.substr(28 + u32At(bytes, 12), left - 28 - u32At(bytes, 12))));
    expectIssue(scratch / "cut.glb", 5020);
  }
}

TEST(Pack, EmbeddedInGltf_IsADataUriOfTheAssetsBytes) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  ASSERT_EQ(packTo(scratch, "out.gltf", {"--embed"}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(scratch / "material.loden"));
  EXPECT_EQ(loden({"validate", scratch / "out.gltf"}).exit_code, 0);
  Json packed = Json::parse(fileText(scratch / "out.gltf"));
  const Json view =
      packed["bufferViews"][packed["extensions"][kExtension]["assets"][0]["bufferView"].get<size_t>()];
  Json& uri = packed["buffers"][view["buffer"].get<size_t>()]["uri"];
  const std::string good = uri, head = "data:application/octet-stream;base64,";
  ASSERT_TRUE(good.starts_with(head)) << good.substr(0, 80);
  EXPECT_EQ(view["byteOffset"], 0);
  EXPECT_TRUE(decodedBase64(good.substr(head.size())) == fileText(sharedAsset()));
  std::string wrong_digit = good, no_digit = good;
  char& digit = wrong_digit[head.size() + (good.size() - head.size()) / 2];
  digit = digit == 'A' ? 'B' : 'A';
  no_digit[head.size() + 7] = '!';
  for (const auto& [damaged, id] :
       {std::pair{wrong_digit, 2005}, {no_digit, 5016}, {good.substr(0, head.size() + 400), 5020}}) {
    uri = damaged;
    writeText(scratch / "bad.gltf", packed.dump());
    expectIssue(scratch / "bad.gltf", id);
  }
}

TEST(Pack, ToAnotherFolder_TakesTheBuffersAlong) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  std::filesystem::create_directories(scratch / "far");
  ASSERT_EQ(packTo(scratch, "far/out.gltf").exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(scratch / "far/scene.bin"));
  EXPECT_TRUE(std::filesystem::exists(scratch / "far/material.loden"));
}

TEST(Pack, SecondAssetOfTheSameName_GetsANameOfItsOwn) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  const ScratchFolder elsewhere;  // outside the scene's folder: the asset is copied
  const std::string other = elsewhere / "material.loden";
  ASSERT_EQ(packTo(scratch, "first.gltf").exit_code, 0);
  ASSERT_EQ(loden({"cook", sharedBake(), "-o", other, "--mode", "surface", "-q"}).exit_code, 0);
  for (int times = 0; times < 2; ++times) {
    const ToolRun run = loden({"pack", scratch / "first.gltf", "--material", "Other", "--asset", other, "-o",
                               scratch / "second.gltf"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  EXPECT_EQ(fileText(scratch / "material.loden"), fileText(sharedAsset()));
  const Json assets = Json::parse(fileText(scratch / "second.gltf"))["extensions"][kExtension]["assets"];
  ASSERT_EQ(assets.size(), 2u);
  EXPECT_EQ(fileText(scratch / assets[1]["uri"].get<std::string>()), fileText(other));
  EXPECT_EQ(loden({"validate", scratch / "second.gltf"}).exit_code, 0);
}

TEST(Pack, OtherFileInTheWay_IsRefused) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  std::filesystem::create_directories(scratch / "far");
  writeText(scratch / "far/scene.bin", "mine");
  const ToolRun run = packTo(scratch, "far/out.gltf");
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_EQ(fileText(scratch / "far/scene.bin"), "mine");
  EXPECT_FALSE(std::filesystem::exists(scratch / "far/material.loden"));
}

TEST(Pack, MembersOfAnotherType_AreIssuesWithTheirPlace) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  std::filesystem::create_directories(scratch / "far");
  const std::string good = fileText(scratch / "scene.gltf");
  struct Case {
    std::string from, to, place;
  };
  const std::vector<Case> cases{
      {"\"name\": \"Cloth\"", "\"name\": 5", "materials[0].name"},
      {"\"name\": \"Cloth\"", "\"name\": \"Cloth\", \"extensions\": []", "materials[0].extensions"},
      {"\"scene\": 0", "\"extensions\": []", "extensions"},
      {"\"scene\": 0", "\"extensions\": {\"LODEN_materials_flat_btf\": 3}",
       "extensions.LODEN_materials_flat_btf"},
      {"\"uri\": \"scene.bin\"", "\"uri\": 5", "buffers[0].uri"},
      {"[\"VENDOR_thing\"]", "{}", "extensionsUsed"},
      {"\"scene\": 0", "\"images\": [4]", "images[0]"},
      {"\"scene\": 0", "\"samplers\": {}", "samplers"},
      {"\"scene\": 0", "\"textures\": 3", "textures"},
  };
  for (const auto& [from, to, place] : cases) {
    SCOPED_TRACE(to);
    std::string text = good;
    ASSERT_NE(text.find(from), std::string::npos);
    writeText(scratch / "scene.gltf", text.replace(text.find(from), from.size(), to));
    const ToolRun pack = packTo(scratch, "far/out.gltf"),
                  validate = loden({"validate", scratch / "scene.gltf", "--format", "json"});
    EXPECT_EQ(pack.exit_code, 3) << pack.err;
    EXPECT_NE(pack.err.find(place + ": "), std::string::npos) << pack.err;
    EXPECT_TRUE(std::filesystem::is_empty(scratch / "far"));
    EXPECT_EQ(validate.exit_code, 3) << validate.err;
    const Json issues = Json::parse(validate.out, nullptr, false)["issues"];
    bool found = false;
    for (const Json& issue : issues)
      found |= issue["id"] == 5014 && issue.dump().find(place) != std::string::npos;
    EXPECT_TRUE(found) << validate.out;
  }
}

TEST(Pack, UnknownMaterial_NamesTheKnownOnes) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  const ToolRun run = loden({"pack", scratch / "scene.gltf", "--material", "Clot", "--asset", sharedAsset(),
                             "-o", scratch / "out.gltf"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("'Cloth'"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "out.gltf"));
}

TEST(Pack, TexCoordsThatAMeshLacks_AreRefusedByPlace) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  const ToolRun run = packTo(scratch, "out.gltf", {"--texcoord", "3"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("meshes[0].primitives[0]"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "out.gltf"));
}

TEST(Pack, MissingFolder_IsRefused) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  EXPECT_EQ(packTo(scratch, "none/out.gltf").exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(scratch / "none"));
}

TEST(Pack, BrokenAsset_IsRefused) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  writeText(scratch / "bad.loden", "no asset");
  const ToolRun run = loden({"pack", scratch / "scene.gltf", "--material", "Cloth", "--asset",
                             scratch / "bad.loden", "-o", scratch / "out.gltf"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(scratch / "out.gltf"));
}

TEST(Validate, HostileScenes_AreIssuesNotCrashes) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  ASSERT_EQ(packTo(scratch, "good.gltf").exit_code, 0);
  const std::string good = fileText(scratch / "good.gltf");
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  };
  const std::vector<std::pair<std::string, int>> cases{
      {std::string(20000, '[') + std::string(20000, ']'), 5002},
      {"{", 5001},
      {replaced("\"material.loden\"", "\"../../etc/passwd\""), 5003},
      {replaced("\"material.loden\"", "\"missing.loden\""), 1001},
      {replaced("\"asset\": 0", "\"asset\": 7"), 5061},
      {replaced("\"asset\": 0", "\"asset\": -1"), 5061},
      {replaced("\"count\": 3", "\"count\": 1000000"), 5029},
      {replaced("\"byteLength\": 24", "\"byteLength\": 9007199254740991"), 5023},
      {replaced("\"byteLength\": 60", "\"byteLength\": 61"), 5020},
      {replaced("\"uri\": \"scene.bin\",", ""), 5021},
      {replaced("\"scene.bin\"", "\"../scene.bin\""), 5003},
      {replaced("\"scene.bin\"", "\"missing.bin\""), 1001},
      {replaced("\"buffers\"", "\"images\": [{\"uri\": \"/etc/passwd\"}], \"buffers\""), 5018},
      {replaced("\"buffers\"", "\"images\": [{\"uri\": \"missing.png\"}], \"buffers\""), 1001},
      {replaced("\"extensionsUsed\"", "\"extensionsUsedNot\""), 5066},
      {replaced("\"extensionsUsed\"", "\"extensionsRequired\": [\"X\"], \"extensionsUsed\""), 5005},
  };
  // Required, but known: the runtime loads them.
  writeText(
      scratch / "known.gltf",
      replaced(
          "\"extensionsUsed\"",
          R"("extensionsRequired": ["KHR_lights_punctual", "KHR_mesh_quantization"], "extensionsUsed")"));
  const ToolRun known = loden({"validate", scratch / "known.gltf"});
  EXPECT_EQ(known.exit_code, 0) << known.out;
  for (const auto& [text, id] : cases) {
    writeText(scratch / "bad.gltf", text);
    expectIssue(scratch / "bad.gltf", id);
  }
}

}  // namespace
}  // namespace loden::test
