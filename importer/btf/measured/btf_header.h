// The parts that all kinds of .btf files share. Internal to importer/btf/measured.
#pragma once

#include <string>

#include "importer/btf/measured/mapped_file.h"
#include "importer/btf/measured/measured.h"
#include "material/base/byte_cursor.h"

namespace loden::importer::btf {

enum class Kind { kDfmf, kFmf, kPvf, kBdi };

struct Signature {
  const char* text;
  Kind kind;
  bool rotations;     // a block of rotations follows the sampling
  bool extra_header;  // FMF12: dynamic range and height map
};

struct Header {
  Signature signature{};
  CosineFlag cosine = CosineFlag::kUnknown;
  uint32_t channels = 3;  // 1 (grey) or 3 (red, green, blue)
  DirectionSet lights, views;
  uint32_t width = 0, height = 0;
  bool legacy = false;      // the PVF layout that has no metadata
  uint32_t view_slots = 0;  // of the legacy layout: its number of factored views
  size_t texels() const { return size_t(width) * height; }
};

struct Limits {
  static constexpr uint32_t kMaxDirections = 4096;
  static constexpr uint32_t kMaxSide = 16384;
  static constexpr uint32_t kMaxComponents = 4096;
  static constexpr uint32_t kMaxChannels = 16;
};

// The issue that the file contradicts itself or its format.
Issue brokenFile(const std::string& name, const std::string& text);
// The issue that the file ends at the place named, so that a part of it is missing.
Issue cutShort(const std::string& name, const std::string& place);
// The issue that the file may be valid, but holds something that this reader does not support.
Issue unsupported(const std::string& name, const std::string& text);

// The header: everything before the kind's own data. The cursor is moved behind it. The rotations of a BDI
// file follow its mask, and are left to its reader.
Result<Header> readHeader(asset::ByteCursor& cursor, const std::string& name);
// Skips the block of rotations, if the signature announces one.
Status skipRotations(asset::ByteCursor& cursor, const Header& header, const std::string& name);

uint8_t readU8(asset::ByteCursor& cursor);

// An array of numbers of 2 (half), 4 or 8 bytes as they are in the file.
class Numbers {
 public:
  Numbers() = default;
  Numbers(std::span<const std::byte> bytes, uint8_t scalar_size) : bytes_(bytes), scalar_size_(scalar_size) {}
  double operator[](size_t i) const;
  size_t size() const { return scalar_size_ ? bytes_.size() / scalar_size_ : 0; }

 private:
  std::span<const std::byte> bytes_;
  uint8_t scalar_size_ = 0;
};
// The next rows x cols numbers; an issue if the file is shorter. `where` names the block in messages. Both
// counts must be below 2^32.
Result<Numbers> readNumbers(asset::ByteCursor& cursor, uint64_t rows, uint64_t cols, uint8_t scalar_size,
                            const std::string& name, const std::string& where);

}  // namespace loden::importer::btf
