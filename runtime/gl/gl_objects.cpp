#include "runtime/gl/gl_objects.h"

#include <epoxy/gl.h>

#include "material/base/check.h"

namespace loden::runtime {
namespace {

GLenum labelIdentifier(GlKind kind) {
  switch (kind) {
    case GlKind::kTexture:
      return GL_TEXTURE;
    case GlKind::kBuffer:
      return GL_BUFFER;
    case GlKind::kFramebuffer:
      return GL_FRAMEBUFFER;
    case GlKind::kProgram:
      return GL_PROGRAM;
    case GlKind::kVertexArray:
      return GL_VERTEX_ARRAY;
  }
  return GL_NONE;
}

template <GlKind kKind>
GlObject<kKind> adopt(GLuint name, std::string_view label) {
  setGlLabel(kKind, name, label);
  return GlObject<kKind>(name);
}

}  // namespace

void detail::deleteGlName(GlKind kind, uint32_t name) {
  switch (kind) {
    case GlKind::kTexture:
      return glDeleteTextures(1, &name);
    case GlKind::kBuffer:
      return glDeleteBuffers(1, &name);
    case GlKind::kFramebuffer:
      return glDeleteFramebuffers(1, &name);
    case GlKind::kProgram:
      return glDeleteProgram(name);
    case GlKind::kVertexArray:
      return glDeleteVertexArrays(1, &name);
  }
}

void setGlLabel(GlKind kind, uint32_t name, std::string_view label) {
  constexpr size_t kMaxLabel = 255;  // every GL 4.3 implementation takes this many
  label = label.substr(0, kMaxLabel);
  glObjectLabel(labelIdentifier(kind), name, GLsizei(label.size()), label.data());
}

GlTexture makeTexture(uint32_t target, std::string_view label) {
  GLuint name = 0;
  glCreateTextures(target, 1, &name);
  return adopt<GlKind::kTexture>(name, label);
}

GlBuffer makeBuffer(size_t bytes, std::span<const std::byte> data, uint32_t flags, std::string_view label) {
  if (!data.empty()) LODEN_CHECK_EQ(data.size(), bytes);
  GLuint name = 0;
  glCreateBuffers(1, &name);
  glNamedBufferStorage(name, GLsizeiptr(bytes), data.empty() ? nullptr : data.data(), flags);
  return adopt<GlKind::kBuffer>(name, label);
}

GlFramebuffer makeFramebuffer(std::string_view label) {
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  return adopt<GlKind::kFramebuffer>(name, label);
}

GlVertexArray makeVertexArray(std::string_view label) {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  return adopt<GlKind::kVertexArray>(name, label);
}

GlDebugGroup::GlDebugGroup(std::string_view name) {
  glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, GLsizei(name.size()), name.data());
}
GlDebugGroup::~GlDebugGroup() {
  glPopDebugGroup();
}

}  // namespace loden::runtime
