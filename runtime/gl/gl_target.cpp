#include "runtime/gl/gl_target.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "material/base/check.h"
#include "material/base/issues.h"
#include "runtime/gl/gl_state.h"

namespace loden::runtime {
namespace {

GLenum internalFormat(ColorFormat format) {
  if (format == ColorFormat::kSrgb8) return GL_SRGB8_ALPHA8;
  return format == ColorFormat::kLinear16 ? GL_RGBA16F : GL_RGBA32F;
}

GlTexture makeAttachment(GLenum format, glm::ivec2 size, const std::string& label) {
  GlTexture texture = makeTexture(GL_TEXTURE_2D, label);
  glTextureStorage2D(texture.name(), 1, format, size.x, size.y);
  return texture;
}

}  // namespace

Result<RenderTarget> makeRenderTarget(glm::ivec2 size, ColorFormat format, std::string_view label) {
  const std::string name(label);
  const Issue impossible{
      issue_id::kMemory, Severity::kError, name,
      "the driver has no picture of " + std::to_string(size.x) + " x " + std::to_string(size.y) + " pixels"};
  GLint side = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
  if (std::min(size.x, size.y) < 1 || std::max(size.x, size.y) > side) return impossible;
  RenderTarget target{size, format, makeAttachment(internalFormat(format), size, name + " colour"),
                      makeAttachment(GL_DEPTH_COMPONENT32F, size, name + " depth"), makeFramebuffer(name)};
  glNamedFramebufferTexture(target.framebuffer.name(), GL_COLOR_ATTACHMENT0, target.color.name(), 0);
  glNamedFramebufferTexture(target.framebuffer.name(), GL_DEPTH_ATTACHMENT, target.depth.name(), 0);
  if (glCheckNamedFramebufferStatus(target.framebuffer.name(), GL_DRAW_FRAMEBUFFER) !=
      GL_FRAMEBUFFER_COMPLETE)
    return impossible;
  return target;
}

Result<RenderTarget> makePicture(std::span<const glm::u8vec4> codes, glm::ivec2 size,
                                 std::string_view label) {
  LODEN_CHECK_EQ(codes.size(), size_t(size.x) * size_t(size.y));
  Result<RenderTarget> target = makeRenderTarget(size, ColorFormat::kSrgb8, label);
  if (!target) return target;
  const GlPixelStateScope scope;
  const size_t width = size_t(size.x), height = size_t(size.y);
  std::vector<glm::u8vec4> bottom_up(codes.size());
  for (size_t y = 0; y < height; ++y)
    std::copy_n(codes.begin() + ptrdiff_t((height - 1 - y) * width), width,
                bottom_up.begin() + ptrdiff_t(y * width));
  glTextureSubImage2D(target->color.name(), 0, 0, 0, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE,
                      bottom_up.data());
  return target;
}

std::vector<glm::vec4> readLinear(const RenderTarget& target) {
  const GlPixelStateScope scope;
  std::vector<glm::vec4> pixels(size_t(target.size.x) * size_t(target.size.y));
  glGetTextureImage(target.color.name(), 0, GL_RGBA, GL_FLOAT, GLsizei(pixels.size() * sizeof(glm::vec4)),
                    pixels.data());
  if (target.format != ColorFormat::kSrgb8) return pixels;
  for (glm::vec4& pixel : pixels)
    for (int c = 0; c < 3; ++c)
      pixel[c] = pixel[c] <= 0.04045f ? pixel[c] / 12.92f : std::pow((pixel[c] + 0.055f) / 1.055f, 2.4f);
  return pixels;
}

std::vector<glm::u8vec4> readCodes(const RenderTarget& target) {
  LODEN_CHECK(target.format == ColorFormat::kSrgb8);
  const GlPixelStateScope scope;
  const size_t width = size_t(target.size.x), height = size_t(target.size.y);
  std::vector<glm::u8vec4> bottom_up(width * height), top_down(width * height);
  glGetTextureImage(target.color.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, GLsizei(bottom_up.size() * 4),
                    bottom_up.data());
  for (size_t y = 0; y < height; ++y)
    std::copy_n(bottom_up.begin() + ptrdiff_t((height - 1 - y) * width), width,
                top_down.begin() + ptrdiff_t(y * width));
  return top_down;
}

namespace {

// [part_from, part_to) of the picture into [from, to).
void copy(const RenderTarget& picture, glm::ivec2 part_from, glm::ivec2 part_to, uint32_t framebuffer,
          glm::ivec2 from, glm::ivec2 to) {
  const bool same = part_to - part_from == to - from;
  const GLboolean converts = glIsEnabled(GL_FRAMEBUFFER_SRGB), clipped = glIsEnabledi(GL_SCISSOR_TEST, 0);
  glDisable(GL_FRAMEBUFFER_SRGB);  // codes stay as they are
  glDisablei(GL_SCISSOR_TEST, 0);
  glBlitNamedFramebuffer(picture.framebuffer.name(), framebuffer, part_from.x, part_from.y, part_to.x,
                         part_to.y, from.x, from.y, to.x, to.y, GL_COLOR_BUFFER_BIT,
                         same ? GL_NEAREST : GL_LINEAR);
  if (converts) glEnable(GL_FRAMEBUFFER_SRGB);
  if (clipped) glEnablei(GL_SCISSOR_TEST, 0);
}

}  // namespace

void copyPicture(const RenderTarget& picture, uint32_t framebuffer, glm::ivec2 from, glm::ivec2 to) {
  copy(picture, {0, 0}, picture.size, framebuffer, from, to);
}

void copyRectangle(const RenderTarget& picture, uint32_t framebuffer, glm::ivec2 from, glm::ivec2 to) {
  copy(picture, from, to, framebuffer, from, to);
}

}  // namespace loden::runtime
