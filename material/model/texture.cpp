#include "material/model/texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "material/base/check.h"

namespace loden {
namespace {

enum class Encoding { kUnorm, kSnorm, kFloat };

struct FormatTraits {
  TexelFormat format;
  const char* name;
  int channels;
  int channel_bytes;
  Encoding encoding;
};

constexpr FormatTraits kFormats[] = {
    {TexelFormat::kR8Unorm, "R8_UNORM", 1, 1, Encoding::kUnorm},
    {TexelFormat::kRG8Unorm, "R8G8_UNORM", 2, 1, Encoding::kUnorm},
    {TexelFormat::kRGBA8Unorm, "R8G8B8A8_UNORM", 4, 1, Encoding::kUnorm},
    {TexelFormat::kRGBA8Snorm, "R8G8B8A8_SNORM", 4, 1, Encoding::kSnorm},
    {TexelFormat::kRG16Snorm, "R16G16_SNORM", 2, 2, Encoding::kSnorm},
    {TexelFormat::kRGBA16Unorm, "R16G16B16A16_UNORM", 4, 2, Encoding::kUnorm},
    {TexelFormat::kRGBA16Snorm, "R16G16B16A16_SNORM", 4, 2, Encoding::kSnorm},
    {TexelFormat::kRGBA16Sfloat, "R16G16B16A16_SFLOAT", 4, 2, Encoding::kFloat},
    {TexelFormat::kRGBA32Sfloat, "R32G32B32A32_SFLOAT", 4, 4, Encoding::kFloat},
};

// Traits by format number, for the inner loops.
constexpr size_t kFormatNumbers = 110;
constexpr auto kTraitsByNumber = [] {
  std::array<FormatTraits, kFormatNumbers> table{};
  for (FormatTraits& traits : table) traits = {TexelFormat{}, "unknown", 0, 0, Encoding::kUnorm};
  for (const FormatTraits& traits : kFormats) table[static_cast<size_t>(traits.format)] = traits;
  return table;
}();

const FormatTraits& traitsOf(TexelFormat format) {
  const auto number = static_cast<size_t>(format);
  return kTraitsByNumber[number < kFormatNumbers ? number : 0];
}

// Bytes decode by table: exact, and no division in the inner loop.
struct ByteTables {
  std::array<float, 256> unorm, snorm;
};
const ByteTables kByteTables = [] {
  ByteTables tables{};
  for (int i = 0; i < 256; ++i) {
    tables.unorm[i] = static_cast<float>(i) / 255.0f;
    tables.snorm[i] = std::max(static_cast<float>(static_cast<int8_t>(i)) / 127.0f, -1.0f);
  }
  return tables;
}();

template <class Raw>
Raw load(const std::byte* from) {
  Raw raw;
  std::memcpy(&raw, from, sizeof raw);
  return raw;
}

// One channel of each encoding.
struct Unorm8 {
  static constexpr int kBytes = 1;
  static float decode(const std::byte* from) { return kByteTables.unorm[static_cast<size_t>(*from)]; }
};
struct Snorm8 {
  static constexpr int kBytes = 1;
  static float decode(const std::byte* from) { return kByteTables.snorm[static_cast<size_t>(*from)]; }
};
struct Unorm16 {
  static constexpr int kBytes = 2;
  static float decode(const std::byte* from) { return static_cast<float>(load<uint16_t>(from)) / 65535.0f; }
};
struct Snorm16 {
  static constexpr int kBytes = 2;
  static float decode(const std::byte* from) {
    return std::max(static_cast<float>(load<int16_t>(from)) / 32767.0f, -1.0f);
  }
};
struct Float16 {
  static constexpr int kBytes = 2;
  static float decode(const std::byte* from) { return floatFromHalf(load<uint16_t>(from)); }
};
struct Float32 {
  static constexpr int kBytes = 4;
  static float decode(const std::byte* from) { return load<float>(from); }
};

template <class Channel, int kChannels>
struct Decoder {
  static constexpr int kBytes = kChannels * Channel::kBytes;
  glm::vec4 operator()(const std::byte* from) const {
    glm::vec4 texel(0, 0, 0, 1);
    for (int c = 0; c < kChannels; ++c) texel[c] = Channel::decode(from + c * Channel::kBytes);
    return texel;
  }
};

// Calls `use` with the format's decoder, so that the format is looked at once per sample and not per texel.
template <class Use>
inline auto withDecoder(TexelFormat format, const Use& use) {
  switch (format) {
    case TexelFormat::kR8Unorm:
      return use(Decoder<Unorm8, 1>());
    case TexelFormat::kRG8Unorm:
      return use(Decoder<Unorm8, 2>());
    case TexelFormat::kRGBA8Unorm:
      return use(Decoder<Unorm8, 4>());
    case TexelFormat::kRGBA8Snorm:
      return use(Decoder<Snorm8, 4>());
    case TexelFormat::kRG16Snorm:
      return use(Decoder<Snorm16, 2>());
    case TexelFormat::kRGBA16Unorm:
      return use(Decoder<Unorm16, 4>());
    case TexelFormat::kRGBA16Snorm:
      return use(Decoder<Snorm16, 4>());
    case TexelFormat::kRGBA16Sfloat:
      return use(Decoder<Float16, 4>());
    case TexelFormat::kRGBA32Sfloat:
      return use(Decoder<Float32, 4>());
  }
  LODEN_CHECK(!"a known texel format");
  std::abort();
}

template <class Raw>
void save(std::byte* to, Raw raw) {
  std::memcpy(to, &raw, sizeof raw);
}

// Nearest code of a value clamped to [low, 1]; a NaN becomes 0.
int normCode(double value, double low, int codes) {
  if (std::isnan(value)) return 0;
  return static_cast<int>(std::lround(std::clamp(value, low, 1.0) * codes));
}

void storeNorm(const FormatTraits& traits, std::byte* to, double value) {
  const bool is_signed = traits.encoding == Encoding::kSnorm;
  if (traits.channel_bytes == 1) {
    save(to, static_cast<uint8_t>(is_signed ? normCode(value, -1, 127) : normCode(value, 0, 255)));
  } else {
    save(to, static_cast<uint16_t>(is_signed ? normCode(value, -1, 32767) : normCode(value, 0, 65535)));
  }
}

void storeFloat(const FormatTraits& traits, std::byte* to, float value) {
  if (traits.channel_bytes == 4) return save(to, value);
  save(to, halfFromFloat(std::isnan(value) ? value : std::clamp(value, -65504.0f, 65504.0f)));
}

size_t texelOffset(const Texture& texture, int mip, int x, int y, int z) {
#ifndef NDEBUG  // not in release builds: every fetch comes by here
  LODEN_CHECK(mip >= 0 && mip < texture.mips && z >= 0 && z < texture.depth);
  LODEN_CHECK(x >= 0 && x < texture.mipWidth(mip) && y >= 0 && y < texture.mipHeight(mip));
#endif
  const size_t row = static_cast<size_t>(z) * texture.mipHeight(mip) + y;
  return texture.mipOffset(mip) + (row * texture.mipWidth(mip) + x) * texelBytes(texture.format);
}

// The two texels along one axis that a linear filter blends, and the weight of the second.
template <class T>
struct Span {
  int first, second;
  T blend;
};

// In [0, 1]; 0 of a coordinate that is not finite, so that no index leaves the texture.
template <class T>
T fraction(T value) {
  const T f = value - std::floor(value);
  return f >= T(0) ? f : T(0);
}

template <class T>
Span<T> repeatSpan(T coordinate, int size) {
  const T texel = fraction(coordinate) * static_cast<T>(size) - T(0.5);
  const T floor = std::floor(texel);
  const int first = static_cast<int>(floor);  // -1 .. size - 1
  return {first < 0 ? first + size : first, first + 1 < size ? first + 1 : first + 1 - size, texel - floor};
}

template <class T>
Span<T> clampSpan(T coordinate, int size) {
  const T texel = std::min(std::max(T(0), coordinate - T(0.5)), static_cast<T>(size - 1));  // 0 of a NaN
  const int first = static_cast<int>(texel);
  return {first, std::min(first + 1, size - 1), texel - static_cast<T>(first)};
}

// Bilinear blend of the rows of one image or slice.
template <class T, class Decode>
inline glm::vec<4, T> blendSquare(const Decode& decode, const std::byte* image, size_t width,
                                  const Span<T>& x, const Span<T>& y) {
  const std::byte* low = image + y.first * width * Decode::kBytes;
  const std::byte* high = image + y.second * width * Decode::kBytes;
  const auto row = [&](const std::byte* texels) {
    const glm::vec<4, T> left(decode(texels + x.first * Decode::kBytes));
    return left + (glm::vec<4, T>(decode(texels + x.second * Decode::kBytes)) - left) * x.blend;
  };
  const glm::vec<4, T> below = row(low);
  return below + (row(high) - below) * y.blend;
}

}  // namespace

int texelBytes(TexelFormat format) {
  return traitsOf(format).channels * traitsOf(format).channel_bytes;
}
int texelChannels(TexelFormat format) {
  return traitsOf(format).channels;
}
const char* texelFormatName(TexelFormat format) {
  return traitsOf(format).name;
}

Texture Texture::make(TexelFormat format, TextureShape shape, int width, int height, int depth, int mips) {
  LODEN_CHECK(width > 0 && height > 0 && depth > 0 && texelBytes(format) > 0);
  LODEN_CHECK(mips >= 1 && mips <= fullMipCount(width, height));
  LODEN_CHECK(shape == TextureShape::kArray2D || mips == 1);
  Texture texture{format, shape, width, height, depth, mips, {}};
  texture.data.resize(textureBytes(format, width, height, depth, mips));
  return texture;
}

size_t Texture::mipOffset(int mip) const {
  size_t texels = 0;
  for (int m = 0; m < mip; ++m) texels += static_cast<size_t>(mipWidth(m)) * mipHeight(m);
  return texels * depth * texelBytes(format);
}

size_t Texture::mipBytes(int mip) const {
  return static_cast<size_t>(mipWidth(mip)) * mipHeight(mip) * depth * texelBytes(format);
}

uint64_t textureBytes(TexelFormat format, uint64_t width, uint64_t height, uint64_t depth, int mips) {
  constexpr uint64_t kTooMany = std::numeric_limits<uint64_t>::max();
  uint64_t total = 0;
  for (int mip = 0; mip < mips; ++mip) {
    uint64_t bytes = static_cast<uint64_t>(texelBytes(format));
    for (const uint64_t extent :
         {std::max<uint64_t>(width >> mip, 1), std::max<uint64_t>(height >> mip, 1), depth}) {
      if (__builtin_mul_overflow(bytes, extent, &bytes)) return kTooMany;
    }
    if (__builtin_add_overflow(total, bytes, &total)) return kTooMany;
  }
  return total;
}

uint64_t textureBytes(const Texture& t) {
  return textureBytes(t.format, uint64_t(t.width), uint64_t(t.height), uint64_t(t.depth), t.mips);
}

glm::vec4 fetchTexel(const Texture& texture, int mip, int x, int y, int z) {
  const std::byte* from = texture.data.data() + texelOffset(texture, mip, x, y, z);
  return withDecoder(texture.format, [from](const auto& decode) { return decode(from); });
}

void storeTexel(Texture& texture, int mip, int x, int y, int z, const glm::vec4& value) {
  const FormatTraits& traits = traitsOf(texture.format);
  std::byte* to = texture.data.data() + texelOffset(texture, mip, x, y, z);
  for (int c = 0; c < traits.channels; ++c, to += traits.channel_bytes) {
    if (traits.encoding == Encoding::kFloat) {
      storeFloat(traits, to, value[c]);
    } else {
      storeNorm(traits, to, value[c]);
    }
  }
}

template <class T>
glm::vec<4, T> sampleRepeat(const Texture& texture, int mip, int layer, glm::vec<2, T> uv) {
  const int width = texture.mipWidth(mip);
  const Span<T> x = repeatSpan(uv.x, width), y = repeatSpan(uv.y, texture.mipHeight(mip));
  const std::byte* image = texture.data.data() + texelOffset(texture, mip, 0, 0, layer);
  return withDecoder(texture.format,
                     [&](const auto& decode) { return blendSquare(decode, image, width, x, y); });
}

template <class T>
glm::vec<4, T> sampleRepeatLod(const Texture& texture, T lod, int layer, glm::vec<2, T> uv) {
  const T clamped = std::min(std::max(T(0), lod), static_cast<T>(texture.mips - 1));  // 0 of a NaN
  const int mip = static_cast<int>(clamped);
  const T blend = clamped - static_cast<T>(mip);
  const glm::vec<4, T> fine = sampleRepeat(texture, mip, layer, uv);
  return blend > T(0) ? glm::mix(fine, sampleRepeat(texture, mip + 1, layer, uv), blend) : fine;
}

template <class T>
glm::vec<4, T> nearestRepeat(const Texture& texture, int mip, int layer, glm::vec<2, T> uv) {
  // fraction() of a tiny negative number rounds to 1.
  const auto wrapped = [](T coordinate, int size) {
    return std::min(static_cast<int>(fraction(coordinate) * static_cast<T>(size)), size - 1);
  };
  return glm::vec<4, T>(fetchTexel(texture, mip, wrapped(uv.x, texture.mipWidth(mip)),
                                   wrapped(uv.y, texture.mipHeight(mip)), layer));
}

template <class T>
glm::vec<4, T> sampleVolume(const Texture& texture, glm::vec<3, T> texel) {
  const Span<T> x = clampSpan(texel.x, texture.width), y = clampSpan(texel.y, texture.height),
                z = clampSpan(texel.z, texture.depth);
  const size_t slice = static_cast<size_t>(texture.width) * texture.height * texelBytes(texture.format);
  return withDecoder(texture.format, [&](const auto& decode) {
    const auto at = [&](int k) {
      return blendSquare(decode, texture.data.data() + k * slice, texture.width, x, y);
    };
    const glm::vec<4, T> below = at(z.first);
    return below + (at(z.second) - below) * z.blend;
  });
}

int fullMipCount(int width, int height) {
  return std::bit_width(static_cast<unsigned>(std::max(width, height)));
}

uint16_t halfFromFloat(float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  const uint16_t sign = static_cast<uint16_t>(bits >> 16 & 0x8000);
  const uint32_t magnitude = bits & 0x7fffffff;
  if (magnitude > 0x7f800000) return sign | 0x7e00;   // NaN
  if (magnitude >= 0x477ff000) return sign | 0x7c00;  // rounds beyond 65504
  if (magnitude < 0x38800000) {
    // Subnormal: adding 1/2 leaves round-to-nearest-even of value / 2^-24 in the low bits.
    const float rounded = std::bit_cast<float>(magnitude) + 0.5f;
    return static_cast<uint16_t>(sign | (std::bit_cast<uint32_t>(rounded) - std::bit_cast<uint32_t>(0.5f)));
  }
  // Rebias the exponent by 112 and round the 13 dropped bits to nearest even.
  const uint32_t rebiased = magnitude - (112u << 23);
  return static_cast<uint16_t>(sign | ((rebiased + 0xfff + (rebiased >> 13 & 1)) >> 13));
}

float floatFromHalf(uint16_t half) {
  const uint32_t sign = static_cast<uint32_t>(half & 0x8000) << 16;
  const uint32_t magnitude = half & 0x7fff;
  if (magnitude >= 0x7c00) return std::bit_cast<float>(sign | 0x7f800000 | (magnitude & 0x3ff) << 13);
  if (magnitude >= 0x0400) return std::bit_cast<float>(sign | ((magnitude << 13) + (112u << 23)));
  const float subnormal = static_cast<float>(magnitude) * 0x1p-24f;
  return std::bit_cast<float>(sign | std::bit_cast<uint32_t>(subnormal));
}

#define LODEN_INSTANTIATE(T)                                                       \
  template glm::vec<4, T> sampleRepeat(const Texture&, int, int, glm::vec<2, T>);  \
  template glm::vec<4, T> sampleRepeatLod(const Texture&, T, int, glm::vec<2, T>); \
  template glm::vec<4, T> nearestRepeat(const Texture&, int, int, glm::vec<2, T>); \
  template glm::vec<4, T> sampleVolume(const Texture&, glm::vec<3, T>);
LODEN_INSTANTIATE(float)
LODEN_INSTANTIATE(double)
#undef LODEN_INSTANTIATE

}  // namespace loden
