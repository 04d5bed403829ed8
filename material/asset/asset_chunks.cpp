#include "material/asset/asset_chunks.h"

#include <xxhash.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <cstring>

#include "material/base/byte_cursor.h"

namespace loden::asset {
namespace {

using Limits = AssetLimits;

constexpr int kZstdLevel = 15;
constexpr size_t kHashOffset = kPreambleBytes - sizeof(uint64_t);  // of the table's hash

// XXH3-64 of the preamble before its hash field, followed by the table.
uint64_t tableHash(std::span<const std::byte> preamble_and_table) {
  std::vector<std::byte> hashed(preamble_and_table.begin(), preamble_and_table.end());
  hashed.erase(hashed.begin() + kHashOffset, hashed.begin() + kPreambleBytes);
  return XXH3_64bits(hashed.data(), hashed.size());
}

uint64_t tableEnd(size_t chunks) {
  return kPreambleBytes + chunks * kEntryBytes;
}

// False, with an issue, if these are not the first bytes of an asset that this version reads.
bool checkPreamble(std::span<const std::byte> bytes, IssueList& issues) {
  const size_t magic_bytes = std::min(bytes.size(), kMagic.size());
  const bool magic =
      std::equal(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(magic_bytes), kMagic.begin(),
                 [](std::byte a, uint8_t b) { return static_cast<uint8_t>(a) == b; });
  if (!magic) {
    issues.add(issue_id::kMagic, "", "not a Loden asset, or damaged by a copy in text mode");
    return false;
  }
  if (bytes.size() < kPreambleBytes) {
    issues.add(issue_id::kPreambleTruncated, "", "the file ends inside its preamble; copy it again");
    return false;
  }
  ByteCursor in(bytes.subspan(kMagic.size()));
  const uint16_t major = in.u16(), minor = in.u16();
  if (major == kMajor) return true;
  issues.add(issue_id::kVersion, "", join("version ", major, ".", minor, " is not 1.x; use a newer Loden"));
  return false;
}

ChunkInfo readEntry(ByteCursor& in, size_t index, IssueList& issues) {
  ChunkInfo chunk;
  chunk.type = in.u32();
  chunk.flags = in.u32();
  chunk.codec = in.u32();
  const uint32_t reserved = in.u32();
  chunk.offset = in.u64();
  chunk.stored_bytes = in.u64();
  chunk.raw_bytes = in.u64();
  chunk.hash = in.u64();
  issues.require(reserved == 0, issue_id::kChunkReserved, chunkPlace(index, chunk.type),
                 "a reserved field is not zero");
  return chunk;
}

// One entry by itself.
void checkEntry(const ChunkInfo& chunk, const std::string& place, IssueList& issues) {
  issues.require((chunk.flags & ~kFlagCritical) == 0, issue_id::kChunkFlags, place, "unknown flags ",
                 chunk.flags);
  issues.require(chunk.codec <= kCodecZstd, issue_id::kChunkCodec, place, "unknown codec ", chunk.codec);
  issues.require(chunk.stored_bytes > 0 && chunk.raw_bytes > 0, issue_id::kChunkEmpty, place,
                 "the chunk is empty");
  const uint64_t most = Limits::kMaxChunkBytes;
  const bool fits = chunk.stored_bytes <= most && chunk.raw_bytes <= most;
  issues.require(fits, issue_id::kChunkBytes, place, "a size is beyond the limit of ", most, " bytes");
  if (!fits || chunk.stored_bytes == 0) return;
  issues.require(chunk.codec != kCodecStored || chunk.raw_bytes == chunk.stored_bytes, issue_id::kStoredSize,
                 place, "a chunk that is not compressed has two different sizes");
  issues.require(chunk.codec != kCodecZstd || chunk.raw_bytes <= chunk.stored_bytes * Limits::kMaxRatio,
                 issue_id::kChunkRatio, place, "raw : stored is above ", Limits::kMaxRatio);
}

// Chunks follow each other in table order, with less than one alignment of padding between them.
void checkOffsets(std::span<const ChunkInfo> chunks, IssueList& issues) {
  uint64_t expected = alignUp(tableEnd(chunks.size()));
  for (size_t i = 0; i < chunks.size(); ++i) {
    const ChunkInfo& chunk = chunks[i];
    const std::string place = chunkPlace(i, chunk.type);
    if (chunk.offset % Limits::kAlignment != 0) {
      issues.add(issue_id::kChunkAlignment, place,
                 join("offset ", chunk.offset, " is not a multiple of ", Limits::kAlignment));
    } else if (chunk.offset < expected) {
      issues.add(issue_id::kOverlap, place,
                 join("offset ", chunk.offset, " overlaps what stands before ", expected));
    } else if (chunk.offset > expected) {
      issues.add(issue_id::kGap, place, join("a gap from ", expected, " to offset ", chunk.offset));
    }
    expected = alignUp(expected + std::min<uint64_t>(chunk.stored_bytes, Limits::kMaxChunkBytes));
  }
}

Issue chunkIssue(int id, const std::string& where, std::string text) {
  return {id, Severity::kError, where, std::move(text)};
}

Result<std::vector<std::byte>> decompress(std::span<const std::byte> stored, uint64_t raw_bytes,
                                          const std::string& where) {
  if (ZSTD_getFrameContentSize(stored.data(), stored.size()) != raw_bytes ||
      ZSTD_findFrameCompressedSize(stored.data(), stored.size()) != stored.size()) {
    return chunkIssue(issue_id::kZstdFrame, where, "not one zstd frame of the raw size");
  }
  std::vector<std::byte> raw(raw_bytes);
  const size_t got = ZSTD_decompress(raw.data(), raw.size(), stored.data(), stored.size());
  if (ZSTD_getErrorCode(got) == ZSTD_error_memory_allocation) return memoryIssue(where, "zstd has no room");
  if (ZSTD_isError(got) || got != raw_bytes) {
    return chunkIssue(issue_id::kZstdDamaged, where, "the zstd frame is damaged");
  }
  return raw;
}

}  // namespace

Result<std::vector<std::byte>> packChunk(std::span<const std::byte> raw, ChunkInfo& chunk) {
  if (raw.size() > Limits::kMaxChunkBytes) {
    return chunkIssue(issue_id::kChunkBytes, chunkName(chunk.type),
                      join(raw.size(), " bytes; the limit is ", Limits::kMaxChunkBytes));
  }
  std::vector<std::byte> stored(ZSTD_compressBound(raw.size()));
  const size_t got = ZSTD_compress(stored.data(), stored.size(), raw.data(), raw.size(), kZstdLevel);
  if (ZSTD_isError(got)) return chunkIssue(issue_id::kMemory, chunkName(chunk.type), ZSTD_getErrorName(got));
  const bool worth_it = got < raw.size() && raw.size() <= uint64_t{got} * Limits::kMaxRatio;
  if (worth_it) {
    stored.resize(got);
  } else {
    stored.assign(raw.begin(), raw.end());
  }
  chunk.codec = worth_it ? kCodecZstd : kCodecStored;
  chunk.stored_bytes = stored.size();
  chunk.raw_bytes = raw.size();
  chunk.hash = XXH3_64bits(stored.data(), stored.size());
  return stored;
}

std::vector<std::byte> encodeChunkTable(std::span<const ChunkInfo> chunks) {
  ByteWriter out;
  out.bytes(std::as_bytes(std::span(kMagic)));
  out.u16(kMajor);
  out.u16(kMinor);
  out.u32(static_cast<uint32_t>(chunks.size()));
  out.u32(0);
  out.u64(0);
  for (const ChunkInfo& chunk : chunks) {
    for (const uint32_t field : {chunk.type, chunk.flags, chunk.codec, 0u}) out.u32(field);
    for (const uint64_t field : {chunk.offset, chunk.stored_bytes, chunk.raw_bytes, chunk.hash})
      out.u64(field);
  }
  std::vector<std::byte> bytes = out.take();
  const uint64_t hash = tableHash(bytes);
  std::memcpy(bytes.data() + kHashOffset, &hash, sizeof hash);
  bytes.resize(alignUp(bytes.size()));
  return bytes;
}

std::vector<ChunkInfo> readChunkTable(const ByteSource& source, IssueList& issues) {
  std::vector<std::byte> bytes(std::min<uint64_t>(source.size(), Limits::kTableEnd));
  if (const Status read = source.read(0, bytes); !read) {
    issues.add(read.issue());
    return {};
  }
  if (!checkPreamble(bytes, issues)) return {};
  ByteCursor in{std::span<const std::byte>(bytes).subspan(kMagic.size() + 2 * sizeof(uint16_t))};
  const uint32_t count = in.u32(), reserved = in.u32();
  const uint64_t hash = in.u64();
  if (count == 0 || count > Limits::kMaxChunks) {
    issues.add(issue_id::kChunkCount, "chunk table",
               join(count, " chunks are not in 1..", Limits::kMaxChunks));
    return {};
  }
  if (in.left() < count * kEntryBytes) {
    issues.add(issue_id::kTableTruncated, "chunk table", "the file ends inside the table; copy it again");
    return {};
  }
  issues.require(hash == tableHash(std::span(bytes).first(tableEnd(count))), issue_id::kTableChecksum,
                 "chunk table", "the checksum does not match; the file is damaged");
  issues.require(reserved == 0, issue_id::kTableReserved, "chunk table", "a reserved field is not zero");
  std::vector<ChunkInfo> chunks(count);
  uint64_t raw_bytes = 0;
  for (size_t i = 0; i < count; ++i) {
    chunks[i] = readEntry(in, i, issues);
    checkEntry(chunks[i], chunkPlace(i, chunks[i].type), issues);
    if (chunks[i].raw_bytes <= Limits::kMaxChunkBytes) raw_bytes += chunks[i].raw_bytes;
  }
  issues.require(raw_bytes <= Limits::kMaxAssetBytes, issue_id::kAssetBytes, "chunk table", raw_bytes,
                 " raw bytes in all; the limit is ", Limits::kMaxAssetBytes);
  checkOffsets(chunks, issues);
  return chunks;
}

int countPresent(std::span<const ChunkInfo> chunks, uint64_t source_bytes) {
  int present = 0;
  for (const ChunkInfo& chunk : chunks) {
    if (chunk.offset > source_bytes || chunk.stored_bytes > source_bytes - chunk.offset) break;
    ++present;
  }
  return present;
}

Result<std::vector<std::byte>> readStored(const ByteSource& source, const ChunkInfo& chunk,
                                          const std::string& where) {
  const uint64_t size = source.size();
  if (chunk.offset > size || chunk.stored_bytes > size - chunk.offset) {
    return chunkIssue(issue_id::kTruncated, where, "the file ends before the end of the chunk");
  }
  std::vector<std::byte> stored(chunk.stored_bytes);
  if (const Status read = source.read(chunk.offset, stored); !read) return read.issue();
  if (XXH3_64bits(stored.data(), stored.size()) != chunk.hash) {
    return chunkIssue(issue_id::kChunkChecksum, where, "the checksum does not match; the file is damaged");
  }
  return stored;
}

Result<std::vector<std::byte>> readRaw(const ByteSource& source, const ChunkInfo& chunk,
                                       const std::string& where) {
  // The table's own check has said so too, but a best-effort reader comes here all the same.
  const bool sizes_fit = chunk.raw_bytes <= Limits::kMaxChunkBytes &&
                         (chunk.codec != kCodecStored || chunk.raw_bytes == chunk.stored_bytes);
  if (!sizes_fit) return chunkIssue(issue_id::kStoredSize, where, "the chunk's sizes contradict each other");
  Result<std::vector<std::byte>> stored = readStored(source, chunk, where);
  if (!stored || chunk.codec == kCodecStored) return stored;
  return decompress(*stored, chunk.raw_bytes, where);
}

void checkPadding(const ByteSource& source, std::span<const ChunkInfo> chunks, size_t index,
                  IssueList& issues) {
  const uint64_t begin =
      index == 0 ? tableEnd(chunks.size()) : chunks[index - 1].offset + chunks[index - 1].stored_bytes;
  const uint64_t end = std::min(chunks[index].offset, source.size());
  if (begin >= end || end - begin >= Limits::kAlignment) return;  // none, or checkOffsets has said so
  std::vector<std::byte> padding(end - begin);
  if (const Status read = source.read(begin, padding); !read) return issues.add(read.issue());
  const bool zero =
      std::all_of(padding.begin(), padding.end(), [](std::byte b) { return b == std::byte{0}; });
  issues.require(zero, issue_id::kPadding, chunkPlace(index, chunks[index].type),
                 "the padding before the chunk is not zero");
}

}  // namespace loden::asset
