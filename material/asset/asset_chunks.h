// Reads and writes the preamble, the chunk table, and the bytes of single chunks. Internal to the container.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "material/asset/asset_format.h"
#include "material/asset/asset_issues.h"

namespace loden::asset {

// --- writing ---

// The chunk's stored bytes: compressed by zstd, unless that does not help or would exceed the limit on the
// ratio of raw to stored bytes. Sets codec, sizes and hash of `chunk`.
Result<std::vector<std::byte>> packChunk(std::span<const std::byte> raw, ChunkInfo& chunk);

// The bytes of preamble and table, padded to the first chunk.
std::vector<std::byte> encodeChunkTable(std::span<const ChunkInfo> chunks);

// --- reading ---

// The chunk table; what is wrong with it is added to `issues`. Empty if it cannot be read at all.
std::vector<ChunkInfo> readChunkTable(const ByteSource& source, IssueList& issues);

// The number of chunks, counted from the front, that lie wholly inside the source.
int countPresent(std::span<const ChunkInfo> chunks, uint64_t source_bytes);

// The stored bytes of one chunk, checked against its hash. `where` is for messages.
Result<std::vector<std::byte>> readStored(const ByteSource& source, const ChunkInfo& chunk,
                                          const std::string& where);
// The raw bytes of one chunk. The caller has checked that raw_bytes is what the content needs, or within a
// limit.
Result<std::vector<std::byte>> readRaw(const ByteSource& source, const ChunkInfo& chunk,
                                       const std::string& where);

// Checks that the padding in front of chunk `index`, from the end of what stands before it, is zero.
void checkPadding(const ByteSource& source, std::span<const ChunkInfo> chunks, size_t index,
                  IssueList& issues);

}  // namespace loden::asset
