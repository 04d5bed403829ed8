// The preamble, the chunk table, and the bytes of single chunks. Internal to the container.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "material/asset/asset_format.h"
#include "material/asset/asset_issues.h"

namespace loden::asset {

// --- writing ---

// The chunk's stored bytes: zstd, unless that does not help or would break the limit on raw : stored. `chunk`
// gets codec, sizes and hash.
Result<std::vector<std::byte>> packChunk(std::span<const std::byte> raw, ChunkInfo& chunk);

// Preamble and table, padded to the first chunk.
std::vector<std::byte> encodeChunkTable(std::span<const ChunkInfo> chunks);

// --- reading ---

// What the table says; whatever is wrong with it goes to `issues`. Empty if it cannot be read at all.
std::vector<ChunkInfo> readChunkTable(const ByteSource& source, IssueList& issues);

// How many chunks, from the front, lie wholly inside the source.
int countPresent(std::span<const ChunkInfo> chunks, uint64_t source_bytes);

// The stored bytes of one chunk, checked against its hash. `where` is for messages.
Result<std::vector<std::byte>> readStored(const ByteSource& source, const ChunkInfo& chunk,
                                          const std::string& where);
// The raw bytes. The caller has checked that raw_bytes is what the content needs, or within a limit.
Result<std::vector<std::byte>> readRaw(const ByteSource& source, const ChunkInfo& chunk,
                                       const std::string& where);

// That the bytes in front of chunk `index`, up to what stands before it, are zero.
void checkPadding(const ByteSource& source, std::span<const ChunkInfo> chunks, size_t index,
                  IssueList& issues);

}  // namespace loden::asset
