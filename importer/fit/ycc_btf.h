// The BTF in the form that the fits read: luma and chroma per view, from a baked output, a measured set or
// memory.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "importer/btf/btf_source.h"
#include "importer/fit/matrix.h"

namespace loden::importer {

// Y, Cb, Cr of all images in memory: 32 bits per value up to kFloatLimit bytes, and 16 (half) above, so that
// a set of 256 x 256 texels and 81 x 81 images takes 2.6 GB.
class YccBtf {
 public:
  enum class Store { kFloat, kHalf };
  YccBtf(int side, int lights, int views);
  // With Store::kHalf values are stored divided by `unit`, a power of two, so that values far from white keep
  // their 11 bits.
  YccBtf(int side, int lights, int views, Store store, double unit = 1);
  // An empty BTF of half the side, with the same kind of storage.
  YccBtf halved() const;

  int side() const { return side_; }
  int texels() const { return side_ * side_; }
  int lights() const { return lights_; }
  int views() const { return views_; }
  // The largest magnitude that the storage can hold.
  float largest() const;

  // Stores one channel of a view. `values`: [light][texel]; channel 0 is Y, 1 Cb, 2 Cr; magnitudes up to
  // largest().
  void store(int channel, int view, std::span<const float> values);
  // Reads one channel of a view as a matrix of texels x lights.
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

// Reads all views of a source, twice if they are stored as halves and are far from white. A value that is not
// finite is an issue that says how many there are and where the first is. `store`: the kind of storage, in
// place of the one that follows from the size.
Result<YccBtf> loadYcc(const BtfSource& source, int threads, std::optional<YccBtf::Store> store = {});

// The value of one texel under one light, seen from one view.
struct BtfSample {
  int view = 0, light = 0;
  glm::ivec2 texel{0};
  glm::dvec3 ycc{0};
};

// What is kept of a BTF that is too large to hold as a whole: all of it at half the side, and samples.
struct HalvedBtf {
  int side = 0;                    // of the BTF
  YccBtf half;                     // of a BTF of one texel, that BTF
  std::vector<BtfSample> samples;  // random, in order of views, and as many of each view
};

// Reads all views of a source as loadYcc does, and keeps `samples` samples at most, but one of each view at
// least. The same texels, lights and views are drawn from all BTFs of the same size.
Result<HalvedBtf> loadHalved(const BtfSource& source, int samples, int threads);

// The largest magnitude of Y, Cb and Cr.
double largestValue(const YccBtf& btf, int threads);

// The images with values whose luma is above `most` scaled down to it, so that their colour is kept.
YccBtf limited(YccBtf btf, double most, int threads);

// The mean over the texels of each image: (views * lights) x 3, row = view * lights + light.
Matrix imageMeans(const YccBtf& btf, int threads);

enum class BoxFilter {
  k2x2,  // mean of four texels, or over the area if the side is odd; keeps position and mean
  k3x3,  // as published (LBTF 3.1): 3 x 3 box around texel 2i, then decimation; shifts by half a texel
};
// The BTF at half the side; the filter is periodic.
YccBtf downsample(const YccBtf& fine, BoxFilter filter, int threads);
// One set of images, texels x n, at half the side; the filter is periodic.
Matrix downsample(const Matrix& fine, int side, BoxFilter filter);

}  // namespace loden::importer
