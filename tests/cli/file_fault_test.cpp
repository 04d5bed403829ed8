// Full disks, killed runs and files that are none, from outside.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>

#include "tests/cli/loden_fixture.h"

namespace loden::test {
namespace {

namespace fs = std::filesystem;

std::string quoted(const std::string& word) {
  return std::string("'").append(word).append("'");
}

// Runs the tool where no file grows beyond `blocks` of 512 bytes, which fails in the middle of a write as a
// full disk does.
ToolRun onFullDisk(int blocks, const std::vector<std::string>& arguments) {
  std::string command = "trap '' XFSZ; ulimit -f " + std::to_string(blocks) + "; exec " + quoted(LODEN_TOOL);
  for (const std::string& argument : arguments) command += " " + quoted(argument);
  return runTool("/bin/sh", {"-c", command});
}

std::vector<std::string> namesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (!entry.is_directory()) names.push_back(fs::relative(entry.path(), folder).string());
  std::sort(names.begin(), names.end());
  return names;
}

std::map<std::string, std::string> filesIn(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const std::string& name : namesIn(folder)) files[name] = fileText(folder / name);
  return files;
}

TEST(FullDisk, KeepsTheOldFileAndSaysSo) {
  const ScratchFolder scratch;
  for (const char* name : {"o.exr", "o.png", "o.jpg", "o.hdr"}) {
    writeText(scratch / name, "OLD");
    const ToolRun run = onFullDisk(1, {"extract", sharedAsset(), "--side", "64", "-o", scratch / name});
    EXPECT_EQ(run.exit_code, 2) << name << ": " << run.err;
    EXPECT_NE(run.err.find("loden: "), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("[1003]"), std::string::npos) << run.err;
    EXPECT_EQ(fileText(scratch / name), "OLD") << name;
  }
  EXPECT_EQ(namesIn(scratch.path()).size(), 4u);
}

const std::vector<std::string> kSmallBake{"--size", "8", "--directions", "3x3", "--supersample", "1", "-q"};

std::vector<std::string> bakeInto(const fs::path& folder, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"bake", "builtin:button", "-o", folder.string()};
  arguments.insert(arguments.end(), kSmallBake.begin(), kSmallBake.end());
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(FullDisk, BakeStopsAndIsResumed) {
  const ScratchFolder scratch;
  ASSERT_EQ(loden(bakeInto(scratch / "whole")).exit_code, 0);
  for (const int blocks : {0, 1, 4}) {
    const fs::path folder = scratch / ("full" + std::to_string(blocks));
    const ToolRun run = onFullDisk(blocks, bakeInto(folder));
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_FALSE(fs::exists(folder / "bake.json"));
    for (const std::string& name : namesIn(folder)) {
      EXPECT_EQ(name.find("tmp"), std::string::npos) << name;
      EXPECT_EQ(name.find(".loden-"), std::string::npos) << name;
    }
    ASSERT_EQ(loden(bakeInto(folder, {"--resume"})).exit_code, 0);
    EXPECT_EQ(filesIn(folder), filesIn(scratch / "whole"));
  }
}

TEST(Resume, BakesAgainWhatIsDamaged) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "bake";
  ASSERT_EQ(loden(bakeInto(folder)).exit_code, 0);
  const auto whole = filesIn(folder);
  writeText(folder / "btf/view_0004.exr", "");
  const auto half = [&](const char* name) {
    fs::resize_file(folder / name, fs::file_size(folder / name) / 2);
  };
  half("flat/view_0003.exr");
  half("visible/view_0002.png");
  half("surface/geometry.exr");
  ASSERT_EQ(loden(bakeInto(folder, {"--resume"})).exit_code, 0);
  EXPECT_EQ(filesIn(folder), whole);
}

// A pipe that nobody writes to: what opens it without care waits for ever.
TEST(Pipe, IsRefusedByEveryVerb) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  const auto pipe = [&](const std::string& name) {
    EXPECT_EQ(mkfifo((scratch / name).c_str(), 0600), 0);
    return (scratch / name).string();
  };
  const std::string asset = pipe("p.loden"), gltf = pipe("p.gltf"), obj = pipe("p.obj"), btf = pipe("p.btf"),
                    json = pipe("p.json"), png = pipe("p.png"), exr = pipe("p.exr");
  std::string scene = fileText(scratch / "scene.gltf");
  scene.replace(scene.find("scene.bin"), 9, "p.png");
  writeText(scratch / "buffer.gltf", scene);
  scene = fileText(scratch / "scene.gltf");
  scene.replace(scene.find("\"buffers\""), 9, "\"images\": [{\"uri\": \"p.png\"}], \"buffers\"");
  writeText(scratch / "image.gltf", scene);
  const std::string out = scratch / "out";
  const auto pack = [&](const std::string& from, const std::string& what) {
    return std::vector<std::string>{"pack",    from, "--material", "Cloth",
                                    "--asset", what, "-o",         out + ".gltf"};
  };
  const std::vector<std::vector<std::string>> runs{
      {"info", asset},
      {"validate", asset},
      {"validate", gltf},
      {"cook", btf, "-o", out + ".loden"},
      {"bake", obj, "-o", out},
      {"bake", gltf, "-o", out},
      {"extract", asset, "-o", out + ".png"},
      {"compare", png, png},
      {"compare", asset, asset},
      {"trace", "builtin:pulli", "-o", out + ".png", "--camera", json},
      {"trace", "builtin:pulli", "-o", out + ".png", "--environment", exr},
      pack(gltf, sharedAsset()),
      pack(scratch / "scene.gltf", asset),
      pack(scratch / "buffer.gltf", sharedAsset()),
      pack(scratch / "image.gltf", sharedAsset()),
      {"extract", sharedAsset(), "-o", exr},  // nor is a picture written over it
  };
  for (const auto& arguments : runs) {
    std::string command = "exec timeout -s KILL 60 " + quoted(LODEN_TOOL);
    for (const std::string& argument : arguments) command += " " + quoted(argument);
    const ToolRun run = runTool("/bin/sh", {"-c", command});
    EXPECT_EQ(run.exit_code, 2) << ::testing::PrintToString(arguments) << ": " << run.err;
    EXPECT_NE(run.err.find("[100"), std::string::npos) << run.err;
  }
  EXPECT_TRUE(fs::is_fifo(exr));
#ifdef LODEN_WALK
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {gltf, "--headless"},
           {"--asset", asset, "--headless"},
           {"--asset", sharedAsset(), "--headless", "--camera", json},
           {"--asset", sharedAsset(), "--headless", "--script", json},
           {"--asset", sharedAsset(), "--headless", "--environment", exr}}) {
    std::string command = "exec timeout -s KILL 60 " + quoted(LODEN_WALK);
    for (const std::string& argument : arguments) command += " " + quoted(argument);
    const ToolRun run = runTool("/bin/sh", {"-c", command});
    EXPECT_EQ(run.exit_code, 2) << ::testing::PrintToString(arguments) << ": " << run.err;
  }
#endif
}

}  // namespace
}  // namespace loden::test
