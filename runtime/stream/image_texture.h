// Textures of an engine's own that MaterialSystem streams beside the materials.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "material/model/texture.h"

namespace loden::runtime {

// A two-dimensional texture of an engine's own, such as those of glTF's materials. Its mips stay in memory,
// from where they are uploaded again after an eviction.
struct ImageTexture {
  std::string name;                     // for messages and labels
  std::shared_ptr<const Texture> mips;  // kRGBA8Unorm, one layer, every mip down to 1 x 1
  bool srgb = false;                    // red, green and blue are sRGB codes
  // GL_TEXTURE_WRAP_S and _T, _MIN_FILTER and _MAG_FILTER.
  uint32_t wrap_s = 0, wrap_t = 0, min_filter = 0, mag_filter = 0;
};

}  // namespace loden::runtime
