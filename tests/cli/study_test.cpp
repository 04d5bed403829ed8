// Every study at a small size: that it runs, and that its rows have the promised keys.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/loden_fixture.h"

namespace loden::test {
namespace {

struct StudyKeys {
  std::string study;
  std::vector<std::string> keys;
};

// Those that the help lists, two spaces in.
std::vector<std::string> listedStudies() {
  std::istringstream help(loden({"study", "--help"}).out);
  std::vector<std::string> names;
  bool listed = false;
  for (std::string line; std::getline(help, line);) {
    if (listed && !line.starts_with("  ")) break;
    if (listed) names.push_back(line.substr(2, line.find(' ', 2) - 2));
    listed = listed || line == "Studies:";
  }
  return names;
}

std::vector<std::string> sorted(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  return names;
}

TEST(Study, EveryStudy_HasItsKeysInEveryRow) {
  const ScratchFolder scratch;
  const std::vector<StudyKeys> all{
      {"flat-reconstruction",
       {"tile", "size", "flat_size", "protocol", "lab_mean", "lab_max", "lab_variance", "rmse_y"}},
      {"vdim-interpolation",
       {"tile", "size", "map", "lookup", "fetches", "bytes", "mean_texels", "median_texels", "p95_texels",
        "over_1_texel"}},
      {"curved-lookup",
       {"tile", "size", "surface", "lookup", "ray", "theta_from", "theta_to", "fetches", "mean_texels",
        "median_texels", "p95_texels", "over_1_texel", "miss_rate", "lost_rate", "found_rate", "samples"}},
      {"view-coherence", {"tile", "kind", "mean", "max"}},
      {"abrdf-size", {"tile", "format", "btf_bytes", "flat_bytes", "ratio"}},
      {"lod-fit",
       {"tile", "size", "mode", "preset", "components", "storage", "coefficient_bytes", "file_bytes",
        "gpu_bytes", "rmse_y", "mse_y", "mae_y", "rmse_cb", "mse_cb", "mae_cb", "rmse_cr", "mse_cr", "mae_cr",
        "directions"}},
      {"minification", {"tile", "mode", "lambda", "rmse_y", "psnr_db"}},
      {"lab-bounds",
       {"tile", "size", "what", "lookup", "components", "lab_mean", "lab_black", "lab_lit", "rmse_y"}},
  };
  std::vector<std::string> tested{"time-error"};  // below
  for (const StudyKeys& study : all) tested.push_back(study.study);
  EXPECT_EQ(sorted(tested), sorted(listedStudies()));
  for (const auto& [study, keys] : all) {
    SCOPED_TRACE(study);
    // The paper's five levels need a side of 16. The tile stands before the name: a list must not take it in.
    const std::string size = study == "lod-fit" || study == "minification" ? "16" : "8";
    const ToolRun run = loden({"study", "--size", size, "--bakes", scratch.path(), "--tile", "pulli", study,
                               "--format", "json", "--pictures", scratch / "pictures", "-q"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const auto json = nlohmann::json::parse(run.out, nullptr, false);
    ASSERT_TRUE(json.is_object()) << run.out;
    EXPECT_EQ(json["schema"], "loden/study/1");
    EXPECT_EQ(json["study"], study);
    EXPECT_FALSE(json["rows"].empty());
    for (const auto& row : json["rows"])
      for (const std::string& key : keys) EXPECT_TRUE(row.contains(key)) << key << " in " << row.dump();
  }
  for (const char* picture :
       {"flat-reconstruction-pulli-16-linear-flat.png", "flat-reconstruction-pulli-16-linear-difference.png",
        "vdim-interpolation-pulli-latlong-8x32-paper.png", "view-coherence-pulli-flat-visible.png",
        "abrdf-size-pulli-1-btf-texel.png", "abrdf-size-pulli-2-flat-nearest-view-point.png",
        "lod-fit-bytes.svg", "minification.svg"})
    EXPECT_TRUE(std::filesystem::exists(scratch / "pictures" / picture)) << picture;
}

TEST(Study, TimeError_HasItsKeysInEveryRow) {
  const ScratchFolder scratch;
  const ToolRun run =
      loden({"study", "time-error", "--size", "16", "--tile", "pulli", "--bakes", scratch / "bakes", "--json",
             scratch / "rows.json", "--csv", scratch / "rows.csv", "--format", "json", "-q"});
  if (run.exit_code == 5) GTEST_SKIP() << run.err;  // built without the runtime
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << run.out;
  EXPECT_EQ(json["schema"], "loden/study/1");
  EXPECT_EQ(json["study"], "time-error");
  EXPECT_TRUE(json["command"].get<std::string>().starts_with("loden study time-error --size 16 --tile pulli"))
      << json["command"];
  EXPECT_EQ(run.out, fileText(scratch / "rows.json"));
  EXPECT_NE(fileText(scratch / "rows.csv").find("bytes_per_pixel"), std::string::npos);
  int tables = 0;
  for (const auto& row : json["rows"]) {
    for (const char* key :
         {"scene", "lambda", "degrees", "renderer", "setting", "ms_median", "ratio_to_normal_map",
          "fetches_per_pixel", "fetches_slowest", "bytes_per_pixel", "gpu_bytes", "flip", "rmse", "psnr_db"})
      EXPECT_TRUE(row.contains(key)) << key << " in " << row.dump();
    EXPECT_GE(row["bytes_per_pixel"], row["fetches_per_pixel"]);
    if (row["renderer"] != "full BTF table") continue;
    ++tables;
    EXPECT_NEAR(row["fetches_per_pixel"].get<double>(), 16, 1e-6);
    // Far away the texels' averages are what is seen: only the directions between the samples are left as an
    // error.
    if (row["lambda"] >= 4) {
      EXPECT_GT(row["psnr_db"], 30);
    }
  }
  EXPECT_EQ(tables, 3);
}

TEST(Study, TimeError_KeepsTheVerbsContract) {
  const ScratchFolder scratch;
  writeText(scratch / "file", "");
  const ToolRun large = loden({"study", "time-error", "--size", "512"});
  if (large.exit_code == 5) GTEST_SKIP() << large.err;  // built without the runtime
  EXPECT_EQ(large.exit_code, 1);
  EXPECT_NE(large.err.find("--size"), std::string::npos) << large.err;
  EXPECT_EQ(
      loden({"study", "time-error", "--size", "16", "--tile", "nosuch.obj", "--bakes", scratch.path(), "-q"})
          .exit_code,
      2);
  EXPECT_EQ(loden({"study", "time-error", "--size", "16", "--tile", "pulli", "--bakes",
                   scratch / "file/bakes", "-q"})
                .exit_code,
            2);
}

TEST(Study, TimeErrorWithoutItsProgram_IsUnsupportedWithARemedy) {
  const ScratchFolder scratch;
  std::filesystem::copy_file(LODEN_TOOL, scratch / "loden");
  const ToolRun run = runTool(scratch / "loden", {"study", "time-error"});
  EXPECT_EQ(run.exit_code, 5);
  EXPECT_NE(run.err.find("bench_time_error"), std::string::npos) << run.err;
}

TEST(Study, EveryNthView_BakesTheseAndIsCompletedLater) {
  const ScratchFolder scratch;
  const std::vector<std::string> all{
      "study", "flat-reconstruction", "--size", "8", "--tile", "pulli", "--format", "json", "-q"};
  const auto rowsOf = [&](const std::string& bakes, const std::string& every) {
    auto arguments = all;
    arguments.insert(arguments.end(), {"--bakes", scratch / bakes, "--every", every});
    const ToolRun run = loden(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out, nullptr, false)["rows"];
  };
  const auto some = rowsOf("a", "27"), later = rowsOf("a", "1"), fresh = rowsOf("b", "1");
  ASSERT_EQ(some.size(), 5u);
  ASSERT_EQ(later, fresh);
  for (size_t k = 0; k < some.size(); ++k) {
    if (some[k]["protocol"] == "paper")
      EXPECT_EQ(some[k]["images"], 3 * 81);
    else
      EXPECT_EQ(some[k], fresh[k]);  // views between the samples are interpolated from all of these
  }
}

TEST(Study, EveryNthViewOfAStudyThatNeedsAll_IsRefused) {
  const ToolRun run = loden({"study", "view-coherence", "--every", "9"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("--every"), std::string::npos) << run.err;
}

TEST(Study, BakeOfAnotherSize_IsNotTaken) {
  const ScratchFolder scratch;
  ASSERT_EQ(
      loden({"bake", "builtin:pulli", "-o", scratch / "pulli-8", "--size", "4", "--supersample", "1", "-q"})
          .exit_code,
      0);
  ASSERT_EQ(
      loden({"study", "view-coherence", "--size", "8", "--bakes", scratch.path(), "--tile", "pulli", "-q"})
          .exit_code,
      0);
  const auto manifest = nlohmann::json::parse(fileText(scratch / "pulli-8/bake.json"), nullptr, false);
  ASSERT_TRUE(manifest.is_object());
  EXPECT_EQ(manifest["size"], 8);
}

}  // namespace
}  // namespace loden::test
