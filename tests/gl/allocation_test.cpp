// Every allocation of loading a material, of the frames that stream it in and of binding it fails in turn: an
// issue, a coarser picture or success, no exception where the header names none, no GL object left over, and
// other materials as they were. A program of its own, because it replaces operator new.
#include <epoxy/gl.h>
#include <link.h>

#include <cmath>
#include <cstdio>
#include <cstring>

#include "material/base/issues.h"
#include "runtime/shader/shader_library.h"
#include "tests/failing_allocation.h"
#include "tests/gl/gl_fixture.h"
#include "tests/unit/material_fixtures.h"
#include "tests/unit/textured_square.h"

extern "C" char __executable_start, etext;  // of this program's code

namespace {

struct CodeRange {
  uintptr_t begin = 0, end = 0;
  bool holds(const void* address) const {
    const auto at = reinterpret_cast<uintptr_t>(address);
    return at >= begin && at < end;
  }
};

// Of the C++ library, which allocates for strings. The driver's own code is left alone: LLVM knows no
// exceptions.
CodeRange standardLibrary() {
  CodeRange range;
  dl_iterate_phdr(
      [](dl_phdr_info* info, size_t, void* data) {
        if (!std::strstr(info->dlpi_name, "libstdc++")) return 0;
        for (int i = 0; i < info->dlpi_phnum; ++i) {
          const auto& segment = info->dlpi_phdr[i];
          if (segment.p_type == PT_LOAD && (segment.p_flags & PF_X) != 0)
            *static_cast<CodeRange*>(data) = {info->dlpi_addr + segment.p_vaddr,
                                              info->dlpi_addr + segment.p_vaddr + segment.p_memsz};
        }
        return 1;
      },
      &range);
  return range;
}

const CodeRange standard_library = standardLibrary();
const CodeRange program{reinterpret_cast<uintptr_t>(&__executable_start),
                        reinterpret_cast<uintptr_t>(&etext)};

thread_local bool counting = false;

}  // namespace

bool loden::test::allocationCounts(const void* caller) {
  return counting && (program.holds(caller) || standard_library.holds(caller));
}

namespace loden::test {
namespace {

using namespace runtime;

const ShaderText kVertex{"vertex", R"(
layout(location = 0) out vec2 x;
void main() {
  x = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
  gl_Position = vec4(x * 2.0 - 1.0, 0.0, 1.0);
})"};
const ShaderText kFragment{"fragment", R"(
#include "loden_material.glsl"
layout(location = 0) in vec2 x;
layout(location = 0) out vec4 color;
void main() {
  vec3 wi = normalize(vec3(0.3, 0.2, 1.0)), wo = normalize(vec3(-0.4, 0.1, 1.0));
  LodenPoint m = loden_point_default();
  LodenHit h = loden_find_hit_at(m, x, 0.0, wo);
  color = vec4(loden_evaluate(h, wi, wo), h.lambda);
})"};

// Draws materials of one variant.
class Screen {
 public:
  explicit Screen(const MaterialVariant& variant)
      : program_(*compileProgram(kVertex, kFragment, variantDefines(variant), "allocation")),
        target_(*makeRenderTarget({16, 16}, ColorFormat::kLinear32, "allocation")),
        array_(makeVertexArray("allocation")) {}
  std::vector<glm::vec4> draw(MaterialSystem& system, MaterialId id) const {
    glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer.name());
    glViewport(0, 0, 16, 16);
    glUseProgram(program_.name());
    glBindVertexArray(array_.name());
    system.bind(id);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return readLinear(target_);
  }

 private:
  GlProgram program_;
  RenderTarget target_;
  GlVertexArray array_;
};

int liveTextures() {
  int count = 0;
  for (GLuint name = 1; name < 2048; ++name) count += glIsTexture(name) + glIsBuffer(name);
  return count;
}

struct Outcome {
  long made = 0;
  int load_issue = 0;  // 0: loaded
  uint64_t failed = 0;
  int thrown = 0;  // of demand(), which may
};

class MaterialAllocation : public GlTest, public testing::WithParamInterface<Material (*)()> {};

TEST_P(MaterialAllocation, EveryFailureLeavesOthersAsTheyWere) {
  tolerated = 1000000;  // parts that failed are logged
  const auto other_bytes = assetSource(lodMaterial());
  const auto bytes = assetSource(GetParam()());
  const std::string name = "a material whose name is too long for a string without an allocation";
  std::unique_ptr<Screen> other_screen, screen;
  std::vector<glm::vec4> other_picture, picture;

  const auto run = [&](long n) {
    Outcome outcome;
    auto system = makeMaterials();
    const MaterialId other = *system->load(other_bytes, "other");
    system->demand(other, 0);
    system->finishLoading();
    if (!other_screen) other_screen = std::make_unique<Screen>(system->variant(other));
    const auto before = other_screen->draw(*system, other);
    if (other_picture.empty()) other_picture = before;
    EXPECT_EQ(before, other_picture);
    const int textures = liveTextures();

    allocations.begin(n), counting = true;
    const Result<MaterialId> id = system->load(bytes, name);
    const auto frame = [&] {
      try {
        system->demand(other, 0);
        if (id) system->demand(*id, 0);
      } catch (const std::bad_alloc&) {
        ++outcome.thrown;
      }
      EXPECT_NO_THROW(system->update(0.1f));
      EXPECT_NO_THROW(system->bind(other));
      if (id) {
        EXPECT_NO_THROW(system->bind(*id));
      }
    };
    for (int still = 0; still<3; still = system->stats().parts_in_flight> 0 ? 0 : still + 1) frame();
    counting = false;

    outcome.made = allocations.made;
    outcome.load_issue = id ? 0 : id.issue().id;
    outcome.failed = system->stats().failed_memory;
    EXPECT_EQ(system->stats().failed_parts, outcome.failed);
    EXPECT_EQ(other_screen->draw(*system, other), other_picture) << "allocation " << n;
    if (!id) {
      EXPECT_EQ(liveTextures(), textures) << "allocation " << n;
      const Result<MaterialId> again = system->load(bytes, name);
      EXPECT_TRUE(again.ok()) << "allocation " << n;
      if (again) system->unload(*again);
    } else {
      system->finishLoading();
      if (!screen) screen = std::make_unique<Screen>(system->variant(*id));
      const auto drawn = screen->draw(*system, *id);
      if (picture.empty()) picture = drawn;
      if (outcome.failed == 0) {
        EXPECT_EQ(drawn, picture) << "allocation " << n;
      }
      for (const glm::vec4& pixel : drawn)
        EXPECT_TRUE(std::isfinite(pixel.x + pixel.y + pixel.z)) << "allocation " << n;
      system->unload(*id);
    }
    if (n >= -1) {
      EXPECT_EQ(liveTextures(), textures) << "allocation " << n;
    }
    system->update(0);
    EXPECT_LE(system->stats().resident_bytes, system->stats().total_bytes) << "allocation " << n;
    return outcome;
  };

  run(-2);  // makes the screens
  const Outcome whole = run(-1);
  ASSERT_EQ(whole.load_issue, 0);
  ASSERT_GT(whole.made, 30);
  int refused = 0, coarser = 0, thrown = 0, untouched = 0;
  for (long n = 0; n < whole.made && !HasFailure(); ++n) {
    const Outcome outcome = run(n);
    ASSERT_TRUE(outcome.load_issue == 0 || outcome.load_issue == issue_id::kMemory) << outcome.load_issue;
    (outcome.load_issue ? refused : outcome.failed ? coarser : outcome.thrown ? thrown : untouched)++;
  }
  std::printf("%ld allocations: %d refused, %d coarser, %d thrown by demand(), %d not noticed\n", whole.made,
              refused, coarser, thrown, untouched);
  EXPECT_GT(refused, 10);
  EXPECT_GT(coarser, 0);
  for (const Issue& message : messages)
    EXPECT_TRUE(message.severity == Severity::kNote || message.id == issue_id::kMemory) << message.text;
}

using TextureAllocation = GlTest;

TEST_F(TextureAllocation, EveryFailureLeavesOthersAsTheyWere) {
  tolerated = 1000000;  // parts that failed are logged
  const auto other_bytes = assetSource(lodMaterial());
  ImageTexture image = imageTexture(noiseImage({256, 256}, 1));
  image.name = "a texture whose name is too long for a string without an allocation";
  std::unique_ptr<Screen> screen;
  std::vector<glm::vec4> picture;

  const auto run = [&](long n) {
    Outcome outcome;
    auto system = makeMaterials();
    const MaterialId other = *system->load(other_bytes, "other");
    system->demand(other, 0);
    system->finishLoading();
    if (!screen) screen = std::make_unique<Screen>(system->variant(other));
    if (picture.empty()) picture = screen->draw(*system, other);
    const int textures = liveTextures();

    allocations.begin(n), counting = true;
    const Result<TextureId> id = system->loadTexture(image);
    for (int frame = 0; frame < 20; ++frame) {
      try {
        system->demand(other, 0);
        if (id) system->demand(*id, 0);
      } catch (const std::bad_alloc&) {
        ++outcome.thrown;
      }
      EXPECT_NO_THROW(system->update(0.1f));
    }
    counting = false;

    outcome.made = allocations.made;
    outcome.load_issue = id ? 0 : id.issue().id;
    outcome.failed = system->stats().failed_memory;
    EXPECT_EQ(screen->draw(*system, other), picture) << "allocation " << n;
    if (id) {
      system->demand(*id, 0);
      system->finishLoading();
      EXPECT_EQ(system->stats().failed_parts, outcome.failed);
      EXPECT_TRUE(outcome.failed > 0 || system->residentLambda(*id) == 0) << "allocation " << n;
      EXPECT_NE(system->textureName(*id), 0u);
      system->unload(*id);
    }
    EXPECT_EQ(liveTextures(), textures) << "allocation " << n;
    EXPECT_EQ(system->stats().texture_bytes, 0u) << "allocation " << n;
    return outcome;
  };

  run(-1);
  const Outcome whole = run(-1);
  ASSERT_EQ(whole.load_issue, 0);
  int refused = 0, coarser = 0;
  for (long n = 0; n < whole.made && !HasFailure(); ++n) {
    const Outcome outcome = run(n);
    ASSERT_TRUE(outcome.load_issue == 0 || outcome.load_issue == issue_id::kMemory) << outcome.load_issue;
    refused += outcome.load_issue != 0, coarser += outcome.failed > 0;
  }
  std::printf("%ld allocations: %d refused, %d coarser\n", whole.made, refused, coarser);
  EXPECT_GT(refused, 5);
  EXPECT_GT(coarser, 0);
}

INSTANTIATE_TEST_SUITE_P(Modes, MaterialAllocation,
                         testing::Values(surfaceMaterial, lodMaterial, nearMaterial));

}  // namespace
}  // namespace loden::test
