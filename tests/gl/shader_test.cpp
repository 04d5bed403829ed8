// Assembly, the list of variants, the binary cache, and the layout shared by C++ and GLSL.
#include <epoxy/gl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>

#include "material/base/issues.h"
#include "material/model/vdim.h"
#include "runtime/shader/shader_assembly.h"
#include "runtime/shader/shader_library.h"
#include "runtime/stream/material_data.h"
#include "shaders/loden_shared.h"
#include "tests/gl/gl_fixture.h"
#include "tests/unit/material_fixtures.h"

namespace loden::test {
namespace {

using namespace runtime;
namespace fs = std::filesystem;

using ShaderLibraryTest = GlTest;
using SharedLayout = GlTest;

// A folder that is gone at the end.
struct ScratchFolder {
  fs::path path = fs::temp_directory_path() / ("loden_shader_test_" + std::to_string(::getpid()));
  ScratchFolder() { fs::remove_all(path); }
  ~ScratchFolder() { fs::remove_all(path); }
};

const ProgramRow& forwardRow() {
  return *findProgramRow("scene_forward");
}

TEST(ShaderAssembly, NamesFileAndLineOfAnError) {
  Result<AssembledShader> shader =
      assembleShader("entry", "int a;\n#include \"loden_shared.h\"\nint b;\n", {});
  ASSERT_TRUE(shader.ok());
  EXPECT_EQ(shader->files, (std::vector<std::string>{"entry", "loden_shared.h"}));
  EXPECT_NE(shader->text.find("#line 3 0\nint b;"), std::string::npos);
  EXPECT_EQ(namedShaderLog("1:12(5): error: x\n0(7) : error C1\nplain\n", shader->files),
            "loden_shared.h:12(5): error: x\nentry(7) : error C1\nplain");
}

TEST(ShaderAssembly, RefusesAnUnknownFile) {
  const Result<AssembledShader> shader = assembleShader("entry", "\n#include \"nothing.glsl\"\n", {});
  ASSERT_FALSE(shader.ok());
  EXPECT_EQ(shader.issue().id, issue_id::kShader);
  EXPECT_EQ(shader.issue().where, "entry:2");
}

TEST(ShaderVariants, AreAllDifferentAndAllowed) {
  for (const ProgramRow& row : kProgramRows) {
    std::vector<std::string> names;
    for (const MaterialVariant& variant : rowVariants(row)) {
      EXPECT_TRUE(rowAllows(row, variant));
      names.push_back(variantName(variant));
    }
    std::sort(names.begin(), names.end());
    EXPECT_TRUE(std::adjacent_find(names.begin(), names.end()) == names.end()) << row.name;
  }
}

// What is drawn far away has neither the near term nor anything of it.
TEST(ShaderVariants, LeaveTheNearTermOutAsAWhole) {
  Material material = test::nearMaterial();
  for (const Visibility visibility : {Visibility::kFast, Visibility::kMap}) {
    material.surface->visibility = visibility;
    const auto variant = materialVariant(material, Lookup::kDefault, Visibility::kDefault);
    ASSERT_TRUE(variant.ok());
    EXPECT_TRUE(variant->indirect);
    const MaterialVariant far = narrowed(*variant, material, {5, 9}),
                          near = narrowed(*variant, material, {-1, 0.4f});
    EXPECT_FALSE(far.near || far.indirect);
    EXPECT_TRUE(near.indirect);
    for (const MaterialVariant& left : {far, near})
      EXPECT_TRUE(rowAllows(forwardRow(), left)) << variantName(left);
    material.surface->indirect = {};
    EXPECT_FALSE(materialVariant(material, Lookup::kDefault, Visibility::kDefault)->indirect);
    material = test::nearMaterial();
  }
}

// Where both lookups are one by the shaders' own text, the program that knows so draws, and nowhere else.
TEST(ShaderVariants, TakeTheFastLookupOverWideFootprints) {
  Material material = test::nearMaterial();
  material.surface->fade_end = 9;
  const auto variant = materialVariant(material, Lookup::kDefault, Visibility::kDefault);
  ASSERT_TRUE(variant.ok());
  ASSERT_EQ(variant->lookup, Lookup::kDefault);
  for (const int geometry_side : {material.side, 128, 256}) {
    material.geometry.texels.width = geometry_side;
    bool found[2] = {};
    for (float lambda = -6; lambda < 6; lambda += 0.25f) {
      const bool one = effortsAreOne(geometry_side, std::exp2(double(lambda)) / material.side);
      found[one] = true;
      const MaterialVariant left = narrowed(*variant, material, {lambda, 9});
      EXPECT_EQ(left.lookup, one ? Lookup::kFast : Lookup::kDefault) << lambda;
      if (one) EXPECT_NE(left.visibility, Visibility::kDefault) << lambda;
      EXPECT_TRUE(rowAllows(forwardRow(), left));
    }
    EXPECT_TRUE(found[false] && found[true]);
  }
}

// Every variant of scene_forward; of the other rows, which differ from it in what surrounds the material, and
// with indirect light, which adds to the near term alone, those of at most one band.
TEST_F(ShaderLibraryTest, CompilesEveryVariant) {
  ShaderLibrary library(*device, {});
  int expected = 0;
  for (const ProgramRow& row : kProgramRows)
    for (const MaterialVariant& variant : rowVariants(row)) {
      const bool all = row.name == "scene_forward" && !variant.indirect;
      if (!all && variant.bands > 1) continue;
      const Result<uint32_t> program = library.program(row.name, variant);
      ASSERT_TRUE(program.ok()) << program.issue().where << ": " << program.issue().text;
      EXPECT_TRUE(glIsProgram(*program));
      ++expected;
    }
  EXPECT_EQ(library.stats().compiled, expected);
}

TEST_F(ShaderLibraryTest, CompilesWhatIsAskedForOnce) {
  ShaderLibrary library(*device, {});
  EXPECT_EQ(library.stats().compiled, 0);
  const MaterialVariant variant{true, 0, Lookup::kDefault};
  const uint32_t first = *library.program("scene_forward", variant);
  EXPECT_EQ(*library.program("scene_forward", variant), first);
  EXPECT_EQ(library.stats().compiled, 1);
}

TEST_F(ShaderLibraryTest, RefusesWhatNoRowAllows) {
  ShaderLibrary library(*device, {});
  const MaterialVariant too_many{false, LODEN_MAX_BANDS + 1, Lookup::kNone};
  for (const Result<uint32_t>& program :
       {library.program("no_such_row", {}), library.program("scene_forward", too_many)}) {
    ASSERT_FALSE(program.ok());
    EXPECT_EQ(program.issue().id, issue_id::kShader);
  }
}

TEST_F(ShaderLibraryTest, ReportsCompileErrorsWithFileAndLine) {
  tolerated = 1;  // Mesa also reports it as a debug message
  const ShaderText vertex{"good.vert", "void main() { gl_Position = vec4(0); }"};
  const ShaderText fragment{"bad.frag",
                            "#include \"loden_shared.h\"\nout vec4 c;\nvoid main() { c = nonsense; }"};
  const Result<GlProgram> program = compileProgram(vertex, fragment, {}, "bad");
  ASSERT_FALSE(program.ok());
  EXPECT_NE(program.issue().text.find("bad.frag:3"), std::string::npos) << program.issue().text;
}

TEST_F(ShaderLibraryTest, TakesProgramsFromItsCacheAndIgnoresDamage) {
  const ScratchFolder folder;
  const MaterialVariant variant = rowVariants(forwardRow()).front();
  ShaderLibrary first(*device, {folder.path});
  ASSERT_TRUE(first.program("scene_forward", variant).ok());
  ASSERT_EQ(first.stats().compiled, 1);
  if (fs::is_empty(folder.path)) GTEST_SKIP() << "this driver returns no program binaries";

  ShaderLibrary second(*device, {folder.path});
  ASSERT_TRUE(second.program("scene_forward", variant).ok());
  EXPECT_EQ(second.stats().from_cache, 1);

  const fs::path file = fs::directory_iterator(folder.path)->path();
  const uintmax_t size = fs::file_size(file);
  for (const uintmax_t at : {uintmax_t(0), uintmax_t(9), size / 2, size - 1}) {
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary)
        .seekp(std::streamoff(at))
        .put('\x5a')
        .put('\x3c');
    ShaderLibrary damaged(*device, {folder.path});
    ASSERT_TRUE(damaged.program("scene_forward", variant).ok());
    EXPECT_EQ(damaged.stats().compiled, 1) << "byte " << at;
  }
  fs::resize_file(file, size / 3);
  ShaderLibrary cut(*device, {folder.path});
  ASSERT_TRUE(cut.program("scene_forward", variant).ok());
  EXPECT_EQ(cut.stats().compiled, 1);
}

struct Member {
  const char* name;
  size_t offset;
};

TEST_F(SharedLayout, IsWhatTheDriverSays) {
  ShaderLibrary library(*device, {});
  const MaterialVariant variant{true, 2, Lookup::kDefault};
  const Result<uint32_t> program = library.program("scene_forward", variant);
  ASSERT_TRUE(program.ok()) << program.issue().text;
  const size_t band1 = offsetof(LodenMaterialData, bands) + sizeof(LodenBandData);
#define LODEN_MEMBER(name) \
  { #name, offsetof(LodenMaterialData, name) }
#define LODEN_BAND_MEMBER(name, suffix) \
  { "bands[1]." #name suffix, band1 + offsetof(LodenBandData, name) }
  const Member members[] = {
      LODEN_MEMBER(bits),
      LODEN_MEMBER(geometry_resident),
      LODEN_MEMBER(atlas_texels),
      LODEN_MEMBER(atlas_directions),
      LODEN_MEMBER(mean),
      LODEN_MEMBER(mean_chroma),
      LODEN_MEMBER(environment_unit),
      LODEN_MEMBER(theta_max),
      LODEN_MEMBER(geometry_range),
      LODEN_MEMBER(geometry_side),
      LODEN_MEMBER(paper_range),
      LODEN_MEMBER(paper_size),
      LODEN_MEMBER(value_scale),
      LODEN_MEMBER(side),
      LODEN_MEMBER(lambda_max),
      LODEN_MEMBER(resident_lambda),
      LODEN_MEMBER(specular_scale),
      LODEN_MEMBER(surface_lambda),
      LODEN_MEMBER(ambient_lambda),
      LODEN_MEMBER(near_end),
      LODEN_MEMBER(near_slope),
      LODEN_MEMBER(shadow_side),
      {"environment_mean[0]", offsetof(LodenMaterialData, environment_mean)},
      {"bands[0].window", offsetof(LodenMaterialData, bands)},
      LODEN_BAND_MEMBER(window, ""),
      LODEN_BAND_MEMBER(lambda_first, ""),
      LODEN_BAND_MEMBER(last_mip, ""),
      LODEN_BAND_MEMBER(side, ""),
      LODEN_BAND_MEMBER(per_table_depth, ""),
      LODEN_BAND_MEMBER(grid, ""),
      LODEN_BAND_MEMBER(per_grid, ""),
      LODEN_BAND_MEMBER(bits, ""),
      LODEN_BAND_MEMBER(y_quads, ""),
      LODEN_BAND_MEMBER(chroma_quads, ""),
      LODEN_BAND_MEMBER(ratio_layer, ""),
      LODEN_BAND_MEMBER(quad_scale, "[0]"),
      LODEN_BAND_MEMBER(quad_begin, "[0]"),
      LODEN_BAND_MEMBER(quad_end, "[0]"),
      LODEN_BAND_MEMBER(ratio_scale, ""),
      LODEN_BAND_MEMBER(rest_share, ""),
      LODEN_BAND_MEMBER(first_rest, ""),
  };
#undef LODEN_MEMBER
#undef LODEN_BAND_MEMBER
  int asked = 0;
  for (const Member& member : members) {
    const std::string name = std::string("LodenMaterialBlock.loden_material.") + member.name;
    const std::string bare = std::string("loden_material.") + member.name;
    GLuint index = glGetProgramResourceIndex(*program, GL_UNIFORM, bare.c_str());
    if (index == GL_INVALID_INDEX) index = glGetProgramResourceIndex(*program, GL_UNIFORM, name.c_str());
    if (index == GL_INVALID_INDEX) continue;  // not used by this variant
    const GLenum property = GL_OFFSET;
    GLint offset = -1;
    glGetProgramResourceiv(*program, GL_UNIFORM, index, 1, &property, 1, nullptr, &offset);
    EXPECT_EQ(size_t(offset), member.offset) << member.name;
    ++asked;
  }
  EXPECT_GE(asked, 20);
  const GLuint block = glGetProgramResourceIndex(*program, GL_UNIFORM_BLOCK, "LodenMaterialBlock");
  const GLenum size_property = GL_BUFFER_DATA_SIZE;
  GLint bytes = 0;
  glGetProgramResourceiv(*program, GL_UNIFORM_BLOCK, block, 1, &size_property, 1, nullptr, &bytes);
  EXPECT_EQ(size_t(bytes), sizeof(LodenMaterialData));
}

}  // namespace
}  // namespace loden::test
