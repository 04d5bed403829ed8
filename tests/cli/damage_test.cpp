// Damaged assets, from outside: every verb that reads one ends with a documented exit code, says why, and
// leaves no output; so does loden_walk. LODEN_DAMAGES=N in the environment tries N per mode instead of a few.
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "tests/cli/loden_fixture.h"

namespace loden::test {
namespace {

using Json = nlohmann::json;

int damagesPerMode() {
  const char* count = std::getenv("LODEN_DAMAGES");
  return count ? std::atoi(count) : 5;
}

struct Damage {
  std::string what, bytes;
};

// In turn: the file cut anywhere, cut at the end of a chunk, a bit turned in the header and chunk table, a
// bit turned anywhere, and a run of bytes overwritten.
Damage damaged(const std::string& sound, const std::vector<size_t>& chunk_ends, int k, std::mt19937& random) {
  const auto below = [&](size_t limit) {
    return std::uniform_int_distribution<size_t>(0, limit - 1)(random);
  };
  std::string bytes = sound;
  const auto turn = [&](size_t at) {
    const int bit = static_cast<int>(below(8));
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
    return Damage{"bit " + std::to_string(bit) + " of byte " + std::to_string(at), bytes};
  };
  switch (k % 5) {
    case 0: {
      const size_t length = below(sound.size());
      return {"cut to " + std::to_string(length) + " bytes", sound.substr(0, length)};
    }
    case 1: {
      const size_t length = chunk_ends[below(chunk_ends.size())];
      return {"cut to " + std::to_string(length) + " bytes, the end of a chunk", sound.substr(0, length)};
    }
    case 2:
      return turn(below(std::min<size_t>(sound.size(), 1024)));
    case 3:
      return turn(below(sound.size()));
    default: {
      const size_t at = below(sound.size()), length = std::min<size_t>(sound.size() - at, 1 + below(64));
      for (size_t i = at; i < at + length; ++i) bytes[i] = static_cast<char>(below(256));
      return {std::to_string(length) + " bytes from " + std::to_string(at), bytes};
    }
  }
}

void expectOneOf(const ToolRun& run, const std::set<int>& codes, const char* verb) {
  EXPECT_TRUE(codes.contains(run.exit_code)) << verb << " exits with " << run.exit_code << ": " << run.err;
  if (run.exit_code != 0 && std::string(verb) != "info" && std::string(verb) != "validate") {
    EXPECT_FALSE(run.err.empty()) << verb;
  }
}

void tryAllVerbs(const ScratchFolder& scratch, const std::string& sound, const Damage& damage) {
  SCOPED_TRACE(damage.what);
  const std::string path = scratch / "bad.loden", picture = scratch / "bad.exr";
  writeText(path, damage.bytes);
  const bool changed = damage.bytes.size() == sound.size() && damage.bytes != sound;
  const ToolRun validate = loden({"validate", path, "--format", "json"});
  expectOneOf(validate, changed ? std::set{3} : std::set{0, 3}, "validate");  // every byte counts
  const Json report = Json::parse(validate.out, nullptr, false);
  ASSERT_TRUE(report.is_object()) << validate.out;
  EXPECT_EQ(report["valid"].get<bool>(), validate.exit_code == 0);
  const bool prefix = validate.exit_code == 0 && damage.bytes.size() < sound.size();
  EXPECT_EQ(report["prefix"].get<bool>(), prefix);
  EXPECT_EQ(report["issues"].size() == 1 && report["issues"][0]["id"] == 2015, prefix);
  EXPECT_EQ(report["issues"].empty(), validate.exit_code == 0 && !prefix);

  const ToolRun info = loden({"info", path, "--format", "json"});
  EXPECT_EQ(info.exit_code, validate.exit_code) << info.err;
  EXPECT_TRUE(Json::parse(info.out, nullptr, false).is_object()) << info.out;

  const std::set<int> readable = validate.exit_code == 0 ? std::set{0} : std::set{3, 5};
  const ToolRun extract = loden({"extract", path, "-o", picture});
  expectOneOf(extract, readable, "extract");
  EXPECT_EQ(std::filesystem::exists(picture), extract.exit_code == 0);
  std::filesystem::remove(picture);
  expectOneOf(loden({"compare", path, path, "--every", "40", "-q"}), readable, "compare");
#ifdef LODEN_WALK
  // What is sound and coarser is drawn, and the exit code says that it is not all.
  const ToolRun walk = runTool(LODEN_WALK, {"--asset", path, "--headless", "--size", "16x16", "-q"});
  expectOneOf(walk, {0, 3, 5}, "loden_walk");
#endif
}

// Ends of the chunks, by info.
std::vector<size_t> chunkEnds(const std::string& asset) {
  const Json info = Json::parse(loden({"info", asset, "--format", "json"}).out);
  std::vector<size_t> ends;
  for (const Json& chunk : info["chunks"])
    ends.push_back(chunk["offset"].get<size_t>() + chunk["stored_bytes"].get<size_t>());
  return ends;
}

class Damaged : public ::testing::TestWithParam<const char*> {};

TEST_P(Damaged, Asset_GivesADocumentedExitCodeAndNoOutput) {
  const ScratchFolder scratch;
  const std::string asset = scratch / "sound.loden";
  std::vector<std::string> cook{"cook", sharedBake(), "-o", asset, "--mode", GetParam(), "-q"};
  if (std::string(GetParam()) == "surface")
    cook.insert(cook.end(), {"--preset", "seed"});  // with a stored VDIM
  ASSERT_EQ(loden(cook).exit_code, 0);
  const std::string sound = fileText(asset);
  const std::vector<size_t> ends = chunkEnds(asset);
  ASSERT_FALSE(ends.empty());
  std::mt19937 random(1);
  for (int k = 0; k < damagesPerMode(); ++k) tryAllVerbs(scratch, sound, damaged(sound, ends, k, random));
}

INSTANTIATE_TEST_SUITE_P(Modes, Damaged, ::testing::Values("lod", "surface", "fused"),
                         [](const auto& mode) { return std::string(mode.param); });

}  // namespace
}  // namespace loden::test
