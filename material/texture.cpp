#include "material/texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include "material/check.h"
#include "material/color.h"

namespace loden {
namespace {

enum class Encoding { kUnorm, kSnorm, kSrgb, kFloat };

struct FormatTraits {
  TexelFormat format;
  const char* name;
  int channels;
  int channel_bytes;
  Encoding encoding;
};

constexpr FormatTraits kFormats[] = {
    {TexelFormat::kR8Unorm, "R8_UNORM", 1, 1, Encoding::kUnorm},
    {TexelFormat::kR8Snorm, "R8_SNORM", 1, 1, Encoding::kSnorm},
    {TexelFormat::kRG8Unorm, "R8G8_UNORM", 2, 1, Encoding::kUnorm},
    {TexelFormat::kRG8Snorm, "R8G8_SNORM", 2, 1, Encoding::kSnorm},
    {TexelFormat::kRGBA8Unorm, "R8G8B8A8_UNORM", 4, 1, Encoding::kUnorm},
    {TexelFormat::kRGBA8Snorm, "R8G8B8A8_SNORM", 4, 1, Encoding::kSnorm},
    {TexelFormat::kRGBA8Srgb, "R8G8B8A8_SRGB", 4, 1, Encoding::kSrgb},
    {TexelFormat::kR16Unorm, "R16_UNORM", 1, 2, Encoding::kUnorm},
    {TexelFormat::kRG16Unorm, "R16G16_UNORM", 2, 2, Encoding::kUnorm},
    {TexelFormat::kRG16Snorm, "R16G16_SNORM", 2, 2, Encoding::kSnorm},
    {TexelFormat::kRGBA16Unorm, "R16G16B16A16_UNORM", 4, 2, Encoding::kUnorm},
    {TexelFormat::kRGBA16Snorm, "R16G16B16A16_SNORM", 4, 2, Encoding::kSnorm},
    {TexelFormat::kRGBA16Sfloat, "R16G16B16A16_SFLOAT", 4, 2, Encoding::kFloat},
    {TexelFormat::kRG32Sfloat, "R32G32_SFLOAT", 2, 4, Encoding::kFloat},
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
  std::array<float, 256> unorm, snorm, srgb;
};
const ByteTables kByteTables = [] {
  ByteTables tables{};
  for (int i = 0; i < 256; ++i) {
    tables.unorm[i] = static_cast<float>(i) / 255.0f;
    tables.snorm[i] = std::max(static_cast<float>(static_cast<int8_t>(i)) / 127.0f, -1.0f);
    tables.srgb[i] = static_cast<float>(linearFromSrgb(i / 255.0));
  }
  return tables;
}();

template <class Raw>
Raw load(const std::byte* from) {
  Raw raw;
  std::memcpy(&raw, from, sizeof raw);
  return raw;
}

template <int kChannels, class Decode>
glm::vec4 gather(const Decode& decode) {
  glm::vec4 texel(0, 0, 0, 1);
  for (int c = 0; c < kChannels; ++c) texel[c] = decode(c);
  return texel;
}

template <int kChannels>
glm::vec4 decodeBytes(const std::byte* from, const std::array<float, 256>& table) {
  return gather<kChannels>([&](int c) { return table[static_cast<size_t>(from[c])]; });
}

template <int kChannels>
glm::vec4 decodeUnorm16(const std::byte* from) {
  return gather<kChannels>([&](int c) { return static_cast<float>(load<uint16_t>(from + 2 * c)) / 65535.0f; });
}

template <int kChannels>
glm::vec4 decodeSnorm16(const std::byte* from) {
  return gather<kChannels>(
      [&](int c) { return std::max(static_cast<float>(load<int16_t>(from + 2 * c)) / 32767.0f, -1.0f); });
}

glm::vec4 decodeSrgb(const std::byte* from) {
  const glm::vec4 rgb = decodeBytes<4>(from, kByteTables.srgb);
  return {rgb.x, rgb.y, rgb.z, kByteTables.unorm[static_cast<size_t>(from[3])]};
}

inline glm::vec4 decodeTexel(TexelFormat format, const std::byte* from) {
  switch (format) {
    case TexelFormat::kR8Unorm: return decodeBytes<1>(from, kByteTables.unorm);
    case TexelFormat::kR8Snorm: return decodeBytes<1>(from, kByteTables.snorm);
    case TexelFormat::kRG8Unorm: return decodeBytes<2>(from, kByteTables.unorm);
    case TexelFormat::kRG8Snorm: return decodeBytes<2>(from, kByteTables.snorm);
    case TexelFormat::kRGBA8Unorm: return decodeBytes<4>(from, kByteTables.unorm);
    case TexelFormat::kRGBA8Snorm: return decodeBytes<4>(from, kByteTables.snorm);
    case TexelFormat::kRGBA8Srgb: return decodeSrgb(from);
    case TexelFormat::kR16Unorm: return decodeUnorm16<1>(from);
    case TexelFormat::kRG16Unorm: return decodeUnorm16<2>(from);
    case TexelFormat::kRG16Snorm: return decodeSnorm16<2>(from);
    case TexelFormat::kRGBA16Unorm: return decodeUnorm16<4>(from);
    case TexelFormat::kRGBA16Snorm: return decodeSnorm16<4>(from);
    case TexelFormat::kRGBA16Sfloat:
      return gather<4>([&](int c) { return floatFromHalf(load<uint16_t>(from + 2 * c)); });
    case TexelFormat::kRG32Sfloat: return gather<2>([&](int c) { return load<float>(from + 4 * c); });
    case TexelFormat::kRGBA32Sfloat: return gather<4>([&](int c) { return load<float>(from + 4 * c); });
  }
  return glm::vec4(0, 0, 0, 1);
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
  assert(mip >= 0 && mip < texture.mips && z >= 0 && z < texture.depth);
  assert(x >= 0 && x < texture.mipWidth(mip) && y >= 0 && y < texture.mipHeight(mip));
  const size_t row = static_cast<size_t>(z) * texture.mipHeight(mip) + y;
  return texture.mipOffset(mip) + (row * texture.mipWidth(mip) + x) * texelBytes(texture.format);
}

// The two texels along one axis that a linear filter blends, and the weight of the second.
template <class T>
struct Span {
  int first, second;
  T blend;
};

template <class T>
T fraction(T value) {
  return value - std::floor(value);
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
  const T texel = std::clamp(coordinate - T(0.5), T(0), static_cast<T>(size - 1));
  const int first = static_cast<int>(texel);
  return {first, std::min(first + 1, size - 1), texel - static_cast<T>(first)};
}

template <class T>
glm::vec<4, T> blendSquare(TexelFormat format, const std::byte* rows, size_t pitch, const Span<T>& x, const Span<T>& y) {
  const size_t step = texelBytes(format);
  const auto at = [&](int i, int j) { return glm::vec<4, T>(decodeTexel(format, rows + j * pitch + i * step)); };
  const glm::vec<4, T> low = glm::mix(at(x.first, y.first), at(x.second, y.first), x.blend);
  const glm::vec<4, T> high = glm::mix(at(x.first, y.second), at(x.second, y.second), x.blend);
  return glm::mix(low, high, y.blend);
}

}  // namespace

int texelBytes(TexelFormat format) { return traitsOf(format).channels * traitsOf(format).channel_bytes; }
int texelChannels(TexelFormat format) { return traitsOf(format).channels; }
const char* texelFormatName(TexelFormat format) { return traitsOf(format).name; }

Texture Texture::make(TexelFormat format, TextureShape shape, int width, int height, int depth, int mips) {
  LODEN_CHECK(width > 0 && height > 0 && depth > 0 && texelBytes(format) > 0);
  LODEN_CHECK(mips >= 1 && mips <= fullMipCount(width, height));
  LODEN_CHECK(shape == TextureShape::kArray2D || mips == 1);
  Texture texture{format, shape, width, height, depth, mips, {}};
  texture.data.resize(textureBytes(format, width, height, depth, mips));
  return texture;
}

size_t Texture::mipOffset(int mip) const {
  size_t offset = 0;
  for (int m = 0; m < mip; ++m) offset += mipBytes(m);
  return offset;
}

size_t Texture::mipBytes(int mip) const {
  return static_cast<size_t>(mipWidth(mip)) * mipHeight(mip) * depth * texelBytes(format);
}

uint64_t textureBytes(TexelFormat format, uint64_t width, uint64_t height, uint64_t depth, int mips) {
  constexpr uint64_t kTooMany = std::numeric_limits<uint64_t>::max();
  uint64_t total = 0;
  for (int mip = 0; mip < mips; ++mip) {
    uint64_t bytes = static_cast<uint64_t>(texelBytes(format));
    for (const uint64_t extent : {std::max<uint64_t>(width >> mip, 1), std::max<uint64_t>(height >> mip, 1), depth}) {
      if (__builtin_mul_overflow(bytes, extent, &bytes)) return kTooMany;
    }
    if (__builtin_add_overflow(total, bytes, &total)) return kTooMany;
  }
  return total;
}

glm::vec4 fetchTexel(const Texture& texture, int mip, int x, int y, int z) {
  return decodeTexel(texture.format, texture.data.data() + texelOffset(texture, mip, x, y, z));
}

void storeTexel(Texture& texture, int mip, int x, int y, int z, const glm::vec4& value) {
  const FormatTraits& traits = traitsOf(texture.format);
  std::byte* to = texture.data.data() + texelOffset(texture, mip, x, y, z);
  for (int c = 0; c < traits.channels; ++c, to += traits.channel_bytes) {
    if (traits.encoding == Encoding::kFloat) {
      storeFloat(traits, to, value[c]);
    } else if (traits.encoding == Encoding::kSrgb && c < 3) {
      storeNorm(traits, to, srgbFromLinear(value[c]));
    } else {
      storeNorm(traits, to, value[c]);
    }
  }
}

template <class T>
glm::vec<4, T> sampleRepeat(const Texture& texture, int mip, int layer, glm::vec<2, T> uv) {
  const int width = texture.mipWidth(mip), height = texture.mipHeight(mip);
  const size_t pitch = static_cast<size_t>(width) * texelBytes(texture.format);
  return blendSquare(texture.format, texture.data.data() + texelOffset(texture, mip, 0, 0, layer), pitch,
                     repeatSpan(uv.x, width), repeatSpan(uv.y, height));
}

template <class T>
glm::vec<4, T> sampleRepeatLod(const Texture& texture, T lod, int layer, glm::vec<2, T> uv) {
  const T clamped = std::clamp(lod, T(0), static_cast<T>(texture.mips - 1));
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
  const size_t pitch = static_cast<size_t>(texture.width) * texelBytes(texture.format);
  const size_t slice = pitch * texture.height;
  const auto at = [&](int k) { return blendSquare(texture.format, texture.data.data() + k * slice, pitch, x, y); };
  return glm::mix(at(z.first), at(z.second), z.blend);
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

#define LODEN_INSTANTIATE(T)                                                                    \
  template glm::vec<4, T> sampleRepeat(const Texture&, int, int, glm::vec<2, T>);               \
  template glm::vec<4, T> sampleRepeatLod(const Texture&, T, int, glm::vec<2, T>);              \
  template glm::vec<4, T> nearestRepeat(const Texture&, int, int, glm::vec<2, T>);              \
  template glm::vec<4, T> sampleVolume(const Texture&, glm::vec<3, T>);
LODEN_INSTANTIATE(float)
LODEN_INSTANTIATE(double)
#undef LODEN_INSTANTIATE

}  // namespace loden
