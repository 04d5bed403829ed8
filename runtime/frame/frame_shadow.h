// Private to the renderer: where the sun's shadow map looks from.
#pragma once

#include <glm/glm.hpp>

#include "runtime/gl/gl_objects.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// An orthographic view along the sunlight that holds everything in `world`.
struct SunView {
  glm::mat4 clip_from_world{1};
  glm::mat4 texture_from_world{1};  // the same in [0, 1]^3
  float texel = 0;                  // metres, the longer side
};
SunView sunView(const Bounds& world, const glm::vec3& direction, int side);

// A square depth texture that compares, and the framebuffer to draw into it.
struct ShadowMap {
  static constexpr int kSide = 2048;
  GlTexture depth;
  GlFramebuffer framebuffer;
};
ShadowMap makeShadowMap();

}  // namespace loden::runtime
