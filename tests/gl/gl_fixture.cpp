#include "tests/gl/gl_fixture.h"

#include <epoxy/gl.h>

#include "runtime/scene/image_mips.h"
#include "runtime/shader/shader_library.h"

namespace loden::test {
namespace {

using namespace runtime;

const ShaderText kFullScreen{"full_screen.vert", R"(
layout(location = 0) out vec2 x;
void main() {
  x = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
  gl_Position = vec4(x * 2.0 - 1.0, 0.0, 1.0);
})"};

// What a renderer that knows nothing of Loden's own scenes has to write.
const ShaderText kPicture{"picture.frag", R"(
#include "loden_shared.h"
#include "loden_interface.glsl"
#include "loden_directions.glsl"
#include "loden_vdim.glsl"
#include "loden_bands.glsl"
#include "loden_material.glsl"
layout(location = 0) in vec2 x;
layout(location = 0) out vec4 color;
layout(location = 0) uniform float lambda;
void main() {
  vec3 wi = normalize(vec3(0.3, 0.2, 1.0)), wo = normalize(vec3(-0.4, 0.1, 1.0));
  LodenPoint m = loden_point_default();
  LodenHit h = loden_find_hit_at(m, x, lambda, wo);
  color = vec4(loden_evaluate(h, wi, wo), h.lambda);
})"};

}  // namespace

void GlTest::SetUp() {
  device = makeDevice();
  ASSERT_TRUE(device);
}

void GlTest::TearDown() {
  int serious = 0;
  for (const Issue& message : messages) {
    if (message.severity == Severity::kNote) continue;
    ++serious;
    if (serious > tolerated) ADD_FAILURE() << message.where << ": " << message.text;
  }
}

std::unique_ptr<Device> GlTest::makeDevice() {
  DeviceOptions options;
  options.debug = true;
  options.log = [this](const Issue& issue) { messages.push_back(issue); };
  Result<std::unique_ptr<Device>> made = Device::create(options);
  if (!made) {
    ADD_FAILURE() << made.issue().text;
    return nullptr;
  }
  return std::move(*made);
}

std::unique_ptr<MaterialSystem> GlTest::makeMaterials(const MaterialSystemOptions& options) {
  Result<std::unique_ptr<MaterialSystem>> made = MaterialSystem::create(*device, options);
  EXPECT_TRUE(made.ok());
  return std::move(*made);
}

std::shared_ptr<const ByteSource> assetSource(const Material& material) {
  Result<std::vector<std::byte>> bytes = serializeAsset(material);
  if (!bytes) {
    ADD_FAILURE() << bytes.issue().text;
    return nullptr;
  }
  return memorySource(std::move(*bytes), material.name);
}

MaterialId GlTest::load(MaterialSystem& system, const Material& material) {
  Result<MaterialId> id = system.load(assetSource(material), material.name);
  if (id.ok()) return *id;
  ADD_FAILURE() << id.issue().where << ": " << id.issue().text;
  return {};
}

ImageTexture imageTexture(const SceneImage& image, bool mipmapped) {
  ImageTexture texture;
  texture.name = image.name;
  texture.mips = std::make_shared<const Texture>(imageMips(image, true));
  texture.srgb = true;
  texture.wrap_s = texture.wrap_t = GL_REPEAT;
  texture.min_filter = mipmapped ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR;
  texture.mag_filter = GL_LINEAR;
  return texture;
}

std::vector<glm::vec4> drawMaterial(MaterialSystem& system, MaterialId id, float lambda, glm::ivec2 size) {
  const std::vector<std::string> defines = variantDefines(system.variant(id));
  Result<GlProgram> program = compileProgram(kFullScreen, kPicture, defines, "picture");
  if (!program) {
    ADD_FAILURE() << program.issue().where << ": " << program.issue().text;
    return {};
  }
  const RenderTarget target = *makeRenderTarget(size, ColorFormat::kLinear32, "picture");
  const GlVertexArray array = makeVertexArray("picture");
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
  glViewport(0, 0, size.x, size.y);
  glUseProgram(program->name());
  glUniform1f(0, lambda);
  glBindVertexArray(array.name());
  system.bind(id);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  std::vector<glm::vec4> pixels = readLinear(target);
  glUseProgram(0);
  return pixels;
}

}  // namespace loden::test
