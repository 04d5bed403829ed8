// The .loden container: writing, checking, and reading whole, by prefix or by byte range. material/FORMAT.md
// is the normative description.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "material/base/result.h"
#include "material/model/leading_part.h"
#include "material/model/maps.h"

namespace loden {

// The limits of the runtime's shaders (shaders/loden_shared.h); files may hold more.
struct ShaderLimits {
  static constexpr int kMaxBands = 8;
  static constexpr int kMaxQuads = 16;  // quads of one band, of all kinds together
};

// Limits of the format. FORMAT.md, section "Limits", lists the same names and numbers, and a test compares
// them.
struct AssetLimits {
  static constexpr uint32_t kMaxSide = 16384;  // any texture extent, and the reference texels per side
  static constexpr uint32_t kMaxBands = 32;    // bands of a material
  static constexpr uint32_t kMaxQuads = 64;    // quads of one band, of each kind
  // Samples of a direction set; look-ups store an index in one byte.
  static constexpr uint32_t kMaxDirections = 256;
  static constexpr uint32_t kMaxGridSide = 256;        // rows, and columns, of a direction grid
  static constexpr uint32_t kMaxGeometrySide = 2048;   // texels per side of a geometry image
  static constexpr uint32_t kMaxAtlasTexels = 128;     // texels per side of a depth atlas
  static constexpr uint32_t kMaxAtlasDirections = 45;  // directions per side; every GL 4.5 has 45 * 45 layers
  static constexpr uint64_t kMaxAtlasWork = kMaxVdimWork;  // work to build a depth atlas (checkVdimWork)
  // Surface patches per column of the tile, 1/32 x 1/32 of a period.
  static constexpr uint64_t kMaxAtlasColumn = kMaxVdimColumn;
  static constexpr uint32_t kMaxAspect = 8;        // ratio of the sides of a tile's period
  static constexpr uint32_t kMaxTilePeriods = 4;   // any extent of the tile, and any displacement
  static constexpr uint32_t kMaxLambda = 32;       // levels of detail
  static constexpr uint32_t kMaxFinerLevels = 8;   // levels of surface maps below lambda 0
  static constexpr uint32_t kMaxSpecular = 65536;  // SurfaceMaps::specular_scale
  static constexpr uint32_t kMaxNameBytes = 256;   // UTF-8 bytes of the material's name
  // Raw bytes of the HEAD chunk; no valid record is longer.
  static constexpr uint32_t kMaxHeadBytes = 131072;
  // Raw bytes of the META chunk, a text about the cooking.
  static constexpr uint32_t kMaxMetaBytes = 1048576;
  static constexpr uint32_t kMaxChunkBytes = 2147483648;  // bytes of one chunk, stored or raw
  static constexpr uint32_t kMaxAssetBytes = 1073741824;  // raw bytes of all chunks together
  static constexpr uint32_t kMaxRatio = 1000;             // ratio of the raw to the stored bytes of a chunk
  // Ratio of Material::side to the greatest side of any texture.
  static constexpr uint32_t kMaxSideRatio = 8;
  static constexpr uint32_t kMaxValue = 65504;  // magnitude of a factor, a scale or a texel
  static constexpr uint32_t kTableEnd = 4096;   // the chunk table ends within this many bytes
  static constexpr uint32_t kMaxChunks = 84;    // entries; as many as fit into kTableEnd
  static constexpr uint32_t kAlignment = 64;    // every chunk's offset is a multiple of this
};

struct ChunkInfo {
  uint32_t type = 0;   // four characters, first in the lowest byte
  uint32_t flags = 0;  // bit 0: critical
  uint32_t codec = 0;  // 0 stored, 1 zstd
  uint64_t offset = 0, stored_bytes = 0, raw_bytes = 0;
  uint64_t hash = 0;  // XXH3-64 of the stored bytes
};
// The chunk type as text, such as "BAND".
std::string chunkName(uint32_t type);

// Bytes that are read by range, from a file or from memory. Calls may come from a worker thread.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual uint64_t size() const = 0;
  virtual Status read(uint64_t offset, std::span<std::byte> into) const = 0;
};
std::unique_ptr<ByteSource> memorySource(std::vector<std::byte> bytes, std::string name);

// The complete bytes of an asset file. Identical materials give identical bytes.
Result<std::vector<std::byte>> serializeAsset(const Material& material);

// The material of an asset. The bytes may also be a prefix of an asset that ends at the end of a chunk: then
// the material has the parts in that prefix, and Material::lambda_min is raised to the finest level that
// these give. `name` is used in messages.
Result<Material> parseAsset(std::span<const std::byte> bytes, const std::string& name);
// The material of an asset, like parseAsset, but from a source that is read as needed.
Result<Material> readAsset(const ByteSource& source, const std::string& name);

// Every issue found: first those of the chunk table, then the others in file order. Empty if the asset is
// valid, and also for a valid asset's prefix that ends at the end of a chunk. After an issue the check
// continues as far as it can.
std::vector<Issue> validateAsset(std::span<const std::byte> bytes, const std::string& name);

// The issues that validateAsset finds without decompressing texels: in the chunk table, the header, the
// checksums and the padding. Reads the source chunk by chunk.
std::vector<Issue> inspectAsset(const ByteSource& source, const std::string& name);

// An asset that is opened but not loaded, for streaming: header, mean and directions are read, and bands and
// maps are loaded on demand. The source may be a prefix of an asset, cut anywhere after the header: parts
// that are not whole count as absent.
class AssetFile {
 public:
  static Result<AssetFile> open(std::shared_ptr<const ByteSource> source, const std::string& name);

  // The material without texel data and META: bands and maps have their descriptions and extents, but their
  // `data` vectors are empty. Parts that are absent from the source are described too.
  const Material& skeleton() const { return skeleton_; }
  // The whole chunk table, absent chunks included.
  std::span<const ChunkInfo> chunks() const { return chunks_; }
  // Material::meta_json, the text about how the asset was cooked; empty if the asset has none, since it is
  // optional.
  Result<std::string> loadMeta() const;
  // The number of chunks, counted from the front of chunks(), that lie wholly inside the source.
  int presentChunks() const { return present_chunks_; }

  // The stored bytes (on disk) of the chunks of one part of skeleton(); 0 if they are absent.
  uint64_t storedBytes(const MaterialPart& part, Share share = Share::kWhole) const;

  // One part, read, checked and decompressed. Each call reads only that part's bytes. For Share::kWhole,
  // `lead` may be the part that a call for Share::kLead returned; then only the rest is read. Thread safe.
  // Issues: kMissingChunk if the part is absent, and those of validateAsset.
  Result<Band> loadBand(int band, Share share = Share::kWhole, const Band* lead = nullptr) const;
  Result<GeometryImage> loadGeometry() const;
  Result<PaperVdim> loadStoredVdim() const;
  Result<SurfaceMaps> loadSurface(Share share = Share::kWhole, const SurfaceMaps* lead = nullptr) const;

 private:
  // A material with only this part. A band becomes bands[0].
  Result<Material> load(uint32_t type, int band, Share share, std::optional<Material> lead = {}) const;

  std::shared_ptr<const ByteSource> source_;
  std::string name_;
  Material skeleton_;
  std::vector<ChunkInfo> chunks_;
  int present_chunks_ = 0;
};

}  // namespace loden
