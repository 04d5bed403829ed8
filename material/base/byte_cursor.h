// Reads little-endian records from untrusted bytes, and writes them to a vector. Internal to the container.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace loden::asset {

static_assert(std::endian::native == std::endian::little, "records are copied as they stand in the file");

// Reads fields from the front of a byte span. A read beyond the end gives zeros and leaves ok() false from
// then on, so that a record can be read field by field and checked once at the end.
class ByteCursor {
 public:
  explicit ByteCursor(std::span<const std::byte> bytes) : rest_(bytes) {}

  bool ok() const { return ok_; }
  size_t left() const { return rest_.size(); }

  uint16_t u16() { return number<uint16_t>(); }
  uint32_t u32() { return number<uint32_t>(); }
  uint64_t u64() { return number<uint64_t>(); }
  float f32() { return number<float>(); }
  double f64() { return number<double>(); }

  // The next `count` bytes; if fewer are left, empty, and ok() becomes false.
  std::span<const std::byte> bytes(size_t count) {
    if (count > rest_.size()) {
      ok_ = false;
      rest_ = {};
      return {};
    }
    const auto front = rest_.first(count);
    rest_ = rest_.subspan(count);
    return front;
  }
  std::string text(size_t count) {
    const auto front = bytes(count);
    return {reinterpret_cast<const char*>(front.data()), front.size()};
  }

 private:
  template <class Number>
  Number number() {
    Number value{};
    const auto front = bytes(sizeof value);
    if (!front.empty()) std::memcpy(&value, front.data(), sizeof value);
    return value;
  }

  std::span<const std::byte> rest_;
  bool ok_ = true;
};

class ByteWriter {
 public:
  std::vector<std::byte> take() { return std::move(bytes_); }

  void u16(uint16_t value) { append(&value, sizeof value); }
  void u32(uint32_t value) { append(&value, sizeof value); }
  void u64(uint64_t value) { append(&value, sizeof value); }
  void f32(float value) { append(&value, sizeof value); }
  void f64(double value) { append(&value, sizeof value); }
  void text(std::string_view value) { append(value.data(), value.size()); }
  void bytes(std::span<const std::byte> value) { append(value.data(), value.size()); }

 private:
  void append(const void* from, size_t count) {
    const auto* bytes = static_cast<const std::byte*>(from);
    bytes_.insert(bytes_.end(), bytes, bytes + count);
  }
  std::vector<std::byte> bytes_;
};

}  // namespace loden::asset
