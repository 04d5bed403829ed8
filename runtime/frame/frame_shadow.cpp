#include "runtime/frame/frame_shadow.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "material/base/check.h"

namespace loden::runtime {

SunView sunView(const Bounds& world, const glm::vec3& direction, int side) {
  const glm::vec3 up = std::abs(direction.y) < 0.99f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::mat4 sun_from_world = glm::lookAt(glm::vec3(0), direction, up);
  Bounds box = transformed(world, sun_from_world);
  const glm::vec3 margin = 0.01f * (box.max - box.min) + 1e-3f;
  box.min -= margin;
  box.max += margin;
  SunView view;
  view.clip_from_world =
      glm::ortho(box.min.x, box.max.x, box.min.y, box.max.y, -box.max.z, -box.min.z) * sun_from_world;
  const glm::mat4 half =
      glm::translate(glm::mat4(1), glm::vec3(0.5f)) * glm::scale(glm::mat4(1), glm::vec3(0.5f));
  view.texture_from_world = half * view.clip_from_world;
  view.texel = std::max(box.max.x - box.min.x, box.max.y - box.min.y) / static_cast<float>(side);
  return view;
}

ShadowMap makeShadowMap() {
  ShadowMap map{makeTexture(GL_TEXTURE_2D, "sun shadow"), makeFramebuffer("sun shadow")};
  const GLuint texture = map.depth.name();
  glTextureStorage2D(texture, 1, GL_DEPTH_COMPONENT32F, ShadowMap::kSide, ShadowMap::kSide);
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  const float lit[4] = {1, 1, 1, 1};
  glTextureParameterfv(texture, GL_TEXTURE_BORDER_COLOR, lit);
  glTextureParameteri(texture, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTextureParameteri(texture, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  glNamedFramebufferTexture(map.framebuffer.name(), GL_DEPTH_ATTACHMENT, texture, 0);
  glNamedFramebufferDrawBuffer(map.framebuffer.name(), GL_NONE);
  LODEN_CHECK_EQ(glCheckNamedFramebufferStatus(map.framebuffer.name(), GL_DRAW_FRAMEBUFFER),
                 GLenum(GL_FRAMEBUFFER_COMPLETE));
  return map;
}

}  // namespace loden::runtime
