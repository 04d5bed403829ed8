// The verbs that read and write materials, on real and on damaged files.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "material/base/issues.h"
#include "tests/cli/run_with.h"
#include "tests/unit/asset_faults.h"

namespace loden::test {
namespace {

using Json = nlohmann::json;

TEST(Bake, TileTooCoarseToParameterize_IsInvalidInput) {
  const ScratchFolder scratch;
  writeText(scratch / "tile.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
  const ToolRun run = loden({"bake", scratch / "tile.obj", "-o", scratch / "out", "-q"});
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_NE(run.err.find("tile.obj"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "out"));
}

TEST(Bake, GltfTooCoarseToParameterize_IsInvalidInput) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  std::string text = fileText(scratch / "scene.gltf");
  text.replace(text.find(", \"TEXCOORD_0\": 1"), 17, "");
  writeText(scratch / "scene.gltf", text);
  const ToolRun run = loden({"bake", scratch / "scene.gltf", "-o", scratch / "out", "-q"});
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_NE(run.err.find("TEXCOORD_0"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "out"));
}

TEST(Bake, NonFiniteVertices_AreInvalidInput) {
  const ScratchFolder scratch;
  writeText(scratch / "tile.obj", "v nan 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n");
  const ToolRun run = loden({"bake", scratch / "tile.obj", "-o", scratch / "out", "-q"});
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "out"));
}

TEST(Bake, FixNonfinite_RepairsAndReports) {
  const ScratchFolder scratch;
  constexpr int kSide = 8;
  std::string text;
  for (int t = 0; t <= (kSide + 1) * (kSide + 1) - 1; ++t) {
    const std::string x = std::to_string(t % (kSide + 1) / double(kSide)),
                      y = std::to_string(t / (kSide + 1) / double(kSide));
    text += "v " + x + " " + (t == 40 ? std::string("nan") : y) + " 0\nvt " + x + " " + y + "\n";
  }
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      text += "f";
      for (const int corner : {0, 1, kSide + 2, kSide + 1}) {
        const std::string v = std::to_string(j * (kSide + 1) + i + corner + 1);
        text += " " + v + "/" + v;
      }
      text += "\n";
    }
  writeText(scratch / "tile.obj", text);
  const std::vector<std::string> bake{"bake", scratch / "tile.obj", "-o",  scratch / "out", "--size",
                                      "4",    "--directions",       "2x2", "--supersample", "1"};
  const ToolRun refused = loden(bake);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("line 81: 1 of 81"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("--fix-nonfinite"), std::string::npos) << refused.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "out"));
  auto fix = bake;
  fix.insert(fix.end(), {"--fix-nonfinite", "--format", "json"});
  const ToolRun repaired = loden(fix);
  ASSERT_EQ(repaired.exit_code, 0) << repaired.err;
  EXPECT_NE(repaired.err.find("not finite: 1, first"), std::string::npos) << repaired.err;
  EXPECT_EQ(Json::parse(repaired.out)["repaired"]["count"], 1);
  fix.back() = "text", fix.push_back("-q");
  EXPECT_EQ(loden(fix).err, "");
}

TEST(Bake, WhatIsNotBaked_IsWarnedOf) {
  const ScratchFolder scratch;
  writeText(scratch / "m.mtl", "newmtl cloth\nmap_Kd weave.png\n");
  writeText(scratch / "tile.obj",
            "mtllib m.mtl\nusemtl cloth\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 "
            "1\nf 1/1 2/2 3/3 4/4\n");
  std::vector<std::string> bake{"bake", scratch / "tile.obj", "-o",  scratch / "out", "--size",
                                "4",    "--directions",       "2x2", "--format",      "json"};
  const ToolRun run = loden(bake);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("m.mtl: line 2, material 'cloth': map_Kd is not baked"), std::string::npos)
      << run.err;
  EXPECT_EQ(Json::parse(run.out)["warnings"].size(), 1u);
  bake.push_back("-q");
  EXPECT_EQ(loden(bake).err, "");
  writeText(scratch / "m.mtl", "newmtl cloth\nKd 2 2 2\n");
  EXPECT_EQ(loden(bake).exit_code, 3);
}

TEST(Bake, ConcentricVdim_IsStoredAndExtracted) {
  const ScratchFolder scratch;
  const std::vector<std::string> bake{"bake", "builtin:pulli", "-o",  scratch / "out", "--size",
                                      "4",    "--directions",  "2x2", "--supersample", "1",
                                      "-q"};
  auto with = bake;
  with.insert(with.end(), {"--vdim", "concentric:3,latlong:4x5"});
  ASSERT_EQ(loden(with).exit_code, 0);
  const ToolRun depths = loden({"extract", scratch / "out", "--map", "vdim.concentric:3", "-o",
                                scratch / "depths.exr", "--format", "json"});
  ASSERT_EQ(depths.exit_code, 0) << depths.err;
  EXPECT_EQ(Json::parse(depths.out)["width"], 12);
  EXPECT_EQ(Json::parse(depths.out)["height"], 12);
  EXPECT_EQ(loden({"extract", scratch / "out", "--map", "vdim.latlong:4x5", "-o", scratch / "latlong.exr"})
                .exit_code,
            0);
  EXPECT_EQ(
      loden({"extract", scratch / "out", "--map", "geometry", "-o", scratch / "geometry.exr"}).exit_code, 0);
  const ToolRun wrong =
      loden({"extract", scratch / "out", "--map", "vdim.concentric:4", "-o", scratch / "wrong.exr"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_NE(wrong.err.find("vdim.concentric:3"), std::string::npos) << wrong.err;
  for (const char* bad :
       {"concentric:0", "concentric:257", "concentric:3x3", "latlong:1x4", "latlong:4x999", "cube:4"}) {
    auto refused = bake;
    refused.insert(refused.end(), {"--vdim", bad});
    EXPECT_EQ(loden(refused).exit_code, 1) << bad;
  }
}

TEST(Bake, MalformedNumber_IsInvalidInputWithItsLine) {
  const ScratchFolder scratch;
  const std::vector<std::pair<std::string, std::string>> cases{
      {"v 0 0 0\nv 1 0,5 0\n", "line 2"},
      {"v 0 0\n", "line 1"},
      {"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3x\n", "line 4"}};
  for (const auto& [text, line] : cases) {
    writeText(scratch / "tile.obj", text);
    const ToolRun run = loden({"bake", scratch / "tile.obj", "-o", scratch / "out", "-q"});
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_NE(run.err.find(line), std::string::npos) << run.err;
  }
}

TEST(Bake, FolderThatIsNoBake_IsLeftAlone) {
  const ScratchFolder scratch;
  std::filesystem::create_directories(scratch / "out/surface");
  writeText(scratch / "out/surface/notes.txt", "mine");
  const ToolRun run =
      loden({"bake", "builtin:pulli", "-o", scratch / "out", "--size", "4", "--supersample", "1", "-q"});
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_EQ(fileText(scratch / "out/surface/notes.txt"), "mine");
  EXPECT_FALSE(std::filesystem::exists(scratch / "out/btf"));
}

TEST(Bake, ListOption_LeavesTheTileAlone) {
  const ScratchFolder scratch;
  const ToolRun run = loden({"bake", "--maps", "surface", "--maps", "vdim,btf", "builtin:pulli", "-o",
                             scratch / "out", "--size", "4", "--supersample", "1", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_FALSE(std::filesystem::is_empty(scratch / "out/surface"));
  EXPECT_FALSE(std::filesystem::is_empty(scratch / "out/btf"));
  EXPECT_TRUE(std::filesystem::is_empty(scratch / "out/flat"));
}

TEST(Cook, ThreadCount_DoesNotChangeTheBytes) {
  const ScratchFolder scratch;
  for (const std::string mode : {"lod", "surface", "fused"}) {
    std::string first;
    for (const char* threads : {"1", "2", "8"}) {
      const std::string asset = scratch / (mode + threads + ".loden");
      ASSERT_EQ(
          loden({"cook", sharedBake(), "-o", asset, "--mode", mode, "--threads", threads, "-q"}).exit_code, 0)
          << mode;
      if (first.empty()) first = fileText(asset);
      EXPECT_TRUE(fileText(asset) == first) << mode << ", " << threads << " threads";
    }
  }
}

TEST(Bake, ThreadCount_DoesNotChangeTheBytes) {
  const ScratchFolder scratch;
  for (const char* threads : {"1", "2", "8"})
    ASSERT_EQ(loden(smallBake(scratch / threads, {"--threads", threads})).exit_code, 0);
  const auto one = filesIn(scratch / "1");
  EXPECT_GT(one.size(), 20u);
  EXPECT_TRUE(filesIn(scratch / "2") == one);
  EXPECT_TRUE(filesIn(scratch / "8") == one);
}

TEST(Bake, BonnLayout_CooksLikeTheBake) {
  const ScratchFolder scratch;
  const std::string bake = scratch / "bake", from_bake = scratch / "a.loden",
                    from_images = scratch / "b.loden";
  ASSERT_EQ(loden({"bake", "builtin:pulli", "-o", bake, "--size", "8", "--supersample", "1", "--layout",
                   "bonn", "--encoding", "hdr", "-q"})
                .exit_code,
            0);
  ASSERT_EQ(loden({"cook", bake, "-o", from_bake, "--mode", "lod", "-q"}).exit_code, 0);
  const ToolRun cook = loden({"cook", scratch / "bake/bonn", "-o", from_images, "--mode", "lod"});
  ASSERT_EQ(cook.exit_code, 0) << cook.err;
  EXPECT_NE(cook.err.find("reciprocity slope"), std::string::npos) << cook.err;
  // RGBE keeps 8 bits of the largest channel.
  EXPECT_EQ(loden({"compare", from_bake, from_images, "--fail", "0.01", "--every", "9", "-q"}).exit_code, 0);
  ASSERT_EQ(loden({"bake", "builtin:sponge", "-o", bake, "--size", "4", "--directions", "2x2",
                   "--supersample", "1", "-q"})
                .exit_code,
            0);
  EXPECT_FALSE(std::filesystem::exists(scratch / "bake/bonn")) << "images of another tile";
}

TEST(Info, Text_SaysWhichLookupTheCookerChoseAndItsError) {
  const ScratchFolder scratch;
  ASSERT_EQ(loden({"cook", sharedBake(), "-o", scratch / "m.loden", "--mode", "surface", "-q"}).exit_code, 0);
  const ToolRun text = loden({"info", scratch / "m.loden"}),
                json = loden({"info", scratch / "m.loden", "--format", "json"});
  const Json lookup = Json::parse(json.out)["cook"]["lookup"];
  char line[60];
  std::snprintf(line, sizeof line, "lookup default  mean error %.3f texels",
                lookup["default"]["mean_texels"].get<double>());
  EXPECT_NE(text.out.find(line), std::string::npos) << text.out;
  const size_t chosen = text.out.find(", chosen");
  ASSERT_NE(chosen, std::string::npos) << text.out;
  EXPECT_EQ(text.out.find(", chosen", chosen + 1), std::string::npos) << "one of those tried";
}

TEST(Info, CutAsset_ShowsWhatItCanAndFails) {
  const ScratchFolder scratch;
  const std::string bytes = fileText(sharedAsset());
  writeText(scratch / "cut.loden", bytes.substr(0, bytes.size() / 2));
  const ToolRun info = loden({"info", scratch / "cut.loden", "--format", "json"});
  EXPECT_EQ(info.exit_code, 3);
  const Json json = Json::parse(info.out, nullptr, false);
  ASSERT_TRUE(json.is_object());
  EXPECT_FALSE(json["issues"].empty());
  EXPECT_EQ(json["mode"], "lod");
  EXPECT_EQ(loden({"validate", scratch / "cut.loden"}).exit_code, 3);
  EXPECT_EQ(loden({"extract", scratch / "cut.loden", "-o", scratch / "o.exr", "--map", "band0.weights"})
                    .exit_code != 0,
            true);
  EXPECT_FALSE(std::filesystem::exists(scratch / "o.exr"));
}

// The notes' own checksum holds in these.
TEST(Info, UnreadableNotes_AreNamed) {
  const ScratchFolder scratch;
  int tried = 0;
  for (const AssetFault& fault : assetFaults()) {
    if (fault.id != issue_id::kMetaText) continue;
    ++tried;
    writeText(scratch / "m.loden",
              std::string(reinterpret_cast<const char*>(fault.file.data()), fault.file.size()));
    const ToolRun info = loden({"info", scratch / "m.loden", "--format", "json"});
    EXPECT_EQ(info.exit_code, 3) << fault.what;
    const Json json = Json::parse(info.out, nullptr, false);
    ASSERT_TRUE(json.is_object());
    ASSERT_EQ(json["issues"].size(), 1u) << fault.what;
    EXPECT_EQ(json["issues"][0]["id"], fault.id) << fault.what;
    EXPECT_FALSE(json["maps"].empty()) << "the rest is shown";
  }
  EXPECT_GT(tried, 0);
}

TEST(Validate, DamagedByte_IsFoundAndNumbered) {
  const ScratchFolder scratch;
  std::string bytes = fileText(sharedAsset());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x40);
  writeText(scratch / "bad.loden", bytes);
  const ToolRun run = loden({"validate", scratch / "bad.loden", "--format", "json"});
  EXPECT_EQ(run.exit_code, 3);
  const Json json = Json::parse(run.out, nullptr, false);
  ASSERT_TRUE(json.is_object());
  EXPECT_FALSE(json["valid"].get<bool>());
  EXPECT_GE(json["issues"][0]["id"].get<int>(), 2000);
}

TEST(Validate, SomethingElse_IsInvalid) {
  const ScratchFolder scratch;
  writeText(scratch / "text.loden", "this is no asset");
  EXPECT_EQ(loden({"validate", scratch / "text.loden"}).exit_code, 3);
  EXPECT_EQ(loden({"info", scratch / "text.loden"}).exit_code, 3);
  writeText(scratch / "empty.loden", "");
  EXPECT_EQ(loden({"validate", scratch / "empty.loden"}).exit_code, 3);
}

TEST(Compare, BakeAgainstItself_IsZero) {
  const ToolRun run =
      loden({"compare", sharedBake(), sharedBake(), "--fail", "0", "--every", "5", "--format", "json", "-q"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["all"]["y"]["rmse"], 0);
  EXPECT_EQ(json["flip"]["mean"], 0);
  EXPECT_GT(json["all"]["samples"], 0);
}

TEST(Compare, AboveTheLimit_IsDifference) {
  EXPECT_EQ(loden({"compare", sharedBake(), sharedAsset(), "--fail", "1e-9", "--every", "9", "-q"}).exit_code,
            7);
  EXPECT_EQ(loden({"compare", sharedBake(), sharedAsset(), "--fail", "10", "--every", "9", "-q"}).exit_code,
            0);
}

TEST(Compare, AssetAgainstItself_IsZero) {
  EXPECT_EQ(loden({"compare", sharedAsset(), sharedAsset(), "--fail", "0", "--every", "20", "-q"}).exit_code,
            0);
}

TEST(Extract, DecodedSlice_ResemblesTheTrueOne) {
  const ScratchFolder scratch;
  const std::vector<std::string> directions{"--light", "30,60", "--view", "45,40"};
  auto truth = directions, decoded = directions;
  truth.insert(truth.begin(), {"extract", sharedBake(), "-o", scratch / "true.exr"});
  decoded.insert(decoded.begin(), {"extract", sharedAsset(), "-o", scratch / "decoded.exr"});
  ASSERT_EQ(loden(truth).exit_code, 0);
  ASSERT_EQ(loden(decoded).exit_code, 0);
  // Measured: 0.043 for the same directions (the material is a fit), 0.11 and more for a wrong light or view.
  const std::string limit = "0.07";
  EXPECT_EQ(
      loden({"compare", scratch / "true.exr", scratch / "decoded.exr", "--fail", limit, "-q"}).exit_code, 0);
  ASSERT_EQ(
      loden({"extract", sharedAsset(), "-o", scratch / "wrong.exr", "--light", "30,240", "--view", "45,40"})
          .exit_code,
      0);
  EXPECT_EQ(loden({"compare", scratch / "true.exr", scratch / "wrong.exr", "--fail", limit, "-q"}).exit_code,
            7);
}

// An asset that has all that lookups read, one without the published map, and one that has nothing to look
// up.
TEST(Extract, EveryLookup_IsTakenOrSaysWhatItNeeds) {
  const ScratchFolder scratch;
  const std::string all = scratch / "all.loden", game = scratch / "game.loden", lod = scratch / "lod.loden",
                    slice = scratch / "slice.exr";
  ASSERT_EQ(loden({"cook", sharedBake(), "-o", all, "--mode", "surface", "--preset", "seed", "-q"}).exit_code,
            0);
  ASSERT_EQ(loden({"cook", sharedBake(), "-o", game, "--mode", "surface", "-q"}).exit_code, 0);
  ASSERT_EQ(loden({"cook", sharedBake(), "-o", lod, "--mode", "lod", "-q"}).exit_code, 0);
  for (const char* lookup : {"none", "paper", "fast", "default", "quality"}) {
    EXPECT_EQ(loden({"extract", all, "--view", "40,30", "--lookup", lookup, "-o", slice}).exit_code, 0)
        << lookup;
    EXPECT_EQ(loden({"extract", lod, "--view", "40,30", "--lookup", lookup, "-o", slice}).exit_code, 0)
        << lookup;
    std::filesystem::remove(slice);
    const bool needs = lookup == std::string("paper");
    const ToolRun run = loden({"extract", game, "--lookup", lookup, "-o", slice}),
                  compared = loden({"compare", all, game, "--lookup", lookup, "--every", "27", "-q"});
    for (const ToolRun* r : {&run, &compared}) {
      EXPECT_EQ(r->exit_code, needs ? 1 : 0) << lookup;
      EXPECT_EQ(r->err.find(game + ": cannot be looked up by --lookup paper") != std::string::npos, needs)
          << r->err;
    }
    EXPECT_EQ(std::filesystem::exists(slice), !needs) << lookup;
  }
}

TEST(Extract, HighestLambda_IsOneTexel) {
  const ScratchFolder scratch;
  const ToolRun run =
      loden({"extract", sharedAsset(), "-o", scratch / "o.exr", "--lambda", "32", "--format", "json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Json::parse(run.out)["width"], 1);
}

TEST(Extract, UnwritablePicture_LeavesNothing) {
  const ScratchFolder scratch;
  std::filesystem::create_directories(scratch / "o.exr/full");  // cannot be renamed over
  EXPECT_EQ(loden({"extract", sharedAsset(), "-o", scratch / "o.exr"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(scratch / "o.tmp.exr"));
}

TEST(Extract, BothDomainsAndMaps_AreWritten) {
  const ScratchFolder scratch;
  EXPECT_EQ(loden({"extract", sharedBake(), "-o", scratch / "flat.exr", "--domain", "flat"}).exit_code, 0);
  EXPECT_EQ(loden({"extract", sharedAsset(), "-o", scratch / "flat2.png", "--domain", "flat"}).exit_code, 0);
  EXPECT_EQ(loden({"extract", sharedBake(), "-o", scratch / "normal.exr", "--map", "normal"}).exit_code, 0);
  EXPECT_EQ(
      loden({"extract", sharedAsset(), "-o", scratch / "weights.exr", "--map", "band0.weights"}).exit_code,
      0);
  for (const char* name : {"flat.exr", "flat2.png", "normal.exr", "weights.exr"})
    EXPECT_TRUE(std::filesystem::exists(scratch / name)) << name;
}

TEST(Trace, SameSeed_SamePictureAtAnyThreadCount) {
  const ScratchFolder scratch;
  for (const std::string surface : {"plane", "cylinder", "sphere"}) {
    const std::vector<std::string> common{"--surface", surface, "--size", "40x30", "--spp", "4", "-q"};
    for (const std::string threads : {"1", "2"}) {
      std::vector<std::string> arguments{
          "trace", "builtin:sponge", "-o", scratch / (surface + threads + ".exr"), "--threads", threads};
      arguments.insert(arguments.end(), common.begin(), common.end());
      ASSERT_EQ(loden(arguments).exit_code, 0);
    }
    EXPECT_EQ(
        loden({"compare", scratch / (surface + "1.exr"), scratch / (surface + "2.exr"), "--fail", "0", "-q"})
            .exit_code,
        0);
  }
}

TEST(Trace, EveryNumberOfSamples_IsTaken) {
  const ScratchFolder scratch;
  for (const std::string samples : {"1", "2", "3", "4"})
    ASSERT_EQ(loden({"trace", "builtin:pulli", "-o", scratch / (samples + ".exr"), "--size", "8x6", "--spp",
                     samples, "-q"})
                  .exit_code,
              0);
  EXPECT_EQ(loden({"compare", scratch / "1.exr", scratch / "2.exr", "--fail", "0", "-q"}).exit_code, 7);
  EXPECT_EQ(loden({"compare", scratch / "3.exr", scratch / "4.exr", "--fail", "0", "-q"}).exit_code, 7);
}

TEST(Trace, CameraThatLooksAlongItsUp_IsRefused) {
  const ScratchFolder scratch;
  writeText(scratch / "camera.json", R"({"position": [0, 0, 1], "target": [0, 0, 0]})");
  const ToolRun run = loden({"trace", "builtin:pulli", "-o", scratch / "o.exr", "--size", "8x6", "--camera",
                             scratch / "camera.json"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("\"up\""), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "o.exr"));
  writeText(scratch / "camera.json", R"({"position": [0, 0, 1], "target": [0, 0, 0], "up": [0, 1, 0]})");
  EXPECT_EQ(loden({"trace", "builtin:pulli", "-o", scratch / "o.exr", "--size", "8x6", "--camera",
                   scratch / "camera.json", "-q"})
                .exit_code,
            0);
}

#ifdef LODEN_WALK
// From a centimetre above everything lies nearer than a room's near plane.
TEST(Walk, CloseCamera_SeesWhatTraceSees) {
  const ScratchFolder scratch;
  ASSERT_EQ(loden({"bake", "builtin:pulli", "-o", scratch / "bake", "--size", "16", "--directions", "3x3",
                   "--supersample", "1", "-q"})
                .exit_code,
            0);
  ASSERT_EQ(loden({"cook", scratch / "bake", "-o", scratch / "a.loden", "--mode", "surface", "-q"}).exit_code,
            0);
  writeText(scratch / "camera.json", R"({"position": [0, 0, 0.01], "target": [0, 0, 0], "up": [0, 1, 0]})");
  const std::vector<std::string> common{
      "--surface", "plane", "--camera", scratch / "camera.json", "--light", "10,0", "--size", "32x32", "-q"};
  std::vector<std::string> trace{"trace", "builtin:pulli", "-o", scratch / "truth.png", "--spp", "4"};
  std::vector<std::string> walk{"--asset", scratch / "a.loden", "--headless", "--capture", scratch / "walk"};
  trace.insert(trace.end(), common.begin(), common.end());
  walk.insert(walk.end(), common.begin(), common.end());
  ASSERT_EQ(loden(trace).exit_code, 0);
  const ToolRun drawn = runTool(LODEN_WALK, walk);
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  const ToolRun run =
      loden({"compare", scratch / "truth.png", scratch / "walk/frame_0000.png", "--format", "json", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const double psnr = nlohmann::json::parse(run.out, nullptr, false)["all"]["psnr_db"];
  EXPECT_GT(psnr, 15) << "a black picture is at some 10";
}

// The same picture as of the packed scene, which the same period laid out.
TEST(Walk, AnAssetIsWornWithoutPacking) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  ASSERT_EQ(loden({"pack", scratch / "scene.gltf", "--material", "Cloth", "--asset", sharedAsset(),
                   "--period", "20cm", "-o", scratch / "packed.gltf", "-q"})
                .exit_code,
            0);
  const std::vector<std::string> common{"--headless", "--size", "32x32", "-q", "--capture"};
  const auto draw = [&](const char* folder, std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), common.begin(), common.end());
    arguments.push_back(scratch / folder);
    const ToolRun run = runTool(LODEN_WALK, arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return scratch / folder / "frame_0000.png";
  };
  const auto packed = draw("a", {scratch / "packed.gltf"});
  const auto worn = draw(
      "b", {scratch / "scene.gltf", "--material", "Cloth", "--asset", sharedAsset(), "--period", "20cm"});
  const ToolRun run = loden({"compare", packed, worn, "--format", "json", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_LT(nlohmann::json::parse(run.out)["flip"]["mean"].get<double>(), 0.05)
      << "but for flat normals, which files without normals have";

  const ToolRun unknown = runTool(
      LODEN_WALK, {scratch / "scene.gltf", "--material", "Sofa", "--asset", sharedAsset(), "--headless"});
  EXPECT_NE(unknown.exit_code, 0);
  EXPECT_NE(unknown.err.find("'Cloth'"), std::string::npos) << unknown.err;
}

TEST(Walk, TurntablesAreFilmed) {
  const ScratchFolder scratch;
  const ToolRun run = runTool(LODEN_WALK, {sharedAsset(), "--turntable", "3", "--size", "33x24", "--film",
                                           scratch / "film", "--report", scratch / "report.json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("--period"), std::string::npos) << "the asset does not say how long its tile is";
  const std::string first = fileText(scratch / "film/frame_0000.png");
  EXPECT_FALSE(first.empty());
  EXPECT_NE(first, fileText(scratch / "film/frame_0001.png"));
  EXPECT_TRUE(std::filesystem::exists(scratch / "film/frame_0002.png"));
  EXPECT_FALSE(std::filesystem::exists(scratch / "film/frame_0003.png"));
  const bool encoded = std::filesystem::exists(scratch / "film/film.mp4");
  EXPECT_EQ(encoded, run.out.find("film.mp4") != std::string::npos) << run.out;
  const auto report = nlohmann::json::parse(fileText(scratch / "report.json"));
  ASSERT_EQ(report["frames"].size(), 3u);
  EXPECT_EQ(report["frames"][2]["materials"].size(), 1u);
}

TEST(Walk, BadCameraScriptOrEnvironment_IsInvalidInputInWordsOfOurOwn) {
  const ScratchFolder scratch;
  const std::string file = scratch / "file";
  const auto walk = [&](const char* option, const std::string& text) {
    writeText(file, text);
    return runTool(LODEN_WALK, {"--asset", sharedAsset(), option, file, "--headless", "--frames", "1"});
  };
  const std::string good = R"("position": [0, 0, 1], "target": [0, 1, 0])";
  const std::vector<std::string> bad_cameras{"",
                                             "[",
                                             "[]",
                                             "3",
                                             "{}",
                                             R"({"position": [0, 0, 1]})",
                                             R"({"position": [0, 0], "target": [0, 1, 0]})",
                                             R"({"position": [0, 0, "x"], "target": [0, 1, 0]})",
                                             R"({"position": [0, 0, 1e999], "target": [0, 1, 0]})",
                                             R"({"position": [0, 0, 1], "target": [0, 0, 1]})",
                                             std::string("{").append(good) + R"(, "fov_degrees": "wide"})",
                                             std::string("{").append(good) + R"(, "fov_degrees": 180})",
                                             std::string("{").append(good) + R"(, "up": null})",
                                             std::string(100000, '[')};
  const std::vector<std::string> bad_scripts{
      "{}",
      R"({"keyframes": {}})",
      R"({"keyframes": []})",
      R"({"keyframes": [3]})",
      R"({"keyframes": [{)" + good + "}]}",
      R"({"keyframes": [{"t": null, )" + good + "}]}",
      R"({"keyframes": [{"t": 1, )" + good + R"(}, {"t": 1, )" + good + "}]}"};
  const std::vector<std::string> bad_panoramas{"", "#?RADIANCE\n",
                                               "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\nshort"};
  for (const auto& [option, texts] : {std::pair{"--camera", &bad_cameras},
                                      {"--camera", &bad_scripts},
                                      {"--script", &bad_scripts},
                                      {"--environment", &bad_panoramas}})
    for (const std::string& text : *texts) {
      const ToolRun run = walk(option, text);
      EXPECT_EQ(run.exit_code, 3) << option << " " << text.substr(0, 80) << ": " << run.err;
      EXPECT_NE(run.err.find(file), std::string::npos) << run.err;
      EXPECT_EQ(run.err.find("json.exception"), std::string::npos) << run.err;
    }
}
#endif

TEST(Trace, BadCamera_IsInvalidInputAndTheMessageShowsTheForm) {
  const ScratchFolder scratch;
  writeText(scratch / "camera.json", R"({"position": [0, 1]})");
  const ToolRun run =
      loden({"trace", "builtin:pulli", "-o", scratch / "o.exr", "--camera", scratch / "camera.json"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("fov_degrees"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "o.exr"));
}

}  // namespace
}  // namespace loden::test
