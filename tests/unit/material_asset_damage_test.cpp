// A small asset of each mode, cut at every byte and with every bit flipped in turn.
#include <gtest/gtest.h>

#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "tests/unit/material_fixtures.h"

namespace loden {
namespace {

using Bytes = std::vector<std::byte>;

class AssetDamage : public testing::TestWithParam<Material (*)()> {};

// What a cut file gives is an issue, or a coarser material; nothing else is read of it than what is there.
TEST_P(AssetDamage, EveryCutIsAnIssueOrAPrefix) {
  const Bytes whole = *serializeAsset(GetParam()());
  size_t prefixes = 0;
  for (size_t length = 0; length < whole.size(); ++length) {
    const std::span<const std::byte> cut(whole.data(), length);
    const Result<Material> read = parseAsset(cut, "cut");
    ASSERT_EQ(read.ok(), validateAsset(cut, "cut").empty()) << length;
    const auto file = AssetFile::open(memorySource({cut.begin(), cut.end()}, "cut"), "cut");
    if (!read.ok()) {
      ASSERT_LT(read.issue().id, 5000) << length;
      continue;
    }
    ++prefixes;
    ASSERT_TRUE(file.ok()) << length;
    ASSERT_LT(file->presentChunks(), static_cast<int>(file->chunks().size())) << length;
    ASSERT_GE(read->lambda_min, file->skeleton().lambda_min) << length;
  }
  EXPECT_GT(prefixes, 0u);
}

// A flipped bit is always an issue: checksums cover the chunks and the table, and padding is zero.
TEST_P(AssetDamage, EveryFlippedBitIsAnIssue) {
  Bytes bytes = *serializeAsset(GetParam()());
  for (size_t at = 0; at < bytes.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      bytes[at] ^= std::byte(1 << bit);
      const Result<Material> read = parseAsset(bytes, "flipped");
      ASSERT_FALSE(read.ok()) << "byte " << at << ", bit " << bit;
      ASSERT_NE(read.issue().id, issue_id::kMemory) << "byte " << at << ", bit " << bit;
      bytes[at] ^= std::byte(1 << bit);
    }
}

std::string modeName(const testing::TestParamInfo<Material (*)()>& mode) {
  constexpr const char* kNames[] = {"Lod", "Fused", "Surface", "SplitFused", "SplitSurface"};
  return kNames[mode.index];
}

INSTANTIATE_TEST_SUITE_P(Modes, AssetDamage,
                         testing::Values(test::lodMaterial, test::fusedMaterial, test::surfaceMaterial,
                                         test::splitFusedMaterial, test::splitSurfaceMaterial),
                         modeName);

}  // namespace
}  // namespace loden
