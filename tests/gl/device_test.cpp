// Contexts, owners of GL names, and GL state.
#include <epoxy/gl.h>

#include <type_traits>

#include "material/base/issues.h"
#include "runtime/gl/gl_state.h"
#include "tests/gl/gl_fixture.h"

namespace loden::test {
namespace {

using namespace runtime;

using DeviceTest = GlTest;
using GlObjects = GlTest;

TEST_F(DeviceTest, HasWhatTheRuntimeNeeds) {
  const Capabilities& c = device->capabilities();
  EXPECT_TRUE(c.missing.empty());
  EXPECT_FALSE(c.renderer.empty());
  EXPECT_GE(c.max_texture_side, 16384);
  EXPECT_EQ(device->nativeWindow(), nullptr);
}

TEST_F(DeviceTest, SendsDriverMessagesToTheLog) {
  tolerated = 1;
  glBindTexture(GL_TEXTURE_2D, 0x7ffffff);  // no such name
  glDebugMessageInsert(GL_DEBUG_SOURCE_APPLICATION, GL_DEBUG_TYPE_ERROR, 7, GL_DEBUG_SEVERITY_HIGH, -1,
                       "hello");
  ASSERT_FALSE(messages.empty());
  EXPECT_EQ(messages.back().text, "hello");
  EXPECT_EQ(messages.back().severity, Severity::kError);
  tolerated = int(messages.size());
}

TEST_F(DeviceTest, LivesBesideAnother) {
  std::unique_ptr<Device> other = makeDevice();
  ASSERT_TRUE(other);
  const GlTexture of_other = makeTexture(GL_TEXTURE_2D, "other");
  device->makeCurrent();
  EXPECT_FALSE(glIsTexture(of_other.name()));
  const GlTexture own = makeTexture(GL_TEXTURE_2D, "own");
  EXPECT_TRUE(glIsTexture(own.name()));
  other->makeCurrent();
  EXPECT_TRUE(glIsTexture(of_other.name()));
}

TEST_F(DeviceTest, OutlivesAnotherOfItsProcess) {
  makeDevice().reset();
  device->makeCurrent();
  EXPECT_TRUE(glIsTexture(makeTexture(GL_TEXTURE_2D, "still here").name()));
}

TEST_F(DeviceTest, StartsEmptyAfterRecreation) {
  GlTexture texture = makeTexture(GL_TEXTURE_2D, "gone");
  const GLuint name = texture.release();
  ASSERT_TRUE(device->recreate().ok());
  EXPECT_FALSE(glIsTexture(name));
  EXPECT_TRUE(device->capabilities().missing.empty());
}

TEST_F(GlObjects, MoveAndDelete) {
  static_assert(!std::is_copy_constructible_v<GlTexture>);
  static_assert(std::is_nothrow_move_constructible_v<GlTexture>);
  GlTexture a = makeTexture(GL_TEXTURE_2D, "a");
  const GLuint name = a.name();
  GlTexture b = std::move(a);
  EXPECT_EQ(a.name(), 0u);
  EXPECT_TRUE(glIsTexture(name));
  b = makeTexture(GL_TEXTURE_3D, "b");
  EXPECT_FALSE(glIsTexture(name)) << "assignment deletes what was held";
}

TEST_F(GlObjects, CarryTheirLabel) {
  const GlBuffer buffer = makeBuffer(16, {}, 0, "sixteen bytes");
  char label[64] = {};
  glGetObjectLabel(GL_BUFFER, buffer.name(), sizeof label, nullptr, label);
  EXPECT_STREQ(label, "sixteen bytes");
}

TEST_F(GlObjects, TargetsOfImpossibleSizesAreRefusedQuietly) {
  const int side = device->capabilities().max_texture_side;
  for (const glm::ivec2 size :
       {glm::ivec2(0, 4), glm::ivec2(4, -1), glm::ivec2(side + 1, 1), glm::ivec2(1, 2147483647)}) {
    const auto target = makeRenderTarget(size, ColorFormat::kSrgb8, "target");
    ASSERT_FALSE(target.ok()) << size.x << " x " << size.y;
    EXPECT_EQ(target.issue().id, issue_id::kMemory);
  }
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
  EXPECT_TRUE(makeRenderTarget({side, 1}, ColorFormat::kSrgb8, "target").ok());
}

TEST_F(GlObjects, TargetsTooLargeForMemoryAreRefused) {
  const int side = device->capabilities().max_texture_side;
  tolerated = 100;  // as many as the driver likes to say about it
  const auto target = makeRenderTarget({side, side}, ColorFormat::kLinear32, "target");
  EXPECT_EQ(target ? issue_id::kMemory : target.issue().id, issue_id::kMemory);
}

TEST_F(GlObjects, TargetsReadBackWhatWasCleared) {
  for (const ColorFormat format : {ColorFormat::kSrgb8, ColorFormat::kLinear16, ColorFormat::kLinear32}) {
    const RenderTarget target = *makeRenderTarget({3, 2}, format, "target");
    const float color[4] = {0.5f, 0.25f, 1, 1};
    glEnable(GL_FRAMEBUFFER_SRGB);
    glClearNamedFramebufferfv(target.framebuffer.name(), GL_COLOR, 0, color);
    const std::vector<glm::vec4> pixels = readLinear(target);
    ASSERT_EQ(pixels.size(), 6u);
    // 8-bit sRGB near .5 has steps of .0074 in linear light.
    for (int c = 0; c < 4; ++c)
      EXPECT_NEAR(pixels[5][c], color[c], format == ColorFormat::kSrgb8 ? 4e-3f : 1e-6f);
    if (format == ColorFormat::kSrgb8) {
      EXPECT_EQ(readCodes(target)[0], glm::u8vec4(188, 137, 255, 255));
    }
  }
}

}  // namespace
}  // namespace loden::test
