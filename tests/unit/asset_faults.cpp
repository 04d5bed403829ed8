#include "tests/unit/asset_faults.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "material/asset/asset.h"
#include "material/asset/asset_header.h"
#include "material/base/issues.h"
#include "tests/unit/material_fixtures.h"

namespace loden::test {

using namespace asset;  // NOLINT: forges files from the container's own pieces

std::vector<RawChunk> rawChunks(const Material& material) {
  std::vector<RawChunk> chunks;
  for (const Part& part : partsOf(material)) {
    RawChunk chunk{part.type, {}};
    if (part.type == kHead) chunk.raw = encodeHeader(material);
    if (part.type == kMeta) {
      const auto text = std::as_bytes(std::span(material.meta_json));
      chunk = {kMeta, {text.begin(), text.end()}, 0};
    }
    if (partsOf(material, part.type, part.band).size() > 1)
      chunk.raw = gatherTexels(material, part);
    else
      for (const Texture* t : partTextures(material, part))
        chunk.raw.insert(chunk.raw.end(), t->data.begin(), t->data.end());
    chunks.push_back(std::move(chunk));
  }
  return chunks;
}

Bytes assemble(const std::vector<RawChunk>& raw, const std::function<void(std::vector<ChunkInfo>&)>& forge,
               bool stored_only) {
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

namespace {

namespace id = issue_id;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

using Chunks = std::vector<ChunkInfo>;
using RawChunks = std::vector<RawChunk>;
using Make = Material (*)();
using Change = std::function<void(Material&)>;

// The table's checksum again, after a change of the bytes before the first chunk.
void sealTable(Bytes& file, size_t chunks) {
  Bytes hashed(file.begin(), file.begin() + static_cast<ptrdiff_t>(kPreambleBytes + chunks * kEntryBytes));
  hashed.erase(hashed.begin() + kPreambleBytes - 8, hashed.begin() + kPreambleBytes);
  const uint64_t hash = XXH3_64bits(hashed.data(), hashed.size());
  std::memcpy(file.data() + kPreambleBytes - 8, &hash, sizeof hash);
}

class FaultList {
 public:
  void file(int id, const char* what, Bytes bytes) {
    faults_.push_back({id, what, std::move(bytes), std::nullopt});
  }
  void table(int id, const char* what, const std::function<void(Chunks&)>& forge) {
    file(id, what, assemble(rawChunks(fusedMaterial()), forge));
  }
  void chunks(int id, const char* what, const std::function<void(RawChunks&)>& change,
              Make make = fusedMaterial) {
    RawChunks raw = rawChunks(make());
    change(raw);
    file(id, what, assemble(raw));
  }
  // Field `at` of HEAD, a 32-bit number counted from its front.
  void headField(int id, const char* what, size_t at, uint32_t value, Make make = fusedMaterial) {
    chunks(
        id, what, [&](RawChunks& raw) { std::memcpy(raw[0].raw.data() + 4 * at, &value, sizeof value); },
        make);
  }
  void material(int id, const char* what, Make make, const Change& change) {
    Material material = make();
    change(material);
    Bytes bytes = assemble(rawChunks(material));
    faults_.push_back({id, what, std::move(bytes), std::move(material)});
  }
  // A changed HEAD before the sound texels, for changes that choose which texels stand where.
  void header(int id, const char* what, const Change& change) {
    Material material = fusedMaterial();
    RawChunks raw = rawChunks(material);
    change(material);
    raw[0].raw = encodeHeader(material);
    faults_.push_back({id, what, assemble(raw), std::move(material)});
  }
  std::vector<AssetFault> take() { return std::move(faults_); }

 private:
  std::vector<AssetFault> faults_;
};

void addPreamble(FaultList& list) {
  const Bytes sound = *serializeAsset(fusedMaterial());
  const size_t chunks = rawChunks(fusedMaterial()).size();
  const auto with = [&](size_t at, int value, bool seal = false) {
    Bytes file = sound;
    file[at] = static_cast<std::byte>(value);
    if (seal) sealTable(file, chunks);
    return file;
  };
  const auto cut = [&](size_t size) { return Bytes(sound.begin(), sound.begin() + ptrdiff_t(size)); };
  list.file(id::kMagic, "a copy in text mode", with(8, '\n'));
  list.file(id::kMagic, "zeros", Bytes(100));
  list.file(id::kVersion, "2.0", with(12, 2));
  list.file(id::kPreambleTruncated, "an empty file", {});
  list.file(id::kPreambleTruncated, "31 bytes", cut(31));
  list.file(id::kTableTruncated, "the first entry", cut(kPreambleBytes + kEntryBytes));
  list.file(id::kTruncated, "the last byte is missing", cut(sound.size() - 1));
  list.file(id::kTableReserved, "the preamble's", with(20, 1, true));
  list.file(id::kChunkReserved, "the first entry's", with(kPreambleBytes + 12, 1, true));
  list.file(id::kChunkCount, "none", with(16, 0));
  list.file(id::kChunkCount, "85", with(16, 85));
  list.file(id::kTableChecksum, "a changed entry", with(kPreambleBytes - 1, 0x5a));
  uint64_t head = 0;
  std::memcpy(&head, sound.data() + kPreambleBytes + 16, sizeof head);
  list.file(id::kPadding, "before HEAD", with(head - 1, 1));
  Bytes longer = sound;
  longer.push_back(std::byte{0});
  list.file(id::kTrailing, "a zero", longer);
  // What stands before BAND is whole.
  Chunks infos;
  assemble(rawChunks(fusedMaterial()), [&](Chunks& honest) { infos = honest; });
  list.file(id::kPrefix, "HEAD and a band", cut(infos[2].offset));
}

void addTable(FaultList& list) {
  list.table(id::kChunkChecksum, "a band's", [](Chunks& c) { c[2].hash ^= 1; });
  list.table(id::kChunkCodec, "2", [](Chunks& c) { c[1].codec = 2; });
  list.table(id::kChunkFlags, "2", [](Chunks& c) { c[1].flags |= 2; });
  list.table(id::kNotCritical, "a band", [](Chunks& c) { c[1].flags = 0; });
  list.table(id::kMetaCritical, "META", [](Chunks& c) { c.back().flags = kFlagCritical; });
  list.table(id::kChunkEmpty, "no raw bytes", [](Chunks& c) {
    c[1].codec = kCodecZstd;
    c[1].raw_bytes = 0;
  });
  list.table(id::kChunkBytes, "4 GiB raw", [](Chunks& c) { c[1].raw_bytes = 1ull << 32; });
  list.table(id::kChunkRatio, "1001", [](Chunks& c) {
    c[1].codec = kCodecZstd;
    c[1].raw_bytes = c[1].stored_bytes * AssetLimits::kMaxRatio + 1;
  });
  list.table(id::kStoredSize, "one byte more", [](Chunks& c) { ++c.back().raw_bytes; });
  // META stands so many zeros later than it has to.
  for (const auto& [id, zeros] : {std::pair{id::kChunkAlignment, size_t{4}}, {id::kGap, size_t{64}}}) {
    uint64_t stored = 0;
    Bytes file = assemble(rawChunks(fusedMaterial()), [&, zeros = zeros](Chunks& c) {
      c.back().offset += zeros;
      stored = c.back().stored_bytes;
    });
    file.insert(file.end() - static_cast<ptrdiff_t>(stored), zeros, std::byte{0});
    list.file(id, "META", std::move(file));
  }
  {  // Two chunks alike, so that every checksum holds.
    RawChunks raw = rawChunks(fusedMaterial());
    raw.insert(raw.end() - 1, 2, {fourCharacters("NEWS"), Bytes(100, std::byte{7}), 0});
    list.file(id::kOverlap, "another chunk",
              assemble(raw, [](Chunks& c) { (c.end() - 2)->offset = (c.end() - 3)->offset; }));
  }
  {  // Enough stored bytes to claim more than a GiB within the ratio.
    RawChunks raw = rawChunks(fusedMaterial());
    const Texture noise = noiseTexture(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, 640, 640, 1, 1, 7);
    raw.insert(raw.end() - 1, {fourCharacters("NEWS"), noise.data, 0});
    list.file(id::kAssetBytes, "more than a GiB", assemble(raw, [](Chunks& c) {
                ChunkInfo& news = *(c.end() - 2);
                news.codec = kCodecZstd;
                news.raw_bytes = uint64_t{AssetLimits::kMaxAssetBytes} + 1;
              }));
  }
}

void addChunks(FaultList& list) {
  list.chunks(id::kUnknownCritical, "NEWS", [](RawChunks& raw) {
    raw.insert(raw.begin() + 2, {fourCharacters("NEWS"), Bytes(100, std::byte{7}), kFlagCritical});
  });
  list.chunks(id::kDuplicate, "META twice", [](RawChunks& raw) { raw.push_back(RawChunk(raw.back())); });
  list.chunks(id::kMissingChunk, "a band", [](RawChunks& raw) { raw.erase(raw.begin() + 3); });
  list.chunks(id::kNoHead, "no HEAD at all", [](RawChunks& raw) { raw.erase(raw.begin()); });
  list.chunks(id::kOrder, "maps before the coarsest band", [](RawChunks& raw) { std::swap(raw[1], raw[2]); });
  list.chunks(id::kHeadBytes, "131073", [](RawChunks& raw) {
    const Texture noise = noiseTexture(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, 182, 182, 1, 1, 7);
    raw[0].raw.insert(raw[0].raw.end(), noise.data.begin(), noise.data.end());
  });
  list.chunks(id::kMetaBytes, "1048577", [](RawChunks& raw) {
    raw.back().raw.assign(AssetLimits::kMaxMetaBytes + 1, std::byte{'a'});
    for (size_t i = 0; i < raw.back().raw.size(); ++i)
      raw.back().raw[i] = static_cast<std::byte>('a' + (i * 2654435761u >> 7) % 26);
  });
  {  // The writer stores noise as it is, so that it is no zstd frame.
    const RawChunks raw = rawChunks(lodMaterial());
    list.file(id::kZstdFrame, "noise", assemble(raw, [](Chunks& c) { c.back().codec = kCodecZstd; }));
  }
  {  // A frame's header states the raw size; the block behind it is damaged, and the checksum is right.
    RawChunks raw = rawChunks(fusedMaterial());
    const std::string text = "{\"repeated\": \"" + std::string(4000, 'x') + "\"}";
    const auto bytes = std::as_bytes(std::span(text));
    raw.back().raw.assign(bytes.begin(), bytes.end());
    ChunkInfo packed{kMeta, 0};
    Bytes frame = *packChunk(raw.back().raw, packed);
    for (size_t i = 0; i < 4; ++i) frame[frame.size() - 1 - i] ^= std::byte{0xff};
    const auto damaged = [&](Chunks& c) { c.back().hash = XXH3_64bits(frame.data(), frame.size()); };
    Bytes file = assemble(raw, damaged);
    std::copy(frame.begin(), frame.end(), file.end() - static_cast<ptrdiff_t>(frame.size()));
    list.file(id::kZstdDamaged, "the end of META's", std::move(file));
  }
}

// Places of 32-bit fields of HEAD, whatever the material is (material/FORMAT.md, section 4).
constexpr size_t kCosineField = 5, kPartsField = 16, kLightsField = 17;
constexpr size_t kDirectionFields = 3;  // of an empty set

void addHeader(FaultList& list) {
  list.chunks(id::kHeadTruncated, "20 bytes", [](RawChunks& raw) { raw[0].raw.resize(20); });
  list.headField(id::kHeadCount, "200 lights", kLightsField + 2, 200);
  list.chunks(id::kHeadTrailing, "a zero", [](RawChunks& raw) { raw[0].raw.push_back(std::byte{0}); });
  list.headField(id::kBoolean, "2", kCosineField, 2);
  list.headField(id::kParts, "8", kPartsField, 8);
  list.headField(id::kDirectionCount, "257 lights", kLightsField + 2, 257);
  list.headField(id::kBandCount, "33", kLightsField + 2 * kDirectionFields, 33);
  list.headField(id::kQuadCount, "65 of Y", kLightsField + 2 * kDirectionFields + 1 + 8, 65);

  const auto fused = [&](int id, const char* what, const Change& change) {
    list.material(id, what, fusedMaterial, change);
  };
  fused(id::kMode, "3", [](Material& m) { m.mode = static_cast<Mode>(3); });
  fused(id::kSurfaceBands, "two", [](Material& m) { m.mode = Mode::kSurface; });
  fused(id::kSide, "0", [](Material& m) { m.side = 0; });
  fused(id::kSide, "16385", [](Material& m) { m.side = 16385; });
  fused(id::kSide, "-1", [](Material& m) { m.side = -1; });
  fused(id::kSideRatio, "16384", [](Material& m) { m.side = 16384; });
  fused(id::kLambdaMin, "-1", [](Material& m) { m.lambda_min = -1; });
  fused(id::kLambdaMin, "33", [](Material& m) { m.lambda_min = 33; });
  fused(id::kLambdaMax, "not finite", [](Material& m) { m.lambda_max = kNan; });
  fused(id::kLambdaOrder, "above", [](Material& m) { m.lambda_min = m.lambda_max + 0.5f; });
  fused(id::kValueScale, "0", [](Material& m) { m.value_scale = 0; });
  fused(id::kValueScale, "65505", [](Material& m) { m.value_scale = 65505; });
  fused(id::kValueScale, "infinite", [](Material& m) { m.value_scale = kInfinity; });
  fused(id::kThetaMax, "2", [](Material& m) { m.theta_max = 2; });
  fused(id::kAspect, "0", [](Material& m) { m.aspect = m.geometry.aspect = 0; });
  fused(id::kAspect, "9", [](Material& m) { m.aspect = m.geometry.aspect = 9; });
  fused(id::kPeriod, "-1", [](Material& m) { m.period = -1; });
  fused(id::kPeriod, "infinite", [](Material& m) { m.period = kInfinity; });
  fused(id::kNameText, "a line end", [](Material& m) { m.name = "a\nb"; });
  fused(id::kNameText, "an overlong zero", [](Material& m) { m.name = "\xC0\x80"; });
  fused(id::kNameBytes, "257", [](Material& m) { m.name.assign(257, 'a'); });
  fused(id::kMetaText, "a surrogate", [](Material& m) { m.meta_json = "\xED\xA0\x80"; });
  fused(id::kMetaText, "a zero", [](Material& m) { m.meta_json = std::string(1, '\0'); });
  fused(id::kMeanCoefficient, "ka", [](Material& m) { m.mean.ka = 3.4e38f; });
  fused(id::kMeanCoefficient, "kd", [](Material& m) { m.mean.kd = -65505; });
  fused(id::kMeanCoefficient, "ks", [](Material& m) { m.mean.ks = kNan; });
  fused(id::kMeanAlpha, "-1", [](Material& m) { m.mean.alpha = -1; });
  fused(id::kMeanChroma, "2", [](Material& m) { m.mean.chroma = static_cast<MeanChroma>(2); });
}

void addDirections(FaultList& list) {
  const auto lod = [&](int id, const char* what, const Change& change) {
    list.material(id, what, lodMaterial, change);
  };
  lod(id::kDirectionKind, "5", [](Material& m) { m.lights.kind = static_cast<DirectionSetKind>(5); });
  lod(id::kDirectionSet, "three of Bonn's 81",
      [](Material& m) { m.lights.kind = DirectionSetKind::kBonn81; });
  lod(id::kDirectionSide, "a concentric set of none",
      [](Material& m) { m.lights.kind = DirectionSetKind::kConcentric; });
  lod(id::kDirectionSide, "3 of another kind", [](Material& m) { m.lights.side = 3; });
  lod(id::kDirectionLength, "2", [](Material& m) { m.views.samples[1] = glm::dvec3(2, 0, 0); });
  lod(id::kDirectionLength, "not finite", [](Material& m) { m.views.samples[1].x = kNan; });
  lod(id::kDirectionBelow, "straight down", [](Material& m) { m.views.samples[1] = glm::dvec3(0, 0, -1); });
}

void addBands(FaultList& list) {
  const auto fused = [&](int id, const char* what, const Change& change) {
    list.material(id, what, fusedMaterial, change);
  };
  fused(id::kBandDomain, "2", [](Material& m) { m.bands[0].domain = static_cast<Domain>(2); });
  fused(id::kBandFilter, "2", [](Material& m) { m.bands[0].filter = static_cast<WeightFilter>(2); });
  fused(id::kBandLayout, "2", [](Material& m) { m.bands[1].layout = static_cast<TableLayout>(2); });
  fused(id::kLodFlatBand, "one", [](Material& m) { m.mode = Mode::kLod; });
  fused(id::kWindowFinite, "the third edge", [](Material& m) { m.bands[0].window = Window{0, 1, kNan, 2}; });
  fused(id::kWindowFinite, "the last edge", [](Material& m) {
    m.bands[0].window = Window{0, 1, 2, kInfinity};
  });
  fused(id::kWindowOrder, "no slope", [](Material& m) { m.bands[0].window = Window{0, 0, 1, 2}; });
  fused(id::kBandLambda, "33", [](Material& m) { m.bands[1].lambda_first = 33; });
  fused(id::kNoQuads, "none", [](Material& m) {
    m.bands[0].y_quads = m.bands[0].chroma_quads = 0;
    m.bands[0].quad_scale.clear();
    m.bands[0].quad_levels.clear();
  });
  fused(id::kQuadScale, "not finite", [](Material& m) { m.bands[0].quad_scale[0].z = kNan; });
  fused(id::kQuadLevels, "not a number", [](Material& m) { m.bands[1].quad_levels[0].end = kNan; });
  fused(id::kQuadLevels, "not finite", [](Material& m) { m.bands[1].quad_levels[1].end = kInfinity; });
  fused(id::kQuadLevels, "ends after the quad before",
        [](Material& m) { m.bands[1].quad_levels[1].end = m.bands[1].quad_levels[0].end + 1; });
  fused(id::kQuadLevels, "begins before the quad before",
        [](Material& m) { m.bands[1].quad_levels[1].begin = m.bands[1].quad_levels[0].begin - 1; });
  fused(id::kQuadScale, "-65505", [](Material& m) { m.bands[0].quad_scale[0].x = -65505; });
  fused(id::kRatioScale, "infinite", [](Material& m) { m.bands[0].ratio_scale.x = kInfinity; });
  fused(id::kRatioScale, "1e9", [](Material& m) { m.bands[0].ratio_scale.y = 1e9f; });
  list.header(id::kLeadQuads, "-1", [](Material& m) { m.bands[1].lead_quads = -1; });
  list.header(id::kLeadQuads, "more than y_quads", [](Material& m) { m.bands[1].lead_quads = 2; });
  list.header(id::kLeadQuads, "no rest", [](Material& m) { m.bands[0].lead_quads = 1; });
  fused(id::kWeightFormat, "8 bits without a sign",
        [](Material& m) { m.bands[0].weights.format = TexelFormat::kRGBA8Unorm; });
  fused(id::kWeightExtent, "16385", [](Material& m) { m.bands[1].weights.height = 16385; });
  fused(id::kWeightExtent, "0", [](Material& m) { m.bands[1].weights.width = 0; });
  fused(id::kWeightMips, "9", [](Material& m) { m.bands[0].weights.mips = 9; });
  fused(id::kWeightSquare, "4 x 5", [](Material& m) { m.bands[1].weights.height = 5; });
  fused(id::kWeightLayers, "one", [](Material& m) { m.bands[0].weights.depth = 1; });
  fused(id::kTableFormat, "8 bits without a sign",
        [](Material& m) { m.bands[0].table.format = TexelFormat::kRGBA8Unorm; });
  fused(id::kTableExtent, "16385", [](Material& m) { m.bands[0].table.height = 16385; });
  fused(id::kTableSize, "no directions", [](Material& m) { m.bands[0].layout = TableLayout::kNearest; });
  fused(id::kTableSize, "10 pairs of zeniths", [](Material& m) { m.bands[1].table.height = 10; });
  list.material(id::kTableSize, "four lights for three", lodMaterial,
                [](Material& m) { m.bands[1].table.width = 4; });
  fused(id::kTableGrid, "one azimuth", [](Material& m) {
    m.bands[0].table = Texture::make(TexelFormat::kRGBA8Snorm, TextureShape::kVolume, 1, 9, 1);
  });
  list.material(id::kBandOrder, "the first two", lodMaterial,
                [](Material& m) { std::swap(m.bands[0], m.bands[1]); });
  list.material(id::kSpareLayer, "its last texel", lodMaterial, [](Material& m) {
    Bytes& data = m.bands[2].weights.data;
    data[data.size() - 1] = data[data.size() - 2] = std::byte{1};
  });
}

void addTexels(FaultList& list) {
  for (const auto& [value, id] : {std::pair{kNan, id::kNonFinite},
                                  {-kInfinity, id::kNonFinite},
                                  {65505.f, id::kTexelRange},
                                  {-1e38f, id::kTexelRange}})
    list.material(id, "a table's", lodMaterial, [value = value](Material& m) {
      std::memcpy(m.bands[0].table.data.data() + 4, &value, sizeof value);
    });
  list.material(id::kNonFinite, "a half float", lodMaterial, [](Material& m) {
    Band& band = m.bands[1];
    band.weights = noiseTexture(TexelFormat::kRGBA16Sfloat, TextureShape::kArray2D, 4, 4, 3, 1, 1);
    const uint16_t half_infinity = 0xfc00;
    std::memcpy(band.weights.data.data() + 2, &half_infinity, sizeof half_infinity);
  });
  // Texels that do not fill the extents: the writer sees the vector, the reader the chunk.
  list.material(id::kMapSize, "geometry", surfaceMaterial,
                [](Material& m) { m.geometry.texels.data.pop_back(); });
  list.material(id::kMapSize, "color map", surfaceMaterial,
                [](Material& m) { m.surface->color.data.resize(10); });
  list.material(id::kMapSize, "a table", fusedMaterial,
                [](Material& m) { m.bands[0].table.data.push_back(std::byte{0}); });
}

void addGeometry(FaultList& list) {
  const auto surface = [&](int id, const char* what, const Change& change) {
    list.material(id, what, surfaceMaterial, change);
  };
  surface(id::kGeometrySide, "2049",
          [](Material& m) { m.geometry.texels.width = m.geometry.texels.height = 2049; });
  surface(id::kGeometryRange, "-1", [](Material& m) { m.geometry.range.z = -1; });
  surface(id::kGeometryRange, "not finite", [](Material& m) { m.geometry.range.x = kNan; });
  surface(id::kAtlasTexels, "0", [](Material& m) { m.atlas.texels = 0; });
  surface(id::kAtlasTexels, "129", [](Material& m) { m.atlas.texels = 129; });
  surface(id::kAtlasDirections, "0", [](Material& m) { m.atlas.directions = 0; });
  surface(id::kAtlasDirections, "46", [](Material& m) { m.atlas.directions = 46; });
  surface(id::kAtlasDirections, "-1", [](Material& m) { m.atlas.directions = -1; });
  surface(id::kVdimSide, "0", [](Material& m) { m.stored_vdim->side = 0; });
  surface(id::kVdimZeniths, "1", [](Material& m) { m.stored_vdim->zeniths = 1; });
  surface(id::kVdimAzimuths, "1", [](Material& m) { m.stored_vdim->azimuths = 1; });
  surface(id::kVdimRange, "infinite", [](Material& m) { m.stored_vdim->range.y = kInfinity; });
  surface(id::kVdimExtent, "2049 azimuths of 8 texels", [](Material& m) {
    m.stored_vdim->azimuths = 2049;
    m.stored_vdim->packed.width = 2049 * m.stored_vdim->side;
  });

  // Small files that would keep a loader busy for hours: a surface that is a wall in every patch, or all in
  // one place.
  const auto shape = [&](int id, const char* what, int side, bool identity, const auto& position) {
    surface(id, what, [&](Material& m) {
      std::vector<glm::dvec3> positions;
      for (int t = 0; t < side * side; ++t) positions.push_back(position(t % side, t / side));
      m.geometry = encodeGeometryImage(side, positions, std::vector<uint16_t>(positions.size(), 1), identity);
      m.geometry.aspect = m.aspect;
      m.atlas = {};
    });
  };
  shape(id::kAtlasWork, "a chequered height field", 256, true,
        [](int i, int j) { return glm::dvec3((i + 0.5) / 256, (j + 0.5) / 256, (i + j) % 2 ? -3.9 : 0.0); });
  shape(id::kAtlasColumn, "a heap", 520, false,
        [](int i, int j) { return glm::dvec3(0.5 + 1e-5 * i, 0.5 + 1e-5 * j, -0.01); });
}

void addMaps(FaultList& list) {
  const auto surface = [&](int id, const char* what, const std::function<void(SurfaceMaps&)>& change) {
    list.material(id, what, surfaceMaterial, [&](Material& m) { change(*m.surface); });
  };
  const auto near = [&](int id, const char* what, const std::function<void(SurfaceMaps&)>& change) {
    list.material(id, what, nearMaterial, [&](Material& m) { change(*m.surface); });
  };
  list.material(id::kLodMaps, "a lod material", surfaceMaterial, [](Material& m) { m.mode = Mode::kLod; });
  surface(id::kLobe, "2", [](SurfaceMaps& s) { s.lobe = static_cast<Lobe>(2); });
  surface(id::kVisibility, "4", [](SurfaceMaps& s) { s.visibility = static_cast<Visibility>(4); });
  surface(id::kShadowMissing, "none", [](SurfaceMaps& s) { s.visibility = Visibility::kMap; });
  surface(id::kSpecularScale, "not finite", [](SurfaceMaps& s) { s.specular_scale = kNan; });
  surface(id::kSpecularScale, "65537", [](SurfaceMaps& s) { s.specular_scale = 65537; });
  surface(id::kMapLevel, "-9", [](SurfaceMaps& s) { s.lambda_first = -9; });
  surface(id::kAmbientLevel, "infinite", [](SurfaceMaps& s) { s.ambient_first = kInfinity; });
  surface(id::kFadeOrder, "at once", [](SurfaceMaps& s) { s.fade_end = s.fade_begin; });
  surface(id::kFadeRange, "infinite", [](SurfaceMaps& s) { s.fade_begin = -kInfinity; });
  surface(id::kMapExtent, "16385", [](SurfaceMaps& s) { s.normal.width = 16385; });
  surface(id::kMapLayers, "three of ambient light", [](SurfaceMaps& s) { s.ambient.depth = 3; });
  surface(id::kMapMips, "9", [](SurfaceMaps& s) { s.normal.mips = 9; });
  surface(id::kMapAverage, "3", [](SurfaceMaps& s) { s.color.mips = 3; });
  surface(id::kMapAverage, "2", [](SurfaceMaps& s) { s.ambient.mips = 2; });
  surface(id::kTailMip, "4", [](SurfaceMaps& s) { s.tail_mip = 4; });
  surface(id::kTailMip, "-1", [](SurfaceMaps& s) { s.tail_mip = -1; });
  near(id::kTailBands, "1", [](SurfaceMaps& s) { s.tail_mip = 1; });
  near(id::kShadowPair, "no map", [](SurfaceMaps& s) { s.shadow = {}; });
  near(id::kShadowPair, "no table", [](SurfaceMaps& s) { s.shadow_table = {}; });
  near(id::kShadowExtent, "3 mips", [](SurfaceMaps& s) { s.shadow.mips = 3; });
  near(id::kShadowLayers, "the map's", [](SurfaceMaps& s) { s.shadow.depth = 2; });
  near(id::kShadowLayers, "the table's", [](SurfaceMaps& s) { s.shadow_table.depth = 2; });
  near(id::kShadowTable, "4 x 5", [](SurfaceMaps& s) { s.shadow_table.width = 4; });
  near(id::kShadowTable, "257 x 257",
       [](SurfaceMaps& s) { s.shadow_table.width = s.shadow_table.height = 257; });
  near(id::kShadowTable, "2 mips", [](SurfaceMaps& s) { s.shadow_table.mips = 2; });
  near(id::kMapLayers, "one of indirect light", [](SurfaceMaps& s) { s.indirect.depth = 1; });
  near(id::kIndirectExtent, "3 mips", [](SurfaceMaps& s) { s.indirect.mips = 3; });
  near(id::kIndirectExtent, "4 x 8", [](SurfaceMaps& s) { s.indirect.width = 4; });
}

}  // namespace

std::vector<AssetFault> assetFaults() {
  FaultList list;
  for (const auto add : {addPreamble, addTable, addChunks, addHeader, addDirections, addBands, addTexels,
                         addGeometry, addMaps})
    add(list);
  return list.take();
}

}  // namespace loden::test
