// An offscreen framebuffer with one colour and one depth attachment, and reading it back to the CPU.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "material/base/result.h"
#include "runtime/gl/gl_objects.h"

namespace loden::runtime {

enum class ColorFormat {
  kSrgb8,     // RGBA8 sRGB, as a window shows it
  kLinear16,  // RGBA16F
  kLinear32,  // RGBA32F: for measuring
};

struct RenderTarget {
  glm::ivec2 size{0};  // pixels
  ColorFormat format = ColorFormat::kSrgb8;
  GlTexture color;
  GlTexture depth;  // 32-bit float
  GlFramebuffer framebuffer;
};
// A render target of this size. Issues: kMemory for sizes that the driver cannot do.
Result<RenderTarget> makeRenderTarget(glm::ivec2 size, ColorFormat format, std::string_view label);

// A render target of format kSrgb8 that holds these RGBA8 codes, [height][width] with the first row at the
// top. Issues: kMemory.
Result<RenderTarget> makePicture(std::span<const glm::u8vec4> codes, glm::ivec2 size, std::string_view label);

// The colour as the texture decodes it, RGBA [height][width] with the first row at the bottom; linear values
// for sRGB targets. Waits for the GPU.
std::vector<glm::vec4> readLinear(const RenderTarget& target);
// The RGBA8 codes as stored, [height][width] with the first row at the top, as in image files; for kSrgb8
// only.
std::vector<glm::u8vec4> readCodes(const RenderTarget& target);

// Copies the whole picture, scaled linearly, into a rectangle of another framebuffer, [from, to) in pixels
// from the bottom left. Framebuffer 0 is the window. Both must be sRGB, or both linear.
void copyPicture(const RenderTarget& picture, uint32_t framebuffer, glm::ivec2 from, glm::ivec2 to);
// Copies a rectangle of the picture, without scaling, to the same place of another framebuffer; arguments as
// for copyPicture.
void copyRectangle(const RenderTarget& picture, uint32_t framebuffer, glm::ivec2 from, glm::ivec2 to);

}  // namespace loden::runtime
