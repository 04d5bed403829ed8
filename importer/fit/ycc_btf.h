// The BTF as the fits read it: luma and chroma per view, from a baked output, a measured set or memory.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "importer/btf/btf_source.h"
#include "importer/fit/matrix.h"

namespace loden::importer {

// Y, Cb, Cr of all images in memory, 32 bits per value up to kFloatLimit and 16 (half) above, so that a
// 256 x 256 x 81 x 81 set takes 2.6 GB.
class YccBtf {
 public:
  enum class Store { kFloat, kHalf };
  YccBtf(int side, int lights, int views);
  // Halves are stored divided by `unit`, a power of two, so that values far from white keep their 11 bits.
  YccBtf(int side, int lights, int views, Store store, double unit = 1);
  // An empty one of half the side, stored as this one is.
  YccBtf halved() const;

  int side() const { return side_; }
  int texels() const { return side_ * side_; }
  int lights() const { return lights_; }
  int views() const { return views_; }
  // Magnitude that the storage can hold.
  float largest() const;

  // values: [light][texel]; channel 0 Y, 1 Cb, 2 Cr; magnitudes up to largest().
  void store(int channel, int view, std::span<const float> values);
  // texels x lights.
  void read(int channel, int view, Matrix& into) const;

  static constexpr size_t kFloatLimit = size_t(1) << 30;  // bytes
  Store storeOf() const { return halves_.empty() ? Store::kFloat : Store::kHalf; }

 private:
  size_t offset(int channel, int view) const;
  int side_, lights_, views_;
  double unit_;
  std::vector<float> floats_;
  std::vector<uint16_t> halves_;
};

// Reads all views, twice if they go to halves and are far from white. A value that is not finite is an error
// with count and first place. `store`: in place of what the size asks for.
Result<YccBtf> loadYcc(const BtfSource& source, int threads, std::optional<YccBtf::Store> store = {});

// The largest magnitude of Y, Cb and Cr.
double largestValue(const YccBtf& btf, int threads);

// The same images with values of a luma above `most` scaled down to it, colour kept.
YccBtf limited(YccBtf btf, double most, int threads);

// Mean over the texels of each image: (views * lights) x 3, row = view * lights + light.
Matrix imageMeans(const YccBtf& btf, int threads);

enum class BoxFilter {
  k2x2,  // mean of the four texels below, of an odd side mean over the area: keeps position and mean
  k3x3,  // as published (LBTF 3.1): 3 x 3 box around texel 2i, then decimation; shifts by half a texel
};
// Half the side; periodic.
YccBtf downsample(const YccBtf& fine, BoxFilter filter, int threads);
// The same for one image set, texels x n.
Matrix downsample(const Matrix& fine, int side, BoxFilter filter);

}  // namespace loden::importer
