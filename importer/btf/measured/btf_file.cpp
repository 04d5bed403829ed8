#include "importer/btf/measured/btf_file.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "importer/btf/measured/btf_color.h"
#include "importer/btf/measured/btf_header.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace btf {
namespace {

// What the four kinds share; they differ in how one view is decoded.
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
  // Texel of an image whose first row is y = 0, for a texel of the file, whose first row is y = 1.
  size_t flipped(size_t file_texel) const {
    return (header_.height - 1 - file_texel / header_.width) * header_.width + file_texel % header_.width;
  }
  // Channel c of a file with fewer or more than three.
  uint32_t rgbChannel(int c) const { return header_.channels >= 3 ? static_cast<uint32_t>(c) : 0; }

  std::shared_ptr<const MappedFile> file_;
  Header header_;
  std::string name_;
};

std::vector<float> floatsOf(const Numbers& numbers, size_t first, size_t count) {
  std::vector<float> floats(count);
  for (size_t i = 0; i < count; ++i) floats[i] = static_cast<float>(numbers[first + i]);
  return floats;
}

// One factored matrix: value(row, col) = sum_k u(row, k) sv(col, k).
struct Factors {
  uint32_t components = 0;
  uint64_t rows = 0, cols = 0;
  Numbers u, sv;

  // Calls use(i, col, value) for rows first_row + i * stride, i < count, and all columns. Numbers are
  // converted once per row and once per column, not once per product.
  template <class Use>
  void decode(size_t first_row, size_t stride, size_t count, const Use& use) const {
    std::vector<float> left;
    for (size_t i = 0; i < count; ++i) {
      const auto row = floatsOf(u, (first_row + i * stride) * components, components);
      left.insert(left.end(), row.begin(), row.end());
    }
    for (size_t col = 0; col < cols; ++col) {
      const std::vector<float> right = floatsOf(sv, col * components, components);
      for (size_t i = 0; i < count; ++i) {
        float sum = 0;
        for (uint32_t k = 0; k < components; ++k) sum += left[i * components + k] * right[k];
        use(i, col, sum);
      }
    }
  }
};

// u8 scalar size, u32 K, u32 rows, u32 cols, S, U, SxV; S is multiplied into V already.
Result<Factors> readFactors(asset::ByteCursor& cursor, uint64_t rows, uint64_t cols,
                            const std::string& name) {
  const uint8_t scalar_size = readU8(cursor);
  Factors factors;
  factors.components = cursor.u32();
  factors.rows = cursor.u32();
  factors.cols = cursor.u32();
  if (!cursor.ok() || factors.components < 1 || factors.components > Limits::kMaxComponents)
    return brokenFile(name, "component count is out of range");
  const bool straight = factors.rows == rows && factors.cols == cols,
             turned = factors.rows == cols && factors.cols == rows;
  if (!straight && !turned)
    return brokenFile(name, "a matrix does not have the rows and columns that sampling and size ask for");
  const auto s = readNumbers(cursor, factors.components, 1, scalar_size, name);
  if (!s) return s.issue();
  const auto u = readNumbers(cursor, factors.rows, factors.components, scalar_size, name);
  if (!u) return u.issue();
  const auto sv = readNumbers(cursor, factors.cols, factors.components, scalar_size, name);
  if (!sv) return sv.issue();
  factors.u = straight ? *u : *sv;
  factors.sv = straight ? *sv : *u;
  factors.rows = rows, factors.cols = cols;
  return factors;
}

Issue trailing(const std::string& name) {
  return brokenFile(name, "has bytes behind its data");
}

class DfmfFile : public BtfFile {
 public:
  using BtfFile::BtfFile;
  Status read(asset::ByteCursor& cursor) {
    const uint32_t channels = cursor.u32();
    const auto model = static_cast<int32_t>(cursor.u32());
    if (!cursor.ok() || channels != 3) return brokenFile(name_, "DFMF must have three channels");
    if (!isSupported(model))
      return Issue{issue_id::kVersion, Severity::kError, name_,
                   "colour model " + std::to_string(model) + " is not supported"};
    color_.model = static_cast<ColorModel>(model);
    for (int c = 0; c < 3; ++c) color_.mean[c] = cursor.f32();
    for (double& m : color_.matrix) m = cursor.f32();
    for (Factors& factors : channels_) {
      auto read_factors = readFactors(cursor, lightCount() * header_.views.size(), header_.texels(), name_);
      if (!read_factors) return read_factors.issue();
      factors = std::move(*read_factors);
    }
    return cursor.left() == 0 ? Status() : Status(trailing(name_));
  }

  Result<std::vector<glm::vec3>> view(int view) const override {
    std::vector<glm::vec3> values(lightCount() * header_.texels());
    for (int c = 0; c < 3; ++c)
      channels_[c].decode(size_t(view) * lightCount(), 1, lightCount(),
                          [&](size_t light, size_t t, float value) {
                            values[light * header_.texels() + flipped(t)][c] = value;
                          });
    for (glm::vec3& value : values) value = color_.rgb(value);
    return values;
  }

 private:
  ColorTransform color_;
  Factors channels_[3];
};

class FmfFile : public BtfFile {
 public:
  using BtfFile::BtfFile;
  Status read(asset::ByteCursor& cursor) {
    if (header_.signature.extra_header) {
      const uint8_t version = readU8(cursor);
      if (version >= 1) exponential_ = cursor.u32() != 0;
      if (version >= 2) {
        const uint64_t width = cursor.u32(), height = cursor.u32(),
                       texels = width * height;  // below 2^64; two bytes each
        if (!cursor.ok() || texels > cursor.left() / 2)
          return brokenFile(name_, "its height map is larger than the file");
        cursor.bytes(2 * texels);
      }
    }
    cursor.u32();  // the component count, which follows again
    auto factors = readFactors(cursor, uint64_t{header_.channels} * lightCount() * header_.views.size(),
                               header_.texels(), name_);
    if (!factors) return factors.issue();
    factors_ = std::move(*factors);
    return cursor.left() == 0 ? Status() : Status(trailing(name_));
  }

  // Rows: channel fastest, then light, then view.
  Result<std::vector<glm::vec3>> view(int view) const override {
    constexpr float kEpsilon = 1e-5f;
    std::vector<glm::vec3> values(lightCount() * header_.texels());
    for (int c = 0; c < 3; ++c) {
      const size_t first_row = size_t(view) * lightCount() * header_.channels + rgbChannel(c);
      factors_.decode(first_row, header_.channels, lightCount(), [&](size_t light, size_t t, float value) {
        values[light * header_.texels() + flipped(t)][c] = exponential_ ? std::exp(value) - kEpsilon : value;
      });
    }
    return values;
  }

 private:
  bool exponential_ = false;
  Factors factors_;
};

// Per view: value(light and channel, texel) = C W + mean.
class PvfFile : public BtfFile {
 public:
  using BtfFile::BtfFile;
  Status read(asset::ByteCursor& cursor) {
    cursor.u32();  // components and slots: each view says its own
    cursor.u32();
    for (int v = 0; v < header_.views.size(); ++v) {
      const uint8_t scalar_size = readU8(cursor);
      View view;
      view.components = cursor.u32();
      const uint32_t weights = cursor.u32(), dimension = cursor.u32();
      if (!cursor.ok() || view.components < 1 || view.components > Limits::kMaxComponents)
        return brokenFile(name_, "view " + std::to_string(v) + ": component count is out of range");
      if (weights != header_.texels() || dimension != lightCount() * header_.channels)
        return brokenFile(name_, "view " + std::to_string(v) + ": its matrices do not fit sampling and size");
      for (const auto& [rows, cols, into] :
           {std::tuple<uint64_t, uint64_t, Numbers*>{view.components, 1, nullptr},
            {dimension, 1, &view.mean},
            {dimension, view.components, &view.basis},
            {weights, view.components, &view.weights}}) {
        const auto numbers = readNumbers(cursor, rows, cols, scalar_size, name_);
        if (!numbers) return numbers.issue();
        if (into) *into = *numbers;
      }
      views_.push_back(view);
    }
    return cursor.left() == 0 ? Status() : Status(trailing(name_));
  }

  Result<std::vector<glm::vec3>> view(int index) const override {
    const View& view = views_[index];
    std::vector<glm::vec3> values(lightCount() * header_.texels());
    for (size_t light = 0; light < lightCount(); ++light)
      for (size_t t = 0; t < header_.texels(); ++t)
        for (int c = 0; c < 3; ++c) {
          const size_t row = light * header_.channels + rgbChannel(c);
          double value = view.mean[row];
          for (uint32_t k = 0; k < view.components; ++k)
            value += view.basis[row * view.components + k] * view.weights[t * view.components + k];
          values[light * header_.texels() + flipped(t)][c] = static_cast<float>(value);
        }
    return values;
  }

 private:
  struct View {
    uint32_t components = 0;
    Numbers mean, basis, weights;
  };
  std::vector<View> views_;
};

// All values as halves, [texel][view][light][channel], in chunks of scanlines.
class BdiFile : public BtfFile {
 public:
  using BtfFile::BtfFile;
  Status read(asset::ByteCursor& cursor) {
    lines_per_chunk_ = cursor.u32();
    const uint8_t compression = readU8(cursor);
    if (compression != 0)
      return Issue{issue_id::kVersion, Severity::kError, name_,
                   "compressed BDI chunks are not supported; write them in full"};
    cursor.bytes(header_.texels());  // mask
    if (!cursor.ok() || lines_per_chunk_ < 1) return brokenFile(name_, "chunk height or mask is broken");
    if (const Status status = skipRotations(cursor, header_, name_); !status) return status;
    const uint64_t texel_numbers = uint64_t{header_.channels} * lightCount() * header_.views.size();
    for (uint32_t line = 0; line < header_.height; line += lines_per_chunk_) {
      const uint64_t lines = std::min(lines_per_chunk_, header_.height - line);
      const uint32_t bytes = cursor.u32();
      const auto numbers = readNumbers(cursor, lines * header_.width, texel_numbers, 2, name_);
      if (!numbers) return numbers.issue();
      if (bytes != lines * header_.width * texel_numbers * 2)
        return brokenFile(name_,
                          "the chunk at line " + std::to_string(line) + " has another size than it says");
      chunks_.push_back(*numbers);
    }
    return cursor.left() == 0 ? Status() : Status(trailing(name_));
  }

  Result<std::vector<glm::vec3>> view(int view) const override {
    std::vector<glm::vec3> values(lightCount() * header_.texels());
    const size_t chunk_texels = size_t(lines_per_chunk_) * header_.width,
                 views = static_cast<size_t>(header_.views.size());
    for (size_t t = 0; t < header_.texels(); ++t) {
      const Numbers& chunk = chunks_[t / chunk_texels];
      for (size_t light = 0; light < lightCount(); ++light)
        for (int c = 0; c < 3; ++c) {
          const size_t at =
              ((t % chunk_texels * views + view) * lightCount() + light) * header_.channels + rgbChannel(c);
          values[light * header_.texels() + flipped(t)][c] = static_cast<float>(chunk[at]);
        }
    }
    return values;
  }

 private:
  uint32_t lines_per_chunk_ = 0;
  std::vector<Numbers> chunks_;
};

template <class File>
Result<std::unique_ptr<MeasuredSource>> opened(std::shared_ptr<const MappedFile> bytes, Header header,
                                               asset::ByteCursor cursor, const std::string& name) {
  auto file = std::make_unique<File>(std::move(bytes), std::move(header), name);
  if (const Status status = file->read(cursor); !status) return status.issue();
  return std::unique_ptr<MeasuredSource>(std::move(file));
}

}  // namespace
}  // namespace btf

Result<std::unique_ptr<MeasuredSource>> openBtfFile(const std::filesystem::path& path) {
  auto file = MappedFile::open(path);
  if (!file) return file.issue();
  const std::string name = path.string();
  asset::ByteCursor cursor((*file)->bytes());
  auto header = btf::readHeader(cursor, name);
  if (!header) return header.issue();
  const btf::Kind kind = header->signature.kind;
  if (kind != btf::Kind::kBdi)  // there they follow the mask
    if (const Status status = btf::skipRotations(cursor, *header, name); !status) return status.issue();
  switch (kind) {
    case btf::Kind::kDfmf:
      return btf::opened<btf::DfmfFile>(std::move(*file), std::move(*header), cursor, name);
    case btf::Kind::kFmf:
      return btf::opened<btf::FmfFile>(std::move(*file), std::move(*header), cursor, name);
    case btf::Kind::kPvf:
      return btf::opened<btf::PvfFile>(std::move(*file), std::move(*header), cursor, name);
    case btf::Kind::kBdi:
      break;
  }
  return btf::opened<btf::BdiFile>(std::move(*file), std::move(*header), cursor, name);
}

}  // namespace loden::importer
