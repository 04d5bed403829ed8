// Files whose values are products of two matrices: DFMF, FMF and PVF.
#include <cmath>
#include <tuple>

#include "importer/btf/measured/btf_color.h"
#include "importer/btf/measured/btf_kinds.h"

namespace loden::importer::btf {
namespace {

std::string sized(uint64_t rows, uint64_t cols) {
  return std::to_string(rows) + " x " + std::to_string(cols);
}

Status checkComponents(uint32_t components, const std::string& name, const std::string& where) {
  if (components >= 1 && components <= Limits::kMaxComponents) return {};
  return brokenFile(name, where + " says " + std::to_string(components) + " components; 1 to " +
                              std::to_string(Limits::kMaxComponents) + " are possible");
}

class DfmfFile : public BtfFile {
 public:
  using BtfFile::BtfFile;
  Status read(asset::ByteCursor& cursor) {
    if (header_.channels != 3)
      return unsupported(name_, "is a DFMF of " + std::to_string(header_.channels) +
                                    " channels, whose colours are not known; convert it to RGB");
    cursor.u32();  // the largest number of components of a channel; each says its own below
    const auto model = static_cast<int32_t>(cursor.u32());
    if (!cursor.ok()) return cutShort(name_, "behind width and height");
    if (!isSupported(model))
      return unsupported(name_, "has colour model " + std::to_string(model) + ", " + colorModelName(model) +
                                    "; convert it to RGB, YUV, YCoCg, PCA or one of the logarithmic models");
    color_.model = static_cast<ColorModel>(model);
    for (int c = 0; c < 3; ++c) color_.mean[c] = cursor.f32();
    for (double& m : color_.matrix) m = cursor.f32();
    for (int c = 0; c < 3; ++c)
      if (const Status status = readChannel(cursor, c); !status) return status;
    return atEnd(cursor);
  }

  Result<std::vector<glm::vec3>> view(int view) const override {
    std::vector<glm::vec3> values(lightCount() * header_.texels());
    for (int c = 0; c < 3; ++c) {
      const Channel& channel = channels_[c];
      forEachProduct(channel.by_pair, {size_t(view) * lightCount(), 1, lightCount()}, channel.by_texel,
                     {0, 1, header_.texels()}, channel.components, [&](size_t light, size_t t, float value) {
                       values[light * header_.texels() + flipped(t)][c] = value;
                     });
    }
    for (glm::vec3& value : values) value = color_.rgb(value);
    return values;
  }

 private:
  struct Channel {
    uint32_t components = 0;
    Numbers by_pair, by_texel;  // rows: view * lights + light, and y * width + x
  };

  // Either matrix may be the one with the singular values; where both have as many rows, U is that by pairs.
  Status readChannel(asset::ByteCursor& cursor, int c) {
    const std::string where = "DFMF channel " + std::to_string(c);
    const auto factors = readFactors(cursor, name_, where);
    if (!factors) return factors.issue();
    const uint64_t pairs = uint64_t{lightCount()} * viewCount(), texels = header_.texels();
    const bool straight = factors->rows == pairs && factors->cols == texels;
    if (!straight && !(factors->rows == texels && factors->cols == pairs))
      return brokenFile(name_, where + " is " + sized(factors->rows, factors->cols) +
                                   "; directions and size ask for " + sized(pairs, texels));
    channels_[c] = {factors->components, straight ? factors->u : factors->sv,
                    straight ? factors->sv : factors->u};
    return {};
  }

  ColorTransform color_;
  Channel channels_[3];
};

class FmfFile : public BtfFile {
 public:
  using BtfFile::BtfFile;
  Status read(asset::ByteCursor& cursor) {
    if (header_.signature.extra_header)
      if (const Status status = readExtraHeader(cursor); !status) return status;
    cursor.u32();  // the number of components, which follows again
    auto factors = readFactors(cursor, name_, "the FMF matrix");
    if (!factors) return factors.issue();
    factors_ = std::move(*factors);
    const uint64_t pairs = uint64_t{lightCount()} * viewCount(), texels = header_.texels(),
                   channels = header_.channels;
    by_texel_stacked_ = !(factors_.rows == channels * pairs && factors_.cols == texels);
    if (by_texel_stacked_ && !(factors_.rows == channels * texels && factors_.cols == pairs))
      return brokenFile(name_, "the FMF matrix is " + sized(factors_.rows, factors_.cols) +
                                   "; channels, directions and size ask for " +
                                   sized(channels * pairs, texels) + ", or for " +
                                   sized(channels * texels, pairs) + " with its images stacked");
    return atEnd(cursor);
  }

  // The rows of U: channel fastest, then light and view, or then x and y.
  Result<std::vector<glm::vec3>> view(int view) const override {
    std::vector<glm::vec3> values(lightCount() * header_.texels());
    const size_t channels = header_.channels, first_pair = size_t(view) * lightCount();
    for (int c = 0; c < 3; ++c) {
      const auto store = [&](size_t light, size_t t, float value) {
        values[light * header_.texels() + flipped(t)][c] =
            exponential_ ? std::exp(value) - kDynamicRangeEpsilon : value;
      };
      if (by_texel_stacked_)
        forEachProduct(factors_.sv, {first_pair, 1, lightCount()}, factors_.u,
                       {channelFor(c), channels, header_.texels()}, factors_.components, store);
      else
        forEachProduct(factors_.u, {first_pair * channels + channelFor(c), channels, lightCount()},
                       factors_.sv, {0, 1, header_.texels()}, factors_.components, store);
    }
    return values;
  }

 private:
  static constexpr float kDynamicRangeEpsilon = 1e-5f;

  // u8 version; from 1 on u32 dynamic range; from 2 on u32 width and height of a height map of halves.
  Status readExtraHeader(asset::ByteCursor& cursor) {
    const uint8_t version = readU8(cursor);
    if (version > 2)
      return unsupported(name_, "has version " + std::to_string(version) +
                                    " of the FMF12 header, and only 0 to 2 are known; write it again as "
                                    "!FMF12FCER version 2 or !FMF06FC");
    if (version >= 1) exponential_ = cursor.u32() != 0;
    if (version < 2) return {};
    const uint64_t width = cursor.u32(), height = cursor.u32(),
                   texels = width * height;  // below 2^64; two bytes each
    if (!cursor.ok() || texels > cursor.left() / 2)
      return cutShort(name_, "in its height map of " + sized(width, height) + " texels");
    cursor.bytes(2 * texels);
    return {};
  }

  bool exponential_ = false, by_texel_stacked_ = false;
  Factors factors_;
};

// Per view: value = basis weights + mean.
class PvfFile : public BtfFile {
 public:
  using BtfFile::BtfFile;
  Status read(asset::ByteCursor& cursor) {
    if (!header_.legacy) {
      cursor.u32();  // the number of components: each view says its own
      header_.view_slots = cursor.u32();
    }
    if (!cursor.ok()) return cutShort(name_, "behind width and height");
    if (header_.view_slots != viewCount())
      return brokenFile(name_, "holds " + std::to_string(header_.view_slots) + " factored views for " +
                                   std::to_string(viewCount()) + " view directions");
    for (size_t v = 0; v < viewCount(); ++v)
      if (const Status status = readView(cursor, "view " + std::to_string(v)); !status) return status;
    return atEnd(cursor);
  }

  // The basis' rows: channel fastest, then light, or then x and y; the weights' rows are the other of both.
  Result<std::vector<glm::vec3>> view(int index) const override {
    const View& view = views_[index];
    std::vector<glm::vec3> values(lightCount() * header_.texels());
    const size_t channels = header_.channels;
    for (int c = 0; c < 3; ++c) {
      const auto store = [&](size_t light, size_t t, float value) {
        const size_t row = (view.by_texel_stacked ? t : light) * channels + channelFor(c);
        values[light * header_.texels() + flipped(t)][c] = value + static_cast<float>(view.mean[row]);
      };
      const RowRange lights{0, 1, lightCount()}, texels{0, 1, header_.texels()};
      if (view.by_texel_stacked)
        forEachProduct(view.weights, lights, view.basis, {channelFor(c), channels, header_.texels()},
                       view.components, store);
      else
        forEachProduct(view.basis, {channelFor(c), channels, lightCount()}, view.weights, texels,
                       view.components, store);
    }
    return values;
  }

 private:
  struct View {
    uint32_t components = 0;
    bool by_texel_stacked = false;
    Numbers mean, basis, weights;
  };

  Status readView(asset::ByteCursor& cursor, const std::string& where) {
    const uint8_t scalar_size = readU8(cursor);
    View view;
    view.components = cursor.u32();
    const uint64_t weights = cursor.u32(), dimension = cursor.u32();
    if (!cursor.ok()) return cutShort(name_, "at " + where);
    if (const Status status = checkComponents(view.components, name_, where); !status) return status;
    const uint64_t channels = header_.channels, lights = lightCount(), texels = header_.texels();
    view.by_texel_stacked = !(weights == texels && dimension == channels * lights);
    if (view.by_texel_stacked && !(weights == lights && dimension == channels * texels))
      return brokenFile(name_, where + " has " + sized(dimension, weights) +
                                   " values; channels, lights and size ask for " +
                                   sized(channels * lights, texels) + ", or for " +
                                   sized(channels * texels, lights) + " with its images stacked");
    for (const auto& [rows, cols, into] :
         {std::tuple<uint64_t, uint64_t, Numbers*>{view.components, 1, nullptr},
          {dimension, 1, &view.mean},
          {dimension, view.components, &view.basis},
          {weights, view.components, &view.weights}}) {
      const auto numbers = readNumbers(cursor, rows, cols, scalar_size, name_, where);
      if (!numbers) return numbers.issue();
      if (into) *into = *numbers;
    }
    views_.push_back(view);
    return {};
  }

  std::vector<View> views_;
};

template <class File>
Result<std::unique_ptr<MeasuredSource>> opened(std::shared_ptr<const MappedFile> bytes, Header header,
                                               asset::ByteCursor cursor, const std::string& name) {
  auto file = std::make_unique<File>(std::move(bytes), std::move(header), name);
  if (const Status status = file->read(cursor); !status) return status.issue();
  return std::unique_ptr<MeasuredSource>(std::move(file));
}

}  // namespace

std::vector<float> floatsOf(const Numbers& numbers, const RowRange& rows, uint32_t cols) {
  std::vector<float> floats;
  floats.reserve(rows.count * cols);
  for (size_t i = 0; i < rows.count; ++i)
    for (uint32_t k = 0; k < cols; ++k)
      floats.push_back(static_cast<float>(numbers[(rows.first + i * rows.stride) * cols + k]));
  return floats;
}

Result<Factors> readFactors(asset::ByteCursor& cursor, const std::string& name, const std::string& where) {
  const uint8_t scalar_size = readU8(cursor);
  Factors factors;
  factors.components = cursor.u32();
  factors.rows = cursor.u32();
  factors.cols = cursor.u32();
  if (!cursor.ok()) return cutShort(name, "at " + where);
  if (const Status status = checkComponents(factors.components, name, where); !status) return status.issue();
  const auto s = readNumbers(cursor, factors.components, 1, scalar_size, name, where);
  if (!s) return s.issue();
  const auto u = readNumbers(cursor, factors.rows, factors.components, scalar_size, name, where);
  if (!u) return u.issue();
  const auto sv = readNumbers(cursor, factors.cols, factors.components, scalar_size, name, where);
  if (!sv) return sv.issue();
  factors.u = *u;
  factors.sv = *sv;
  return factors;
}

Result<std::unique_ptr<MeasuredSource>> openDfmf(std::shared_ptr<const MappedFile> file, Header header,
                                                 asset::ByteCursor cursor, const std::string& name) {
  return opened<DfmfFile>(std::move(file), std::move(header), cursor, name);
}

Result<std::unique_ptr<MeasuredSource>> openFmf(std::shared_ptr<const MappedFile> file, Header header,
                                                asset::ByteCursor cursor, const std::string& name) {
  return opened<FmfFile>(std::move(file), std::move(header), cursor, name);
}

Result<std::unique_ptr<MeasuredSource>> openPvf(std::shared_ptr<const MappedFile> file, Header header,
                                                asset::ByteCursor cursor, const std::string& name) {
  return opened<PvfFile>(std::move(file), std::move(header), cursor, name);
}

}  // namespace loden::importer::btf
