// An offscreen framebuffer with one colour and one depth attachment, and the way back to the CPU.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "material/base/result.h"
#include "runtime/gl/gl_objects.h"

namespace loden::runtime {

enum class ColorFormat {
  kSrgb8,     // RGBA8 sRGB: what a window shows
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
// Issues: kMemory, for sizes that the driver cannot.
Result<RenderTarget> makeRenderTarget(glm::ivec2 size, ColorFormat format, std::string_view label);

// A target of kSrgb8 that holds these RGBA8 codes, [height][width], first row at the top. Issues: kMemory.
Result<RenderTarget> makePicture(std::span<const glm::u8vec4> codes, glm::ivec2 size, std::string_view label);

// RGBA as the texture decodes, [height][width], first row at the bottom; waits for the GPU. sRGB targets give
// linear values.
std::vector<glm::vec4> readLinear(const RenderTarget& target);
// RGBA8 codes as stored, [height][width], first row at the top (as image files have it); kSrgb8 only.
std::vector<glm::u8vec4> readCodes(const RenderTarget& target);

// Copies the whole picture into a rectangle of another, [from, to) in pixels from the bottom left, linearly
// scaled. Framebuffer 0 is the window; both must be sRGB, or both linear.
void copyPicture(const RenderTarget& picture, uint32_t framebuffer, glm::ivec2 from, glm::ivec2 to);
// Copies a rectangle of the picture to the same place of another, otherwise as copyPicture.
void copyRectangle(const RenderTarget& picture, uint32_t framebuffer, glm::ivec2 from, glm::ivec2 to);

}  // namespace loden::runtime
