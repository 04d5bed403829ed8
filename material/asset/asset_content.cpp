#include "material/asset/asset_content.h"

#include <algorithm>

#include "material/asset/asset_check.h"
#include "material/asset/asset_chunks.h"
#include "material/asset/asset_header.h"
#include "material/model/leading_part.h"

namespace loden::asset {
namespace {

using Limits = AssetLimits;

bool isKnown(uint32_t type) {
  return type == kHead || type == kBand || type == kGeom || type == kVdim || type == kSurf || type == kMeta;
}

void checkTypes(std::span<const ChunkInfo> chunks, IssueList& issues) {
  for (size_t i = 0; i < chunks.size(); ++i) {
    const bool critical = (chunks[i].flags & kFlagCritical) != 0;
    const std::string place = chunkPlace(i, chunks[i].type);
    if (!isKnown(chunks[i].type)) {
      issues.require(!critical, issue_id::kUnknownCritical, place,
                     "unknown, and marked as critical; use a newer Loden");
    } else {
      const bool optional = chunks[i].type == kMeta;
      issues.require(critical != optional, optional ? issue_id::kMetaCritical : issue_id::kNotCritical, place,
                     "wrong critical flag");
    }
  }
}

// Chunks of known types must be the parts that the header declares, in their order; META may follow.
bool checkParts(std::span<const ChunkInfo> chunks, const Material& skeleton, IssueList& issues) {
  std::vector<uint32_t> expected, actual;
  for (const Part& part : partsOf(skeleton)) expected.push_back(part.type);
  for (const ChunkInfo& chunk : chunks) {
    if (isKnown(chunk.type)) actual.push_back(chunk.type);
  }
  if (std::count(actual.begin(), actual.end(), kMeta) > 0) expected.push_back(kMeta);
  bool same_counts = true;
  for (const uint32_t type : {kHead, kBand, kGeom, kVdim, kSurf, kMeta}) {
    const auto needed = std::count(expected.begin(), expected.end(), type);
    const auto given = std::count(actual.begin(), actual.end(), type);
    same_counts = same_counts && needed == given;
    if (given != needed) {
      issues.add(given < needed ? issue_id::kMissingChunk : issue_id::kDuplicate, "chunk table",
                 join(given, " chunks ", chunkName(type), "; the header declares ", needed));
    }
  }
  if (same_counts && actual != expected) {
    issues.add(issue_id::kOrder, "chunk table", "the chunks do not stand in the order of FORMAT.md");
  }
  return actual == expected;
}

// True if HEAD could be read and describes a valid material.
bool readHeader(const ByteSource& source, Contents& contents, IssueList& issues) {
  const ChunkInfo& chunk = contents.chunks.front();
  const std::string place = chunkPlace(0, chunk.type);
  if (chunk.type != kHead) {
    issues.add(issue_id::kNoHead, place, "the first chunk is not HEAD");
    return false;
  }
  if (chunk.raw_bytes > Limits::kMaxHeadBytes) {
    issues.add(issue_id::kHeadBytes, place,
               join(chunk.raw_bytes, " raw bytes; the limit is ", Limits::kMaxHeadBytes));
    return false;
  }
  const Result<std::vector<std::byte>> record = readRaw(source, chunk, issues.where(place));
  if (!record) {
    issues.add(record.issue());
    return false;
  }
  const size_t before = issues.size();
  contents.skeleton = decodeHeader(*record, issues);
  if (issues.size() == before) checkMaterial(contents.skeleton, issues);
  return issues.size() == before;
}

// The end of the source must be the end of a chunk, or lie in the padding behind one.
void checkEnd(const ByteSource& source, const Contents& contents, IssueList& issues) {
  const ChunkInfo& last = contents.chunks.back();
  if (contents.present == static_cast<int>(contents.chunks.size())) {
    const uint64_t behind = source.size() - (last.offset + last.stored_bytes);
    issues.require(behind == 0, issue_id::kTrailing, "", behind, " bytes stand behind the last chunk");
    return;
  }
  const ChunkInfo& cut = contents.chunks[contents.present];
  const bool at_a_chunk = contents.present > 0 && source.size() <= cut.offset;
  issues.require(at_a_chunk, issue_id::kTruncated, chunkPlace(contents.present, cut.type),
                 "the file ends at byte ", source.size(), ", inside the chunk; copy it again");
}

void forgetAbsent(const Contents& contents, Material& material) {
  const auto absent = [&](const Part& part) {
    return chunkOfPart(contents.chunks, contents.skeleton, part) >= contents.present;
  };
  const Material& whole = contents.skeleton;
  const int bands = static_cast<int>(material.bands.size());
  int finest = bands;  // bands of an asset are present from the back
  while (finest > 0 && !absent({kBand, finest - 1})) --finest;
  for (int band = 0; band < finest; ++band) {
    const float coarser = std::min(material.bands[band].window.out_end, material.lambda_max);
    material.lambda_min = std::max(material.lambda_min, coarser);
  }
  material.bands.erase(material.bands.begin(), material.bands.begin() + finest);
  if (absent({kGeom})) material.geometry = {};
  if (absent({kVdim})) material.stored_vdim.reset();
  if (material.surface && absent({kSurf})) {
    if (!whole.bands.empty()) {
      const float coarser = std::min(material.surface->fade_end, material.lambda_max);
      material.lambda_min = std::max(material.lambda_min, coarser);
    }
    material.surface.reset();
  }
}

}  // namespace

Contents readContents(const ByteSource& source, IssueList& issues) {
  Contents contents;
  contents.chunks = readChunkTable(source, issues);
  if (contents.chunks.empty()) return contents;
  const bool table_is_valid = issues.empty();
  contents.present = countPresent(contents.chunks, source.size());
  checkTypes(contents.chunks, issues);
  if (!readHeader(source, contents, issues)) return contents;
  contents.described = checkParts(contents.chunks, contents.skeleton, issues) && table_is_valid;
  return contents;
}

int chunkOfPart(std::span<const ChunkInfo> chunks, const Material& skeleton, const Part& part) {
  int skip = 0;
  for (const Part& before : partsOf(skeleton)) {
    if (before == part) break;
    if (before.type == part.type) ++skip;
  }
  for (size_t i = 0; i < chunks.size(); ++i) {
    if (chunks[i].type == part.type && skip-- == 0) return static_cast<int>(i);
  }
  return -1;
}

namespace {

// A chunk's raw bytes, which must be as many as the description needs. Empty after an issue.
std::vector<std::byte> readTexels(const ByteSource& source, const ChunkInfo& chunk, const std::string& place,
                                  uint64_t needed, IssueList& issues) {
  if (chunk.raw_bytes != needed) {
    issues.add(issue_id::kMapSize, place, join(chunk.raw_bytes, " raw bytes; the header describes ", needed));
    return {};
  }
  Result<std::vector<std::byte>> raw = readRaw(source, chunk, issues.where(place));
  if (raw) return std::move(*raw);
  issues.add(raw.issue());
  return {};
}

void loadMeta(const ByteSource& source, const ChunkInfo& chunk, const std::string& place, Material& material,
              IssueList& issues) {
  if (chunk.raw_bytes > Limits::kMaxMetaBytes) {
    return issues.add(issue_id::kMetaBytes, place,
                      join(chunk.raw_bytes, " raw bytes; the limit is ", Limits::kMaxMetaBytes));
  }
  const Result<std::vector<std::byte>> raw = readRaw(source, chunk, issues.where(place));
  if (!raw) return issues.add(raw.issue());
  material.meta_json.assign(reinterpret_cast<const char*>(raw->data()), raw->size());
  checkMeta(material.meta_json, issues);
}

}  // namespace

void loadPart(const ByteSource& source, const ChunkInfo& chunk, size_t index, const Part& part,
              const Material& described, Material& material, IssueList& issues) {
  const std::string place = chunkPlace(index, chunk.type);
  if (part.type == kHead) return;
  if (part.type == kMeta) return loadMeta(source, chunk, place, material, issues);
  const std::vector<std::byte> raw = readTexels(source, chunk, place, partBytes(described, part), issues);
  if (raw.empty()) return;
  const Part first{part.type, part.band};
  std::vector<std::byte> lead;
  if (part.rest) {
    for (const Texture* t : partTextures(material, first))
      if (t->empty()) return;  // the leading part is damaged
    lead = gatherTexels(material, first);
  }
  if (part.type == kBand) {
    const Band& whole = described.bands[part.band];
    material.bands[part.band] = part.rest ? whole : leadOf(whole);
  }
  if (part.type == kSurf) material.surface = part.rest ? *described.surface : leadOf(*described.surface);
  if (part.rest) scatterTexels(lead, first, material);
  scatterTexels(raw, part, material);
  checkPartTexels(material, part, place, issues);
}

Material readAll(const ByteSource& source, bool stop_at_first, IssueList& issues) {
  const Contents contents = readContents(source, issues);
  const auto stopped = [&] { return contents.chunks.empty() || (stop_at_first && !issues.empty()); };
  if (stopped()) return {};
  Material material = contents.skeleton;
  std::vector<Part> parts = partsOf(material);
  parts.push_back({kMeta});
  auto part = parts.begin();
  for (size_t i = 0; i < contents.chunks.size() && !stopped(); ++i) {
    const ChunkInfo& chunk = contents.chunks[i];
    checkPadding(source, contents.chunks, i, issues);
    if (static_cast<int>(i) >= contents.present) break;
    if (contents.described && isKnown(chunk.type)) {
      loadPart(source, chunk, i, *part++, contents.skeleton, material, issues);
    } else if (i > 0) {
      const auto stored = readStored(source, chunk, issues.where(chunkPlace(i, chunk.type)));
      if (!stored) issues.add(stored.issue());
    }
  }
  if (!stopped()) checkEnd(source, contents, issues);
  forgetAbsent(contents, material);
  return material;
}

void inspectAll(const ByteSource& source, IssueList& issues) {
  const Contents contents = readContents(source, issues);
  if (contents.chunks.empty()) return;
  for (size_t i = 0; i < contents.chunks.size(); ++i) {
    const ChunkInfo& chunk = contents.chunks[i];
    checkPadding(source, contents.chunks, i, issues);
    if (static_cast<int>(i) >= contents.present) break;
    if (i == 0) continue;  // HEAD has been read
    const auto stored = readStored(source, chunk, issues.where(chunkPlace(i, chunk.type)));
    if (!stored) issues.add(stored.issue());
  }
  checkEnd(source, contents, issues);
}

}  // namespace loden::asset
