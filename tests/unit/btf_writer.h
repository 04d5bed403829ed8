// Writes Bonn .btf files for tests. It is written from the description of the formats (the order of the
// fields and of the numbers in a matrix, and what fields mean), and shares no code with the reader that it
// tests.
//
// A file has the signature; metadata; for each view theta, phi, the number of lights and their angles; width
// and height; rotations if the signature ends in R; then the data of its kind. Images begin with their top
// row, which is y = 1.
#pragma once

#include <cmath>
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
  size_t pairs() const { return views.samples.size() * lights.samples.size(); }
  const glm::vec3& at(int view, int light, size_t texel) const {
    return values[(size_t(view) * lights.size() + light) * texels() + texel];
  }
};

// Choices of a writer. The defaults are those of UBO2014 files, as far as these have such a field.
struct BtfFormat {
  uint8_t scalar_size = 2;                  // half, single or double numbers
  bool images_stacked = false;              // the left matrix runs over texels, the right one over directions
  int32_t color_model = 0;                  // DFMF: 0 RGB, 4 YCoCg, 11 log Y, U / Y, V / Y
  uint32_t more_components[3] = {0, 9, 4};  // DFMF: unused columns of each channel's matrices
  uint32_t metadata_version = 4;
  std::vector<std::string> channels = {"R", "G", "B"};
  uint32_t cosine_flag = 1;
  double light_rounding = 0;       // added to the angles of the lights of all views but the first, radians
  uint8_t header_version = 2;      // FMF12: 0 to 2 are known
  bool legacy = false;             // PVF: the layout without metadata
  uint8_t compression = 0;         // BDI: 0 full, 1 bzip, 2 sparse
  uint32_t lines_per_chunk = 4;    // BDI
  bool last_chunk_filled = false;  // BDI: chunks are all of one size
  std::vector<size_t> missing;     // BDI: texels that the mask marks as missing
};

class BtfWriter {
 public:
  explicit BtfWriter(const MemoryBtf& btf, BtfFormat format = {}) : btf_(btf), format_(std::move(format)) {}

  // A DFMF file: three factorizations, one for each channel, each with its own number of components. The
  // number in front of the colour model is the largest number of components; it is not the number of
  // channels.
  std::string dfmf() {
    begin("!DFMF08FCR");
    uint32_t largest = 0;
    for (const uint32_t more : format_.more_components) largest = std::max(largest, fullRank() + more);
    u32(largest), u32(static_cast<uint32_t>(format_.color_model));
    for (int i = 0; i < 3; ++i) f32(0);
    for (int i = 0; i < 9; ++i) f32(i % 4 == 0 ? 1.f : 0.f);
    for (int c = 0; c < 3; ++c)
      factorization(btf_.pairs(), btf_.texels(), fullRank() + format_.more_components[c],
                    [&](size_t pair, size_t texel) { return decorrelated(value(pair, texel))[c]; });
    return bytes_;
  }

  // An FMF file: one factorization. Its rows run over channels (fastest), lights and views; with
  // images_stacked over channels, x and y.
  std::string fmf() { return fmfBehind("!FMF06FC"); }
  // An FMF12 file: FMF with a further header, which has a version, the dynamic range (1: logarithms), and the
  // size and data of a height map.
  std::string fmf12() {
    begin("!FMF12FCER");
    u8(format_.header_version);
    if (format_.header_version >= 1) u32(1);
    if (format_.header_version >= 2) {
      u32(2), u32(3);
      for (int i = 0; i < 6; ++i) number(0.5, 2);
    }
    logarithms_ = format_.header_version >= 1;
    return fmfBehind(nullptr);
  }

  // A PVF file. Each view has scalar size, components, rows of the weights, rows of the basis; eigenvalues,
  // mean, basis, weights. The rows of the basis run over channels (fastest) and lights; with images_stacked
  // over channels, x and y.
  std::string pvf() {
    const auto lights = static_cast<uint32_t>(btf_.lights.size()), texels = u32Of(btf_.texels());
    const uint32_t components = fullRank(), rows = format_.images_stacked ? texels : lights,
                   weights = format_.images_stacked ? lights : texels;
    if (format_.legacy) {
      bytes_ = "!PVF06FC";
      u32(301074), u32(components), size(), u32(static_cast<uint32_t>(btf_.views.size()));
      sampling();
    } else {
      begin("!PVF06FC");
      u32(components), u32(static_cast<uint32_t>(btf_.views.size()));
    }
    constexpr double kMean = 0.25;
    for (int v = 0; v < btf_.views.size(); ++v) {
      u8(format_.scalar_size);
      u32(components), u32(weights), u32(3 * rows);
      const auto at = [&](size_t row, size_t column) {
        const size_t light = format_.images_stacked ? column : row / 3,
                     texel = format_.images_stacked ? row / 3 : column;
        return value(size_t(v) * lights + light, texel)[static_cast<int>(row % 3)] - kMean;
      };
      for (uint32_t k = 0; k < components; ++k) number(1);
      for (uint32_t row = 0; row < 3 * rows; ++row) number(kMean);
      matrix(3 * rows, components, [&](size_t row, size_t k) { return k < weights ? at(row, k) : 0.0; });
      matrix(weights, components, [](size_t row, size_t k) { return row == k ? 1.0 : 0.0; });
    }
    return bytes_;
  }

  // A BDI file: scanlines per chunk, compression, mask, rotations, and chunks of whole scanlines, each after
  // its size in bytes.
  std::string bdi() {
    begin("!BDIF06R2!");
    u32(format_.lines_per_chunk), u8(format_.compression);
    std::string mask(btf_.texels(), '\1');
    for (const size_t texel : format_.missing) mask[texel] = '\0';
    bytes_ += mask;
    u32(0);
    const auto lines_per_chunk = static_cast<int>(format_.lines_per_chunk);
    for (int line = 0; line < btf_.height; line += lines_per_chunk) {
      const int lines = std::min(lines_per_chunk, btf_.height - line);
      const int written = format_.last_chunk_filled ? lines_per_chunk : lines;
      const size_t width = static_cast<size_t>(btf_.width);
      u32(u32Of(static_cast<size_t>(written) * width * btf_.pairs() * 3 * 2));
      for (size_t texel = size_t(line) * width; texel < size_t(line + written) * width; ++texel)
        for (size_t pair = 0; pair < btf_.pairs(); ++pair)
          for (int c = 0; c < 3; ++c)
            number(texel < size_t(line + lines) * width ? value(pair, texel)[c] : 0.0, 2);
    }
    return bytes_;
  }

 private:
  // The value of a texel, counted from the top row, for a pair, counted view by view with lights fastest.
  glm::dvec3 value(size_t pair, size_t texel) const {
    const size_t width = static_cast<size_t>(btf_.width), row = texel / width;
    const size_t from_below = (static_cast<size_t>(btf_.height) - 1 - row) * width + texel % width;
    return glm::dvec3(btf_.values[pair * btf_.texels() + from_below]);
  }

  glm::dvec3 decorrelated(const glm::dvec3& rgb) const {
    constexpr double kEpsilon = 1e-5;
    if (format_.color_model == 4) {
      const glm::dmat3 rgb_from_ycocg(1, 1, 1, 1, 0, -1, -1, 1, -1);  // columns
      return glm::inverse(rgb_from_ycocg) * rgb;
    }
    if (format_.color_model == 11) {
      const glm::dmat3 rgb_from_yuv(1, 1, 1, 0, -0.39465, 2.03211, 1.13983, -0.5806, 0);  // columns
      const glm::dvec3 yuv = glm::inverse(rgb_from_yuv) * rgb;
      return {std::log(yuv.x + kEpsilon), yuv.y / (yuv.x + kEpsilon), yuv.z / (yuv.x + kEpsilon)};
    }
    return rgb;
  }

  static uint32_t u32Of(size_t value) { return static_cast<uint32_t>(value); }
  // The number of rows of the right matrix: with so many components any data can be represented.
  uint32_t fullRank() const {
    if (!format_.images_stacked) return u32Of(btf_.texels());
    return u32Of(std::max(btf_.pairs(), btf_.lights.samples.size()));
  }

  void u8(uint8_t value) { bytes_ += static_cast<char>(value); }
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
  void number(double value) { number(value, format_.scalar_size); }

  void begin(const std::string& signature) {
    bytes_ = signature;
    metadata();
    sampling();
    size();
    if (!signature.ends_with('R')) return;
    u32(1);
    for (int i = 0; i < 9; ++i) f32(i % 4 == 0 ? 1.f : 0.f);
  }

  void metadata() {
    const std::string xml = "<measurement/>";
    const size_t begin = bytes_.size();
    u32(0);  // the size of the metadata from here on, which is written below
    u32(format_.metadata_version);
    for (const char* text : {"dome", "camera", "lamp"}) {
      std::string field = text;
      field.resize(80);
      bytes_ += field;
    }
    f32(12.5f);
    for (int i = 0; i < 3; ++i) f32(1);
    if (format_.metadata_version > 1) u32(format_.cosine_flag);
    if (format_.metadata_version > 2) u32(u32Of(xml.size())), bytes_ += xml;
    if (format_.metadata_version > 3) {
      u32(u32Of(format_.channels.size()));
      for (const std::string& channel : format_.channels) u32(u32Of(channel.size())), bytes_ += channel;
    }
    const uint32_t bytes = u32Of(bytes_.size() - begin);
    std::memcpy(bytes_.data() + begin, &bytes, 4);
  }

  void sampling() {
    u32(static_cast<uint32_t>(btf_.views.size()));
    for (int v = 0; v < btf_.views.size(); ++v) {
      angles(btf_.views.samples[v], 0);
      u32(static_cast<uint32_t>(btf_.lights.size()));
      for (const glm::dvec3& wi : btf_.lights.samples) angles(wi, v > 0 ? format_.light_rounding : 0);
    }
  }
  void angles(const glm::dvec3& w, double rounding) {
    const Spherical s = sphericalFromDirection(w);
    f32(static_cast<float>(s.theta + rounding)), f32(static_cast<float>(s.phi - rounding));
  }
  void size() { u32(static_cast<uint32_t>(btf_.width)), u32(static_cast<uint32_t>(btf_.height)); }

  std::string fmfBehind(const char* signature) {
    if (signature) begin(signature);
    u32(fullRank());
    const size_t rows = btf_.pairs(), columns = btf_.texels();
    factorization(
        3 * (format_.images_stacked ? columns : rows), format_.images_stacked ? rows : columns, fullRank(),
        [&](size_t row, size_t column) {
          const size_t pair = format_.images_stacked ? column : row / 3,
                       texel = format_.images_stacked ? row / 3 : column;
          const double v = value(pair, texel)[static_cast<int>(row % 3)];
          return logarithms_ ? std::log(v + 1e-5) : v;
        },
        false);
    return bytes_;
  }

  template <class Value>
  void matrix(size_t rows, uint32_t components, const Value& value) {
    for (size_t row = 0; row < rows; ++row)
      for (uint32_t k = 0; k < components; ++k) number(value(row, k));
  }

  // A factorization: scalar size, components, rows, columns, singular values, U, and V times the singular
  // values. Here U is the matrix itself and V the identity, so that only the rounding to the scalar size
  // loses precision. Columns of U beyond those of the matrix are multiplied by zeros.
  template <class Value>
  void factorization(size_t rows, size_t columns, uint32_t components, const Value& value,
                     bool may_turn = true) {
    const bool turned = may_turn && format_.images_stacked;
    if (turned) std::swap(rows, columns);
    u8(format_.scalar_size);
    u32(components), u32(u32Of(rows)), u32(u32Of(columns));
    for (uint32_t k = 0; k < components; ++k) number(1);
    matrix(rows, components, [&](size_t row, size_t k) {
      return k >= columns ? 0.7 : turned ? value(k, row) : value(row, k);
    });
    matrix(columns, components, [](size_t column, size_t k) { return column == k ? 1.0 : 0.0; });
  }

  const MemoryBtf& btf_;
  BtfFormat format_;
  bool logarithms_ = false;
  std::string bytes_;
};

}  // namespace loden::test
