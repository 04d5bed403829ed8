// Every issue that the container can raise, each provoked by an input, in writer and reader alike.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "material/asset/asset.h"
#include "material/asset/asset_header.h"
#include "material/base/issue_table.h"
#include "material/base/issues.h"
#include "material/system/asset_io.h"
#include "tests/unit/asset_faults.h"
#include "tests/unit/material_fixtures.h"

namespace loden {
namespace {

using namespace asset;  // NOLINT: forges files from the container's own pieces
using test::assemble;
using test::Bytes;
using test::RawChunk;
using test::rawChunks;

std::string listed(const std::vector<Issue>& issues) {
  std::ostringstream text;
  for (const Issue& issue : issues) text << issue.id << " " << issue.where << ": " << issue.text << "\n";
  return text.str();
}

// Both readers name this issue and no other, and the message has a place and a text.
void expectRejected(const Bytes& file, int id) {
  const std::vector<Issue> issues = validateAsset(file, "test");
  ASSERT_FALSE(issues.empty());
  for (const Issue& issue : issues) {
    EXPECT_EQ(issue.id, id) << listed(issues);
    EXPECT_EQ(issue.where.substr(0, 4), "test");
    EXPECT_FALSE(issue.text.empty());
  }
  const Result<Material> read = parseAsset(file, "test");
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.issue().id, id) << read.issue().text;
}

TEST(AssetIssues, ForgedFilesAreWhatTheWriterWritesIfNothingIsForged) {
  for (const Material& material :
       {test::fusedMaterial(), test::splitFusedMaterial(), test::splitSurfaceMaterial()})
    EXPECT_TRUE(assemble(rawChunks(material)) == *serializeAsset(material));
}

// What is wrong is named, alone; and what the readers refuse of a material, the writer refuses with the same
// number.
TEST(AssetIssues, EachFaultIsNamedAndNoOther) {
  for (const test::AssetFault& fault : test::assetFaults()) {
    SCOPED_TRACE(std::to_string(fault.id) + " " + std::string(issueKind(fault.id)->name) + ": " + fault.what);
    if (fault.id == issue_id::kPrefix) {  // a remark of validateAssetBytes
      EXPECT_EQ(listed(validateAsset(fault.file, "test")), "");
      continue;
    }
    expectRejected(fault.file, fault.id);
    if (!fault.material) continue;
    const Result<Bytes> written = serializeAsset(*fault.material);
    ASSERT_FALSE(written.ok()) << "the writer took it";
    EXPECT_EQ(written.issue().id, fault.id) << written.issue().where << ": " << written.issue().text;
  }
}

TEST(AssetIssues, UnknownOptionalIsSkipped) {
  const Material material = test::fusedMaterial();
  for (const size_t place : {size_t{1}, size_t{3}, rawChunks(material).size()}) {
    std::vector<RawChunk> chunks = rawChunks(material);
    chunks.insert(chunks.begin() + static_cast<ptrdiff_t>(place),
                  {fourCharacters("NEWS"), Bytes(100, std::byte{7}), 0});
    const Bytes file = assemble(chunks);
    EXPECT_EQ(listed(validateAsset(file, "test")), "");
    const Result<Material> read = parseAsset(file, "test");
    ASSERT_TRUE(read.ok());
    test::expectSame(*read, material);
  }
}

TEST(AssetIssues, HeaderCountsAreCheckedBeforeTheyAreBelieved) {
  // Each 32-bit field in turn becomes huge: an issue, quickly, and no allocation to match.
  for (const Material& material :
       {test::lodMaterial(), test::splitFusedMaterial(), test::splitSurfaceMaterial()}) {
    const size_t head = encodeHeader(material).size();
    for (size_t at = 0; at + 4 <= head; at += 4) {
      std::vector<RawChunk> chunks = rawChunks(material);
      std::memset(chunks[0].raw.data() + at, 0x7f, 4);
      const Bytes file = assemble(chunks);
      const Result<Material> read = parseAsset(file, "test");
      if (read.ok()) {
        EXPECT_LT(validateAsset(file, "test").size(), 1u);
      }
    }
  }
}

// A leading part and its rest are held against the header's numbers one by one.
TEST(AssetIssues, SplitPartsOfTheWrongSize) {
  for (const Material& material : {test::splitFusedMaterial(), test::splitSurfaceMaterial()}) {
    const std::vector<Part> parts = partsOf(material);
    for (size_t i = 0; i < parts.size(); ++i) {
      if (partsOf(material, parts[i].type, parts[i].band).size() == 1) continue;
      std::vector<RawChunk> chunks = rawChunks(material);
      chunks[i].raw.pop_back();
      expectRejected(assemble(chunks), issue_id::kMapSize);
    }
    std::vector<RawChunk> chunks = rawChunks(material);
    chunks.erase(std::find_if(chunks.begin(), chunks.end(),
                              [](const RawChunk& c) { return c.type == kBand || c.type == kSurf; }));
    expectRejected(assemble(chunks), issue_id::kMissingChunk);
  }
}

// Rough surfaces and dense ones are not what kAtlasWork and kAtlasColumn refuse.
TEST(AssetIssues, SurfacesOfModerateCostPass) {
  const auto surface = [](int side, bool identity, const std::function<glm::dvec3(int, int)>& position) {
    std::vector<glm::dvec3> positions;
    for (int t = 0; t < side * side; ++t) positions.push_back(position(t % side, t / side));
    Material material = test::surfaceMaterial();
    material.geometry =
        encodeGeometryImage(side, positions, std::vector<uint16_t>(positions.size(), 1), identity);
    material.geometry.aspect = material.aspect;
    material.atlas = {};
    return material;
  };
  EXPECT_TRUE(serializeAsset(surface(256, true, [](int i, int j) {
                return glm::dvec3((i + 0.5) / 256, (j + 0.5) / 256, (i + j) % 2 ? -0.05 : 0.0);
              })).ok());
  EXPECT_TRUE(serializeAsset(surface(64, false, [](int i, int j) {
                return glm::dvec3(0.5 + 1e-5 * i, 0.5 + 1e-5 * j, -0.01);
              })).ok());
}

TEST(AssetIssues, TheGreatestTexelPasses) {
  Material material = test::lodMaterial();
  const float greatest = -65504;
  std::memcpy(material.bands[0].table.data.data() + 4, &greatest, sizeof greatest);
  EXPECT_TRUE(serializeAsset(material).ok());
}

// --- what the fuzzers begin with ---

// A seed that the reader refuses at the door teaches a fuzzer nothing. After a change of the format, write
// them anew:
//   LODEN_WRITE_SEEDS=1 unit_material --gtest_filter='FuzzSeeds.*'
TEST(FuzzSeeds, AreAssetsOfThisFormat) {
  const std::string folder = std::string(LODEN_TESTS_DIR) + "/fuzz/corpus/asset_fuzz/";
  for (const Material& material :
       {test::surfaceMaterial(), test::lodMaterial(), test::fusedMaterial(), test::splitSurfaceMaterial(),
        test::splitFusedMaterial(), test::nearMaterial()})
    for (const bool stored : {false, true}) {
      std::string name = material.name + (stored ? " stored" : "") + ".loden";
      std::replace(name.begin(), name.end(), ' ', '_');
      SCOPED_TRACE(name);
      if (std::getenv("LODEN_WRITE_SEEDS") != nullptr) {
        const Bytes bytes = assemble(rawChunks(material), {}, stored);
        std::ofstream(folder + name, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
      }
      const Result<Material> seed = readAsset(folder + name);
      ASSERT_TRUE(seed.ok()) << seed.issue().text;
      test::expectSame(*seed, material);
    }
}

// --- the document ---

// The constants, the table and the document name the same issues.
TEST(AssetIssues, TableAndTextNameEveryNumber) {
  const auto textOf = [](const char* file) {
    std::ifstream stream(std::string(LODEN_TESTS_DIR) + "/../material/" + file);
    EXPECT_TRUE(stream.good()) << file;
    return std::string{std::istreambuf_iterator<char>(stream), {}};
  };
  std::vector<int> constants, tabled;
  const std::string header = textOf("base/issues.h");
  const std::regex constant(R"(constexpr int k[A-Za-z]+ = ([0-9]+);)");
  for (std::sregex_iterator match(header.begin(), header.end(), constant), end; match != end; ++match)
    constants.push_back(std::stoi((*match)[1]));
  std::set<std::string_view> names;
  for (const IssueKind& kind : kIssueKinds) {
    tabled.push_back(kind.id);
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    EXPECT_EQ(issueKind(kind.id), &kind);
  }
  EXPECT_EQ(constants, tabled);
  EXPECT_EQ(issueKind(9999), nullptr);

  std::map<int, std::string> documented, expected;
  const std::string format = textOf("FORMAT.md");
  const std::regex cells(R"(\n\| ([0-9]{4}) \| ([a-z-]+) \| ([^|\n]+) \|)");
  for (std::sregex_iterator match(format.begin(), format.end(), cells), end; match != end; ++match)
    documented[std::stoi((*match)[1])] = (*match)[2].str() + ": " + (*match)[3].str();
  for (const IssueKind& kind : kIssueKinds)
    if (kind.id >= 2000 && kind.id < 5000 && kind.found_by == FoundBy::kValidate)
      expected[kind.id] = std::string(kind.name) + ": " + std::string(kind.summary);
  EXPECT_EQ(documented, expected);
}

TEST(AssetIssues, FormatTextAndCodeHaveTheSameLimits) {
  std::ifstream stream(std::string(LODEN_TESTS_DIR) + "/../material/FORMAT.md");
  ASSERT_TRUE(stream.good());
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::map<std::string, uint64_t> documented;
  const std::regex row(R"(\| (k[A-Za-z]+) \| ([0-9]+) \|)");
  for (std::sregex_iterator match(text.begin(), text.end(), row), end; match != end; ++match) {
    documented[(*match)[1]] = std::stoull((*match)[2]);
  }
  using Limits = AssetLimits;
  const std::map<std::string, uint64_t> coded = {
      {"kMaxSide", Limits::kMaxSide},
      {"kMaxBands", Limits::kMaxBands},
      {"kMaxQuads", Limits::kMaxQuads},
      {"kMaxDirections", Limits::kMaxDirections},
      {"kMaxGridSide", Limits::kMaxGridSide},
      {"kMaxLambda", Limits::kMaxLambda},
      {"kMaxFinerLevels", Limits::kMaxFinerLevels},
      {"kMaxSpecular", Limits::kMaxSpecular},
      {"kMaxGeometrySide", Limits::kMaxGeometrySide},
      {"kMaxAspect", Limits::kMaxAspect},
      {"kMaxTilePeriods", Limits::kMaxTilePeriods},
      {"kMaxAtlasTexels", Limits::kMaxAtlasTexels},
      {"kMaxAtlasDirections", Limits::kMaxAtlasDirections},
      {"kMaxAtlasWork", Limits::kMaxAtlasWork},
      {"kMaxAtlasColumn", Limits::kMaxAtlasColumn},
      {"kMaxNameBytes", Limits::kMaxNameBytes},
      {"kMaxHeadBytes", Limits::kMaxHeadBytes},
      {"kMaxMetaBytes", Limits::kMaxMetaBytes},
      {"kMaxChunkBytes", Limits::kMaxChunkBytes},
      {"kMaxAssetBytes", Limits::kMaxAssetBytes},
      {"kMaxRatio", Limits::kMaxRatio},
      {"kMaxSideRatio", Limits::kMaxSideRatio},
      {"kMaxValue", Limits::kMaxValue},
      {"kTableEnd", Limits::kTableEnd},
      {"kMaxChunks", Limits::kMaxChunks},
      {"kAlignment", Limits::kAlignment},
  };
  EXPECT_EQ(documented, coded);
}

}  // namespace
}  // namespace loden
