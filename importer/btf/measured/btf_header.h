// The parts that all kinds of .btf files share. Internal to importer/measured.
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
  uint32_t channels = 3;
  DirectionSet lights, views;
  uint32_t width = 0, height = 0;
  size_t texels() const { return size_t(width) * height; }
};

struct Limits {
  static constexpr uint32_t kMaxDirections = 4096;
  static constexpr uint32_t kMaxSide = 16384;
  static constexpr uint32_t kMaxComponents = 4096;
  static constexpr uint32_t kMaxChannels = 16;
};

Issue brokenFile(const std::string& name, const std::string& text);

// Reads up to and including width and height; the cursor stands behind them.
Result<Header> readHeader(asset::ByteCursor& cursor, const std::string& name);
// Skips the block of rotations, if the signature announces one.
Status skipRotations(asset::ByteCursor& cursor, const Header& header, const std::string& name);

uint8_t readU8(asset::ByteCursor& cursor);

// Numbers of 2 (half), 4 or 8 bytes as they stand in the file.
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
// The next rows x cols numbers; an issue if the file is shorter.
Result<Numbers> readNumbers(asset::ByteCursor& cursor, uint64_t rows, uint64_t cols, uint8_t scalar_size,
                            const std::string& name);

}  // namespace loden::importer::btf
