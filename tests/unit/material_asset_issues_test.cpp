// Every issue that the container can raise, each provoked by an input, in writer and reader alike.
#define XXH_INLINE_ALL
#include <gtest/gtest.h>
#include <xxhash.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "material/asset/asset.h"
#include "material/asset/asset_check.h"
#include "material/asset/asset_chunks.h"
#include "material/asset/asset_header.h"
#include "material/base/issue_table.h"
#include "material/base/issues.h"
#include "material/system/asset_io.h"
#include "tests/unit/material_fixtures.h"

namespace loden {
namespace {

using namespace asset;  // NOLINT: forges files from the container's own pieces
using Bytes = std::vector<std::byte>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct RawChunk {
  uint32_t type;
  Bytes raw;
  uint32_t flags = kFlagCritical;
};

// The chunks of a material as the writer would lay them out, without its checks.
std::vector<RawChunk> rawChunks(const Material& material) {
  std::vector<RawChunk> chunks;
  for (const Part& part : partsOf(material)) {
    RawChunk chunk{part.type, {}};
    if (part.type == kHead) chunk.raw = encodeHeader(material);
    if (part.type == kMeta) {
      const auto text = std::as_bytes(std::span(material.meta_json));
      chunk = {kMeta, {text.begin(), text.end()}, 0};
    }
    if (part.share != Part::Share::kWhole)
      chunk.raw = gatherTexels(material, part);
    else
      for (const Texture* t : partTextures(material, part))
        chunk.raw.insert(chunk.raw.end(), t->data.begin(), t->data.end());
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

Bytes assemble(const std::vector<RawChunk>& raw,
               const std::function<void(std::vector<ChunkInfo>&)>& forge = {}, bool stored_only = false) {
  std::vector<ChunkInfo> chunks;
  std::vector<Bytes> stored;
  for (const RawChunk& chunk : raw) {
    ChunkInfo info{chunk.type, chunk.flags};
    stored.push_back(std::move(*packChunk(chunk.raw, info)));
    if (stored_only) {
      stored.back() = chunk.raw;
      info.codec = kCodecStored;
      info.stored_bytes = chunk.raw.size();
      info.hash = XXH3_64bits(chunk.raw.data(), chunk.raw.size());
    }
    chunks.push_back(info);
  }
  uint64_t offset = alignUp(kPreambleBytes + chunks.size() * kEntryBytes);
  for (ChunkInfo& chunk : chunks) {
    chunk.offset = offset;
    offset = alignUp(offset + chunk.stored_bytes);
  }
  const std::vector<ChunkInfo> honest = chunks;
  if (forge) forge(chunks);
  Bytes file = encodeChunkTable(chunks);
  for (size_t i = 0; i < stored.size(); ++i) {
    file.resize(std::max<size_t>(file.size(), honest[i].offset));
    file.insert(file.end(), stored[i].begin(), stored[i].end());
  }
  return file;
}

std::string listed(const std::vector<Issue>& issues) {
  std::ostringstream text;
  for (const Issue& issue : issues) text << issue.id << " " << issue.where << ": " << issue.text << "\n";
  return text.str();
}

// Both readers name the issue, and the message has a place and a text.
void expectRejected(const Bytes& file, int id) {
  const std::vector<Issue> issues = validateAsset(file, "test");
  const auto found =
      std::find_if(issues.begin(), issues.end(), [id](const Issue& issue) { return issue.id == id; });
  ASSERT_NE(found, issues.end()) << "no issue " << id << " among\n" << listed(issues);
  EXPECT_EQ(found->where.substr(0, 4), "test");
  EXPECT_FALSE(found->text.empty());
  EXPECT_FALSE(parseAsset(file, "test").ok());
}

// --- the container ---

using Chunks = std::vector<ChunkInfo>;

void expectForgedTableRejected(int id, const std::function<void(Chunks&)>& forge) {
  expectRejected(assemble(rawChunks(test::fusedMaterial()), forge), id);
}

TEST(AssetIssues, ForgedFilesAreWhatTheWriterWritesIfNothingIsForged) {
  for (const Material& material :
       {test::fusedMaterial(), test::splitFusedMaterial(), test::splitSurfaceMaterial()})
    EXPECT_TRUE(assemble(rawChunks(material)) == *serializeAsset(material));
}

TEST(AssetIssues, Magic) {
  Bytes file = *serializeAsset(test::fusedMaterial());
  file[8] = std::byte{'\n'};  // as a copy in text mode would
  expectRejected(file, issue_id::kMagic);
  expectRejected(Bytes(100, std::byte{0}), issue_id::kMagic);
}

TEST(AssetIssues, Version) {
  Bytes file = *serializeAsset(test::fusedMaterial());
  file[12] = std::byte{2};
  expectRejected(file, issue_id::kVersion);
}

TEST(AssetIssues, Truncated) {
  Bytes file = *serializeAsset(test::fusedMaterial());
  file.pop_back();
  expectRejected(file, issue_id::kTruncated);
  expectRejected({}, issue_id::kTruncated);
}

TEST(AssetIssues, ChunkTable) {
  expectForgedTableRejected(issue_id::kChunkTable, [](Chunks& chunks) { chunks[1].flags = 3; });
  expectForgedTableRejected(issue_id::kChunkTable, [](Chunks& chunks) { chunks[1].offset += 4; });
  expectForgedTableRejected(issue_id::kChunkTable, [](Chunks& chunks) { chunks[1].raw_bytes = 0; });
  expectForgedTableRejected(issue_id::kChunkTable, [](Chunks& chunks) { chunks[1].codec = kCodecStored; });
  expectForgedTableRejected(issue_id::kChunkTable, [](Chunks& chunks) { chunks[1].flags = 0; });
  expectForgedTableRejected(issue_id::kChunkTable,
                            [](Chunks& chunks) { chunks.back().flags = kFlagCritical; });
}

TEST(AssetIssues, ChunkChecksum) {
  Bytes file = *serializeAsset(test::fusedMaterial());
  file.back() ^= std::byte{1};
  expectRejected(file, issue_id::kChunkChecksum);
  expectForgedTableRejected(issue_id::kChunkChecksum, [](Chunks& chunks) { chunks[2].hash ^= 1; });
  Bytes table = *serializeAsset(test::fusedMaterial());
  table[kPreambleBytes + 40] ^= std::byte{1};
  expectRejected(table, issue_id::kChunkChecksum);
}

TEST(AssetIssues, ChunkCodec) {
  expectForgedTableRejected(issue_id::kChunkCodec, [](Chunks& chunks) { chunks[1].codec = 2; });
  std::vector<RawChunk> chunks = rawChunks(test::lodMaterial());
  // Noise is stored as it is, and is no zstd frame.
  expectRejected(assemble(chunks, [](Chunks& infos) { infos.back().codec = kCodecZstd; }),
                 issue_id::kChunkCodec);
}

TEST(AssetIssues, UnknownCritical) {
  std::vector<RawChunk> chunks = rawChunks(test::fusedMaterial());
  chunks.insert(chunks.begin() + 2, {fourCharacters("NEWS"), Bytes(100, std::byte{7}), kFlagCritical});
  expectRejected(assemble(chunks), issue_id::kUnknownCritical);
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

TEST(AssetIssues, Padding) {
  Bytes file = *serializeAsset(test::fusedMaterial());
  uint64_t head = 0;
  std::memcpy(&head, file.data() + kPreambleBytes + 16, sizeof head);
  file[head - 1] = std::byte{1};
  expectRejected(file, issue_id::kPadding);
  expectForgedTableRejected(issue_id::kPadding, [](Chunks& chunks) { chunks.back().offset += 64; });
}

TEST(AssetIssues, Overlap) {
  expectForgedTableRejected(issue_id::kOverlap, [](Chunks& chunks) { chunks[2].offset = chunks[1].offset; });
  expectForgedTableRejected(issue_id::kOverlap, [](Chunks& chunks) { chunks[0].offset = 0; });
}

TEST(AssetIssues, Duplicate) {
  std::vector<RawChunk> chunks = rawChunks(test::fusedMaterial());
  chunks.push_back(chunks.back());
  expectRejected(assemble(chunks), issue_id::kDuplicate);
}

TEST(AssetIssues, Trailing) {
  Bytes file = *serializeAsset(test::fusedMaterial());
  file.push_back(std::byte{0});
  expectRejected(file, issue_id::kTrailing);
  std::vector<RawChunk> chunks = rawChunks(test::fusedMaterial());
  chunks[0].raw.push_back(std::byte{0});
  expectRejected(assemble(chunks), issue_id::kTrailing);
}

TEST(AssetIssues, Limit) {
  expectForgedTableRejected(issue_id::kLimit, [](Chunks& chunks) { chunks[1].raw_bytes = 1ull << 32; });
  expectForgedTableRejected(issue_id::kLimit, [](Chunks& chunks) { chunks[1].stored_bytes = ~0ull; });
  expectForgedTableRejected(issue_id::kLimit,
                            [](Chunks& chunks) { chunks[1].raw_bytes = chunks[1].stored_bytes * 1000 + 1; });
  expectForgedTableRejected(issue_id::kLimit, [](Chunks& chunks) {
    chunks[1].raw_bytes = chunks[2].raw_bytes = (1ull << 29) + 1;
    chunks[1].stored_bytes = chunks[2].stored_bytes = 1ull << 28;
  });
  Bytes file = *serializeAsset(test::fusedMaterial());
  file[16] = std::byte{85};
  expectRejected(file, issue_id::kLimit);
  file[16] = std::byte{0};
  expectRejected(file, issue_id::kLimit);
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

TEST(AssetIssues, MissingChunk) {
  std::vector<RawChunk> chunks = rawChunks(test::fusedMaterial());
  chunks.erase(chunks.begin() + 2);
  expectRejected(assemble(chunks), issue_id::kMissingChunk);
  chunks.erase(chunks.begin());
  expectRejected(assemble(chunks), issue_id::kMissingChunk);
}

TEST(AssetIssues, Order) {
  std::vector<RawChunk> chunks = rawChunks(test::fusedMaterial());
  std::swap(chunks[1], chunks[2]);
  expectRejected(assemble(chunks), issue_id::kOrder);
}

// A leading part and its rest are held against the header's numbers one by one.
TEST(AssetIssues, SplitPartsOfTheWrongSize) {
  for (const Material& material : {test::splitFusedMaterial(), test::splitSurfaceMaterial()}) {
    const std::vector<Part> parts = partsOf(material);
    for (size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].share == Part::Share::kWhole) continue;
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

// --- the material: the writer refuses what the readers refuse ---

void expectBothReject(const Material& material, int id) {
  const Result<Bytes> written = serializeAsset(material);
  ASSERT_FALSE(written.ok()) << "the writer took it";
  EXPECT_EQ(written.issue().id, id) << written.issue().where << ": " << written.issue().text;
  expectRejected(assemble(rawChunks(material)), id);
}

using Change = std::function<void(Material&)>;

void expectEachRejected(Material (*make)(), int id, std::initializer_list<Change> changes) {
  int index = 0;
  for (const Change& change : changes) {
    SCOPED_TRACE("change " + std::to_string(index++));
    Material material = make();
    change(material);
    expectBothReject(material, id);
  }
}

TEST(AssetIssues, HeaderField) {
  expectEachRejected(test::fusedMaterial, issue_id::kHeaderField,
                     {
                         [](Material& m) { m.mode = static_cast<Mode>(3); },
                         [](Material& m) { m.mode = Mode::kSurface; },
                         [](Material& m) { m.side = 0; },
                         [](Material& m) { m.side = 16385; },
                         [](Material& m) { m.side = -1; },
                         [](Material& m) { m.side = 16384; },
                         [](Material& m) { m.mean.ka = 3.4e38f; },
                         [](Material& m) { m.mean.kd = -65505; },
                         [](Material& m) { m.value_scale = 65505; },
                         [](Material& m) { m.lambda_min = -1; },
                         [](Material& m) { m.lambda_max = kNan; },
                         [](Material& m) { m.value_scale = 0; },
                         [](Material& m) { m.value_scale = kInfinity; },
                         [](Material& m) { m.theta_max = 2; },
                         [](Material& m) { m.aspect = m.geometry.aspect = 0; },
                         [](Material& m) { m.aspect = m.geometry.aspect = 9; },
                         [](Material& m) { m.period = -1; },
                         [](Material& m) { m.period = kInfinity; },
                         [](Material& m) { m.mean.ks = kNan; },
                         [](Material& m) { m.mean.alpha = -1; },
                         [](Material& m) { m.mean.chroma = static_cast<MeanChroma>(2); },
                         [](Material& m) { m.name = "a\nb"; },
                         [](Material& m) { m.name = "\xC0\x80"; },
                         [](Material& m) { m.meta_json = "\xED\xA0\x80"; },
                         [](Material& m) { m.meta_json = std::string(1, '\0'); },
                     });
}

TEST(AssetIssues, Directions) {
  expectEachRejected(test::lodMaterial, issue_id::kDirections,
                     {
                         [](Material& m) { m.lights.kind = static_cast<DirectionSetKind>(5); },
                         [](Material& m) { m.lights.kind = DirectionSetKind::kBonn81; },
                         [](Material& m) { m.lights.kind = DirectionSetKind::kConcentric; },
                         [](Material& m) { m.lights.side = 3; },
                         [](Material& m) {
                           m.views.samples[1] = {2, 0, 0};
                         },
                         [](Material& m) { m.views.samples[1].x = kNan; },
                         [](Material& m) {
                           m.views.samples[1] = {0, 0, -1};
                         },
                     });
}

TEST(AssetIssues, BandField) {
  expectEachRejected(test::fusedMaterial, issue_id::kBandField,
                     {
                         [](Material& m) { m.bands[0].domain = static_cast<Domain>(2); },
                         [](Material& m) { m.bands[0].filter = static_cast<WeightFilter>(2); },
                         [](Material& m) { m.bands[0].layout = static_cast<TableLayout>(2); },
                         [](Material& m) { m.bands[0].layout = TableLayout::kNearest; },
                         [](Material& m) { m.mode = Mode::kLod; },
                         [](Material& m) {
                           m.bands[0].window = {0, 0, 1, 2};
                         },
                         [](Material& m) {
                           m.bands[0].window = {0, 1, kNan, 2};
                         },
                         [](Material& m) {
                           m.bands[0].window = {0, 1, 2, kInfinity};
                         },
                         [](Material& m) { m.bands[1].lambda_first = 33; },
                         [](Material& m) { m.bands[1].lead_quads = -1; },
                         [](Material& m) { m.bands[1].lead_quads = 2; },
                         [](Material& m) { m.bands[0].lead_quads = 1; },
                         [](Material& m) { m.bands[0].quad_scale[0].z = kNan; },
                         [](Material& m) { m.bands[0].ratio_scale.x = kInfinity; },
                         [](Material& m) { m.bands[0].ratio_scale.y = 1e9f; },
                         [](Material& m) { m.bands[0].quad_scale[0].x = -65505; },
                         [](Material& m) { m.bands[0].weights.format = TexelFormat::kRGBA8Unorm; },
                         [](Material& m) { m.bands[0].weights.mips = 9; },
                         [](Material& m) { m.bands[0].weights.depth = 1; },
                         [](Material& m) { m.bands[0].table.width = 4; },
                         [](Material& m) { m.bands[1].table.height = 10; },
                     });
  Material spare = test::lodMaterial();
  spare.bands[2].weights.data.back() = std::byte{1};
  spare.bands[2].weights.data[spare.bands[2].weights.data.size() - 2] = std::byte{1};
  expectBothReject(spare, issue_id::kBandField);
}

TEST(AssetIssues, BandsOutOfOrder) {
  Material material = test::lodMaterial();
  std::swap(material.bands[0], material.bands[1]);
  expectBothReject(material, issue_id::kOrder);
}

TEST(AssetIssues, ExtentLimit) {
  expectEachRejected(test::fusedMaterial, issue_id::kLimit,
                     {
                         [](Material& m) { m.bands[1].weights.height = 16385; },
                         [](Material& m) { m.bands[1].weights.width = 0; },
                     });
}

TEST(AssetIssues, MapField) {
  expectEachRejected(test::surfaceMaterial, issue_id::kMapField,
                     {
                         [](Material& m) { m.geometry.range.z = -1; },
                         [](Material& m) { m.geometry.range.x = kNan; },
                         [](Material& m) { m.atlas.texels = 0; },
                         [](Material& m) { m.atlas.texels = 129; },
                         [](Material& m) { m.atlas.directions = 0; },
                         [](Material& m) { m.atlas.directions = 46; },
                         [](Material& m) { m.atlas.directions = -1; },
                         [](Material& m) { m.stored_vdim->zeniths = 1; },
                         [](Material& m) { m.stored_vdim->range.y = kInfinity; },
                         [](Material& m) { m.surface->specular_scale = kNan; },
                         [](Material& m) { m.surface->specular_scale = 65537; },
                         [](Material& m) { m.surface->normal.mips = 9; },
                         [](Material& m) { m.surface->color.mips = 3; },
                         [](Material& m) { m.surface->ambient.mips = 2; },
                         [](Material& m) { m.surface->lambda_first = -9; },
                         [](Material& m) { m.surface->ambient_first = kInfinity; },
                         [](Material& m) { m.surface->fade_end = m.surface->fade_begin; },
                         [](Material& m) { m.surface->fade_begin = -kInfinity; },
                         [](Material& m) { m.surface->specular_scale = 1e30f; },
                         [](Material& m) { m.surface->lobe = static_cast<Lobe>(2); },
                         [](Material& m) { m.surface->visibility = static_cast<Visibility>(4); },
                         [](Material& m) { m.surface->visibility = Visibility::kMap; },
                         [](Material& m) { m.surface->tail_mip = 4; },
                         [](Material& m) { m.surface->tail_mip = -1; },
                     });
  expectEachRejected(test::nearMaterial, issue_id::kMapField,
                     {
                         [](Material& m) { m.surface->shadow = {}; },
                         [](Material& m) { m.surface->shadow_table = {}; },
                         [](Material& m) { m.surface->shadow.mips = 3; },
                         [](Material& m) { m.surface->shadow.depth = 2; },
                         [](Material& m) { m.surface->shadow_table.depth = 2; },
                         [](Material& m) { m.surface->shadow_table.width = 4; },
                         [](Material& m) { m.surface->shadow_table.width = 257; },
                         [](Material& m) { m.surface->shadow_table.mips = 2; },
                     });
}

// A small file that would keep a loader busy for hours: a surface that is a wall in every patch, or all in
// one place.
TEST(AssetIssues, SurfaceTornEverywhere) {
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
  const auto checkered = [&](int side, float depth) {
    return surface(side, true, [=](int i, int j) {
      return glm::dvec3((i + 0.5) / side, (j + 0.5) / side, (i + j) % 2 ? -depth : 0);
    });
  };
  expectBothReject(checkered(256, 4), issue_id::kMapField);
  EXPECT_TRUE(serializeAsset(checkered(256, 0.05f)).ok()) << "a rough surface";
  const auto gathered = [&](int side) {
    return surface(side, false,
                   [=](int i, int j) { return glm::dvec3(0.5 + 1e-5 * i, 0.5 + 1e-5 * j, -0.01); });
  };
  expectBothReject(gathered(520), issue_id::kMapField);
  EXPECT_TRUE(serializeAsset(gathered(64)).ok());
}

TEST(AssetIssues, MapSize) {
  // Texels that do not fill the extents: the writer sees the vector, the reader the chunk.
  expectEachRejected(test::surfaceMaterial, issue_id::kMapSize,
                     {
                         [](Material& m) { m.geometry.texels.data.pop_back(); },
                         [](Material& m) { m.surface->color.data.resize(10); },
                     });
  expectEachRejected(test::fusedMaterial, issue_id::kMapSize,
                     {[](Material& m) { m.bands[0].table.data.push_back(std::byte{0}); }});
}

TEST(AssetIssues, NonFiniteTexels) {
  Material material = test::lodMaterial();
  for (const float value : {kNan, -kInfinity, 65505.f, -1e38f}) {
    std::memcpy(material.bands[0].table.data.data() + 4, &value, sizeof value);
    expectBothReject(material, issue_id::kNonFinite);
  }
  const float greatest = -65504;
  std::memcpy(material.bands[0].table.data.data() + 4, &greatest, sizeof greatest);
  EXPECT_TRUE(serializeAsset(material).ok());

  material = test::lodMaterial();
  Band& band = material.bands[1];
  band.weights = test::noiseTexture(TexelFormat::kRGBA16Sfloat, TextureShape::kArray2D, 4, 4, 3, 1, 1);
  const uint16_t half_infinity = 0xfc00;
  std::memcpy(band.weights.data.data() + 2, &half_infinity, sizeof half_infinity);
  expectBothReject(material, issue_id::kNonFinite);
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
    if (kind.id >= 2000 && kind.id < 5000)
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
