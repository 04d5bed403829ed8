// Private to the renderer: a framebuffer with several samples per pixel, for smooth silhouettes. Materials filter
// themselves; shading runs once per pixel.
#pragma once

#include <glm/glm.hpp>

#include "runtime/gl_objects.h"

namespace loden::runtime {

struct MultisampleTarget {
  glm::ivec2 size{0};
  int samples = 0;
  GlTexture color, depth;  // RGBA8 sRGB, 32-bit float
  GlFramebuffer framebuffer;
};
// `samples` is lowered to what the driver can do.
MultisampleTarget makeMultisampleTarget(glm::ivec2 size, int samples);

// Averages the samples into a framebuffer of the same size.
void resolve(const MultisampleTarget& from, uint32_t framebuffer);

}  // namespace loden::runtime
