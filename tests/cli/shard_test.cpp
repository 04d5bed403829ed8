// Several processes fill one folder.
#include <gtest/gtest.h>

#include <future>
#include <map>

#include "tests/cli/loden_fixture.h"

namespace loden::test {
namespace {

namespace fs = std::filesystem;

// Relative name to bytes of every file.
std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = fileText(entry.path());
  return files;
}

std::vector<std::string> bakeInto(const fs::path& folder) {
  return {"bake", "builtin:sponge", "-o",          folder,      "--size", "32", "--directions",
          "6x6",  "--vdim",         "latlong:4x5", "--threads", "1",      "-q"};
}

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

void expectSameFiles(const fs::path& folder, const std::map<std::string, std::string>& expected) {
  const auto found = contents(folder);
  EXPECT_EQ(found.size(), expected.size());
  for (const auto& [name, bytes] : expected) {
    const auto file = found.find(name);
    ASSERT_NE(file, found.end()) << name;
    EXPECT_TRUE(file->second == bytes) << name;
  }
}

TEST(Bake, ThreeShardsOneKilledAndResumed_GiveTheSameBytesAsOneRun) {
  const ScratchFolder scratch;
  const fs::path whole = scratch / "whole", shared = scratch / "shared";
  ASSERT_EQ(loden(bakeInto(whole)).exit_code, 0);

  // All three start at once on an empty folder. The second is killed as soon as its first view (number 1) is
  // done.
  const auto start = [&](const char* shard, const fs::path& kill_at) {
    return std::async(std::launch::async, [=, &shared] {
      return loden(with(bakeInto(shared), {"--shard", shard}), kill_at, SIGKILL);
    });
  };
  auto first = start("0/3", {}), killed = start("1/3", shared / "visible/view_0001.png"),
       third = start("2/3", {});
  EXPECT_EQ(killed.get().exit_code, 128 + SIGKILL);
  const ToolRun a = first.get(), c = third.get();
  EXPECT_EQ(a.exit_code, 0) << a.err;
  EXPECT_EQ(c.exit_code, 0) << c.err;
  EXPECT_FALSE(fs::exists(shared / "bake.json"));

  const ToolRun resumed = loden(with(bakeInto(shared), {"--shard", "1/3", "--resume"}));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  expectSameFiles(shared, contents(whole));
}

TEST(Bake, ShardOfAFinishedBakeBegunAgain_IsUnfinishedUntilItsLastPass) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "bake";
  const auto bake = with(bakeInto(folder), {"--fill", "nearest-view"});
  ASSERT_EQ(loden(bake).exit_code, 0);
  const auto whole = contents(folder);
  const ToolRun killed =
      runTool(LODEN_TOOL, with(bake, {"--shard", "0/2"}), folder / "bake.unfinished.json", SIGKILL);
  EXPECT_EQ(killed.exit_code, 128 + SIGKILL);
  EXPECT_FALSE(fs::exists(folder / "bake.json"));
  EXPECT_EQ(loden(with(bake, {"--shard", "0/2"})).exit_code, 0);
  expectSameFiles(folder, whole);
}

TEST(Bake, ShardsThatFinishAtOnce_GiveTheSameBytesAsOneRun) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "bake";
  const auto bake = with(bakeInto(folder), {"--fill", "nearest-view"});
  ASSERT_EQ(loden(bake).exit_code, 0);
  const auto whole = contents(folder);
  std::vector<std::future<ToolRun>> runs;  // all find everything there, and go to the last pass
  for (const char* shard : {"0/3", "1/3", "2/3"})
    runs.push_back(std::async(std::launch::async, [&, shard] {
      return loden(with(bake, {"--shard", shard, "--resume"}));
    }));
  for (auto& run : runs) {
    const ToolRun ended = run.get();
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
  }
  expectSameFiles(folder, whole);
}

}  // namespace
}  // namespace loden::test
