#include "runtime/gl/material/texture_gpu.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "runtime/gl/material/gl_texture.h"

namespace loden::runtime {

bool isMipmapped(const ImageTexture& image) {
  return image.min_filter != GL_NEAREST && image.min_filter != GL_LINEAR;
}

void TextureGpu::create() {
  PartPlan coarsest;
  coarsest.first_mip = image_.mips->mips - 1;
  coarsest.mips = 1;
  texel_ = uploadWhole(imagePart(image_, coarsest), image_.name + " coarsest");
  if (texel_) setSampling(texel_.name());
  shown_ = texel_.name();
}

void TextureGpu::contextLost() {
  texel_.release();
  for (Part& part : parts_) {
    part.texture.release();
    part = {};
  }
  shown_ = 0;
}

void TextureGpu::setSampling(uint32_t texture) const {
  glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GLint(image_.wrap_s));
  glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GLint(image_.wrap_t));
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GLint(image_.min_filter));
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GLint(image_.mag_filter));
}

void TextureGpu::setPart(size_t part, GlTexture texture, const PartTexture& source) {
  setSampling(texture.name());
  parts_[part] = {std::move(texture), source.first_mip, source.mips > 1};
}

bool TextureGpu::publish(float lambda) {
  const auto finest =
      std::find_if(parts_.rbegin(), parts_.rend(), [](const Part& part) { return bool(part.texture); });
  const uint32_t name = finest == parts_.rend() ? texel_.name() : finest->texture.name();
  if (name == shown_ && lambda == shown_lambda_) return false;
  shown_ = name;
  shown_lambda_ = lambda;
  if (finest == parts_.rend() || !finest->mipmapped) return true;
  constexpr float kNoBound = -1000;  // GL's default
  const float least = lambda - static_cast<float>(finest->first_mip);
  glTextureParameterf(name, GL_TEXTURE_MIN_LOD, least > 0 ? least : kNoBound);
  return true;
}

}  // namespace loden::runtime
