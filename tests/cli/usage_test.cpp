// What every verb promises: exit codes, streams, JSON, and no half-written output.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <future>
#include <nlohmann/json.hpp>

#include "tests/cli/loden_fixture.h"

namespace loden::test {
namespace {

const std::vector<std::string> kVerbs{"bake",    "cook", "info",  "validate", "extract",
                                      "compare", "pack", "trace", "study",    "doctor"};

TEST(Cli, NoVerb_IsUsage) {
  EXPECT_EQ(loden({}).exit_code, 1);
}

TEST(Cli, UnknownVerb_IsUsage) {
  EXPECT_EQ(loden({"frobnicate"}).exit_code, 1);
}

TEST(Cli, ValidateList_NamesEveryIssueInTextAndJson) {
  const ToolRun text = loden({"validate", "--list"}),
                json = loden({"validate", "--list", "--format", "json"});
  EXPECT_EQ(text.exit_code, 0);
  EXPECT_NE(text.out.find("2005 chunk-checksum"), std::string::npos) << text.out;
  const auto list = nlohmann::json::parse(json.out, nullptr, false);
  ASSERT_TRUE(list.is_object()) << json.out;
  EXPECT_EQ(list["schema"], "loden/validate-list/1");
  EXPECT_EQ(list["issues"].size(), size_t(std::count(text.out.begin(), text.out.end(), '\n')));
  EXPECT_EQ(loden({"validate"}).exit_code, 1);
}

TEST(Cli, VerbThatIsNearlyOne_IsSuggested) {
  for (const auto& [typed, meant] : {std::pair{"bak", "bake"},
                                     {"cokk", "cook"},
                                     {"inof", "info"},
                                     {"vaildate", "validate"},
                                     {"Pack", "pack"}}) {
    const ToolRun run = loden({typed});
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_NE(run.err.find(std::string("did you mean '") + meant + "'"), std::string::npos) << run.err;
  }
  EXPECT_EQ(loden({"frobnicate"}).err.find("did you mean"), std::string::npos);
}

#ifdef LODEN_WALK
TEST(Cli, EveryToolTellsTheSameVersion) {
  const ToolRun tool = loden({"--version"}), walk = runTool(LODEN_WALK, {"--version"});
  EXPECT_EQ(tool.exit_code, 0);
  EXPECT_EQ(walk.exit_code, 0);
  EXPECT_EQ(walk.out, "loden_walk" + tool.out.substr(std::string("loden").size()));
}
#endif

TEST(Cli, Help_NamesEveryVerb) {
  const ToolRun run = loden({"--help"});
  EXPECT_EQ(run.exit_code, 0);
  for (const std::string& verb : kVerbs)
    EXPECT_NE(run.out.find("\n  " + verb + " "), std::string::npos) << verb;
}

TEST(Cli, EveryVerb_HasHelpAndRefusesUnknownOptions) {
  for (const std::string& verb : kVerbs) {
    EXPECT_EQ(loden({verb, "--help"}).exit_code, 0) << verb;
    const ToolRun run = loden({verb, "--no-such-option"});
    EXPECT_EQ(run.exit_code, 1) << verb;
    EXPECT_TRUE(run.out.empty()) << verb;
    EXPECT_NE(run.err.find("--help"), std::string::npos) << run.err;
  }
}

TEST(Cli, MissingInput_IsIoErrorThatNamesTheFile) {
  const ScratchFolder scratch;
  const std::string none = scratch / "none.loden", out = scratch / "out.exr";
  const std::vector<std::vector<std::string>> runs{
      {"bake", scratch / "none.gltf", "-o", scratch / "out"},
      {"cook", scratch / "none", "-o", scratch / "out.loden"},
      {"info", none},
      {"validate", none},
      {"extract", none, "-o", out},
      {"compare", none, none},
      {"pack", scratch / "none.gltf", "--material", "m", "--asset", none, "-o", scratch / "out.gltf"},
      {"trace", scratch / "none.gltf", "-o", out},
  };
  for (const auto& arguments : runs) {
    const ToolRun run = loden(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments[0] << ": " << run.err;
    EXPECT_NE(run.err.find("none"), std::string::npos) << arguments[0] << ": " << run.err;
    EXPECT_TRUE(run.out.empty()) << arguments[0];
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
}

TEST(Cli, InputThatCannotBeRead_IsIoError) {
  const ScratchFolder scratch;
  const std::string picture = scratch / "picture.png";
  ASSERT_EQ(loden({"extract", sharedAsset(), "-o", picture}).exit_code, 0);
  const auto runs = [&](const std::string& stem) {
    return std::vector<std::vector<std::string>>{
        {"bake", stem + ".gltf", "-o", scratch / "out"},
        {"bake", stem + ".obj", "-o", scratch / "out"},
        {"info", stem + ".loden"},
        {"info", stem + ".gltf"},
        {"validate", stem + ".loden"},
        {"validate", stem + ".gltf"},
        {"pack", stem + ".glb", "--material", "m", "--asset", sharedAsset(), "-o", scratch / "out.glb"},
        {"trace", "builtin:pulli", "-o", scratch / "out.exr", "--camera", stem + ".json"},
        {"trace", "builtin:pulli", "-o", scratch / "out.exr", "--environment", stem + ".exr"},
        {"study", "view-coherence", "--tile", stem + ".obj", "--bakes", scratch / "bakes"},
    };
  };
  const auto fails = [](const std::vector<std::string>& arguments) {
    const ToolRun run = loden(arguments);
    EXPECT_EQ(run.exit_code, 2) << ::testing::PrintToString(arguments) << ": " << run.err;
    EXPECT_TRUE(run.out.empty()) << run.out;
  };
  for (const auto& arguments : runs(scratch / "missing")) fails(arguments);
  for (const char* extension : {"gltf", "glb", "obj", "loden", "json", "exr"})
    std::filesystem::create_directory(scratch / (std::string("folder.") + extension));
  for (const auto& arguments : runs(scratch / "folder")) fails(arguments);

  if (::geteuid() == 0) return;  // who may read everything
  for (const char* extension : {"gltf", "glb", "obj", "loden", "json", "exr", "png"}) {
    const std::string locked = scratch / (std::string("locked.") + extension);
    writeText(locked, "");
    std::filesystem::permissions(locked, std::filesystem::perms::none);
  }
  std::filesystem::create_directory(scratch / "locked");
  std::filesystem::permissions(scratch / "locked", std::filesystem::perms::none);
  for (const auto& arguments : runs(scratch / "locked")) fails(arguments);
  fails({"compare", picture, scratch / "locked.png"});
  fails({"compare", sharedAsset(), scratch / "locked.loden"});
  for (const char* name : {"locked", "locked.loden"}) {
    fails({"cook", scratch / name, "-o", scratch / "out.loden"});
    fails({"extract", scratch / name, "-o", scratch / "out.exr"});
  }
}

TEST(Cli, BadValues_AreUsage) {
  const ScratchFolder scratch;
  const std::string out = scratch / "out";
  const std::vector<std::vector<std::string>> runs{
      {"bake", "builtin:pulli", "-o", out, "--size", "-4"},
      {"bake", "builtin:pulli", "-o", out, "--directions", "bonn80"},
      {"bake", "builtin:pulli", "-o", out, "--maps", "btf,colour"},
      {"bake", "builtin:pulli", "-o", out, "--shard", "3/3"},
      {"cook", sharedBake(), "-o", out + ".txt"},
      {"cook", sharedBake(), "-o", out + ".loden", "--components", "8,2"},
      {"cook", sharedBake(), "-o", out + ".loden", "--max-bytes", "many"},
      {"extract", sharedAsset(), "-o", out + ".exr", "--light", "95,0"},
      {"extract", sharedAsset(), "-o", out + ".exr", "--map", "nothing"},
      {"extract", sharedAsset(), "-o", out + ".xyz"},
      {"trace", "builtin:pulli", "-o", out + ".exr", "--size", "800"},
      {"trace", "builtin:pulli", "-o", out + ".xyz", "--spp", "65536"},  // refused before an hour of work
      {"study", "no-such-study"},
      {"study"},
      {"bake", "builtin:pulli", "-o", out, "--layout", "bonn", "--shard", "0/2"},
      {"bake", "builtin:pulli", "-o", out, "--layout", "bonn", "--maps", "flat,vdim"},
      {"compare", sharedBake(), sharedAsset(), "--fail", "nan"},
      {"pack", scratch / "scene.gltf", "--material", "Cloth", "--asset", sharedAsset(), "-o", out + ".gltf",
       "--rotation", "inf"},
      {"extract", sharedAsset(), "-o", out + ".exr", "--lambda", "inf"},
      {"cook", sharedBake(), "-o", out + ".loden", "--target-rmse", "inf"},
      {"cook", sharedBake(), "-o", out + ".loden", "--target-rmse", "nan"},
      {"cook", sharedBake(), "-o", out + ".loden", "--mode", "lod", "--max-bytes", "600k"},
      {"cook", sharedBake(), "-o", out + ".loden", "--mode", "lod", "--levels", "16"},
      {"cook", sharedBake(), "-o", out + ".loden", "--mode", "lod", "--components", "4,2,0"},
      {"cook", sharedBake(), "-o", out + ".loden", "--mode", "surface", "--levels", "3"},
      {"cook", sharedBake(), "-o", out + ".loden", "--mode", "surface", "--components", "4,0,0"},
      {"cook", sharedBake(), "-o", out + ".loden", "--mode", "lod", "--components", "8,2,4"},
      {"cook", sharedBake(), "-o", out + ".loden", "--levels", "12"},
      {"cook", sharedBake(), "-o", out + ".loden", "--components", "4,2,4"},
      {"cook", sharedBake(), "-o", out + ".loden", "--components", "0,2,2", "--max-bytes", "600k"},
      {"cook", sharedBake(), "-o", out + ".loden", "--preset", "seed"},
      {"cook", sharedBake(), "-o", out + ".loden", "--components", "4,0,0", "--max-bytes", "600k"},
  };
  for (const auto& arguments : runs) {
    const ToolRun run = loden(arguments);
    EXPECT_EQ(run.exit_code, 1) << arguments[0] << " ... " << arguments.back() << ": " << run.err;
    EXPECT_FALSE(run.err.empty());
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
}

TEST(Cli, UnwritableOutput_IsIoError) {
  const ScratchFolder scratch;
  EXPECT_EQ(loden({"extract", sharedAsset(), "-o", scratch / "no/such/folder/out.exr"}).exit_code, 2);
  EXPECT_EQ(loden({"cook", sharedBake(), "-o", scratch / "no/such/folder/out.loden", "--mode", "lod", "-q"})
                .exit_code,
            2);
}

TEST(Cli, PictureThatIsNone_IsInvalidInput) {
  const ScratchFolder scratch;
  const std::string none = scratch / "none.png", small = scratch / "small.png", large = scratch / "large.png",
                    bake = scratch / "bake";
  writeText(none, "no picture");
  EXPECT_EQ(loden({"compare", none, none}).exit_code, 3);
  for (const auto& [picture, size] : {std::pair{small, "4x4"}, {large, "8x4"}})
    ASSERT_EQ(loden({"trace", "builtin:pulli", "-o", picture, "--size", size, "--spp", "1", "-q"}).exit_code,
              0);
  EXPECT_EQ(loden({"compare", small, large}).exit_code, 3);
  std::filesystem::copy(sharedBake(), bake, std::filesystem::copy_options::recursive);
  const auto view = scratch / "bake/btf/view_0000.exr";
  std::filesystem::copy_file(sharedBake() + "/visible/view_0000.png", view,
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(loden({"cook", bake, "-o", scratch / "m.loden", "--mode", "lod", "-q"}).exit_code,
            3);  // of another size
  writeText(view, "no picture");
  EXPECT_EQ(loden({"cook", bake, "-o", scratch / "m.loden", "--mode", "lod", "-q"}).exit_code, 3);
  std::filesystem::remove(view);
  EXPECT_EQ(loden({"cook", bake, "-o", scratch / "m.loden", "--mode", "lod", "-q"}).exit_code, 2);
}

TEST(Cli, MaterialAgainstPicture_IsUsage) {
  const ScratchFolder scratch;
  const std::string picture = scratch / "slice.png";
  ASSERT_EQ(loden({"extract", sharedAsset(), "-o", picture}).exit_code, 0);
  EXPECT_EQ(loden({"compare", sharedAsset(), picture}).exit_code, 1);
  EXPECT_EQ(loden({"compare", picture, sharedBake()}).exit_code, 1);
}

TEST(Cli, StdoutThatIsFull_IsIoError) {
  const std::string command = std::string(LODEN_TOOL) + " info " + sharedAsset() + " > /dev/full";
  const ToolRun run = runTool("/bin/sh", {"-c", command});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("standard output"), std::string::npos) << run.err;
}

TEST(Cli, OutOfMemory_IsRuntimeErrorWithARemedy) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers reserve more address space than the limit";
#endif
  const ScratchFolder scratch;
  const std::string out = scratch / "out.exr";
  // The picture alone takes 4 GiB.
  const std::string command = "ulimit -v 2000000; exec " + std::string(LODEN_TOOL) +
                              " trace builtin:pulli --size 16384x16384 --spp 1 -q -o " + out;
  const ToolRun run = runTool("/bin/sh", {"-c", command});
  EXPECT_EQ(run.exit_code, 4) << run.err;
  EXPECT_NE(run.err.find("memory"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(Cli, NewerFormat_IsUnsupported) {
  const ScratchFolder scratch;
  std::string bytes = fileText(sharedAsset());
  bytes[12] = 9;  // major version, behind the magic
  writeText(scratch / "new.loden", bytes);
  EXPECT_EQ(loden({"extract", scratch / "new.loden", "-o", scratch / "o.exr"}).exit_code, 5);
  EXPECT_EQ(loden({"compare", scratch / "new.loden", sharedAsset()}).exit_code, 5);
  EXPECT_EQ(loden({"validate", scratch / "new.loden"}).exit_code, 3);
}

TEST(Cli, NamesThatAreNoUtf8_GoThroughEveryVerb) {
  const ScratchFolder scratch;
  const std::string bake = scratch / "bake\xff", asset = scratch / "m\xff.loden";
  std::filesystem::copy(sharedBake(), bake, std::filesystem::copy_options::recursive);
  EXPECT_EQ(loden({"cook", bake, "-o", asset, "--mode", "lod", "-q"}).exit_code, 0);
  const ToolRun info = loden({"info", asset, "--format", "json"});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  EXPECT_EQ(nlohmann::json::parse(info.out)["name"], "pulli");
  EXPECT_EQ(loden({"validate", asset}).exit_code, 0);
  EXPECT_EQ(loden({"compare", bake, asset, "--every", "9", "-q"}).exit_code, 0);
}

TEST(Cli, Json_IsCleanAndNamesItsSchema) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  const std::string asset = sharedAsset(), bake = sharedBake();
  const std::vector<std::vector<std::string>> runs{
      {"bake", "builtin:pulli", "-o", scratch / "bake", "--size", "4", "--directions", "2x2", "--supersample",
       "1"},
      {"cook", bake, "-o", scratch / "cooked.loden", "--mode", "lod"},
      {"pack", scratch / "scene.gltf", "--material", "Cloth", "--asset", asset, "-o",
       scratch / "packed.gltf"},
      {"info", asset},
      {"validate", asset},
      {"validate", scratch / "packed.gltf"},
      {"compare", bake, asset, "--every", "9"},
      {"extract", asset, "-o", scratch / "slice.exr"},
      {"trace", "builtin:pulli", "-o", scratch / "truth.png", "--size", "16x12", "--spp", "1"},
      {"doctor"},
  };
  for (auto arguments : runs) {
    const std::string verb = arguments[0];
    arguments.insert(arguments.end(), {"--format", "json", "-q"});
    const ToolRun run = loden(arguments);
    EXPECT_EQ(run.exit_code, 0) << verb << ": " << run.err;
    EXPECT_TRUE(run.err.empty()) << verb << ": " << run.err;
    const auto json = nlohmann::json::parse(run.out, nullptr, false);
    ASSERT_TRUE(json.is_object()) << verb << ": " << run.out;
    EXPECT_EQ(json["schema"], "loden/" + verb + "/1");
  }
}

TEST(Cli, Interrupt_Gives130AndNoFinishedLookingOutput) {
  const ScratchFolder scratch;
  const ToolRun run =
      loden({"bake", "builtin:isba", "-o", scratch / "bake", "--size", "128", "-q"}, scratch / "bake");
  EXPECT_EQ(run.exit_code, 130) << run.err;
  EXPECT_FALSE(std::filesystem::exists(scratch / "bake/bake.json"));
  EXPECT_EQ(loden({"cook", scratch / "bake", "-o", scratch / "m.loden", "-q"}).exit_code, 3);
}

TEST(Cli, InterruptOrTerminationAmidAFit_LeavesNoAssetAndNoTemporaryFile) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const ScratchFolder scratch, clock;
    // Starting takes .3 s; a goal that no plan meets tries them all, which takes many seconds. A signal that
    // comes earlier gives the same.
    const auto timer = std::async(std::launch::async, [&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(800));
      writeText(clock / "now", "");
    });
    const ToolRun run =
        loden({"cook", sharedBake(), "-o", scratch / "m.loden", "--target-rmse", "1e-6", "-q"}, clock / "now",
              signal);
    EXPECT_EQ(run.exit_code, 128 + signal) << run.err;
    EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
  }
}

}  // namespace
}  // namespace loden::test
