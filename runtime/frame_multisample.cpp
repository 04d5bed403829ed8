#include "runtime/frame_multisample.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "material/check.h"

namespace loden::runtime {
namespace {

GlTexture makeSampled(GLenum format, glm::ivec2 size, int samples, std::string_view label) {
  GlTexture texture = makeTexture(GL_TEXTURE_2D_MULTISAMPLE, label);
  glTextureStorage2DMultisample(texture.name(), samples, format, size.x, size.y, GL_TRUE);
  return texture;
}

}  // namespace

MultisampleTarget makeMultisampleTarget(glm::ivec2 size, int samples) {
  GLint most = 1;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  const int given = std::min<int>(samples, most);
  MultisampleTarget target{size, samples, makeSampled(GL_SRGB8_ALPHA8, size, given, "frame samples colour"),
                           makeSampled(GL_DEPTH_COMPONENT32F, size, given, "frame samples depth"),
                           makeFramebuffer("frame samples")};
  const GLuint framebuffer = target.framebuffer.name();
  glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, target.color.name(), 0);
  glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, target.depth.name(), 0);
  LODEN_CHECK_EQ(glCheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER), GLenum(GL_FRAMEBUFFER_COMPLETE));
  return target;
}

void resolve(const MultisampleTarget& from, uint32_t framebuffer) {
  glBlitNamedFramebuffer(from.framebuffer.name(), framebuffer, 0, 0, from.size.x, from.size.y, 0, 0, from.size.x,
                         from.size.y, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

}  // namespace loden::runtime
