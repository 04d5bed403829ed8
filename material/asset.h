// The .loden container (normative text: material/FORMAT.md): writing, reading whole, reading by prefix and by
// byte range, and checking.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "material/material.h"
#include "material/result.h"

namespace loden {

// Limits of the format; FORMAT.md section "Limits" lists the same numbers and a test compares them.
struct AssetLimits {
  static constexpr uint32_t kMaxSide = 16384;
  static constexpr uint32_t kMaxBands = 32;
  static constexpr uint32_t kMaxChunks = 4096;
  static constexpr uint32_t kMaxRatio = 1000;  // raw : stored
  static constexpr uint32_t kTableEnd = 4096;  // the chunk table ends within the first 4 KiB
};


struct ChunkInfo {
  uint32_t type = 0;   // four characters, first in the lowest byte
  uint32_t flags = 0;  // bit 0: critical
  uint32_t codec = 0;  // 0 stored, 1 zstd
  uint64_t offset = 0, stored_bytes = 0, raw_bytes = 0;
  uint64_t hash = 0;   // XXH3-64 of the stored bytes
};
std::string chunkName(uint32_t type);

// Complete bytes of an asset, identical for identical input.
Result<std::vector<std::byte>> serializeAsset(const Material& material);
// serializeAsset to a temporary file, fsync, rename, fsync of the folder.
Status writeAsset(const Material& material, const std::filesystem::path& path);

// The whole asset. `name` is used in messages.
Result<Material> parseAsset(std::span<const std::byte> bytes, const std::string& name);
Result<Material> readAsset(const std::filesystem::path& path);

// Every issue found, in file order; empty if valid. Best effort: goes on after an issue where it can.
std::vector<Issue> validateAsset(std::span<const std::byte> bytes, const std::string& name);

// Bytes by range, from a file or from memory; calls may come from a worker thread.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual uint64_t size() const = 0;
  virtual Status read(uint64_t offset, std::span<std::byte> into) const = 0;
};
Result<std::unique_ptr<ByteSource>> openFileSource(const std::filesystem::path& path);
std::unique_ptr<ByteSource> memorySource(std::vector<std::byte> bytes, std::string name);

// An asset opened but not loaded: header, mean and directions are read, bands and maps come on demand. What
// streaming uses, and what makes any prefix that ends at a chunk a valid, coarser asset.
class AssetFile {
 public:
  static Result<AssetFile> open(std::shared_ptr<const ByteSource> source, const std::string& name);

  // The material without texel data: bands have their description and extents, `data` vectors are empty.
  const Material& skeleton() const { return skeleton_; }
  std::span<const ChunkInfo> chunks() const { return chunks_; }
  // Stored bytes (on disk) of the chunk behind one band (index as in skeleton().bands), the geometry image,
  // stored VDIM and surface maps; 0 if there is none.
  uint64_t bandStoredBytes(int band) const;

  // Read, check and decompress one part. Each call reads only that part's bytes. Thread safe.
  Result<Band> loadBand(int band) const;
  Result<GeometryImage> loadGeometry() const;
  Result<PaperVdim> loadStoredVdim() const;
  Result<SurfaceMaps> loadSurface() const;

 private:
  std::shared_ptr<const ByteSource> source_;
  std::string name_;
  Material skeleton_;
  std::vector<ChunkInfo> chunks_;
};

}  // namespace loden
