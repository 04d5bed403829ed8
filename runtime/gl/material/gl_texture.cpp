#include "runtime/gl/material/gl_texture.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <limits>

#include "material/base/check.h"

namespace loden::runtime {
namespace {

struct GlFormat {
  GLenum internal, format, type;
};

GlFormat glFormat(const PartTexture& part) {
  if (part.image) return {GLenum(part.srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8), GL_RGBA, GL_UNSIGNED_BYTE};
  // The packed geometry image (material/model/packed_geometry.h): all bytes of a texel in one channel, so
  // that one gather returns a whole patch.
  if (part.plain_2d && part.texels.format == TexelFormat::kRG8Unorm)
    return {GL_R16, GL_RED, GL_UNSIGNED_SHORT};
  if (part.plain_2d) return {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT};
  switch (part.texels.format) {
    case TexelFormat::kR8Unorm:
      return {GL_R8, GL_RED, GL_UNSIGNED_BYTE};
    case TexelFormat::kRG8Unorm:
      return {GL_RG8, GL_RG, GL_UNSIGNED_BYTE};
    case TexelFormat::kRGBA8Unorm:
      return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case TexelFormat::kRGBA8Snorm:
      return {GL_RGBA8_SNORM, GL_RGBA, GL_BYTE};
    case TexelFormat::kRG16Snorm:
      return {GL_RG16_SNORM, GL_RG, GL_SHORT};
    case TexelFormat::kRGBA16Unorm:
      return {GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT};
    case TexelFormat::kRGBA16Snorm:
      return {GL_RGBA16_SNORM, GL_RGBA, GL_SHORT};
    case TexelFormat::kRGBA16Sfloat:
      return {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT};
    case TexelFormat::kRGBA32Sfloat:
      return {GL_RGBA32F, GL_RGBA, GL_FLOAT};
  }
  LODEN_CHECK(!"texel format without a GL format");
  return {};
}

void setSampling(GLuint texture, Sampling sampling) {
  const bool repeat = sampling <= Sampling::kRepeatNearest;
  const GLint wrap = repeat ? GL_REPEAT : GL_CLAMP_TO_EDGE;
  const bool linear = sampling != Sampling::kRepeatNearest && sampling != Sampling::kClampNearest;
  const GLint mag = linear ? GL_LINEAR : GL_NEAREST;
  const GLint min = sampling == Sampling::kRepeatTrilinear ? GL_LINEAR_MIPMAP_LINEAR : mag;
  glTextureParameteri(texture, GL_TEXTURE_WRAP_S, wrap);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_T, wrap);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_R, wrap);
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, min);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, mag);
}

}  // namespace

GlTexture allocateTexture(const PartTexture& part, std::string_view label) {
  const Texture& t = part.source();
  const int width = t.mipWidth(part.first_mip), height = t.mipHeight(part.first_mip);
  const GLsizei mips = part.endMip() - part.first_mip;
  const GLenum internal = glFormat(part).internal;
  const bool volume = t.shape == TextureShape::kVolume;
  GlTexture texture = makeTexture(volume          ? GL_TEXTURE_3D
                                  : part.plain_2d ? GL_TEXTURE_2D
                                                  : GL_TEXTURE_2D_ARRAY,
                                  label);
  if (part.plain_2d)
    glTextureStorage2D(texture.name(), mips, internal, width, height);
  else
    glTextureStorage3D(texture.name(), mips, internal, width, height, t.depth);
  GLint stored = GL_FALSE;  // false if it could not be
  glGetTextureParameteriv(texture.name(), GL_TEXTURE_IMMUTABLE_FORMAT, &stored);
  if (stored == GL_FALSE) return {};
  setSampling(texture.name(), part.sampling);
  return texture;
}

GlTexture uploadWhole(const PartTexture& part, std::string_view label) {
  GlTexture texture = allocateTexture(part, label);
  int64_t unlimited = std::numeric_limits<int64_t>::max();
  if (texture) TextureUpload().step(part, texture.name(), unlimited);
  return texture;
}

GlTexture makeIndexTexture(std::span<const uint8_t> indices, int side, std::string_view label) {
  LODEN_CHECK_EQ(indices.size(), size_t(side) * size_t(side));
  GlTexture texture = makeTexture(GL_TEXTURE_2D, label);
  glTextureStorage2D(texture.name(), 1, GL_R8UI, side, side);
  glTextureSubImage2D(texture.name(), 0, 0, 0, side, side, GL_RED_INTEGER, GL_UNSIGNED_BYTE, indices.data());
  setSampling(texture.name(), Sampling::kClampNearest);
  return texture;
}

bool TextureUpload::step(const PartTexture& part, uint32_t texture, int64_t& budget) {
  do {
    budget -= int64_t(uploadSome(part, texture, uint64_t(std::max<int64_t>(budget, 0))));
    if (part.first_mip + mip_ == part.endMip()) return true;
  } while (budget > 0);
  return false;
}

// One call's worth: whole layers where they fit, else rows of one layer. Returns bytes.
uint64_t TextureUpload::uploadSome(const PartTexture& part, uint32_t texture, uint64_t budget) {
  const Texture& t = part.source();
  const int mip = part.first_mip + mip_;  // of the source
  const int width = t.mipWidth(mip), height = t.mipHeight(mip), depth = t.depth;
  const uint64_t row_bytes = uint64_t(width) * uint64_t(texelBytes(t.format)),
                 layer_bytes = row_bytes * uint64_t(height);
  int rows = height, layers = 1;
  if (row_ == 0 && budget >= layer_bytes)
    layers = int(std::min(uint64_t(depth - layer_), budget / layer_bytes));
  else
    rows = int(std::clamp(budget / row_bytes, uint64_t(1), uint64_t(height - row_)));
  const std::byte* texels =
      t.data.data() + t.mipOffset(mip) + layer_bytes * uint64_t(layer_) + row_bytes * uint64_t(row_);
  const GlFormat gl = glFormat(part);
  if (part.plain_2d)
    glTextureSubImage2D(texture, mip_, 0, row_, width, rows, gl.format, gl.type, texels);
  else
    glTextureSubImage3D(texture, mip_, 0, row_, layer_, width, rows, layers, gl.format, gl.type, texels);
  const uint64_t used = row_bytes * uint64_t(rows) * uint64_t(layers);
  row_ += rows;
  if (row_ < height) return used;
  row_ = 0;
  layer_ += layers;
  if (layer_ < depth) return used;
  layer_ = 0;
  ++mip_;
  return used;
}

}  // namespace loden::runtime
