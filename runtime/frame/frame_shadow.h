// Private to the renderer: the sun's shadow map and its projection.
#pragma once

#include <glm/glm.hpp>

#include "runtime/gl/gl_objects.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// An orthographic view along the sunlight that holds the whole box `world`.
struct SunView {
  glm::mat4 clip_from_world{1};
  glm::mat4 texture_from_world{1};  // like clip_from_world, but into [0, 1]^3
  float texel = 0;                  // the longer side of a shadow map texel, metres
};
SunView sunView(const Bounds& world, const glm::vec3& direction, int side);

// A square depth texture with comparison (for sampler2DShadow), and the framebuffer that draws into it.
struct ShadowMap {
  static constexpr int kSide = 2048;
  GlTexture depth;
  GlFramebuffer framebuffer;
};
ShadowMap makeShadowMap();

}  // namespace loden::runtime
