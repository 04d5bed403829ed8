// Saves GL state and restores it, so that a public call leaves the context as it found it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/gl/gl_objects.h"

namespace loden::runtime {

// Saves and restores pixel transfer state and the pixel buffers, which uploads and read-backs change. While
// it lives, rows are tightly packed.
class GlPixelStateScope {
 public:
  GlPixelStateScope();
  ~GlPixelStateScope();
  GlPixelStateScope(const GlPixelStateScope&) = delete;
  GlPixelStateScope& operator=(const GlPixelStateScope&) = delete;

 private:
  std::array<int32_t, 16> stored_{};
  int32_t pack_buffer_ = 0, unpack_buffer_ = 0;
};

// Saves and restores all the state that drawing a frame sets, and no other: framebuffers, program, vertex
// array, buffers, textures and samplers of the first `units` units, enabled capabilities, clip control,
// depth, culling, polygon and clear state. Of state that exists per draw buffer or viewport (blending, colour
// mask, scissor test, viewport, depth range) only the first is saved, and the frame must not set the others.
class GlDrawStateScope {
 public:
  explicit GlDrawStateScope(int units, int uniform_bindings);
  ~GlDrawStateScope();
  GlDrawStateScope(const GlDrawStateScope&) = delete;
  GlDrawStateScope& operator=(const GlDrawStateScope&) = delete;

 private:
  struct Unit {
    std::array<int32_t, 4> textures{};  // one per target of kTargets
    int32_t sampler = 0;
  };
  struct UniformBinding {
    int32_t buffer = 0;
    int64_t offset = 0, size = 0;
  };
  void saveUnits(int units);
  void restoreUnits() const;

  std::vector<Unit> units_;
  std::vector<UniformBinding> uniforms_;
  std::vector<uint8_t> enabled_;
  int32_t active_texture_ = 0, program_ = 0, pipeline_ = 0, vertex_array_ = 0, array_buffer_ = 0,
          uniform_buffer_ = 0;
  int32_t draw_framebuffer_ = 0, read_framebuffer_ = 0;
  int32_t clip_origin_ = 0, clip_depth_ = 0;
  std::array<uint8_t, 4> color_mask_{};
  std::array<float, 4> viewport_{}, clear_color_{};
  std::array<double, 2> depth_range_{};
  double clear_depth_ = 1;
  std::array<int32_t, 2> blend_equation_{};  // for colour and alpha
  std::array<int32_t, 4> blend_func_{};      // source and destination, for colour and alpha
  int32_t depth_func_ = 0, cull_face_ = 0, front_face_ = 0, polygon_mode_ = 0;
  uint8_t depth_mask_ = 1;
  std::array<float, 2> polygon_offset_{};
};

}  // namespace loden::runtime
