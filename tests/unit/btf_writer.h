// Writes Bonn .btf files for tests, from the format's description. Not a product feature.
#pragma once

#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "material/model/directions.h"
#include "material/model/texture.h"

namespace loden::test {

// A BTF in memory, [view][light][texel]; row 0 is y = 0.
struct MemoryBtf {
  DirectionSet lights, views;
  int width = 0, height = 0;
  std::vector<glm::vec3> values;
  size_t texels() const { return size_t(width) * height; }
  const glm::vec3& at(int view, int light, size_t texel) const {
    return values[(size_t(view) * lights.size() + light) * texels() + texel];
  }
};

class BtfWriter {
 public:
  explicit BtfWriter(const MemoryBtf& btf) : btf_(btf) {}

  // Full rank: one component per column, U = the matrix, SxV = identity, so that only the scalar size loses.
  std::string dfmf(uint8_t scalar_size) {
    begin("!DFMF08FCR", 4);
    rotations();
    u32(3), u32(0);
    for (int i = 0; i < 3; ++i) f32(0);
    for (int i = 0; i < 9; ++i) f32(i % 4 == 0 ? 1.f : 0.f);
    for (int c = 0; c < 3; ++c) {
      factors(scalar_size, rows(),
              [&](size_t row, size_t t) { return btf_.values[row * btf_.texels() + flipped(t)][c]; });
    }
    return bytes_;
  }

  std::string fmf(uint8_t scalar_size) {
    begin("!FMF06FC", 4);
    u32(static_cast<uint32_t>(btf_.texels()));
    factors(scalar_size, rows() * 3, [&](size_t row, size_t t) {
      return btf_.values[row / 3 * btf_.texels() + flipped(t)][static_cast<int>(row % 3)];
    });
    return bytes_;
  }

  // One component more than needed for texel 0; mean zero, basis per texel.
  std::string pvf(uint8_t scalar_size) {
    begin("!PVF06FC", 4);
    const auto k = static_cast<uint32_t>(btf_.texels());
    u32(k), u32(k);
    const size_t dimension = btf_.lights.samples.size() * 3;
    for (int v = 0; v < btf_.views.size(); ++v) {
      bytes_ += static_cast<char>(scalar_size);
      u32(k), u32(static_cast<uint32_t>(btf_.texels())), u32(static_cast<uint32_t>(dimension));
      for (uint32_t i = 0; i < k; ++i) number(1, scalar_size);
      for (size_t i = 0; i < dimension; ++i) number(0, scalar_size);
      for (size_t row = 0; row < dimension; ++row)
        for (uint32_t t = 0; t < k; ++t)
          number(btf_.at(v, static_cast<int>(row / 3), flipped(t))[static_cast<int>(row % 3)], scalar_size);
      for (size_t t = 0; t < btf_.texels(); ++t)
        for (uint32_t i = 0; i < k; ++i) number(t == i, scalar_size);
    }
    return bytes_;
  }

  std::string bdi(uint32_t lines_per_chunk) {
    begin("!BDIF06R2!", 4);
    u32(lines_per_chunk);
    bytes_ += '\0';
    bytes_.append(btf_.texels(), '\1');
    rotations();
    for (int line = 0; line < btf_.height; line += static_cast<int>(lines_per_chunk)) {
      const int lines = std::min<int>(static_cast<int>(lines_per_chunk), btf_.height - line);
      u32(static_cast<uint32_t>(size_t(lines) * btf_.width * btf_.views.size() * btf_.lights.size() * 3 * 2));
      for (size_t t = size_t(line) * btf_.width; t < size_t(line + lines) * btf_.width; ++t)
        for (int v = 0; v < btf_.views.size(); ++v)
          for (int l = 0; l < btf_.lights.size(); ++l)
            for (int c = 0; c < 3; ++c) number(btf_.at(v, l, flipped(t))[c], 2);
    }
    return bytes_;
  }

  uint32_t cosine_flag = 1;

 private:
  size_t rows() const { return btf_.views.samples.size() * btf_.lights.samples.size(); }
  size_t flipped(size_t t) const { return (btf_.height - 1 - t / btf_.width) * btf_.width + t % btf_.width; }

  void u32(uint32_t value) { bytes_.append(reinterpret_cast<const char*>(&value), 4); }
  void f32(float value) { bytes_.append(reinterpret_cast<const char*>(&value), 4); }
  void number(double value, uint8_t scalar_size) {
    const auto single = static_cast<float>(value);
    const uint16_t half = halfFromFloat(single);
    if (scalar_size == 2)
      bytes_.append(reinterpret_cast<const char*>(&half), 2);
    else if (scalar_size == 4)
      f32(single);
    else
      bytes_.append(reinterpret_cast<const char*>(&value), 8);
  }

  void begin(const char* signature, uint32_t version) {
    bytes_ = signature;
    u32(4 + 4 + 240 + 16 + 4 + 4 + 3 + 4 + 3 * 5), u32(version);
    bytes_.append(240, ' ');
    for (int i = 0; i < 4; ++i) f32(1);
    u32(cosine_flag);
    u32(3), bytes_ += "<x>";
    u32(3);
    for (const char* name : {"R", "G", "B"}) u32(1), bytes_ += name;
    u32(static_cast<uint32_t>(btf_.views.size()));
    for (const glm::dvec3& wo : btf_.views.samples) {
      angles(wo);
      u32(static_cast<uint32_t>(btf_.lights.size()));
      for (const glm::dvec3& wi : btf_.lights.samples) angles(wi);
    }
    u32(static_cast<uint32_t>(btf_.width)), u32(static_cast<uint32_t>(btf_.height));
  }

  void angles(const glm::dvec3& w) {
    const Spherical s = sphericalFromDirection(w);
    f32(static_cast<float>(s.theta)), f32(static_cast<float>(s.phi));
  }

  void rotations() {
    u32(1);
    for (int i = 0; i < 9; ++i) f32(0);
  }

  template <class Value>
  void factors(uint8_t scalar_size, size_t row_count, const Value& value) {
    const auto k = static_cast<uint32_t>(btf_.texels());
    bytes_ += static_cast<char>(scalar_size);
    u32(k), u32(static_cast<uint32_t>(row_count)), u32(k);
    for (uint32_t i = 0; i < k; ++i) number(1, scalar_size);
    for (size_t row = 0; row < row_count; ++row)
      for (uint32_t i = 0; i < k; ++i) number(value(row, i), scalar_size);
    for (uint32_t col = 0; col < k; ++col)
      for (uint32_t i = 0; i < k; ++i) number(col == i, scalar_size);
  }

  const MemoryBtf& btf_;
  std::string bytes_;
};

}  // namespace loden::test
