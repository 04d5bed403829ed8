// The container: round trips, order, prefixes, damage.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "material/asset/asset.h"
#include "material/asset/asset_format.h"
#include "material/base/issues.h"
#include "material/eval/evaluate.h"
#include "material/model/leading_part.h"
#include "tests/unit/material_fixtures.h"

namespace loden {
namespace {

using test::expectSame;
using Bytes = std::vector<std::byte>;

const auto kMakers = {test::surfaceMaterial,      test::lodMaterial,        test::fusedMaterial,
                      test::splitSurfaceMaterial, test::splitFusedMaterial, test::nearMaterial};

Bytes serialized(const Material& material) {
  Result<Bytes> bytes = serializeAsset(material);
  EXPECT_TRUE(bytes.ok()) << bytes.issue().where << ": " << bytes.issue().text;
  return std::move(*bytes);
}

Result<AssetFile> openBytes(Bytes bytes) {
  return AssetFile::open(memorySource(std::move(bytes), "test"), "test");
}

Bytes prefix(const Bytes& bytes, size_t count) {
  return {bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(count)};
}

TEST(Asset, ReturnsWhatWasWritten) {
  for (const auto make : kMakers) {
    const Material material = make();
    SCOPED_TRACE(material.name);
    const Bytes bytes = serialized(material);
    const Result<Material> read = parseAsset(bytes, "test");
    ASSERT_TRUE(read.ok()) << read.issue().where << ": " << read.issue().text;
    expectSame(material, *read);
    EXPECT_TRUE(validateAsset(bytes, "test").empty());
    EXPECT_TRUE(serialized(*read) == bytes) << "not byte-identical after a round trip";
  }
}

TEST(Asset, WritesTheSameBytesEachTime) {
  for (const auto make : kMakers) EXPECT_TRUE(serialized(make()) == serialized(make()));
}

TEST(Asset, LoadsEachPartByItself) {
  for (const auto make : kMakers) {
    const Material material = make();
    SCOPED_TRACE(material.name);
    const Result<AssetFile> file = openBytes(serialized(material));
    ASSERT_TRUE(file.ok());
    Material read = file->skeleton();
    for (size_t i = 0; i < read.bands.size(); ++i) {
      EXPECT_TRUE(read.bands[i].weights.empty());
      EXPECT_GT(file->storedBytes({PartKind::kBand, static_cast<int>(i)}), 0u);
      read.bands[i] = *file->loadBand(static_cast<int>(i));
    }
    EXPECT_EQ(file->storedBytes({PartKind::kGeometry}) > 0, !material.geometry.empty());
    if (!material.geometry.empty()) read.geometry = *file->loadGeometry();
    if (material.stored_vdim) read.stored_vdim = *file->loadStoredVdim();
    if (material.surface) read.surface = *file->loadSurface();
    read.meta_json = *file->loadMeta();
    expectSame(material, read);
  }
}

TEST(Asset, OrdersChunksFromCoarseToFine) {
  std::string order;
  const Result<AssetFile> file = openBytes(serialized(test::fusedMaterial()));
  for (const ChunkInfo& chunk : file->chunks()) order += chunkName(chunk.type) + " ";
  EXPECT_EQ(order, "HEAD BAND GEOM BAND META ");
  EXPECT_EQ(file->storedBytes({PartKind::kBand, 1}), file->chunks()[1].stored_bytes)
      << "the coarse band comes first";
  EXPECT_EQ(file->storedBytes({PartKind::kBand, 0}), file->chunks()[3].stored_bytes);
}

// Bytes read through it.
class Counter final : public ByteSource {
 public:
  explicit Counter(Bytes bytes) : source_(memorySource(std::move(bytes), "test")) {}
  uint64_t size() const override { return source_->size(); }
  Status read(uint64_t offset, std::span<std::byte> into) const override {
    count += into.size();
    return source_->read(offset, into);
  }
  mutable uint64_t count = 0;

 private:
  std::unique_ptr<ByteSource> source_;
};

TEST(Asset, LoadsALeadingPartByItselfAndThenTheRestAlone) {
  for (const Material& material : {test::splitFusedMaterial(), test::splitSurfaceMaterial()}) {
    SCOPED_TRACE(material.name);
    const auto counter = std::make_shared<Counter>(serialized(material));
    const Result<AssetFile> file = AssetFile::open(counter, "test");
    ASSERT_TRUE(file.ok());
    const bool bands = !material.bands.empty();
    const uint64_t stored =
        bands ? file->storedBytes({PartKind::kBand, 1}) : file->storedBytes({PartKind::kSurface});
    counter->count = 0;
    Material expected = material, lead = material, whole = material;
    if (bands) {
      expected.bands[1] = leadOf(material.bands[1]);
      lead.bands[1] = *file->loadBand(1, Share::kLead);
    } else {
      expected.surface = leadOf(*material.surface);
      lead.surface = *file->loadSurface(Share::kLead);
    }
    expectSame(lead, expected);
    EXPECT_GT(counter->count, 0u);
    EXPECT_LT(counter->count, stored);
    if (bands)
      whole.bands[1] = *file->loadBand(1, Share::kWhole, &lead.bands[1]);
    else
      whole.surface = *file->loadSurface(Share::kWhole, &*lead.surface);
    expectSame(whole, material);
    EXPECT_EQ(counter->count, stored) << "each byte once";
  }
}

TEST(Asset, PrefixWithALeadingPartAloneIsThatPart) {
  const auto prefixOf = [](const Material& material, size_t chunk) {
    const Bytes bytes = serialized(material);
    const ChunkInfo last = openBytes(bytes)->chunks()[chunk];
    return *parseAsset(prefix(bytes, last.offset + last.stored_bytes), "test");
  };
  const Material fused = test::splitFusedMaterial(), surface = test::splitSurfaceMaterial();
  const Material coarse = prefixOf(fused, 1);
  ASSERT_EQ(coarse.bands.size(), 1u);
  EXPECT_EQ(coarse.bands[0].y_quads, 2);
  EXPECT_EQ(coarse.bands[0].chroma_quads, 0);
  EXPECT_TRUE(coarse.bands[0].ratio);
  EXPECT_TRUE(coarse.bands[0].table.data == leadOf(fused.bands[1]).table.data);
  EXPECT_TRUE(coarse.bands[0].weights.data == leadOf(fused.bands[1]).weights.data);
  EXPECT_EQ(coarse.lambda_min, prefixOf(fused, 2).lambda_min) << "fewer quads are no coarser level";

  const Material tail = prefixOf(surface, 3);
  EXPECT_EQ(tail.surface->color.width, 2);
  EXPECT_EQ(tail.surface->lambda_first, 2);
  const glm::vec3 wi(0.1f, 0.2f, 0.97f), wo(0, 0, 1);
  const Evaluator a(tail), b(surface);
  const auto value = [&](const Evaluator& e, float lambda) {
    return e.evaluate(e.findHit(glm::vec2(0.3f, 0.8f), lambda, wo, Lookup::kNone), wi, wo);
  };
  EXPECT_EQ(value(a, 0.0f), value(b, 2.0f)) << "nothing finer";
  EXPECT_EQ(value(a, 2.5f), value(b, 2.5f));
  EXPECT_TRUE(std::equal(tail.surface->color.data.rbegin(), tail.surface->color.data.rend(),
                         surface.surface->color.data.rbegin()));
}

TEST(Asset, SplitsWhatIsLargerThanALeadingPart) {
  Material small = test::splitFusedMaterial();
  splitLeadingParts(small);
  EXPECT_EQ(small.bands[1].lead_quads, 0) << "fits as a whole";

  Material fused = test::fusedMaterial();
  Band& band = fused.bands[1];
  band.y_quads = 5;
  band.chroma_quads = 0;
  band.ratio = true;
  band.quad_scale.assign(5, glm::vec4(1));
  band.quad_levels.assign(5, {});
  band.weights = Texture::make(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, 32, 32, 6, 6);
  band.table = Texture::make(TexelFormat::kRGBA8Snorm, TextureShape::kVolume, 18, 36, 5 * 18);
  const uint64_t whole = gpuBytes(band);
  splitLeadingParts(fused);
  EXPECT_EQ(band.lead_quads, 1);
  EXPECT_LE(gpuBytes(leadOf(band)), kLeadingPartBytes);
  EXPECT_EQ(leadingPartBytes(fused), gpuBytes(leadOf(band)));
  EXPECT_EQ(gpuBytes(band), whole);
  EXPECT_TRUE(validateAsset(serialized(fused), "test").empty());
  band.table = Texture::make(TexelFormat::kRGBA8Snorm, TextureShape::kVolume, 25, 36, 5 * 25);
  splitLeadingParts(fused);
  EXPECT_EQ(band.lead_quads, 0) << "not even one quad fits";

  Material surface = test::surfaceMaterial();
  for (Texture* map : {&surface.surface->normal, &surface.surface->color, &surface.surface->ambient})
    *map = Texture::make(map->format, map->shape, 64, 64, map->depth, 7);
  splitLeadingParts(surface);
  EXPECT_EQ(surface.surface->tail_mip, 1);
  EXPECT_LE(gpuBytes(leadOf(*surface.surface)), kLeadingPartBytes);
}

TEST(Asset, PutsMapsFirstIfTheCoarsestBandIsFlat) {
  Material material = test::fusedMaterial();
  material.bands.pop_back();
  const Result<AssetFile> file = openBytes(serialized(material));
  EXPECT_EQ(chunkName(file->chunks()[1].type), "GEOM");
}

TEST(Asset, EveryPrefixThatEndsAtAChunkIsACoarserAsset) {
  for (const auto make : kMakers) {
    const Material material = make();
    SCOPED_TRACE(material.name);
    const Bytes bytes = serialized(material);
    const std::vector<ChunkInfo> chunks = [&] {
      const auto file = openBytes(bytes);
      return std::vector<ChunkInfo>(file->chunks().begin(), file->chunks().end());
    }();
    float last_lambda_min = 1e9f;
    for (size_t i = 0; i < chunks.size(); ++i) {
      const Bytes part = prefix(bytes, chunks[i].offset + chunks[i].stored_bytes);
      EXPECT_TRUE(validateAsset(part, "test").empty());
      const Result<Material> read = parseAsset(part, "test");
      ASSERT_TRUE(read.ok()) << read.issue().text;
      EXPECT_LE(read->lambda_min, last_lambda_min) << "more bytes must never be coarser";
      last_lambda_min = read->lambda_min;
      for (const Band& band : read->bands) EXPECT_FALSE(band.weights.empty());
      const Result<Material> again = parseAsset(serialized(*read), "test");
      ASSERT_TRUE(again.ok()) << "a prefix is a material like any other: " << again.issue().text;
      expectSame(*read, *again);
    }
    EXPECT_EQ(last_lambda_min, 0);
  }
}

TEST(Asset, PrefixOfLodStartsAtItsFinestWholeLevel) {
  const Bytes bytes = serialized(test::lodMaterial());
  const Result<AssetFile> whole = openBytes(bytes);
  const ChunkInfo coarsest = whole->chunks()[1];
  const Result<Material> read = parseAsset(prefix(bytes, coarsest.offset + coarsest.stored_bytes), "test");
  ASSERT_TRUE(read.ok());
  ASSERT_EQ(read->bands.size(), 1u);
  EXPECT_EQ(read->bands[0].lambda_first, 2);
  EXPECT_EQ(read->lambda_min, 2);
}

TEST(Asset, RejectsTruncationAtEveryByte) {
  const Bytes bytes = serialized(test::splitFusedMaterial());
  const Result<AssetFile> whole = openBytes(bytes);
  const auto isWhole = [&](size_t size) {  // ends behind a chunk, or in the padding that follows
    for (size_t i = 0; i < whole->chunks().size(); ++i) {
      const ChunkInfo& chunk = whole->chunks()[i];
      const size_t next = i + 1 < whole->chunks().size() ? whole->chunks()[i + 1].offset : bytes.size();
      if (size >= chunk.offset + chunk.stored_bytes && size <= next) return true;
    }
    return false;
  };
  for (size_t size = 0; size < bytes.size(); ++size) {
    const Bytes cut = prefix(bytes, size);
    const Result<Material> read = parseAsset(cut, "test");
    const std::vector<Issue> issues = validateAsset(cut, "test");
    ASSERT_EQ(read.ok(), isWhole(size)) << "cut at " << size;
    ASSERT_EQ(issues.empty(), isWhole(size)) << "cut at " << size;
    if (!read.ok()) {
      const size_t table_end = asset::kPreambleBytes + whole->chunks().size() * asset::kEntryBytes;
      ASSERT_EQ(read.issue().id, size < asset::kPreambleBytes ? issue_id::kPreambleTruncated
                                 : size < table_end           ? issue_id::kTableTruncated
                                                              : issue_id::kTruncated)
          << "cut at " << size;
    }
  }
}

TEST(Asset, DrawsTheWholeChunksOfACutFile) {
  const Bytes bytes = serialized(test::fusedMaterial());
  const Result<AssetFile> whole = openBytes(bytes);
  const ChunkInfo fine = whole->chunks()[3];
  const Result<AssetFile> cut = openBytes(prefix(bytes, fine.offset + fine.stored_bytes - 1));
  ASSERT_TRUE(cut.ok()) << cut.issue().text;
  EXPECT_EQ(cut->presentChunks(), 3);
  EXPECT_EQ(cut->storedBytes({PartKind::kBand, 0}), 0u);
  EXPECT_EQ(cut->loadBand(0).issue().id, issue_id::kMissingChunk);
  EXPECT_TRUE(cut->loadBand(1).ok());
  EXPECT_TRUE(cut->loadGeometry().ok());
}

TEST(Asset, NoticesEveryFlippedBit) {
  const Bytes bytes = serialized(test::splitFusedMaterial());
  const size_t head_end = 1024;  // all bits up to here, one bit of each byte behind
  for (size_t at = 0; at < bytes.size(); ++at) {
    for (int bit = 0; bit < (at < head_end ? 8 : 1); ++bit) {
      Bytes flipped = bytes;
      flipped[at] ^= static_cast<std::byte>(1 << bit);
      ASSERT_FALSE(parseAsset(flipped, "test").ok()) << "byte " << at << ", bit " << bit;
      if (bit == 0) {
        ASSERT_FALSE(validateAsset(flipped, "test").empty()) << "byte " << at;
      }
    }
  }
}

TEST(Asset, StoresWhatCompressesTooWell) {
  Material material = test::lodMaterial();
  Band& band = material.bands[0];
  band.weights = Texture::make(TexelFormat::kRGBA32Sfloat, TextureShape::kArray2D, 256, 256, 3);
  const Bytes bytes = serialized(material);
  EXPECT_TRUE(validateAsset(bytes, "test").empty());
  EXPECT_GT(bytes.size(), band.weights.data.size());
}

}  // namespace
}  // namespace loden
