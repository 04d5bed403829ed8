#include "runtime/gl/gl_state.h"

#include <epoxy/gl.h>

#include <iterator>

namespace loden::runtime {
namespace {

constexpr GLenum kPixelStore[] = {
    GL_UNPACK_ALIGNMENT, GL_UNPACK_ROW_LENGTH,  GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_PIXELS,
    GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES, GL_UNPACK_SWAP_BYTES,   GL_UNPACK_LSB_FIRST,
    GL_PACK_ALIGNMENT,   GL_PACK_ROW_LENGTH,    GL_PACK_IMAGE_HEIGHT,   GL_PACK_SKIP_PIXELS,
    GL_PACK_SKIP_ROWS,   GL_PACK_SKIP_IMAGES,   GL_PACK_SWAP_BYTES,     GL_PACK_LSB_FIRST};

struct Target {
  GLenum target, binding;
};
// Those that drawing binds; glBindTextureUnit with a texture leaves a unit's other targets as they are.
constexpr Target kTargets[] = {{GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D},
                               {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
                               {GL_TEXTURE_3D, GL_TEXTURE_BINDING_3D},
                               {GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP}};

constexpr GLenum kSwitches[] = {GL_CULL_FACE,
                                GL_DEPTH_TEST,
                                GL_STENCIL_TEST,
                                GL_FRAMEBUFFER_SRGB,
                                GL_POLYGON_OFFSET_FILL,
                                GL_POLYGON_SMOOTH,
                                GL_DEPTH_CLAMP,
                                GL_RASTERIZER_DISCARD,
                                GL_MULTISAMPLE,
                                GL_SAMPLE_ALPHA_TO_COVERAGE,
                                GL_SAMPLE_COVERAGE,
                                GL_SAMPLE_MASK,
                                GL_SAMPLE_SHADING,
                                GL_PRIMITIVE_RESTART,
                                GL_PRIMITIVE_RESTART_FIXED_INDEX,
                                GL_COLOR_LOGIC_OP,
                                GL_TEXTURE_CUBE_MAP_SEAMLESS,
                                GL_CLIP_DISTANCE0,
                                GL_CLIP_DISTANCE1,
                                GL_CLIP_DISTANCE2,
                                GL_CLIP_DISTANCE3,
                                GL_CLIP_DISTANCE4,
                                GL_CLIP_DISTANCE5,
                                GL_CLIP_DISTANCE6,
                                GL_CLIP_DISTANCE7};
// Of the first draw buffer, and the first viewport.
constexpr GLenum kIndexedSwitches[] = {GL_BLEND, GL_SCISSOR_TEST};

// Of the first draw buffer.
constexpr GLenum kBlendEquations[] = {GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA};
constexpr GLenum kBlendFuncs[] = {GL_BLEND_SRC_RGB, GL_BLEND_DST_RGB, GL_BLEND_SRC_ALPHA, GL_BLEND_DST_ALPHA};

GLint integer(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

void setSwitch(GLenum name, bool on) {
  on ? glEnable(name) : glDisable(name);
}
void setFirstSwitch(GLenum name, bool on) {
  on ? glEnablei(name, 0) : glDisablei(name, 0);
}

}  // namespace

GlPixelStateScope::GlPixelStateScope() {
  pack_buffer_ = integer(GL_PIXEL_PACK_BUFFER_BINDING);
  unpack_buffer_ = integer(GL_PIXEL_UNPACK_BUFFER_BINDING);
  for (size_t i = 0; i < stored_.size(); ++i) {
    stored_[i] = integer(kPixelStore[i]);
    const bool alignment = kPixelStore[i] == GL_UNPACK_ALIGNMENT || kPixelStore[i] == GL_PACK_ALIGNMENT;
    glPixelStorei(kPixelStore[i], alignment ? 1 : 0);
  }
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

GlPixelStateScope::~GlPixelStateScope() {
  for (size_t i = 0; i < stored_.size(); ++i) glPixelStorei(kPixelStore[i], stored_[i]);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, GLuint(pack_buffer_));
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, GLuint(unpack_buffer_));
}

GlDrawStateScope::GlDrawStateScope(int units, int uniform_bindings) {
  active_texture_ = integer(GL_ACTIVE_TEXTURE);
  saveUnits(units);
  uniform_buffer_ = integer(GL_UNIFORM_BUFFER_BINDING);
  uniforms_.resize(size_t(uniform_bindings));
  for (size_t i = 0; i < uniforms_.size(); ++i) {
    UniformBinding& u = uniforms_[i];
    glGetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, GLuint(i), &u.buffer);
    glGetInteger64i_v(GL_UNIFORM_BUFFER_START, GLuint(i), &u.offset);
    glGetInteger64i_v(GL_UNIFORM_BUFFER_SIZE, GLuint(i), &u.size);
  }
  for (GLenum name : kSwitches) enabled_.push_back(glIsEnabled(name));
  for (GLenum name : kIndexedSwitches) enabled_.push_back(glIsEnabledi(name, 0));
  program_ = integer(GL_CURRENT_PROGRAM);
  pipeline_ = integer(GL_PROGRAM_PIPELINE_BINDING);
  vertex_array_ = integer(GL_VERTEX_ARRAY_BINDING);
  array_buffer_ = integer(GL_ARRAY_BUFFER_BINDING);
  draw_framebuffer_ = integer(GL_DRAW_FRAMEBUFFER_BINDING);
  read_framebuffer_ = integer(GL_READ_FRAMEBUFFER_BINDING);
  clip_origin_ = integer(GL_CLIP_ORIGIN);
  clip_depth_ = integer(GL_CLIP_DEPTH_MODE);
  glGetFloati_v(GL_VIEWPORT, 0, viewport_.data());
  glGetBooleani_v(GL_COLOR_WRITEMASK, 0, color_mask_.data());
  glGetFloatv(GL_COLOR_CLEAR_VALUE, clear_color_.data());
  glGetDoublei_v(GL_DEPTH_RANGE, 0, depth_range_.data());
  glGetDoublev(GL_DEPTH_CLEAR_VALUE, &clear_depth_);
  for (size_t i = 0; i < std::size(kBlendEquations); ++i)
    glGetIntegeri_v(kBlendEquations[i], 0, &blend_equation_[i]);
  for (size_t i = 0; i < std::size(kBlendFuncs); ++i) glGetIntegeri_v(kBlendFuncs[i], 0, &blend_func_[i]);
  depth_func_ = integer(GL_DEPTH_FUNC);
  cull_face_ = integer(GL_CULL_FACE_MODE);
  front_face_ = integer(GL_FRONT_FACE);
  GLint polygon_mode[2] = {GL_FILL, GL_FILL};  // some drivers still write two values
  glGetIntegerv(GL_POLYGON_MODE, polygon_mode);
  polygon_mode_ = polygon_mode[0];
  glGetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
  glGetFloatv(GL_POLYGON_OFFSET_FACTOR, &polygon_offset_[0]);
  glGetFloatv(GL_POLYGON_OFFSET_UNITS, &polygon_offset_[1]);
}

GlDrawStateScope::~GlDrawStateScope() {
  restoreUnits();
  for (size_t i = 0; i < uniforms_.size(); ++i) {
    const UniformBinding& u = uniforms_[i];
    if (u.buffer != 0 && u.size != 0)
      glBindBufferRange(GL_UNIFORM_BUFFER, GLuint(i), GLuint(u.buffer), GLintptr(u.offset),
                        GLsizeiptr(u.size));
    else
      glBindBufferBase(GL_UNIFORM_BUFFER, GLuint(i), GLuint(u.buffer));
  }
  glBindBuffer(GL_UNIFORM_BUFFER, GLuint(uniform_buffer_));
  for (size_t i = 0; i < std::size(kSwitches); ++i) setSwitch(kSwitches[i], enabled_[i] != 0);
  for (size_t i = 0; i < std::size(kIndexedSwitches); ++i)
    setFirstSwitch(kIndexedSwitches[i], enabled_[std::size(kSwitches) + i] != 0);
  glUseProgram(GLuint(program_));
  glBindProgramPipeline(GLuint(pipeline_));
  glBindVertexArray(GLuint(vertex_array_));
  glBindBuffer(GL_ARRAY_BUFFER, GLuint(array_buffer_));
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(draw_framebuffer_));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(read_framebuffer_));
  glClipControl(GLenum(clip_origin_), GLenum(clip_depth_));
  glViewportIndexedfv(0, viewport_.data());
  glColorMaski(0, color_mask_[0], color_mask_[1], color_mask_[2], color_mask_[3]);
  glClearColor(clear_color_[0], clear_color_[1], clear_color_[2], clear_color_[3]);
  glDepthRangeIndexed(0, depth_range_[0], depth_range_[1]);
  glClearDepth(clear_depth_);
  glBlendEquationSeparatei(0, GLenum(blend_equation_[0]), GLenum(blend_equation_[1]));
  glBlendFuncSeparatei(0, GLenum(blend_func_[0]), GLenum(blend_func_[1]), GLenum(blend_func_[2]),
                       GLenum(blend_func_[3]));
  glDepthFunc(GLenum(depth_func_));
  glCullFace(GLenum(cull_face_));
  glFrontFace(GLenum(front_face_));
  glPolygonMode(GL_FRONT_AND_BACK, GLenum(polygon_mode_));
  glDepthMask(depth_mask_);
  glPolygonOffset(polygon_offset_[0], polygon_offset_[1]);
}

void GlDrawStateScope::saveUnits(int units) {
  units_.resize(size_t(units));
  for (int i = 0; i < units; ++i) {
    glActiveTexture(GLenum(GL_TEXTURE0 + i));
    Unit& unit = units_[size_t(i)];
    for (size_t t = 0; t < unit.textures.size(); ++t) unit.textures[t] = integer(kTargets[t].binding);
    unit.sampler = integer(GL_SAMPLER_BINDING);
  }
  glActiveTexture(GLenum(active_texture_));
}

void GlDrawStateScope::restoreUnits() const {
  for (size_t i = 0; i < units_.size(); ++i) {
    glActiveTexture(GLenum(GL_TEXTURE0 + i));
    for (size_t t = 0; t < units_[i].textures.size(); ++t)
      glBindTexture(kTargets[t].target, GLuint(units_[i].textures[t]));
    glBindSampler(GLuint(i), GLuint(units_[i].sampler));
  }
  glActiveTexture(GLenum(active_texture_));
}

}  // namespace loden::runtime
