// Private to the renderer: a framebuffer with several samples per pixel, for smooth silhouettes. Shading
// still runs once per pixel, since materials are filtered by their level of detail.
#pragma once

#include <glm/glm.hpp>

#include "material/base/result.h"
#include "runtime/gl/gl_objects.h"

namespace loden::runtime {

struct MultisampleTarget {
  glm::ivec2 size{0};
  int samples = 0;
  uint32_t color_format = 0;  // GL's internal format
  // `color` is RGBA8 sRGB, or has as many floating-point bits as the target; `depth` is 32-bit float.
  GlTexture color, depth;
  GlFramebuffer framebuffer;
};
// A target whose samples can be resolved into `framebuffer`. `samples` is lowered to what the driver can do.
// Issues: kMemory for sizes that the driver cannot do.
Result<MultisampleTarget> makeMultisampleTarget(glm::ivec2 size, int samples, uint32_t framebuffer);

// Whether the target can be used for these arguments of makeMultisampleTarget.
bool fits(const MultisampleTarget& target, glm::ivec2 size, int samples, uint32_t framebuffer);

// Averages the samples into the colour of a framebuffer of the same size, whose depth stays as it is.
void resolve(const MultisampleTarget& from, uint32_t framebuffer);

}  // namespace loden::runtime
