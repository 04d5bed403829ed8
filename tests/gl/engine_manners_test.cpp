// What the material system owes the engine that it lives in: state, units, names, labels, lost contexts.
#include <epoxy/gl.h>

#include <chrono>
#include <thread>

#include "material/base/issues.h"
#include "shaders/loden_shared.h"
#include "tests/gl/gl_fixture.h"
#include "tests/gl/gl_state_dump.h"
#include "tests/unit/material_fixtures.h"
#include "tests/unit/textured_square.h"

namespace loden::test {
namespace {

using namespace runtime;

using EngineManners = GlTest;

TEST_F(EngineManners, UnitsBelowTheFirstStayTheEngines) {
  for (const Material& material : {fusedMaterial(), lodMaterial(), surfaceMaterial()}) {
    std::vector<glm::vec4> pictures[2];
    for (const int first : {0, 7}) {
      const auto system = makeMaterials({.first_unit = first});
      const MaterialId id = load(*system, material);
      system->demand(id, 0);
      system->finishLoading();
      const GlTexture own = makeTexture(GL_TEXTURE_2D, "the engine's");
      for (int unit = 0; unit < first; ++unit) glBindTextureUnit(GLuint(unit), own.name());
      pictures[first > 0] = drawMaterial(*system, id, 0, {16, 16});
      for (int unit = 0; unit < first; ++unit) {
        glActiveTexture(GLenum(GL_TEXTURE0 + unit));
        GLint bound = 0;
        glGetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
        EXPECT_EQ(GLuint(bound), own.name()) << "unit " << unit;
      }
      EXPECT_LE(unitsOf(system->variant(id)), LODEN_MAX_UNITS);
    }
    EXPECT_EQ(pictures[0], pictures[1]) << material.name;
  }
}

TEST_F(EngineManners, MoreUnitsThanTheDriverHas_IsAnIssue) {
  const auto system = makeMaterials({.first_unit = device->capabilities().max_fragment_textures - 1});
  const auto id = system->load(assetSource(fusedMaterial()), "fused");
  ASSERT_FALSE(id.ok());
  EXPECT_EQ(id.issue().id, issue_id::kLimit);
}

TEST_F(EngineManners, EveryPublicCallLeavesGlStateAsFound) {
  disturbGlState();
  const GlState before = dumpGlState();
  ASSERT_GE(before.size(), 60u);
  const auto expectUnchanged = [&](const char* call) {
    for (const std::string& name : differences(before, dumpGlState()))
      ADD_FAILURE() << call << " changed " << name;
  };
  auto system = makeMaterials();
  expectUnchanged("create");
  std::vector<MaterialId> ids;
  for (const Material& material : {surfaceMaterial(), lodMaterial(), fusedMaterial()})
    ids.push_back(load(*system, material));
  expectUnchanged("load");
  const TextureId texture = *system->loadTexture(imageTexture(noiseImage({256, 128}, 1)));
  expectUnchanged("loadTexture");
  for (MaterialId id : ids) system->demand(id, 0);
  system->demand(texture, 0);
  system->update(0.1f);
  expectUnchanged("update");
  system->finishLoading();
  expectUnchanged("finishLoading");
  const RenderTarget target = *makeRenderTarget({4, 4}, ColorFormat::kSrgb8, "target");
  readLinear(target);
  readCodes(target);
  expectUnchanged("render target");
  system->unload(ids[0]);
  system->unload(texture);
  expectUnchanged("unload");
  system.reset();
  expectUnchanged("destruction");
}

// Counts live names of one kind by asking for each of the first few thousand.
template <class IsName>
int countNames(IsName isName) {
  int count = 0;
  for (GLuint name = 1; name < 4096; ++name) count += isName(name) ? 1 : 0;
  return count;
}
int liveNames() {
  return countNames(glIsTexture) + countNames(glIsBuffer) + countNames(glIsProgram);
}

TEST_F(EngineManners, LeavesNoNamesBehind) {
  const int before = liveNames();
  {
    auto system = makeMaterials();
    for (const Material& material : {surfaceMaterial(), lodMaterial(), fusedMaterial()}) {
      const MaterialId id = load(*system, material);
      system->demand(id, 0);
      system->finishLoading();
      drawMaterial(*system, id, 0);
    }
    system->demand(*system->loadTexture(imageTexture(noiseImage({256, 128}, 1))), 0);
    system->finishLoading();
    EXPECT_GT(liveNames(), before);
  }
  EXPECT_EQ(liveNames(), before);
}

TEST_F(EngineManners, LabelsEveryObject) {
  auto system = makeMaterials();
  for (const Material& material : {surfaceMaterial(), lodMaterial(), fusedMaterial()}) {
    system->demand(load(*system, material), 0);
    system->finishLoading();
  }
  system->demand(*system->loadTexture(imageTexture(noiseImage({256, 128}, 1))), 0);
  system->finishLoading();
  int textures = 0;
  for (GLuint name = 1; name < 4096; ++name) {
    for (const GLenum kind : {GL_TEXTURE, GL_BUFFER}) {
      if (!(kind == GL_TEXTURE ? glIsTexture(name) : glIsBuffer(name))) continue;
      GLsizei length = 0;
      glGetObjectLabel(kind, name, 0, &length, nullptr);
      EXPECT_GT(length, 0) << name;
      ++textures;
    }
  }
  EXPECT_GT(textures, 10);
}

TEST_F(EngineManners, SurvivesTwentyLostContexts) {
  auto system = makeMaterials();
  std::vector<MaterialId> ids;
  for (const Material& material : {surfaceMaterial(), lodMaterial(), fusedMaterial()})
    ids.push_back(load(*system, material));
  std::vector<std::vector<glm::vec4>> reference;
  int names = 0;
  for (int loss = 0; loss <= 20; ++loss) {
    for (MaterialId id : ids) system->demand(id, 0);
    if (loss % 3 == 1)
      system->update(0.01f);  // lose it while parts are on their way
    else
      system->finishLoading();
    if (loss % 3 != 1) {
      std::vector<std::vector<glm::vec4>> pictures;
      for (MaterialId id : ids) pictures.push_back(drawMaterial(*system, id, 0));
      if (reference.empty()) {
        reference = pictures;
        names = liveNames();
      }
      EXPECT_TRUE(pictures == reference) << "after " << loss << " losses";
      EXPECT_EQ(liveNames(), names) << "after " << loss << " losses";
    }
    system->contextLost();
    ASSERT_TRUE(device->recreate().ok());
    ASSERT_TRUE(system->contextRestored().ok());
  }
}

// A loss behind each of the first frames, with a few rows of texels a frame, so that parts are asked for,
// read, half uploaded and resident; and calls from there until there is a new context, while none is current.
TEST_F(EngineManners, SurvivesALossAtEveryFrameOfLoading) {
  MaterialSystemOptions slow;
  slow.upload_bytes_per_frame = 512;
  auto system = makeMaterials(slow);
  std::vector<MaterialId> ids;
  for (const Material& material : {surfaceMaterial(), lodMaterial(), nearMaterial()})
    ids.push_back(load(*system, material));
  const auto demandAll = [&] {
    for (MaterialId id : ids) system->demand(id, 0);
  };
  std::vector<std::vector<glm::vec4>> reference;
  int in_flight = 0;
  for (int frames = 0; frames < 24; ++frames) {
    for (int frame = 0; frame < frames; ++frame) {
      demandAll();
      system->update(0.02f);
      if (frame % 3 == 2) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    in_flight += system->stats().parts_in_flight > 0;
    const MaterialId passing = load(*system, fusedMaterial());
    system->contextLost();
    device->releaseCurrent();
    demandAll();
    system->update(0.02f);
    system->finishLoading();
    const auto refused = system->load(assetSource(fusedMaterial()), "in between");
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.issue().id, issue_id::kGlContext);
    system->unload(passing);
    ASSERT_TRUE(device->recreate().ok());
    ASSERT_TRUE(system->contextRestored().ok());
    if (frames % 6 != 5) continue;
    demandAll();
    system->finishLoading();
    std::vector<std::vector<glm::vec4>> pictures;
    for (MaterialId id : ids) pictures.push_back(drawMaterial(*system, id, 0));
    if (reference.empty()) reference = pictures;
    EXPECT_TRUE(pictures == reference) << "after a loss behind frame " << frames;
  }
  EXPECT_GT(in_flight, 5);
  EXPECT_EQ(system->stats().failed_parts, 0u);
}

TEST_F(EngineManners, WorkOnTwoDevicesAtOnce) {
  auto first = makeMaterials();
  std::unique_ptr<Device> other = makeDevice();
  Result<std::unique_ptr<MaterialSystem>> second = MaterialSystem::create(*other, {});
  ASSERT_TRUE(second.ok());
  const MaterialId b = load(**second, fusedMaterial());
  (*second)->demand(b, 0);
  (*second)->finishLoading();
  const std::vector<glm::vec4> on_other = drawMaterial(**second, b, 0);
  device->makeCurrent();
  const MaterialId a = load(*first, fusedMaterial());
  first->demand(a, 0);
  first->finishLoading();
  EXPECT_TRUE(drawMaterial(*first, a, 0) == on_other);
  first.reset();
  other->makeCurrent();
  second->reset();
}

}  // namespace
}  // namespace loden::test
