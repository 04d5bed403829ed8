// Uploads texel arrays to GPU textures in steps of bounded size. Private to the runtime.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "material/model/texture.h"
#include "runtime/gl/gl_objects.h"
#include "runtime/stream/material_parts.h"

namespace loden::runtime {

// A texture with immutable storage for the part's extents and with its sampling parameters, but without
// texels yet. Empty if the driver has no memory for it.
GlTexture allocateTexture(const PartTexture& part, std::string_view label);

// The same with all its texels.
GlTexture uploadWhole(const PartTexture& part, std::string_view label);

// A usampler2D texture of indices: one unsigned byte per texel, side x side, nearest filter.
GlTexture makeIndexTexture(std::span<const uint8_t> indices, int side, std::string_view label);

// Copies texels to the GPU a few rows at a time. GL's pixel transfer state must be that of tightly packed
// rows (GlPixelStateScope).
class TextureUpload {
 public:
  // Uploads at least one row, then whole rows or layers while `budget` bytes last, and subtracts what was
  // used from `budget`, which may become negative. Returns true when the texture is complete.
  bool step(const PartTexture& part, uint32_t texture, int64_t& budget);

 private:
  uint64_t uploadSome(const PartTexture& part, uint32_t texture, uint64_t budget);
  int mip_ = 0, layer_ = 0, row_ = 0;
};

}  // namespace loden::runtime
