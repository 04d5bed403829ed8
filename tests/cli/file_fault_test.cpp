// Full disks, killed runs and files that are none, from outside.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <sstream>

#include "tests/cli/run_with.h"

namespace loden::test {
namespace {

namespace fs = std::filesystem;

// Runs the tool where no file grows beyond `blocks` of 512 bytes, which fails in the middle of a write as a
// full disk does.
ToolRun onFullDisk(int blocks, const std::vector<std::string>& arguments) {
  return lodenFromShell("trap '' XFSZ; ulimit -f " + std::to_string(blocks) + "; exec", arguments);
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

TEST(FullDisk, BakeStopsAndIsResumed) {
  const ScratchFolder scratch;
  ASSERT_EQ(loden(smallBake(scratch / "whole")).exit_code, 0);
  for (const int blocks : {0, 1, 4}) {
    const fs::path folder = scratch / ("full" + std::to_string(blocks));
    const ToolRun run = onFullDisk(blocks, smallBake(folder));
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_FALSE(fs::exists(folder / "bake.json"));
    for (const std::string& name : namesIn(folder)) EXPECT_FALSE(isTemporary(name)) << name;
    ASSERT_EQ(loden(smallBake(folder, {"--resume"})).exit_code, 0);
    EXPECT_EQ(filesIn(folder), filesIn(scratch / "whole"));
  }
}

TEST(Resume, BakesAgainWhatIsDamaged) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "bake";
  ASSERT_EQ(loden(smallBake(folder)).exit_code, 0);
  const auto whole = filesIn(folder);
  writeText(folder / "btf/view_0004.exr", "");
  const auto half = [&](const char* name) {
    fs::resize_file(folder / name, fs::file_size(folder / name) / 2);
  };
  half("flat/view_0003.exr");
  half("visible/view_0002.png");
  half("surface/geometry.exr");
  ASSERT_EQ(loden(smallBake(folder, {"--resume"})).exit_code, 0);
  EXPECT_EQ(filesIn(folder), whole);
}

#ifdef LODEN_FAULT_SHIM
// Runs the tool with the `at`-th call on files below `folder` failing, and all such calls that follow; `hit`
// tells whether there were as many.
ToolRun withFault(const char* call, int at, int error, const fs::path& folder,
                  const std::vector<std::string>& arguments, bool& hit) {
  const ScratchFolder scratch;
  std::ostringstream before;
  before << "export LODEN_FAULT=" << quoted(call) << ":" << at << ":" << error << ":"
         << quoted(folder.string()) << " LODEN_FAULT_HIT=" << quoted(scratch / "hit")
         << " LD_PRELOAD=" << quoted(LODEN_FAULT_SHIM) << "; exec";
  const ToolRun run = lodenFromShell(before.str(), arguments);
  hit = fs::exists(scratch / "hit");
  return run;
}

// A file that a verb writes, with every call of each kind failing in turn: it is old, with a message that
// names a file and the exit code of input and output, or new, with success.
void expectOldOrNew(std::initializer_list<std::pair<const char*, int>> calls, const std::string& name,
                    const std::vector<std::string>& arguments, const ScratchFolder& scratch) {
  const fs::path out = scratch / "out";
  fs::remove_all(out);
  fs::create_directories(out);
  ASSERT_EQ(loden(arguments).exit_code, 0);
  const std::string whole = fileText(out / name);
  for (const auto& [call, error] : calls) {
    bool hit = true;
    int refused = 0;
    for (int at = 1; hit && at < 20; ++at) {
      SCOPED_TRACE(std::string(call) + " " + std::to_string(at) + " of " + name);
      writeText(out / name, "OLD");
      const ToolRun run = withFault(call, at, error, out, arguments, hit);
      if (!hit) {
        EXPECT_EQ(run.exit_code, 0) << run.err;
      }
      if (run.exit_code == 0) {
        EXPECT_TRUE(fileText(out / name) == whole);
      } else {
        ++refused;
        EXPECT_EQ(run.exit_code, 2) << run.err;
        EXPECT_NE(run.err.find(name), std::string::npos) << run.err;
        EXPECT_NE(run.err.find("[1003]"), std::string::npos) << run.err;
        EXPECT_EQ(fileText(out / name), "OLD");
      }
      EXPECT_EQ(namesIn(out), std::vector<std::string>{name});
    }
    EXPECT_FALSE(hit) << "there are more calls";
    EXPECT_GT(refused, 0) << "no failure was noticed";
  }
}

// writeScene's scene in one file.
std::string gltfAsGlb(const ScratchFolder& scratch) {
  const auto number = [](size_t value) {
    const auto bytes = static_cast<uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&bytes), sizeof bytes);
  };
  std::string json = fileText(scratch / "scene.gltf"), bin = fileText(scratch / "scene.bin");
  const std::string uri = "\"uri\": \"scene.bin\",";
  json.replace(json.find(uri), uri.size(), "");
  json.append((4 - json.size() % 4) % 4, ' ');
  const std::string chunks =
      number(json.size()) + "JSON" + json + number(bin.size()) + std::string("BIN\0", 4) + bin;
  writeText(scratch / "scene.glb", "glTF" + number(2) + number(12 + chunks.size()) + chunks);
  return scratch / "scene.glb";
}

TEST(FailingWrites, LeaveTheOldFileOrTheNew) {
  const ScratchFolder scratch;
  const std::string out = scratch / "out/";
  writeScene(scratch.path());
  expectOldOrNew({{"write", ENOSPC}}, "o.loden",
                 {"cook", sharedBake(), "-o", out + "o.loden", "--mode", "lod", "-q"}, scratch);
  expectOldOrNew({{"write", EIO}, {"rename", ENOSPC}}, "o.png",
                 {"extract", sharedAsset(), "-o", out + "o.png"}, scratch);
  expectOldOrNew({{"write", ENOSPC}, {"fsync", EIO}, {"rename", EIO}}, "o.glb",
                 {"pack", gltfAsGlb(scratch), "--material", "Cloth", "--asset", sharedAsset(), "--embed",
                  "-o", out + "o.glb"},
                 scratch);
}

TEST(FailingWrites, BakeStopsAndIsResumed) {
  const ScratchFolder scratch;
  ASSERT_EQ(loden(smallBake(scratch / "whole")).exit_code, 0);
  const auto whole = filesIn(scratch / "whole");
  for (const auto& [call, at] : {std::pair{"write", 1}, {"write", 23}, {"rename", 12}, {"fsync", 2}}) {
    SCOPED_TRACE(std::string(call) + " " + std::to_string(at));
    const fs::path folder = scratch / (call + std::to_string(at));
    bool hit = false;
    const ToolRun run = withFault(call, at, ENOSPC, folder, smallBake(folder), hit);
    ASSERT_TRUE(hit) << run.err;
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_NE(run.err.find("[1003]"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(folder / "bake.json"));
    if (fs::exists(folder)) {
      for (const std::string& name : namesIn(folder)) EXPECT_FALSE(isTemporary(name)) << name;
    }
    ASSERT_EQ(loden(smallBake(folder, {"--resume"})).exit_code, 0);
    EXPECT_TRUE(filesIn(folder) == whole);
  }
}

// Disks that fail in the middle of a read: no run succeeds with less, and none writes.
TEST(FailingReads, AreSaidAndNothingIsWritten) {
  const ScratchFolder scratch;
  const std::string good = scratch / "good.loden", cooked = scratch / "o.loden", png = scratch / "o.png";
  fs::copy_file(sharedAsset(), good);
  fs::copy(sharedBake(), scratch / "bake", fs::copy_options::recursive);
  const auto expectSaid = [&](const std::string& below, const std::vector<std::string>& arguments,
                              const std::string& output, std::initializer_list<int> moments) {
    int refused = 0;
    for (const int at : moments) {
      SCOPED_TRACE(arguments[0] + ", read " + std::to_string(at));
      bool hit = false;
      const ToolRun run = withFault("read", at, EIO, below, arguments, hit);
      if (!hit) {
        EXPECT_EQ(run.exit_code, 0) << run.err;
        break;
      }
      ++refused;
      EXPECT_TRUE(run.exit_code == 2 || run.exit_code == 3) << run.exit_code << run.err;
      EXPECT_NE((run.err + run.out).find("100"), std::string::npos) << run.err << run.out;
      EXPECT_TRUE(output.empty() || !fs::exists(output)) << output;
    }
    EXPECT_GT(refused, 0);
  };
  expectSaid(good, {"validate", good}, "", {1, 2});
  expectSaid(good, {"info", good}, "", {1, 5, 9});
  expectSaid(good, {"extract", good, "-o", png}, png, {1, 5});
  expectSaid(scratch / "bake", {"cook", scratch / "bake", "-o", cooked, "--mode", "lod", "-q"}, cooked,
             {1, 2, 9, 40});
}
#endif

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
    const ToolRun run = lodenFromShell("exec timeout -s KILL 60", arguments);
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
    for (const std::string& argument : arguments) command.append(" ").append(quoted(argument));
    const ToolRun run = runTool("/bin/sh", {"-c", command});
    EXPECT_EQ(run.exit_code, 2) << ::testing::PrintToString(arguments) << ": " << run.err;
  }
#endif
}

}  // namespace
}  // namespace loden::test
