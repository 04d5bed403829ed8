// Private to the renderer: a framebuffer with several samples per pixel, for smooth silhouettes. Materials
// filter themselves; shading runs once per pixel.
#pragma once

#include <glm/glm.hpp>

#include "material/base/result.h"
#include "runtime/gl/gl_objects.h"

namespace loden::runtime {

struct MultisampleTarget {
  glm::ivec2 size{0};
  int samples = 0;
  uint32_t color_format = 0;  // GL's
  GlTexture color, depth;     // RGBA8 sRGB or as many floating-point bits as the target has; 32-bit float
  GlFramebuffer framebuffer;
};
// For resolving into `framebuffer`. `samples` is lowered to what the driver can do. Issues: kMemory, for
// sizes that it cannot.
Result<MultisampleTarget> makeMultisampleTarget(glm::ivec2 size, int samples, uint32_t framebuffer);

// Whether it still fits.
bool fits(const MultisampleTarget& target, glm::ivec2 size, int samples, uint32_t framebuffer);

// Averages the samples into a framebuffer of the same size; its depth stays as it is.
void resolve(const MultisampleTarget& from, uint32_t framebuffer);

}  // namespace loden::runtime
