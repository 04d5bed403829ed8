// Every study at a small size: that it runs, and that its rows have the promised keys.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/loden_fixture.h"

namespace loden::test {
namespace {

struct StudyKeys {
  std::string study;
  std::vector<std::string> keys;
};

TEST(Study, EveryStudy_HasItsKeysInEveryRow) {
  const ScratchFolder scratch;
  const std::vector<StudyKeys> all{
      {"flat-reconstruction", {"tile", "size", "flat_size", "protocol", "lab_mean", "lab_max", "lab_variance", "rmse_y"}},
      {"vdim-interpolation", {"tile", "size", "map", "lookup", "fetches", "bytes", "mean_texels", "median_texels", "p95_texels", "over_1_texel"}},
      {"view-coherence", {"tile", "kind", "mean", "max"}},
      {"abrdf-size", {"tile", "format", "btf_bytes", "flat_bytes", "ratio"}},
      {"lod-fit", {"tile", "size", "mode", "preset", "components", "storage", "coefficient_bytes", "file_bytes", "gpu_bytes",
                   "rmse_y", "mse_y", "mae_y", "rmse_cb", "mse_cb", "mae_cb", "rmse_cr", "mse_cr", "mae_cr", "directions"}},
      {"minification", {"tile", "mode", "lambda", "rmse_y", "psnr_db"}},
      {"shadow-split", {"tile", "kind", "components", "coefficient_bytes", "rmse_y"}},
  };
  for (const auto& [study, keys] : all) {
    SCOPED_TRACE(study);
    // The paper's five levels need a side of 16. The tile stands before the name: a list must not take it in.
    const std::string size = study == "lod-fit" || study == "minification" ? "16" : "8";
    const ToolRun run = loden({"study", "--size", size, "--bakes", scratch.path(), "--tile", "pulli", study, "--format", "json", "-q"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const auto json = nlohmann::json::parse(run.out, nullptr, false);
    ASSERT_TRUE(json.is_object()) << run.out;
    EXPECT_EQ(json["schema"], "loden/study/1");
    EXPECT_EQ(json["study"], study);
    EXPECT_FALSE(json["rows"].empty());
    for (const auto& row : json["rows"])
      for (const std::string& key : keys) EXPECT_TRUE(row.contains(key)) << key << " in " << row.dump();
  }
}

TEST(Study, BakeOfAnotherSize_IsNotTaken) {
  const ScratchFolder scratch;
  ASSERT_EQ(loden({"bake", "builtin:pulli", "-o", scratch / "pulli-8", "--size", "4", "--supersample", "1", "-q"}).exit_code, 0);
  ASSERT_EQ(loden({"study", "view-coherence", "--size", "8", "--bakes", scratch.path(), "--tile", "pulli", "-q"}).exit_code, 0);
  const auto manifest = nlohmann::json::parse(fileText(scratch / "pulli-8/bake.json"), nullptr, false);
  ASSERT_TRUE(manifest.is_object());
  EXPECT_EQ(manifest["size"], 8);
}

}  // namespace
}  // namespace loden::test
