#include <algorithm>

#include "material/asset/asset.h"
#include "material/asset/asset_check.h"
#include "material/asset/asset_chunks.h"
#include "material/asset/asset_header.h"

namespace loden {
namespace {

using namespace asset;  // NOLINT: this file is the other half of it

std::vector<std::byte> rawBytes(const Material& material, const Part& part) {
  if (part.type == kHead) return encodeHeader(material);
  if (part.type == kMeta) {
    const auto bytes = std::as_bytes(std::span(material.meta_json));
    return {bytes.begin(), bytes.end()};
  }
  return gatherTexels(material, part);
}

// The reader's checks, so that nothing is written that cannot be read.
void checkWritable(const Material& material, const std::vector<Part>& parts, IssueList& issues) {
  checkMaterial(material, issues);
  if (!issues.empty()) return;
  checkMeta(material.meta_json, issues);
  uint64_t raw_bytes = 0;
  for (const Part& part : parts) raw_bytes += partBytes(material, part);
  issues.require(raw_bytes <= AssetLimits::kMaxAssetBytes, issue_id::kAssetBytes, "", raw_bytes,
                 " bytes of texels; the limit is ", AssetLimits::kMaxAssetBytes);
  for (const Part& part : parts) checkPartTexels(material, part, chunkName(part.type), issues);
}

Result<std::vector<std::byte>> serialize(const Material& material) {
  IssueList issues(material.name.empty() ? "material" : material.name);
  const std::vector<Part> parts = partsOf(material);
  checkWritable(material, parts, issues);
  if (!issues.empty()) return issues.first();

  std::vector<ChunkInfo> chunks;
  std::vector<std::vector<std::byte>> stored;
  for (const Part& part : parts) {
    ChunkInfo chunk{part.type, part.type == kMeta ? 0 : kFlagCritical};
    auto packed = packChunk(rawBytes(material, part), chunk);
    if (!packed) return packed.issue();
    chunks.push_back(chunk);
    stored.push_back(std::move(*packed));
  }
  uint64_t offset = alignUp(kPreambleBytes + chunks.size() * kEntryBytes);
  for (ChunkInfo& chunk : chunks) {
    chunk.offset = offset;
    offset = alignUp(offset + chunk.stored_bytes);
  }
  std::vector<std::byte> file = encodeChunkTable(chunks);
  file.reserve(offset);
  for (size_t i = 0; i < chunks.size(); ++i) {
    file.resize(chunks[i].offset);
    file.insert(file.end(), stored[i].begin(), stored[i].end());
  }
  return file;
}

}  // namespace

Result<std::vector<std::byte>> serializeAsset(const Material& material) {
  return withoutExceptions(material.name, [&] { return serialize(material); });
}

}  // namespace loden
