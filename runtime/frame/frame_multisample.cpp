#include "runtime/frame/frame_multisample.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <string>

#include "material/base/issues.h"

namespace loden::runtime {
namespace {

GlTexture makeSampled(GLenum format, glm::ivec2 size, int samples, std::string_view label) {
  GlTexture texture = makeTexture(GL_TEXTURE_2D_MULTISAMPLE, label);
  glTextureStorage2DMultisample(texture.name(), samples, format, size.x, size.y, GL_TRUE);
  return texture;
}

// What keeps all that a framebuffer can hold. A window's buffers are taken for 8 bits.
GLenum colorFormat(uint32_t framebuffer) {
  GLint kind = GL_NONE, component = GL_NONE, bits = 0;
  const auto ask = [framebuffer](GLenum name, GLint& value) {
    glGetNamedFramebufferAttachmentParameteriv(framebuffer, GL_COLOR_ATTACHMENT0, name, &value);
  };
  if (framebuffer != 0) ask(GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE, kind);
  if (kind == GL_NONE) return GL_SRGB8_ALPHA8;
  ask(GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE, component);
  if (component != GL_FLOAT) return GL_SRGB8_ALPHA8;
  ask(GL_FRAMEBUFFER_ATTACHMENT_RED_SIZE, bits);
  return bits > 16 ? GL_RGBA32F : GL_RGBA16F;
}

int mostSamples() {
  GLint color = 1, depth = 1;
  glGetIntegerv(GL_MAX_COLOR_TEXTURE_SAMPLES, &color);
  glGetIntegerv(GL_MAX_DEPTH_TEXTURE_SAMPLES, &depth);
  return std::min(color, depth);
}

}  // namespace

Result<MultisampleTarget> makeMultisampleTarget(glm::ivec2 size, int samples, uint32_t target_framebuffer) {
  const int given = std::min(samples, mostSamples());
  const GLenum format = colorFormat(target_framebuffer);
  MultisampleTarget target{size,
                           samples,
                           format,
                           makeSampled(format, size, given, "frame samples colour"),
                           makeSampled(GL_DEPTH_COMPONENT32F, size, given, "frame samples depth"),
                           makeFramebuffer("frame samples")};
  const GLuint framebuffer = target.framebuffer.name();
  glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, target.color.name(), 0);
  glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, target.depth.name(), 0);
  if (glCheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return Issue{issue_id::kMemory, Severity::kError, "frame",
                 std::string("the driver has no frame of ") + std::to_string(size.x) + " x " +
                     std::to_string(size.y) + " pixels and " + std::to_string(given) +
                     " samples; ask for fewer"};
  return target;
}

bool fits(const MultisampleTarget& target, glm::ivec2 size, int samples, uint32_t framebuffer) {
  return target.framebuffer && target.size == size && target.samples == samples &&
         target.color_format == colorFormat(framebuffer);
}

void resolve(const MultisampleTarget& from, uint32_t framebuffer) {
  glBlitNamedFramebuffer(from.framebuffer.name(), framebuffer, 0, 0, from.size.x, from.size.y, 0, 0,
                         from.size.x, from.size.y, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

}  // namespace loden::runtime
