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
  return {"bake", "builtin:sponge", "-o", folder, "--size", "32", "--directions", "6x6", "--vdim", "latlong:4x5", "--threads", "1", "-q"};
}

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(Bake, ThreeShardsOneKilledAndResumed_GiveTheSameBytesAsOneRun) {
  const ScratchFolder scratch;
  const fs::path whole = scratch / "whole", shared = scratch / "shared";
  ASSERT_EQ(loden(bakeInto(whole)).exit_code, 0);

  // All three start at once on an empty folder. The second is killed as soon as its first view (number 1) is done.
  const auto start = [&](const char* shard, const fs::path& kill_at) {
    return std::async(std::launch::async, [=, &shared] { return loden(with(bakeInto(shared), {"--shard", shard}), kill_at, SIGKILL); });
  };
  auto first = start("0/3", {}), killed = start("1/3", shared / "visible/view_0001.png"), third = start("2/3", {});
  EXPECT_EQ(killed.get().exit_code, 128 + SIGKILL);
  const ToolRun a = first.get(), c = third.get();
  EXPECT_EQ(a.exit_code, 0) << a.err;
  EXPECT_EQ(c.exit_code, 0) << c.err;
  EXPECT_FALSE(fs::exists(shared / "bake.json"));

  const ToolRun resumed = loden(with(bakeInto(shared), {"--shard", "1/3", "--resume"}));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  const auto expected = contents(whole), found = contents(shared);
  EXPECT_EQ(found.size(), expected.size());
  for (const auto& [name, bytes] : expected) {
    const auto file = found.find(name);
    ASSERT_NE(file, found.end()) << name;
    EXPECT_TRUE(file->second == bytes) << name;
  }
}

}  // namespace
}  // namespace loden::test
