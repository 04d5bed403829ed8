// The key test: shaders against the CPU evaluator, all three modes, all builtin tiles, at seeded
// (x, lambda, wi, wo). Materials are baked and cooked here, small but through the whole road.

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>

#include "importer/bake/bake.h"
#include "importer/cook/cook.h"
#include "material/asset/asset.h"
#include "material/eval/evaluate.h"
#include "runtime/gl/device.h"
#include "runtime/gl/gl_objects.h"
#include "runtime/gl/gl_target.h"
#include "runtime/gl/material/material_system.h"
#include "runtime/shader/shader_library.h"
#include "shaders/loden_shared.h"

namespace loden::runtime {
namespace {

constexpr int kSide = 112;  // 12,544 samples
constexpr int kSamples = kSide * kSide;

// fp32 on both sides: what is left is the order of sums in filters, 2e-5 on llvmpipe.
constexpr double kMaxDifference = 1e-3, kMeanDifference = 1e-4;
// The indirection jumps at silhouettes. A sample that rounding puts on the other side of a jump is at fault
// only if the evaluator has no such value within this distance of x (tile periods), in fp32's reach.
constexpr float kRounding = 4e-6f;
constexpr int kMaxAtJumps = 4;  // of 12,544; measured 2
// The light's lookup jumps as well, wherever the edge of a shadow runs.
constexpr int kMaxAtShadows = 80;  // of 12,544; measured up to 49
// A search whose residual is at its threshold goes on for a fetch more or less.
constexpr int kMaxOtherFetches = 12;  // of 12,544; measured 0 to 6
// Rays that go by the surface show nothing of it: what is compared is that both sides say so.
constexpr float kMissed = -1;

constexpr const char* kVertex = R"(
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
)";
constexpr const char* kFragment = R"(
#include "loden_material.glsl"
layout(binding = LODEN_MAX_UNITS) uniform sampler2DArray samples;  // (x, lambda, 0), wi, wo
layout(location = 0) out vec4 color;
#ifdef ENVIRONMENT
layout(location = 0) uniform vec4 environment[9];
#endif
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 x = texelFetch(samples, ivec3(at, 0), 0);
  vec3 wi = texelFetch(samples, ivec3(at, 1), 0).xyz, wo = texelFetch(samples, ivec3(at, 2), 0).xyz;
  LodenPoint m = loden_point_default();
  m.skip_parallax = SKIP_PARALLAX;
#ifdef CURVATURE
  m.curvature = mat2(CURVATURE);
  m.x_from_tangent = mat2(X_FROM_TANGENT);
#endif
  LodenHit hit = loden_find_hit_at(m, x.xy, x.z, wo);
  float fetches = float(loden_fetches);  // of the lookup
#ifdef ENVIRONMENT
  LodenHemisphere light = loden_hemisphere_light(environment, loden_hit_frame(hit, mat3(1.0)));
  color = vec4(loden_evaluate_environment(hit, light, wo), fetches);
#else
  color = vec4(loden_evaluate(hit, wi, wo), fetches);
#endif
  if (hit.missed) color.xyz = vec3(MISSED);
}
)";

struct Sample {
  glm::vec2 x;
  float lambda;
  glm::vec3 wi, wo;
};

// How p is found.
struct Way {
  Lookup lookup = Lookup::kDefault;
  Parallax parallax = Parallax::kFull;
  bool environment = false;  // loden_evaluate_environment instead of loden_evaluate
  bool curved = false;       // on the surface below instead of a plane
};

// Convex, with stretched and sheared texture coordinates.
LocalSurface<float> localSurface(const Way& way, const Material& material) {
  if (!way.curved) return LocalSurface<float>::flat(material.geometry.aspect);
  return {glm::mat2(0.3f, 0.05f, 0.05f, 0.2f), glm::mat2(1.2f, 0.1f, -0.05f, 0.9f)};
}
std::string matrixText(const glm::mat2& m) {
  return std::to_string(m[0].x) + ", " + std::to_string(m[0].y) + ", " + std::to_string(m[1].x) + ", " +
         std::to_string(m[1].y);
}

// Some light from all around, as the shader takes it.
constexpr glm::vec4 kEnvironment[9] = {
    {0.3f, -0.2f, 0.4f, 0.9f}, {0.2f, -0.3f, 0.1f, 0}, {0.15f, -0.2f, 0.05f, 0},
    {0.1f, 0.2f, 0.5f, 0.8f},  {0.1f, 0.1f, -0.2f, 0}, {-0.1f, 0.1f, 0.2f, 0},
    {-0.4f, 0.1f, 0.2f, 0.6f}, {-0.2f, 0.3f, 0.0f, 0}, {0.05f, 0.2f, -0.1f, 0}};

HemisphereLight hemisphereOfEnvironment(const glm::mat3& frame) {
  EnvironmentLight light;
  for (int c = 0; c < 3; ++c) {
    const glm::vec4 *first = &kEnvironment[3 * c], &d = first[1], &o = first[2];
    light.linear[c] = glm::vec3(*first);
    light.constant[c] = first->w;
    light.quadratic[c] = glm::mat3(d.x, o.x, o.y, o.x, d.y, o.z, o.y, o.z, d.z);
  }
  return hemisphereLight(light, frame);
}

glm::vec3 upperDirection(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0, 1);
  const float z = 0.02f + 0.98f * unit(random), phi = 6.2831853f * unit(random), sine = std::sqrt(1 - z * z);
  return {sine * std::cos(phi), sine * std::sin(phi), z};
}

std::vector<Sample> seededSamples() {
  std::mt19937 random(20261122);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Sample> samples(kSamples);
  for (Sample& s : samples) {
    s.x = glm::vec2(3 * unit(random) - 1, 3 * unit(random) - 1);
    s.lambda = 7 * unit(random) - 0.5f;
    s.wi = upperDirection(random);
    s.wo = upperDirection(random);
  }
  return samples;
}

GlTexture uploadSamples(const std::vector<Sample>& samples) {
  std::vector<glm::vec4> texels;
  for (const Sample& s : samples) texels.emplace_back(s.x, s.lambda, 0);
  for (const Sample& s : samples) texels.emplace_back(s.wi, 0);
  for (const Sample& s : samples) texels.emplace_back(s.wo, 0);
  GlTexture texture = makeTexture(GL_TEXTURE_2D_ARRAY, "parity samples");
  glTextureStorage3D(texture.name(), 1, GL_RGBA32F, kSide, kSide, 3);
  glTextureSubImage3D(texture.name(), 0, 0, 0, 0, kSide, kSide, 3, GL_RGBA, GL_FLOAT, texels.data());
  return texture;
}

// Value of every sample, and the texture fetches of its lookup, as the shader computes and counts them.
std::vector<glm::vec4> evaluateOnGpu(const Material& material, const std::vector<Sample>& samples,
                                     const Way& way) {
  auto device = Device::create(
      {.debug = true, .log = [](const Issue& issue) { ADD_FAILURE() << issue.where << ": " << issue.text; }});
  EXPECT_TRUE(device.ok());
  MaterialSystemOptions options;
  options.lookup = way.lookup;
  auto system = MaterialSystem::create(**device, options);
  EXPECT_TRUE(system.ok());
  auto bytes = serializeAsset(material);
  EXPECT_TRUE(bytes.ok()) << (bytes.ok() ? "" : bytes.issue().text);
  const auto id = (*system)->load(memorySource(std::move(*bytes), "parity"), "parity");
  EXPECT_TRUE(id.ok()) << (id.ok() ? "" : id.issue().text);
  (*system)->demand(*id, 0);
  (*system)->finishLoading();
  EXPECT_EQ((*system)->residentLambda(*id), finestLevel(material));

  std::vector<std::string> defines = variantDefines((*system)->variant(*id));
  defines.push_back(std::string("SKIP_PARALLAX ") + (way.parallax == Parallax::kFaded ? "true" : "false"));
  defines.push_back("MISSED " + std::to_string(kMissed));
  defines.push_back("LODEN_COUNT_FETCHES 1");
  if (way.environment) defines.push_back("ENVIRONMENT 1");
  if (way.curved) {
    const LocalSurface<float> surface = localSurface(way, material);
    defines.push_back("LODEN_FOLLOW_SURFACE 1");
    defines.push_back("CURVATURE " + matrixText(surface.curvature));
    defines.push_back("X_FROM_TANGENT " + matrixText(surface.x_from_tangent));
  }
  const auto program =
      compileProgram({"parity.vert", kVertex}, {"parity.frag", kFragment}, defines, "parity");
  EXPECT_TRUE(program.ok()) << (program.ok() ? "" : program.issue().text);
  const RenderTarget target = *makeRenderTarget({kSide, kSide}, ColorFormat::kLinear32, "parity");
  const GlTexture texture = uploadSamples(samples);
  const GlVertexArray no_vertices = makeVertexArray("none");
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
  glViewport(0, 0, kSide, kSide);
  glUseProgram(program->name());
  if (way.environment) glUniform4fv(0, 9, &kEnvironment[0].x);
  glBindVertexArray(no_vertices.name());
  (*system)->bind(*id);
  glBindTextureUnit(LODEN_MAX_UNITS, texture.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  return readLinear(target);
}

double difference(const glm::vec3& value, const glm::vec4& gpu) {
  const glm::vec3 off = glm::abs(value - glm::vec3(gpu));
  return std::max({off.x, off.y, off.z});
}

// What the shader returns.
glm::vec3 evaluateAt(const Evaluator& evaluator, const Sample& s, const Way& way) {
  const Hit<float> hit = evaluator.findHit(s.x, s.lambda, s.wo, way.lookup, way.parallax,
                                           localSurface(way, evaluator.material()));
  if (hit.missed) return glm::vec3(kMissed);
  if (way.environment)
    return evaluator.evaluateEnvironment(hit, hemisphereOfEnvironment(hitFrame(hit, glm::mat3(1))), s.wo);
  return evaluator.evaluate(hit, s.wi, s.wo);
}

int fetchesAt(const Evaluator& evaluator, const Sample& s, const Way& way) {
  return evaluator
      .findHit(s.x, s.lambda, s.wo, way.lookup, way.parallax, localSurface(way, evaluator.material()))
      .fetches;
}

// The smallest difference to the evaluator's values around the sample.
double differenceNearby(const Evaluator& evaluator, const Sample& s, const Way& way, const glm::vec4& gpu) {
  double smallest = 1e9;
  for (int k = 0; k < 1024; ++k) {
    const float angle = 0.7f * static_cast<float>(k), radius = kRounding * static_cast<float>(k + 1) / 1024;
    Sample near = s;
    near.x += radius * glm::vec2(std::cos(angle), std::sin(angle));
    smallest = std::min(smallest, difference(evaluateAt(evaluator, near, way), gpu));
  }
  return smallest;
}

void expectParity(const Material& material, const Way& way) {
  const std::vector<Sample> samples = seededSamples();
  const std::vector<glm::vec4> gpu = evaluateOnGpu(material, samples, way);
  ASSERT_EQ(gpu.size(), samples.size());
  Evaluator evaluator(material);
  if (way.environment) evaluator.prepareEnvironment();
  double sum = 0;
  int at_jumps = 0, other_fetches = 0;
  for (size_t k = 0; k < samples.size(); ++k) {
    const Sample& s = samples[k];
    const double off = difference(evaluateAt(evaluator, s, way), gpu[k]);
    ASSERT_TRUE(std::isfinite(off)) << "sample " << k;
    sum += off;
    other_fetches += float(fetchesAt(evaluator, s, way)) != gpu[k].w;
    if (off <= kMaxDifference) continue;
    ++at_jumps;
    EXPECT_LE(differenceNearby(evaluator, s, way, gpu[k]), kMaxDifference)
        << "sample " << k << " differs by " << off << " and no jump is near";
  }
  const bool shadows = material.surface && byLookup(material.surface->visibility);
  EXPECT_LE(at_jumps, shadows && !way.environment ? kMaxAtShadows : kMaxAtJumps);
  EXPECT_LE(sum / kSamples, kMeanDifference);
  EXPECT_LE(other_fetches, kMaxOtherFetches);
}

struct Bake {
  importer::BakedOutput output;
  std::string folder;
};

// `aspect`: of the period, in place of the tile's own.
Bake bakeSmall(const std::string& name, int geometry_size = 64, double aspect = 0) {
  std::string folder = (std::filesystem::temp_directory_path() / "loden_parity_XXXXXX").string();
  EXPECT_NE(::mkdtemp(folder.data()), nullptr);
  auto tile = importer::builtinTile(name);
  EXPECT_TRUE(tile.ok());
  if (aspect > 0) tile->aspect = aspect;
  importer::BakeOptions options;
  options.size = 32;
  options.geometry_size = geometry_size;
  options.directions = concentricDirections(5);
  options.vdims = {{16, 16}};
  options.supersample = 1;
  options.bounces = 2;
  options.quiet = true;
  const auto report = importer::bake(*tile, "builtin:" + name, folder, options);
  EXPECT_TRUE(report.ok()) << (report.ok() ? "" : report.issue().text);
  auto baked = importer::BakedOutput::open(folder);
  EXPECT_TRUE(baked.ok()) << (baked.ok() ? "" : baked.issue().text);
  return {std::move(*baked), folder};
}

// What a material is cooked as.
struct Kind {
  Mode mode = Mode::kFused;
  importer::Preset preset = importer::Preset::kGame;
  importer::Near near = importer::Near::kSurface;
  bool shadow_map = false;
  auto operator<=>(const Kind&) const = default;
};

Material cooked(const importer::BakedOutput& baked, const Kind& kind) {
  importer::CookOptions options;
  options.mode = kind.mode;
  options.preset = kind.preset;
  options.near = kind.near;
  if (kind.shadow_map) options.visibility = Visibility::kMap;
  options.quiet = true;
  auto material = importer::cook(baked, options);
  EXPECT_TRUE(material.ok()) << (material.ok() ? "" : material.issue().text);
  return std::move(*material);
}

// One tile, baked once for all modes, and cooked once as each kind.
class Parity : public testing::TestWithParam<std::string> {};

TEST_P(Parity, GpuAgreesWithEvaluatorInEveryMode) {
  using enum importer::Preset;
  const Bake baked = bakeSmall(GetParam());
  const auto surface = importer::Near::kSurface, band = importer::Near::kBand;
  const Kind fused{}, flat{Mode::kFused, kGame, band};
  const Kind mapped{Mode::kFused, kGame, surface, true}, near_mapped{Mode::kSurface, kGame, surface, true};
  const Kind near{Mode::kSurface, kGame}, published{Mode::kSurface, kSeed, surface};
  const Kind lod{Mode::kLod, kGame}, lod_published{Mode::kLod, kSeed};
  const Way full{}, faded{Lookup::kDefault, Parallax::kFaded}, fast{Lookup::kFast}, none{Lookup::kNone};
  const Way curved{Lookup::kDefault, Parallax::kFull, false, true};
  const Way lit{Lookup::kDefault, Parallax::kFull, true},
      lit_curved{Lookup::kDefault, Parallax::kFull, true, true};
  struct Case {
    const char* name;
    Kind kind;
    Way way;
    Visibility visibility = Visibility::kFast;  // of the near term, if there is one
    bool cosine_included = true;
    bool indirect = true;  // keeps what the near term has of it
  };
  std::map<Kind, Material> materials;
  for (const Case& c :
       {Case{"near and coarse", fused, full},
        Case{"near and coarse, fast", fused, fast},
        Case{"near and coarse, faded", fused, faded},
        Case{"near and coarse, curved", fused, curved},
        Case{"near and coarse, environment", fused, lit},
        Case{"near and coarse, curved, environment", fused, lit_curved},
        Case{"near and coarse, no shadows", fused, full, Visibility::kNone},
        Case{"near and coarse, shadow map", mapped, full, Visibility::kMap},
        Case{"near and coarse, shadow map, curved", mapped, curved, Visibility::kMap},
        Case{"surface, shadow map", near_mapped, fast, Visibility::kMap},
        Case{"near and coarse, direct light alone", fused, full, Visibility::kFast, true, false},
        Case{"surface", near, full, Visibility::kNone},
        Case{"surface, shadows", near, full, Visibility::kDefault},
        Case{"surface as published", published, {Lookup::kPaper}, Visibility::kNone},
        Case{"surface, environment", near, lit},
        Case{"lod as published", lod_published, none},
        Case{"lod with 8-bit maps", lod, none},
        Case{"lod without the cosine", lod, none, {}, false},
        Case{"lod, environment", lod_published, {Lookup::kNone, Parallax::kFull, true}},
        Case{"flat band", flat, full},
        Case{"flat band, environment", flat, lit}}) {
    SCOPED_TRACE(c.name);
    if (!materials.contains(c.kind)) materials[c.kind] = cooked(baked.output, c.kind);
    Material material = materials[c.kind];
    material.cosine_included = c.cosine_included;
    if (material.surface) material.surface->visibility = c.visibility;
    if (c.kind == fused) {
      EXPECT_GT(material.surface->indirect.width, 0);
    }
    if (material.surface && !c.indirect) material.surface->indirect = {};
    expectParity(material, c.way);
  }
  std::filesystem::remove_all(baked.folder);
}

INSTANTIATE_TEST_SUITE_P(Tiles, Parity, testing::Values("button", "isba", "pulli", "sponge", "weave"),
                         [](const auto& tile) { return tile.param; });

// A height field, a surface that overhangs and charts, whose periods are no squares: slopes differ by axis.
TEST(ParityOnRectangles, GpuAgreesWithEvaluator) {
  for (const auto& [name, aspect] : {std::pair{"sponge", 0.6}, {"isba", 1.7}, {"shingles", 0.0}}) {
    SCOPED_TRACE(name);
    const Bake baked = bakeSmall(name, 0, aspect);
    const Material material =
        cooked(baked.output, {Mode::kFused, importer::Preset::kGame, importer::Near::kBand});
    EXPECT_NE(material.geometry.aspect, 1);
    expectParity(material, {});
    expectParity(material, {Lookup::kFast, Parallax::kFaded});
    std::filesystem::remove_all(baked.folder);
  }
}

}  // namespace
}  // namespace loden::runtime
