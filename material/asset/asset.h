// The .loden container (normative text: material/FORMAT.md): writing, reading whole, reading by prefix and by
// byte range, and checking.
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

namespace loden {

// What the runtime's shaders read of a material (shaders/loden_shared.h); files may hold more.
struct ShaderLimits {
  static constexpr int kMaxBands = 8;
  static constexpr int kMaxQuads = 16;  // of one band, of all kinds together
};

// Limits of the format; FORMAT.md section "Limits" lists the same names and numbers, and a test compares
// them.
struct AssetLimits {
  static constexpr uint32_t kMaxSide = 16384;         // any texture extent, and the reference texels per side
  static constexpr uint32_t kMaxBands = 32;           // bands of a material
  static constexpr uint32_t kMaxQuads = 64;           // quads of one band, of each kind
  static constexpr uint32_t kMaxDirections = 256;     // samples of a direction set; lookups store a byte each
  static constexpr uint32_t kMaxGridSide = 256;       // rows, and columns, of a direction grid
  static constexpr uint32_t kMaxGeometrySide = 2048;  // texels per side of a geometry image
  static constexpr uint32_t kMaxAtlasTexels = 128;    // texels per side of a depth atlas
  static constexpr uint32_t kMaxAtlasDirections = 45;  // directions per side; every GL 4.5 has 45 * 45 layers
  static constexpr uint64_t kMaxAtlasWork = kMaxVdimWork;      // to build that atlas
  static constexpr uint64_t kMaxAtlasColumn = kMaxVdimColumn;  // patches per 32nd of a period squared
  static constexpr uint32_t kMaxAspect = 8;                    // sides of a tile's period to one another
  static constexpr uint32_t kMaxTilePeriods = 4;               // any extent of the tile, and any displacement
  static constexpr uint32_t kMaxLambda = 32;                   // levels of detail
  static constexpr uint32_t kMaxFinerLevels = 8;               // of surface maps, below lambda 0
  static constexpr uint32_t kMaxSpecular = 65536;              // specular_scale
  static constexpr uint32_t kMaxNameBytes = 256;               // material name
  static constexpr uint32_t kMaxHeadBytes = 131072;            // raw HEAD; no valid record is longer
  static constexpr uint32_t kMaxMetaBytes = 1048576;           // text about the cooking
  static constexpr uint32_t kMaxChunkBytes = 2147483648;       // one chunk, stored or raw
  static constexpr uint32_t kMaxAssetBytes = 1073741824;       // raw bytes of all chunks together
  static constexpr uint32_t kMaxRatio = 1000;                  // raw : stored
  static constexpr uint32_t kMaxSideRatio = 8;                 // side : the greatest side of a texture
  static constexpr uint32_t kMaxValue = 65504;                 // magnitude of a factor, a scale or a texel
  static constexpr uint32_t kTableEnd = 4096;                  // the chunk table ends within the first 4 KiB,
  static constexpr uint32_t kMaxChunks = 84;                   // which is what fits there
  static constexpr uint32_t kAlignment = 64;                   // of every chunk's offset
};

struct ChunkInfo {
  uint32_t type = 0;   // four characters, first in the lowest byte
  uint32_t flags = 0;  // bit 0: critical
  uint32_t codec = 0;  // 0 stored, 1 zstd
  uint64_t offset = 0, stored_bytes = 0, raw_bytes = 0;
  uint64_t hash = 0;  // XXH3-64 of the stored bytes
};
std::string chunkName(uint32_t type);

// Bytes by range, from a file or from memory; calls may come from a worker thread.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual uint64_t size() const = 0;
  virtual Status read(uint64_t offset, std::span<std::byte> into) const = 0;
};
std::unique_ptr<ByteSource> memorySource(std::vector<std::byte> bytes, std::string name);

// Complete bytes of an asset, identical for identical input.
Result<std::vector<std::byte>> serializeAsset(const Material& material);

// The whole asset; of a prefix that ends at a chunk, what it holds, with Material::lambda_min raised to the
// finest level that this still gives. `name` is used in messages.
Result<Material> parseAsset(std::span<const std::byte> bytes, const std::string& name);
// The same of a source, read as it is needed.
Result<Material> readAsset(const ByteSource& source, const std::string& name);

// Every issue found, the chunk table's first and then in file order; empty if valid, as a prefix that ends at
// a chunk is. Best effort: goes on after an issue where it can.
std::vector<Issue> validateAsset(std::span<const std::byte> bytes, const std::string& name);

// What validateAsset finds without decompressing a texel: in the chunk table, the header, the checksums and
// the padding. Reads the source chunk by chunk.
std::vector<Issue> inspectAsset(const ByteSource& source, const std::string& name);

// An asset opened but not loaded: header, mean and directions are read, bands and maps come on demand. What
// streaming uses. The source may be a prefix, cut anywhere after the header: what is not whole is absent.
class AssetFile {
 public:
  static Result<AssetFile> open(std::shared_ptr<const ByteSource> source, const std::string& name);

  // The material without texel data and META: bands have their description and extents, `data` vectors are
  // empty. Absent parts are described too.
  const Material& skeleton() const { return skeleton_; }
  // The whole chunk table, absent chunks included.
  std::span<const ChunkInfo> chunks() const { return chunks_; }
  // How it was cooked (Material::meta_json); empty if that is absent, since it is optional.
  Result<std::string> loadMeta() const;
  // How many of chunks(), from the front, lie wholly inside the source.
  int presentChunks() const { return present_chunks_; }

  // Stored bytes (on disk) of the chunks behind one band (index as in skeleton().bands); 0 if they are
  // absent.
  uint64_t bandStoredBytes(int band, Share share = Share::kWhole) const;
  // The same of the geometry image, the stored VDIM and the surface maps.
  uint64_t geometryStoredBytes() const;
  uint64_t storedVdimStoredBytes() const;
  uint64_t surfaceStoredBytes(Share share = Share::kWhole) const;

  // Read, check and decompress one part. Each call reads only that part's bytes, and of a whole whose `lead`
  // the same call gave before only the rest. Thread safe. What is absent is an issue (kMissingChunk).
  Result<Band> loadBand(int band, Share share = Share::kWhole, const Band* lead = nullptr) const;
  Result<GeometryImage> loadGeometry() const;
  Result<PaperVdim> loadStoredVdim() const;
  Result<SurfaceMaps> loadSurface(Share share = Share::kWhole, const SurfaceMaps* lead = nullptr) const;

 private:
  // By chunk type; `band` only for BAND.
  uint64_t storedBytes(uint32_t type, int band, Share share) const;
  // A material with this part only. For BAND it is bands[0].
  Result<Material> load(uint32_t type, int band, Share share, std::optional<Material> lead = {}) const;

  std::shared_ptr<const ByteSource> source_;
  std::string name_;
  Material skeleton_;
  std::vector<ChunkInfo> chunks_;
  int present_chunks_ = 0;
};

}  // namespace loden
