// The container: round trips, order, prefixes, damage.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "material/asset.h"
#include "material/issues.h"
#include "tests/unit/material_fixtures.h"

namespace loden {
namespace {

using test::expectSame;
using Bytes = std::vector<std::byte>;

const auto kMakers = {test::surfaceMaterial, test::lodMaterial, test::fusedMaterial, test::lightFactorMaterial};

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
      EXPECT_GT(file->bandStoredBytes(static_cast<int>(i)), 0u);
      read.bands[i] = *file->loadBand(static_cast<int>(i));
    }
    EXPECT_EQ(file->geometryStoredBytes() > 0, !material.geometry.empty());
    if (!material.geometry.empty()) read.geometry = *file->loadGeometry();
    if (material.stored_vdim) read.stored_vdim = *file->loadStoredVdim();
    if (material.surface) read.surface = *file->loadSurface();
    expectSame(material, read);
  }
}

TEST(Asset, OrdersChunksFromCoarseToFine) {
  std::string order;
  const Result<AssetFile> file = openBytes(serialized(test::fusedMaterial()));
  for (const ChunkInfo& chunk : file->chunks()) order += chunkName(chunk.type) + " ";
  EXPECT_EQ(order, "HEAD BAND GEOM BAND META ");
  EXPECT_EQ(file->bandStoredBytes(1), file->chunks()[1].stored_bytes) << "the coarse band comes first";
  EXPECT_EQ(file->bandStoredBytes(0), file->chunks()[3].stored_bytes);
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
  const Bytes bytes = serialized(test::fusedMaterial());
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
      ASSERT_EQ(read.issue().id, issue_id::kTruncated) << "cut at " << size;
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
  EXPECT_EQ(cut->bandStoredBytes(0), 0u);
  EXPECT_EQ(cut->loadBand(0).issue().id, issue_id::kMissingChunk);
  EXPECT_TRUE(cut->loadBand(1).ok());
  EXPECT_TRUE(cut->loadGeometry().ok());
}

TEST(Asset, NoticesEveryFlippedBit) {
  const Bytes bytes = serialized(test::fusedMaterial());
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
