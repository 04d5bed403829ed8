#include "importer/fit/ycc_btf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>

#include "importer/base/random.h"
#include "importer/fit/reduction.h"
#include "material/base/issues.h"
#include "material/model/color.h"
#include "material/model/texture.h"

namespace loden::importer {

namespace {

size_t valuesOf(int side, int lights, int views) {
  return size_t(3) * size_t(views) * size_t(lights) * size_t(side) * size_t(side);
}

}  // namespace

YccBtf::YccBtf(int side, int lights, int views)
    : YccBtf(side, lights, views,
             valuesOf(side, lights, views) * sizeof(float) <= kFloatLimit ? Store::kFloat : Store::kHalf) {}

YccBtf::YccBtf(int side, int lights, int views, Store store, double unit)
    : side_(side), lights_(lights), views_(views), unit_(store == Store::kHalf ? unit : 1) {
  const size_t values = valuesOf(side, lights, views);
  if (store == Store::kFloat)
    floats_.resize(values);
  else
    halves_.resize(values);
}

YccBtf YccBtf::halved() const {
  return {side_ / 2, lights_, views_, storeOf(), unit_};
}

float YccBtf::largest() const {
  return halves_.empty() ? std::numeric_limits<float>::max() : float(65504 * unit_);
}

size_t YccBtf::offset(int channel, int view) const {
  return (size_t(channel) * size_t(views_) + size_t(view)) * size_t(lights_) * size_t(texels());
}

void YccBtf::store(int channel, int view, std::span<const float> values) {
  LODEN_CHECK_EQ(values.size(), size_t(lights_) * size_t(texels()));
  const size_t at = offset(channel, view);
  for (size_t i = 0; i < values.size(); ++i) {
    if (halves_.empty())
      floats_[at + i] = values[i];
    else
      halves_[at + i] = halfFromFloat(float(values[i] / unit_));
  }
}

void YccBtf::read(int channel, int view, Matrix& into) const {
  const size_t at = offset(channel, view), count = size_t(lights_) * size_t(texels());
  if (into.rows != texels() || into.cols != lights_) into = Matrix(texels(), lights_);
  for (size_t i = 0; i < count; ++i)
    into.data[i] = halves_.empty() ? double(floats_[at + i]) : unit_ * double(floatFromHalf(halves_[at + i]));
}

namespace {

struct NonFinite {
  size_t count = 0, first = 0;  // first: light * texels + texel
  double largest = 0;           // finite magnitude
};

using Planes = std::array<std::vector<float>, 3>;  // Y, Cb, Cr: [light][texel]

// The planes of a view. Magnitudes above `most` are left out.
NonFinite splitView(const std::vector<glm::vec3>& rgb, double most, Planes& planes) {
  NonFinite bad;
  for (auto& plane : planes) plane.assign(rgb.size(), 0.0f);
  for (size_t i = 0; i < rgb.size(); ++i) {
    const glm::dvec3 ycc = yccFromRgb(glm::dvec3(rgb[i]));
    const double magnitude = std::max({std::abs(ycc.x), std::abs(ycc.y), std::abs(ycc.z)});
    if (!(magnitude <= double(std::numeric_limits<float>::max()))) {
      if (bad.count++ == 0) bad.first = i;
      continue;
    }
    bad.largest = std::max(bad.largest, magnitude);
    if (magnitude > most) continue;
    for (size_t k = 0; k < 3; ++k) planes[k][i] = static_cast<float>(ycc[int(k)]);
  }
  return bad;
}

Issue nonFiniteIssue(const BtfSource& source, int view, const NonFinite& bad) {
  const size_t side = size_t(source.size().x), texels = side * side, texel = bad.first % texels;
  return {issue_id::kNonFinite, Severity::kError, source.name(),
          std::to_string(bad.count) + " values are not finite in view " + std::to_string(view) +
              ", the first at light " + std::to_string(bad.first / texels) + ", texel (" +
              std::to_string(texel % side) + ", " + std::to_string(texel / side) +
              "); repair the input, or let --fix-nonfinite do it"};
}

// Calls take(view, planes) for every view, on several threads, with magnitudes up to `most`. Returns the
// largest magnitude there is, taken or not.
template <class Take>
Result<double> readViews(const BtfSource& source, double most, int threads, const Take& take) {
  const auto views = size_t(source.views().size());
  std::vector<std::optional<Issue>> issues(views);
  std::vector<double> largest(views, 0.0);
  parallelFor(views, threads, [&](size_t i) {
    const int v = static_cast<int>(i);
    auto rgb = source.view(v);
    if (!rgb) {
      issues[i] = rgb.issue();
      return;
    }
    LODEN_CHECK_EQ(rgb->size(),
                   size_t(source.lights().size()) * size_t(source.size().x) * size_t(source.size().y));
    Planes planes;
    const NonFinite bad = splitView(*rgb, most, planes);
    take(v, planes);
    largest[i] = bad.largest;
    if (bad.count) issues[i] = nonFiniteIssue(source, v, bad);
  });
  for (auto& issue : issues)
    if (issue) return *issue;
  return *std::max_element(largest.begin(), largest.end());
}

// Of halves: the largest value becomes some 2^8, and all down to 2^-22 of it keep 11 bits. 1 where values are
// about white anyway.
double unitFor(double largest) {
  if (largest == 0 || (largest <= 0x1p12 && largest >= 0x1p-2)) return 1;
  return std::exp2(std::floor(std::log2(largest)) - 8);
}

Status checkSquare(const BtfSource& source) {
  if (source.size().x == source.size().y) return {};
  return Issue{issue_id::kOption, Severity::kError, source.name(),
               "is " + std::to_string(source.size().x) + " x " + std::to_string(source.size().y) +
                   " texels; only squares can be cooked: cut the images to a square"};
}

// Reads all views by take(btf, view, planes), and once more if `btf` stores halves of another unit.
template <class Take>
Status readInto(YccBtf& btf, const BtfSource& source, int threads, const Take& take) {
  const auto read = [&] {
    return readViews(source, double(btf.largest()), threads,
                     [&](int view, const Planes& planes) { take(btf, view, planes); });
  };
  auto largest = read();
  if (!largest) return largest.issue();
  const double unit = unitFor(*largest);
  if (btf.storeOf() == YccBtf::Store::kFloat || unit == 1) return {};
  btf = YccBtf(btf.side(), btf.lights(), btf.views(), YccBtf::Store::kHalf, unit);
  largest = read();
  return largest ? Status() : Status(largest.issue());
}

// The k-th sample of a view.
BtfSample sampleOf(const Planes& planes, int side, int lights, int view, int k) {
  const uint64_t seed = mixSeed(uint64_t(view), uint64_t(k));
  const int texels = side * side;
  const int t = std::min(int(uniform(seed, 0) * texels), texels - 1);
  const int l = std::min(int(uniform(seed, 1) * lights), lights - 1);
  const size_t at = size_t(l) * size_t(texels) + size_t(t);
  return {view, l, {t % side, t / side}, {planes[0][at], planes[1][at], planes[2][at]}};
}

}  // namespace

Result<YccBtf> loadYcc(const BtfSource& source, int threads, std::optional<YccBtf::Store> store) {
  if (Status square = checkSquare(source); !square) return square.issue();
  const int side = source.size().x, lights = source.lights().size(), views = source.views().size();
  YccBtf btf = store ? YccBtf(side, lights, views, *store) : YccBtf(side, lights, views);
  const Status read = readInto(btf, source, threads, [](YccBtf& into, int view, const Planes& planes) {
    for (int channel = 0; channel < 3; ++channel) into.store(channel, view, planes[size_t(channel)]);
  });
  if (!read) return read.issue();
  return btf;
}

Result<HalvedBtf> loadHalved(const BtfSource& source, int samples, int threads) {
  if (Status square = checkSquare(source); !square) return square.issue();
  const int side = source.size().x, lights = source.lights().size(), views = source.views().size();
  const int per_view = std::max(1, samples / views);
  HalvedBtf kept{side, YccBtf(std::max(side / 2, 1), lights, views), {}};
  kept.samples.resize(size_t(views) * size_t(per_view));
  const Status read = readInto(kept.half, source, threads, [&](YccBtf& half, int view, const Planes& planes) {
    for (int k = 0; k < per_view; ++k)
      kept.samples[size_t(view * per_view + k)] = sampleOf(planes, side, lights, view, k);
    Matrix block(side * side, lights);
    for (int channel = 0; channel < 3; ++channel) {
      const std::vector<float>& plane = planes[size_t(channel)];
      std::copy(plane.begin(), plane.end(), block.data.begin());
      const Matrix small = side > 1 ? downsample(block, side, BoxFilter::k2x2) : block;
      half.store(channel, view, std::vector<float>(small.data.begin(), small.data.end()));
    }
  });
  if (!read) return read.issue();
  return kept;
}

double largestValue(const YccBtf& btf, int threads) {
  std::vector<double> largest(size_t(btf.views()), 0.0);
  parallelFor(size_t(btf.views()), threads, [&](size_t v) {
    Matrix plane;
    for (int c = 0; c < 3; ++c) {
      btf.read(c, int(v), plane);
      for (const double value : plane.data) largest[v] = std::max(largest[v], std::abs(value));
    }
  });
  return *std::max_element(largest.begin(), largest.end());
}

YccBtf limited(YccBtf btf, double most, int threads) {
  parallelFor(size_t(btf.views()), threads, [&](size_t v) {
    Matrix planes[3];
    for (int c = 0; c < 3; ++c) btf.read(c, int(v), planes[c]);
    bool changed = false;
    for (size_t i = 0; i < planes[0].data.size(); ++i) {
      if (!(planes[0].data[i] > most)) continue;
      const double scale = most / planes[0].data[i];
      for (Matrix& plane : planes) plane.data[i] *= scale;
      changed = true;
    }
    for (int c = 0; c < 3 && changed; ++c)
      btf.store(c, int(v), std::vector<float>(planes[c].data.begin(), planes[c].data.end()));
  });
  return btf;
}

Matrix imageMeans(const YccBtf& btf, int threads) {
  Matrix means(btf.views() * btf.lights(), 3);
  parallelFor(btf.views(), threads, [&](int v) {
    Matrix block;
    for (int channel = 0; channel < 3; ++channel) {
      btf.read(channel, v, block);
      for (int l = 0; l < btf.lights(); ++l) {
        double sum = 0;
        for (double value : block.col(l)) sum += value;
        means(v * btf.lights() + l, channel) = sum / btf.texels();
      }
    }
  });
  return means;
}

namespace {

// The fine texels [first, first + count) along one axis that coarse texel i covers, and the share of each in
// it, where `half` texels cover the same length as `side`, which is odd: a border of coarse texels cuts
// through a fine one.
struct Overlap {
  int first = 0, count = 0;
  double share[4] = {0, 0, 0, 0};
};
Overlap overlapOf(int i, int side, int half) {
  const double width = double(side) / half, begin = i * width, end = std::min((i + 1) * width, double(side));
  Overlap o{static_cast<int>(begin), 0, {}};
  for (int t = o.first; t < side && t < end; ++t)
    o.share[o.count++] = (std::min(t + 1.0, end) - std::max(double(t), begin)) / width;
  return o;
}

Matrix downsampleOdd(const Matrix& fine, int side) {
  const int half = side / 2;
  Matrix coarse(half * half, fine.cols);
  for (int t = 0; t < half * half; ++t) {
    const Overlap x = overlapOf(t % half, side, half), y = overlapOf(t / half, side, half);
    for (int c = 0; c < fine.cols; ++c)
      for (int k = 0; k < x.count * y.count; ++k) {
        const int i = k % x.count, j = k / x.count;
        coarse(t, c) += x.share[i] * y.share[j] * fine((y.first + j) * side + x.first + i, c);
      }
  }
  return coarse;
}

}  // namespace

Matrix downsample(const Matrix& fine, int side, BoxFilter filter) {
  const int half = side / 2;
  if (side % 2 != 0 && filter == BoxFilter::k2x2) return downsampleOdd(fine, side);
  Matrix coarse(half * half, fine.cols);
  const int first = filter == BoxFilter::k2x2 ? 0 : -1, taps = filter == BoxFilter::k2x2 ? 2 : 3;
  for (int c = 0; c < fine.cols; ++c)
    for (int j = 0; j < half; ++j)
      for (int i = 0; i < half; ++i) {
        double sum = 0;
        for (int dj = 0; dj < taps; ++dj)
          for (int di = 0; di < taps; ++di)
            sum += fine((2 * j + first + dj + side) % side * side + (2 * i + first + di + side) % side, c);
        coarse(j * half + i, c) = sum / (taps * taps);
      }
  return coarse;
}

YccBtf downsample(const YccBtf& fine, BoxFilter filter, int threads) {
  YccBtf coarse = fine.halved();
  parallelFor(fine.views(), threads, [&](int v) {
    Matrix block;
    for (int channel = 0; channel < 3; ++channel) {
      fine.read(channel, v, block);
      const Matrix small = downsample(block, fine.side(), filter);
      coarse.store(channel, v, std::vector<float>(small.data.begin(), small.data.end()));
    }
  });
  return coarse;
}

}  // namespace loden::importer
