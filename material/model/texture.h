// Texel arrays exactly as they are uploaded to the GPU, and sampling them on the CPU with the same fetch,
// wrap and linear filter as the shaders, so that the reference evaluator and the GPU agree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace loden {

// Texel formats, numbered as in VkFormat; common GPU formats only.
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

// Bytes per texel; 0 for a number that is not one of the formats.
int texelBytes(TexelFormat format);
// Channels per texel, 1, 2 or 4; 0 for an unknown format.
int texelChannels(TexelFormat format);
const char* texelFormatName(TexelFormat format);

enum class TextureShape : uint32_t {
  kArray2D,  // depth = layers, which mips keep
  kVolume,   // depth = z extent; volumes here have one mip
};

// A texture in memory. Mip 0 comes first; within a mip x runs fastest, then y, then layer or z; there is no
// padding. Row 0 is v = 0. Normalised formats decode as in Vulkan: snorm8 = max(byte / 127, -1).
struct Texture {
  TexelFormat format = TexelFormat::kRGBA8Unorm;
  TextureShape shape = TextureShape::kArray2D;
  int width = 0, height = 0, depth = 0, mips = 1;
  std::vector<std::byte> data;

  static Texture make(TexelFormat format, TextureShape shape, int width, int height, int depth, int mips = 1);
  bool empty() const { return data.empty(); }
  int mipWidth(int mip) const { return width >> mip > 1 ? width >> mip : 1; }
  int mipHeight(int mip) const { return height >> mip > 1 ? height >> mip : 1; }
  // Bytes before this mip, and bytes of this mip.
  size_t mipOffset(int mip) const;
  size_t mipBytes(int mip) const;
};

// The bytes that a texture of these extents needs, in 64 bit and without a Texture, for checks before an
// allocation.
uint64_t textureBytes(TexelFormat format, uint64_t width, uint64_t height, uint64_t depth, int mips);
// The bytes that a texture's extents need; its texels need not be there.
uint64_t textureBytes(const Texture& texture);

// One texel. Missing channels read as 0, alpha as 1 (as in GL). Coordinates must be inside the mip.
glm::vec4 fetchTexel(const Texture& texture, int mip, int x, int y, int z);
// Stores one texel, clamped to the format's range and rounded to nearest; snorm formats never store the most
// negative code.
void storeTexel(Texture& texture, int mip, int x, int y, int z, const glm::vec4& value);

// A bilinear sample with repeat wrap of one mip of one layer; uv in periods, any finite value. T is float or
// double.
template <class T>
glm::vec<4, T> sampleRepeat(const Texture& texture, int mip, int layer, glm::vec<2, T> uv);
// A trilinear sample with repeat wrap: bilinear in the two mips that enclose `lod` (clamped to the mips that
// exist), and linear between them.
template <class T>
glm::vec<4, T> sampleRepeatLod(const Texture& texture, T lod, int layer, glm::vec<2, T> uv);
// The texel under uv, with repeat wrap.
template <class T>
glm::vec<4, T> nearestRepeat(const Texture& texture, int mip, int layer, glm::vec<2, T> uv);
// A trilinear sample of a volume, clamped; coordinates are in texels, with the centre of texel 0 at .5.
template <class T>
glm::vec<4, T> sampleVolume(const Texture& texture, glm::vec<3, T> texel);

// The number of mips from these extents down to 1 x 1.
int fullMipCount(int width, int height);

uint16_t halfFromFloat(float value);
float floatFromHalf(uint16_t half);

}  // namespace loden
