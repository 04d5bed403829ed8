// The kinds of .btf files as BTF sources. Internal to importer/btf/measured.
#pragma once

#include <memory>
#include <string>

#include "importer/btf/measured/btf_header.h"

namespace loden::importer::btf {

// The base class of all kinds, which differ in how one view is decoded.
class BtfFile : public MeasuredSource {
 public:
  BtfFile(std::shared_ptr<const MappedFile> file, Header header, std::string name)
      : file_(std::move(file)), header_(std::move(header)), name_(std::move(name)) {}
  const std::string& name() const override { return name_; }
  glm::ivec2 size() const override { return {header_.width, header_.height}; }
  const DirectionSet& lights() const override { return header_.lights; }
  const DirectionSet& views() const override { return header_.views; }
  CosineFlag cosineFlag() const override { return header_.cosine; }
  std::string format() const override { return std::string("Bonn .btf, ") + header_.signature.text; }

 protected:
  size_t lightCount() const { return static_cast<size_t>(header_.lights.size()); }
  size_t viewCount() const { return static_cast<size_t>(header_.views.size()); }
  // The texel of an image whose first row is y = 0, for a texel of the file, whose first row is y = 1.
  size_t flipped(size_t file_texel) const {
    return (header_.height - 1 - file_texel / header_.width) * header_.width + file_texel % header_.width;
  }
  // The file's channel from which channel c of the values is read; a file of one channel is grey.
  uint32_t channelFor(int c) const { return header_.channels == 3 ? static_cast<uint32_t>(c) : 0; }
  // Success, or an issue if bytes follow the data.
  Status atEnd(const asset::ByteCursor& cursor) const;

  std::shared_ptr<const MappedFile> file_;
  Header header_;
  std::string name_;
};

// Each of the following functions reads what follows the common header, from the cursor on.
//
// openDfmf: decorrelated full matrix factorization, with one product of two matrices for each channel of a
// colour model.
Result<std::unique_ptr<MeasuredSource>> openDfmf(std::shared_ptr<const MappedFile> file, Header header,
                                                 asset::ByteCursor cursor, const std::string& name);
// Full matrix factorization: one product of two matrices, of which one holds the channels one after the
// other.
Result<std::unique_ptr<MeasuredSource>> openFmf(std::shared_ptr<const MappedFile> file, Header header,
                                                asset::ByteCursor cursor, const std::string& name);
// Per-view factorization: a mean and a product of two matrices for each view.
Result<std::unique_ptr<MeasuredSource>> openPvf(std::shared_ptr<const MappedFile> file, Header header,
                                                asset::ByteCursor cursor, const std::string& name);
// Bidirectional images: all values, texel by texel, in chunks of scanlines.
Result<std::unique_ptr<MeasuredSource>> openBdi(std::shared_ptr<const MappedFile> file, Header header,
                                                asset::ByteCursor cursor, const std::string& name);

// The rows first, first + stride, ... of a row-major matrix.
struct RowRange {
  size_t first = 0, stride = 1, count = 0;
};
std::vector<float> floatsOf(const Numbers& numbers, const RowRange& rows, uint32_t cols);

// Calls use(i, j, dot(left row i, right row j)) for all pairs of rows; both matrices have `components`
// columns. Numbers are converted once per row, not once per product.
template <class Use>
void forEachProduct(const Numbers& left, const RowRange& left_rows, const Numbers& right,
                    const RowRange& right_rows, uint32_t components, const Use& use) {
  const std::vector<float> left_floats = floatsOf(left, left_rows, components);
  for (size_t j = 0; j < right_rows.count; ++j) {
    const std::vector<float> row =
        floatsOf(right, {right_rows.first + j * right_rows.stride, 1, 1}, components);
    for (size_t i = 0; i < left_rows.count; ++i) {
      float sum = 0;
      for (uint32_t k = 0; k < components; ++k) sum += left_floats[i * components + k] * row[k];
      use(i, j, sum);
    }
  }
}

// The factors of a matrix: value(row, col) = sum_k u(row, k) sv(col, k). The singular values are multiplied
// into sv.
struct Factors {
  uint32_t components = 0;
  uint64_t rows = 0, cols = 0;
  Numbers u, sv;
};
// Reads factors: u8 scalar size, u32 components, u32 rows, u32 cols, the singular values, U and SxV, both
// row-major. `where` names the matrix in messages. The caller must check the numbers of rows and columns.
Result<Factors> readFactors(asset::ByteCursor& cursor, const std::string& name, const std::string& where);

}  // namespace loden::importer::btf
