// Textures on the GPU from texel arrays, in bounded steps. Private to the runtime.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "material/model/texture.h"
#include "runtime/gl/gl_objects.h"
#include "runtime/stream/material_parts.h"

namespace loden::runtime {

// Immutable storage for the texture's extents, and its sampling parameters; no texels yet. Empty if the
// driver has no memory for it.
GlTexture allocateTexture(const PartTexture& part, std::string_view label);

// One unsigned byte per texel, side x side, nearest: indices for usampler2D.
GlTexture makeIndexTexture(std::span<const uint8_t> indices, int side, std::string_view label);

// Copies texels to the GPU a few rows at a time. Pixel transfer state must be GL's tight rows
// (GlPixelStateScope).
class TextureUpload {
 public:
  // Uploads at least one row, then whole rows or layers while `budget` bytes last, and lowers it by what was
  // used: below 0 where a row takes more than there is. True when the texture is complete.
  bool step(const PartTexture& part, uint32_t texture, int64_t& budget);

 private:
  uint64_t uploadSome(const PartTexture& part, uint32_t texture, uint64_t budget);
  int mip_ = 0, layer_ = 0, row_ = 0;
};

}  // namespace loden::runtime
