// Runs that are killed at any moment: what they write is the old file, the new one, or absent; what they
// leave goes with the next run, and a bake goes on where it was.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <random>
#include <thread>

#include "tests/cli/run_with.h"

namespace loden::test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// How many moments for each verb; LODEN_KILL_MOMENTS chooses, as ./loden.sh stress does.
int moments() {
  const char* chosen = std::getenv("LODEN_KILL_MOMENTS");
  return chosen ? std::max(1, std::atoi(chosen)) : 7;
}

// Starts the tool and kills it after `delay`, if it is still there then. True if it was.
bool runAndKill(const std::vector<std::string>& arguments, Clock::duration delay) {
  std::vector<std::string> words{LODEN_TOOL};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int spawned = posix_spawn(&child, LODEN_TOOL, &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  EXPECT_EQ(spawned, 0);
  if (spawned != 0) return false;
  std::this_thread::sleep_for(delay);
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}

// Runs the tool once to its end, then again and again to moments spread over as long, with `before` and
// `check` around each.
template <class Before, class Check>
void killAtMoments(const std::vector<std::string>& arguments, uint32_t seed, const Before& before,
                   const Check& check) {
  before();
  const auto begin = Clock::now();
  const ToolRun whole = loden(arguments);
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const std::chrono::duration<double> lasts = Clock::now() - begin;
  std::mt19937 random(seed);
  int killed = 0;
  for (int k = 0, count = moments(); k < count; ++k) {
    // One in each of `count` parts of the run.
    const double share = (k + std::generate_canonical<double, 32>(random)) / count;
    SCOPED_TRACE("killed after " + std::to_string(share) + " of " + std::to_string(lasts.count()) + " s");
    before();
    killed += runAndKill(arguments, std::chrono::duration_cast<Clock::duration>(share * lasts));
    check();
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(killed, 0) << "every run had ended before it was killed";
}

TEST(Kill, Bake_LeavesWholeFilesAndIsResumed) {
  const ScratchFolder scratch;
  const fs::path folder = scratch / "bake";
  ASSERT_EQ(loden(smallBake(scratch / "whole")).exit_code, 0);
  const auto whole = filesIn(scratch / "whole");
  killAtMoments(
      smallBake(folder), 1, [&] { fs::remove_all(folder); },
      [&] {
        if (fs::exists(folder)) {
          for (const auto& [name, bytes] : filesIn(folder)) {
            if (isTemporary(name) || name == "bake.unfinished.json") continue;
            ASSERT_TRUE(whole.contains(name)) << name;
            EXPECT_TRUE(whole.at(name) == bytes) << name << " is neither absent nor whole";
          }
          if (fs::exists(folder / "bake.json")) {
            for (const auto& [name, bytes] : whole) EXPECT_TRUE(fs::exists(folder / name)) << name;
          }
        }
        const ToolRun resumed = loden(smallBake(folder, {"--resume"}));
        ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
        EXPECT_TRUE(filesIn(folder) == whole) << testing::PrintToString(namesIn(folder));
      });
}

// One output file, that is there before: the old one or the new one, and after the next run the new one
// alone.
void killWriterOf(const std::string& name, const std::vector<std::string>& arguments, uint32_t seed,
                  const ScratchFolder& scratch) {
  const fs::path out = scratch / "out";
  fs::create_directories(out);
  std::string whole;
  const auto writeOld = [&] { writeText(out / name, "OLD"); };
  killAtMoments(arguments, seed, writeOld, [&] {
    if (whole.empty()) {
      writeOld();
      ASSERT_EQ(loden(arguments).exit_code, 0);
      whole = fileText(out / name);
      ASSERT_GT(whole.size(), 100u);
      return;
    }
    const std::string left = fileText(out / name);
    EXPECT_TRUE(left == "OLD" || left == whole) << left.size() << " bytes of " << whole.size();
    for (const std::string& other : namesIn(out)) EXPECT_TRUE(other == name || isTemporary(other)) << other;
    ASSERT_EQ(loden(arguments).exit_code, 0);
    EXPECT_TRUE(fileText(out / name) == whole);
    EXPECT_EQ(namesIn(out), std::vector<std::string>{name});
  });
}

TEST(Kill, Cook_LeavesTheOldAssetOrTheNew) {
  const ScratchFolder scratch;
  killWriterOf("cloth.loden",
               {"cook", sharedBake(), "-o", scratch / "out/cloth.loden", "--mode", "lod", "-q"}, 2, scratch);
}

TEST(Kill, Pack_LeavesTheOldSceneOrTheNew) {
  const ScratchFolder scratch;
  writeScene(scratch.path());
  const std::string bin = fileText(scratch / "scene.bin"), asset = fileText(sharedAsset());
  const fs::path out = scratch / "out";
  const std::vector<std::string> arguments{
      "pack",    scratch / "scene.gltf", "--material", "Cloth",
      "--asset", sharedAsset(),          "-o",         out / "scene.gltf"};
  fs::create_directories(out);
  ASSERT_EQ(loden(arguments).exit_code, 0);
  const auto whole = filesIn(out);
  ASSERT_EQ(whole.size(), 3u) << testing::PrintToString(namesIn(out));
  killAtMoments(
      arguments, 3,
      [&] {
        fs::remove_all(out);
        fs::create_directories(out);
        writeText(out / "scene.gltf", "OLD");
      },
      [&] {
        for (const auto& [name, bytes] : filesIn(out)) {
          if (isTemporary(name)) continue;
          const bool old = name == "scene.gltf" && bytes == "OLD";
          EXPECT_TRUE(old || (whole.contains(name) && whole.at(name) == bytes)) << name;
        }
        if (fileText(out / "scene.gltf") != "OLD") {  // written last, with all that it refers to beside it
          for (const auto& [name, bytes] : whole) EXPECT_TRUE(fs::exists(out / name)) << name;
        }
        ASSERT_EQ(loden(arguments).exit_code, 0);
        EXPECT_TRUE(filesIn(out) == whole) << testing::PrintToString(namesIn(out));
      });
}

}  // namespace
}  // namespace loden::test
