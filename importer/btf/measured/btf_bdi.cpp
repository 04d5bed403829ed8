// Bidirectional images: all values as halves, [texel][view][light][channel], in chunks of scanlines.
#include <algorithm>

#include "importer/btf/measured/btf_kinds.h"

namespace loden::importer::btf {
namespace {

class BdiFile : public BtfFile {
 public:
  using BtfFile::BtfFile;
  Status read(asset::ByteCursor& cursor) {
    lines_per_chunk_ = cursor.u32();
    const uint8_t compression = readU8(cursor);
    const auto mask = cursor.bytes(header_.texels());
    if (!cursor.ok()) return cutShort(name_, "in the mask behind width and height");
    if (lines_per_chunk_ < 1) return brokenFile(name_, "says that a chunk has no scanlines");
    if (const Status status = checkStorage(compression, mask); !status) return status;
    if (const Status status = skipRotations(cursor, header_, name_); !status) return status;
    for (uint32_t line = 0; line < header_.height; line += std::min(lines_per_chunk_, header_.height - line))
      if (const Status status = readChunk(cursor, line); !status) return status;
    return atEnd(cursor);
  }

  Result<std::vector<glm::vec3>> view(int view) const override {
    std::vector<glm::vec3> values(lightCount() * header_.texels());
    const size_t chunk_texels = size_t(lines_per_chunk_) * header_.width;
    for (size_t t = 0; t < header_.texels(); ++t) {
      const Numbers& chunk = chunks_[t / chunk_texels];
      for (size_t light = 0; light < lightCount(); ++light)
        for (int c = 0; c < 3; ++c) {
          const size_t at =
              ((t % chunk_texels * viewCount() + view) * lightCount() + light) * header_.channels +
              channelFor(c);
          values[light * header_.texels() + flipped(t)][c] = static_cast<float>(chunk[at]);
        }
    }
    return values;
  }

 private:
  enum Compression : uint8_t { kFull = 0, kBzip = 1, kSparse = 2 };

  // A sparse file stores the texels of its mask alone: with all of them set it is a full one. What stands in
  // the place of a texel that was not measured is not known.
  Status checkStorage(uint8_t compression, std::span<const std::byte> mask) const {
    if (compression != kFull && compression != kSparse)
      return unsupported(
          name_, (compression == kBzip ? std::string("has chunks compressed by bzip")
                                       : "has the unknown compression " + std::to_string(compression)) +
                     "; write it as an uncompressed BDI or as DFMF");
    const auto hole = std::find(mask.begin(), mask.end(), std::byte{0});
    if (hole == mask.end()) return {};
    const size_t first = static_cast<size_t>(hole - mask.begin());
    return unsupported(
        name_, "its mask leaves out " + std::to_string(std::count(mask.begin(), mask.end(), std::byte{0})) +
                   " of " + std::to_string(header_.texels()) + " texels, the first at (" +
                   std::to_string(first % header_.width) + ", " + std::to_string(first / header_.width) +
                   "); cut it to a rectangle that has all its texels");
  }

  // u32 bytes, then the texels of the chunk's scanlines. The last chunk may be filled up to full height.
  Status readChunk(asset::ByteCursor& cursor, uint32_t line) {
    const std::string where = "the chunk at scanline " + std::to_string(line);
    const uint64_t lines = std::min(lines_per_chunk_, header_.height - line),
                   texel_numbers = uint64_t{header_.channels} * lightCount() * viewCount(),
                   line_bytes = uint64_t{header_.width} * texel_numbers * 2;  // below 2^43
    const uint64_t bytes = cursor.u32();
    const auto numbers = readNumbers(cursor, lines * header_.width, texel_numbers, 2, name_, where);
    if (!numbers) return numbers.issue();
    const uint64_t used = lines * line_bytes,
                   full = std::min(lines_per_chunk_, Limits::kMaxSide) * line_bytes;
    if (bytes != used && bytes != full)
      return brokenFile(name_, where + " says that it has " + std::to_string(bytes) + " bytes; " +
                                   std::to_string(lines) + " scanlines have " + std::to_string(used));
    if (bytes - used > cursor.left()) return cutShort(name_, "in " + where);
    cursor.bytes(bytes - used);
    chunks_.push_back(*numbers);
    return {};
  }

  uint32_t lines_per_chunk_ = 0;
  std::vector<Numbers> chunks_;
};

}  // namespace

Result<std::unique_ptr<MeasuredSource>> openBdi(std::shared_ptr<const MappedFile> file, Header header,
                                                asset::ByteCursor cursor, const std::string& name) {
  auto source = std::make_unique<BdiFile>(std::move(file), std::move(header), name);
  if (const Status status = source->read(cursor); !status) return status.issue();
  return std::unique_ptr<MeasuredSource>(std::move(source));
}

}  // namespace loden::importer::btf
