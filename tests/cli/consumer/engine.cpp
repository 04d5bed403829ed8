// An engine with an OpenGL 4.5 context of its own draws one picture of a material: engine FILE.loden
// Prints the picture's mean colour.
#include <epoxy/gl.h>

#include <cstdio>
#include <span>
#include <vector>

#include "runtime/gl/device.h"
#include "runtime/gl/gl_target.h"
#include "runtime/gl/material/material_system.h"
#include "runtime/shader/shader_library.h"

using namespace loden::runtime;

// One triangle over the picture, 4 x 4 tiles, seen and lit from fixed directions.
const ShaderText kVertex{"engine.vert", R"(
layout(location = 0) out vec2 x;
void main() {
  x = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 8.0;
  gl_Position = vec4(x * 0.5 - 1.0, 0.0, 1.0);
})"};
const ShaderText kFragment{"engine.frag", R"(
#include "loden_material.glsl"
layout(location = 0) in vec2 x;
layout(location = 0) out vec4 color;
void main() {
  vec3 wi = normalize(vec3(0.0, 0.5, 1.0)), wo = normalize(vec3(0.4, 0.0, 1.0));
  LodenPoint m = loden_point_default();
  LodenHit h = loden_find_hit(m, x, dFdx(x), dFdy(x), wo);
  color = vec4(loden_material.value_scale * loden_evaluate(h, wi, wo), 1.0);
})"};

int fail(const loden::Issue& issue) {
  std::fprintf(stderr, "%s: %s\n", issue.where.c_str(), issue.text.c_str());
  return 1;
}

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  const auto window = Device::create({});  // stands for the engine's own way to a context
  if (!window) return fail(window.issue());

  const auto device = Device::create({.kind = DeviceKind::kCurrent});
  if (!device) return fail(device.issue());
  const auto materials = MaterialSystem::create(**device, {.budget_bytes = 64 << 20});
  if (!materials) return fail(materials.issue());
  const auto knit = (*materials)->load(argv[1]);
  if (!knit) return fail(knit.issue());
  const auto program =
      compileProgram(kVertex, kFragment, variantDefines((*materials)->variant(*knit)), "engine");
  if (!program) return fail(program.issue());
  const auto target = makeRenderTarget({64, 64}, ColorFormat::kLinear32, "picture");
  if (!target) return fail(target.issue());

  GLuint no_vertices = 0;
  glCreateVertexArrays(1, &no_vertices);
  for (int frame = 0; frame < 120; ++frame) {  // detail arrives meanwhile
    (*materials)->demand(*knit, 0);
    (*materials)->update(1.0f / 60);
    glBindFramebuffer(GL_FRAMEBUFFER, target->framebuffer.name());
    glViewport(0, 0, target->size.x, target->size.y);
    glUseProgram(program->name());
    glBindVertexArray(no_vertices);
    (*materials)->bind(*knit);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
  glDeleteVertexArrays(1, &no_vertices);

  glm::vec3 mean(0);
  for (const glm::vec4& pixel : readLinear(*target)) mean += glm::vec3(pixel) / 4096.0f;
  std::printf("%g %g %g\n", mean.r, mean.g, mean.b);
}
