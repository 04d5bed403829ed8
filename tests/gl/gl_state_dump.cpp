#include "tests/gl/gl_state_dump.h"

#include <epoxy/gl.h>

namespace loden::test {
namespace {

struct Named {
  GLenum value;
  const char* name;
  int count = 1;
};
#define NAMED(x) \
  { x, #x }
#define NAMED_N(x, n) \
  { x, #x, n }

const Named kSwitches[] = {NAMED(GL_BLEND),
                           NAMED(GL_CULL_FACE),
                           NAMED(GL_DEPTH_TEST),
                           NAMED(GL_SCISSOR_TEST),
                           NAMED(GL_STENCIL_TEST),
                           NAMED(GL_FRAMEBUFFER_SRGB),
                           NAMED(GL_POLYGON_OFFSET_FILL),
                           NAMED(GL_POLYGON_OFFSET_LINE),
                           NAMED(GL_DEPTH_CLAMP),
                           NAMED(GL_RASTERIZER_DISCARD),
                           NAMED(GL_MULTISAMPLE),
                           NAMED(GL_DITHER),
                           NAMED(GL_SAMPLE_ALPHA_TO_COVERAGE),
                           NAMED(GL_SAMPLE_ALPHA_TO_ONE),
                           NAMED(GL_SAMPLE_COVERAGE),
                           NAMED(GL_PRIMITIVE_RESTART),
                           NAMED(GL_COLOR_LOGIC_OP),
                           NAMED(GL_TEXTURE_CUBE_MAP_SEAMLESS),
                           NAMED(GL_PROGRAM_POINT_SIZE),
                           NAMED(GL_LINE_SMOOTH),
                           NAMED(GL_POLYGON_SMOOTH),
                           NAMED(GL_SAMPLE_MASK),
                           NAMED(GL_SAMPLE_SHADING),
                           NAMED(GL_PRIMITIVE_RESTART_FIXED_INDEX),
                           NAMED(GL_CLIP_DISTANCE0),
                           NAMED(GL_CLIP_DISTANCE1),
                           NAMED(GL_CLIP_DISTANCE2),
                           NAMED(GL_CLIP_DISTANCE3),
                           NAMED(GL_CLIP_DISTANCE4),
                           NAMED(GL_CLIP_DISTANCE5),
                           NAMED(GL_CLIP_DISTANCE6),
                           NAMED(GL_CLIP_DISTANCE7)};

const Named kValues[] = {NAMED(GL_ACTIVE_TEXTURE),
                         NAMED(GL_CURRENT_PROGRAM),
                         NAMED(GL_PROGRAM_PIPELINE_BINDING),
                         NAMED(GL_VERTEX_ARRAY_BINDING),
                         NAMED(GL_ARRAY_BUFFER_BINDING),
                         NAMED(GL_ELEMENT_ARRAY_BUFFER_BINDING),
                         NAMED(GL_UNIFORM_BUFFER_BINDING),
                         NAMED(GL_SHADER_STORAGE_BUFFER_BINDING),
                         NAMED(GL_COPY_READ_BUFFER_BINDING),
                         NAMED(GL_COPY_WRITE_BUFFER_BINDING),
                         NAMED(GL_DRAW_INDIRECT_BUFFER_BINDING),
                         NAMED(GL_PIXEL_PACK_BUFFER_BINDING),
                         NAMED(GL_PIXEL_UNPACK_BUFFER_BINDING),
                         NAMED(GL_TRANSFORM_FEEDBACK_BINDING),
                         NAMED(GL_DRAW_FRAMEBUFFER_BINDING),
                         NAMED(GL_READ_FRAMEBUFFER_BINDING),
                         NAMED(GL_RENDERBUFFER_BINDING),
                         NAMED(GL_CLIP_ORIGIN),
                         NAMED(GL_CLIP_DEPTH_MODE),
                         NAMED(GL_MIN_SAMPLE_SHADING_VALUE),
                         NAMED_N(GL_VIEWPORT, 4),
                         NAMED_N(GL_SCISSOR_BOX, 4),
                         NAMED_N(GL_COLOR_WRITEMASK, 4),
                         NAMED_N(GL_COLOR_CLEAR_VALUE, 4),
                         NAMED_N(GL_BLEND_COLOR, 4),
                         NAMED_N(GL_DEPTH_RANGE, 2),
                         NAMED(GL_DEPTH_CLEAR_VALUE),
                         NAMED(GL_DEPTH_FUNC),
                         NAMED(GL_DEPTH_WRITEMASK),
                         NAMED(GL_BLEND_SRC_RGB),
                         NAMED(GL_BLEND_DST_RGB),
                         NAMED(GL_BLEND_SRC_ALPHA),
                         NAMED(GL_BLEND_DST_ALPHA),
                         NAMED(GL_BLEND_EQUATION_RGB),
                         NAMED(GL_BLEND_EQUATION_ALPHA),
                         NAMED(GL_STENCIL_FUNC),
                         NAMED(GL_STENCIL_REF),
                         NAMED(GL_STENCIL_VALUE_MASK),
                         NAMED(GL_STENCIL_FAIL),
                         NAMED(GL_STENCIL_PASS_DEPTH_FAIL),
                         NAMED(GL_STENCIL_PASS_DEPTH_PASS),
                         NAMED(GL_STENCIL_WRITEMASK),
                         NAMED(GL_STENCIL_BACK_FUNC),
                         NAMED(GL_STENCIL_BACK_REF),
                         NAMED(GL_STENCIL_BACK_VALUE_MASK),
                         NAMED(GL_STENCIL_BACK_FAIL),
                         NAMED(GL_STENCIL_BACK_WRITEMASK),
                         NAMED(GL_STENCIL_CLEAR_VALUE),
                         NAMED(GL_CULL_FACE_MODE),
                         NAMED(GL_FRONT_FACE),
                         NAMED(GL_POLYGON_MODE),
                         NAMED(GL_POLYGON_OFFSET_FACTOR),
                         NAMED(GL_POLYGON_OFFSET_UNITS),
                         NAMED(GL_LINE_WIDTH),
                         NAMED(GL_POINT_SIZE),
                         NAMED(GL_LOGIC_OP_MODE),
                         NAMED(GL_PRIMITIVE_RESTART_INDEX),
                         NAMED(GL_PROVOKING_VERTEX),
                         NAMED(GL_SAMPLE_COVERAGE_VALUE),
                         NAMED(GL_UNPACK_ALIGNMENT),
                         NAMED(GL_UNPACK_ROW_LENGTH),
                         NAMED(GL_UNPACK_IMAGE_HEIGHT),
                         NAMED(GL_UNPACK_SKIP_PIXELS),
                         NAMED(GL_UNPACK_SKIP_ROWS),
                         NAMED(GL_UNPACK_SKIP_IMAGES),
                         NAMED(GL_UNPACK_SWAP_BYTES),
                         NAMED(GL_PACK_ALIGNMENT),
                         NAMED(GL_PACK_ROW_LENGTH),
                         NAMED(GL_PACK_IMAGE_HEIGHT),
                         NAMED(GL_PACK_SKIP_PIXELS),
                         NAMED(GL_PACK_SKIP_ROWS),
                         NAMED(GL_PACK_SKIP_IMAGES),
                         NAMED(GL_PACK_SWAP_BYTES),
                         NAMED(GL_DRAW_BUFFER),
                         NAMED(GL_READ_BUFFER),
                         NAMED(GL_DEBUG_GROUP_STACK_DEPTH)};

// What is kept per draw buffer, and per viewport.
const Named kBufferValues[] = {NAMED_N(GL_COLOR_WRITEMASK, 4), NAMED(GL_BLEND_SRC_RGB),
                               NAMED(GL_BLEND_DST_RGB),        NAMED(GL_BLEND_SRC_ALPHA),
                               NAMED(GL_BLEND_DST_ALPHA),      NAMED(GL_BLEND_EQUATION_RGB),
                               NAMED(GL_BLEND_EQUATION_ALPHA)};
const Named kViewportValues[] = {NAMED_N(GL_VIEWPORT, 4), NAMED_N(GL_SCISSOR_BOX, 4),
                                 NAMED_N(GL_DEPTH_RANGE, 2)};
constexpr GLuint kIndices = 8;  // every GL 4.5 has as many draw buffers, and more viewports

const Named kUnitBindings[] = {NAMED(GL_TEXTURE_BINDING_2D), NAMED(GL_TEXTURE_BINDING_2D_ARRAY),
                               NAMED(GL_TEXTURE_BINDING_3D), NAMED(GL_TEXTURE_BINDING_CUBE_MAP),
                               NAMED(GL_SAMPLER_BINDING)};
constexpr int kUnits = 32, kUniformBindings = 8;

void dumpUnits(GlState& state) {
  GLint active = 0;
  glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
  for (int unit = 0; unit < kUnits; ++unit) {
    glActiveTexture(GLenum(GL_TEXTURE0 + unit));
    for (const Named& binding : kUnitBindings) {
      GLint name = 0;
      glGetIntegerv(binding.value, &name);
      state[std::string(binding.name) + " of unit " + std::to_string(unit)] = {double(name)};
    }
  }
  glActiveTexture(GLenum(active));
}

void dumpIndexed(GlState& state, const Named& item, GLuint index) {
  std::vector<double>& values = state[std::string(item.name) + " " + std::to_string(index)];
  values.resize(16);
  glGetDoublei_v(item.value, index, values.data());
  values.resize(size_t(item.count));
}

void dumpBuffersAndViewports(GlState& state) {
  for (GLuint i = 0; i < kIndices; ++i) {
    state["GL_BLEND " + std::to_string(i)] = {double(glIsEnabledi(GL_BLEND, i))};
    state["GL_SCISSOR_TEST " + std::to_string(i)] = {double(glIsEnabledi(GL_SCISSOR_TEST, i))};
    for (const Named& item : kBufferValues) dumpIndexed(state, item, i);
    for (const Named& item : kViewportValues) dumpIndexed(state, item, i);
  }
  GLint mask = 0;
  glGetIntegeri_v(GL_SAMPLE_MASK_VALUE, 0, &mask);
  state["GL_SAMPLE_MASK_VALUE"] = {double(mask)};
}

GLuint newTexture(GLenum target) {
  GLuint name = 0;
  glCreateTextures(target, 1, &name);
  return name;
}

void disturbUnits() {
  for (int unit = 0; unit < kUnits; ++unit) {
    for (GLenum target : {GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY, GL_TEXTURE_3D})
      glBindTextureUnit(GLuint(unit), newTexture(target));
    GLuint sampler = 0;
    glCreateSamplers(1, &sampler);
    glBindSampler(GLuint(unit), sampler);
  }
  glActiveTexture(GL_TEXTURE0 + 5);
}

void disturbBuffers() {
  GLuint buffers[6], array = 0, framebuffer = 0;
  glCreateBuffers(6, buffers);
  for (GLuint buffer : buffers) glNamedBufferStorage(buffer, 4096, nullptr, 0);
  for (GLuint i = 0; i < kUniformBindings; ++i)
    glBindBufferRange(GL_UNIFORM_BUFFER, i, buffers[0], 256 * i, 256);
  glBindBuffer(GL_UNIFORM_BUFFER, buffers[1]);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffers[2]);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, buffers[3]);
  glCreateVertexArrays(1, &array);
  glBindVertexArray(array);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[4]);
  glBindBuffer(GL_ARRAY_BUFFER, buffers[5]);
  const GLuint color = newTexture(GL_TEXTURE_2D);
  glTextureStorage2D(color, 1, GL_RGBA8, 64, 64);
  glCreateFramebuffers(1, &framebuffer);
  glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, color, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
}

void disturbFixedFunction() {
  for (GLenum name : {GL_BLEND, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_POLYGON_OFFSET_FILL, GL_DEPTH_CLAMP,
                      GL_CULL_FACE, GL_PRIMITIVE_RESTART, GL_PRIMITIVE_RESTART_FIXED_INDEX,
                      GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_COVERAGE, GL_SAMPLE_MASK, GL_SAMPLE_SHADING,
                      GL_POLYGON_SMOOTH, GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE3, GL_CLIP_DISTANCE7})
    glEnable(name);
  glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
  glSampleMaski(0, 2);
  glDisable(GL_DITHER);
  glViewport(1, 2, 33, 44);
  glScissor(3, 4, 30, 40);
  glColorMask(GL_TRUE, GL_FALSE, GL_TRUE, GL_FALSE);
  glClearColor(0.1f, 0.2f, 0.3f, 0.4f);
  glBlendColor(0.5f, 0.6f, 0.7f, 0.8f);
  glDepthRange(0.25, 0.75);
  for (GLuint i = 1; i < kIndices; ++i) {
    i % 2 ? glDisablei(GL_BLEND, i) : glEnablei(GL_BLEND, i);
    i % 2 ? glDisablei(GL_SCISSOR_TEST, i) : glEnablei(GL_SCISSOR_TEST, i);
    glColorMaski(i, i & 1, i >> 1 & 1, i >> 2 & 1, GL_TRUE);
    glViewportIndexedf(i, 0.5f, float(i), 20.25f + float(i), 30);
    glScissorIndexed(i, GLint(i), 1, 10, 20);
    glDepthRangeIndexed(i, 0.1 * i, 0.9);
  }
  glClearDepth(0.5);
  glDepthFunc(GL_GEQUAL);
  glDepthMask(GL_FALSE);
  glBlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_DST_ALPHA);
  glBlendEquationSeparate(GL_FUNC_SUBTRACT, GL_MAX);
  glBlendFunci(2, GL_DST_COLOR, GL_ZERO);
  glBlendEquationi(3, GL_MIN);
  glStencilFuncSeparate(GL_FRONT, GL_NOTEQUAL, 3, 0x0f);
  glStencilFuncSeparate(GL_BACK, GL_LESS, 5, 0xf0);
  glStencilOp(GL_INCR, GL_DECR, GL_INVERT);
  glStencilMask(0x3c);
  glClearStencil(9);
  glCullFace(GL_FRONT);
  glFrontFace(GL_CW);
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  glPolygonOffset(1.5f, 2.5f);
}

void disturbPixelStore() {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 8);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 100);
  glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, 101);
  glPixelStorei(GL_UNPACK_SKIP_PIXELS, 3);
  glPixelStorei(GL_UNPACK_SKIP_ROWS, 4);
  glPixelStorei(GL_UNPACK_SKIP_IMAGES, 5);
  glPixelStorei(GL_UNPACK_SWAP_BYTES, 1);
  glPixelStorei(GL_PACK_ALIGNMENT, 2);
  glPixelStorei(GL_PACK_ROW_LENGTH, 200);
  glPixelStorei(GL_PACK_SKIP_ROWS, 6);
}

}  // namespace

GlState dumpGlState() {
  GlState state;
  for (const Named& item : kSwitches) state[item.name] = {double(glIsEnabled(item.value))};
  for (const Named& item : kValues) {
    std::vector<double>& values = state[item.name];
    values.resize(16);
    glGetDoublev(item.value, values.data());
    values.resize(size_t(item.count));
  }
  for (GLuint i = 0; i < kUniformBindings; ++i) {
    GLint buffer = 0;
    GLint64 offset = 0, size = 0;
    glGetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, i, &buffer);
    glGetInteger64i_v(GL_UNIFORM_BUFFER_START, i, &offset);
    glGetInteger64i_v(GL_UNIFORM_BUFFER_SIZE, i, &size);
    state["uniform buffer " + std::to_string(i)] = {double(buffer), double(offset), double(size)};
  }
  dumpUnits(state);
  dumpBuffersAndViewports(state);
  return state;
}

void disturbGlState() {
  disturbUnits();
  disturbBuffers();
  disturbFixedFunction();
  disturbPixelStore();
}

std::vector<std::string> differences(const GlState& a, const GlState& b) {
  std::vector<std::string> names;
  for (const auto& [name, values] : a)
    if (b.at(name) != values) names.push_back(name);
  return names;
}

}  // namespace loden::test
