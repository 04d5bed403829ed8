// Texel arrays exactly as the GPU gets them, and the CPU's reading of them: the same fetch, wrap and
// linear filter that the shaders use, so that the reference evaluator and the GPU agree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace loden {

// VkFormat numbers; stock GPU formats only.
enum class TexelFormat : uint32_t {
  kR8Unorm = 9,
  kRG8Unorm = 16,
  kRGBA8Unorm = 37,
  kRGBA8Snorm = 38,
  kRG16Snorm = 78,
  kRGBA16Unorm = 91,
  kRGBA16Snorm = 92,
  kRGBA16Sfloat = 97,
  kRGBA32Sfloat = 109,
};

// Bytes per texel; 0 for a number that is none of the above.
int texelBytes(TexelFormat format);
// Channels per texel, 1, 2 or 4; 0 for an unknown format.
int texelChannels(TexelFormat format);
const char* texelFormatName(TexelFormat format);

enum class TextureShape : uint32_t {
  kArray2D,  // depth = layers, which mips keep
  kVolume,   // depth = z extent; volumes here have one mip
};

// Mip 0 first; within a mip x runs fastest, then y, then layer or z; no padding.
// Row 0 is v = 0. Normalised formats decode as in Vulkan: snorm8 = max(byte / 127, -1).
struct Texture {
  TexelFormat format = TexelFormat::kRGBA8Unorm;
  TextureShape shape = TextureShape::kArray2D;
  int width = 0, height = 0, depth = 0, mips = 1;
  std::vector<std::byte> data;

  static Texture make(TexelFormat format, TextureShape shape, int width, int height, int depth, int mips = 1);
  bool empty() const { return data.empty(); }
  int mipWidth(int mip) const { return width >> mip > 1 ? width >> mip : 1; }
  int mipHeight(int mip) const { return height >> mip > 1 ? height >> mip : 1; }
  // Bytes before this mip, and of it.
  size_t mipOffset(int mip) const;
  size_t mipBytes(int mip) const;
};

// Bytes that the extents need, in 64 bit, without a Texture: for checks before an allocation.
uint64_t textureBytes(TexelFormat format, uint64_t width, uint64_t height, uint64_t depth, int mips);
// Of a texture whose texels need not be there.
uint64_t textureBytes(const Texture& texture);

// Missing channels read as 0, alpha as 1 (as in GL). Coordinates must be inside.
glm::vec4 fetchTexel(const Texture& texture, int mip, int x, int y, int z);
// Clamped to the format's range and rounded to nearest; snorm never stores the most negative code.
void storeTexel(Texture& texture, int mip, int x, int y, int z, const glm::vec4& value);

// Bilinear, repeat wrap, one mip of one layer; uv in periods, any finite value. T is float or double.
template <class T>
glm::vec<4, T> sampleRepeat(const Texture& texture, int mip, int layer, glm::vec<2, T> uv);
// The same with linear filtering between the two mips that enclose `lod` (clamped to what exists).
template <class T>
glm::vec<4, T> sampleRepeatLod(const Texture& texture, T lod, int layer, glm::vec<2, T> uv);
// The texel under uv, repeat wrap.
template <class T>
glm::vec<4, T> nearestRepeat(const Texture& texture, int mip, int layer, glm::vec<2, T> uv);
// Trilinear, clamped; uvw in texels, so that the centre of texel 0 is at .5.
template <class T>
glm::vec<4, T> sampleVolume(const Texture& texture, glm::vec<3, T> texel);

// The largest power-of-two mip count down to 1 x 1.
int fullMipCount(int width, int height);

uint16_t halfFromFloat(float value);
float floatFromHalf(uint16_t half);

}  // namespace loden
