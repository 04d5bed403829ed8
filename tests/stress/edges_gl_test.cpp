// Shaders against the CPU evaluator, and both against formulas in double, at the edges of what directions,
// coordinates, levels and footprints can be: what tests/gl/parity_test.cpp compares at random samples.

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "material/eval/evaluate.h"
#include "runtime/shader/shader_library.h"
#include "shaders/loden_shared.h"
#include "tests/gl/gl_fixture.h"
#include "tests/stress/stress.h"
#include "tests/stress/stress_materials.h"
#include "tests/unit/material_fixtures.h"

namespace loden::stress {
namespace {

using namespace runtime;

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
  vec4 first = texelFetch(samples, ivec3(at, 0), 0);
  vec4 second = texelFetch(samples, ivec3(at, 1), 0);
  vec4 third = texelFetch(samples, ivec3(at, 2), 0);
  MAIN
}
)";
constexpr const char* kEvaluate =
    "LodenPoint m = loden_point_default(); m.skip_parallax = false;"
    "LodenHit hit = loden_find_hit_at(m, first.xy, first.z, third.xyz);"
    "color = vec4(loden_evaluate(hit, second.xyz, third.xyz), 0.0);";
constexpr const char* kEnvironmentMain =
    "LodenPoint m = loden_point_default(); m.skip_parallax = false;"
    "LodenHit hit = loden_find_hit_at(m, first.xy, first.z, third.xyz);"
    "LodenHemisphere light = loden_hemisphere_light(environment, loden_hit_frame(hit, mat3(1.0)));"
    "color = vec4(loden_evaluate_environment(hit, light, third.xyz), 0.0);";

struct Sample {
  glm::vec4 first{0}, second{0}, third{0};
};
Sample sampleAt(glm::vec2 x, float lambda, const glm::vec3& wi, const glm::vec3& wo) {
  return {glm::vec4(x, lambda, 0), glm::vec4(wi, 0), glm::vec4(wo, 0)};
}

// White all around: a constant of 1 for each colour.
constexpr glm::vec4 kWhiteSky[9] = {{0, 0, 0, 1}, {}, {}, {0, 0, 0, 1}, {}, {}, {0, 0, 0, 1}, {}, {}};
HemisphereLight whiteSky() {
  EnvironmentLight light;
  light.constant = glm::vec3(1);
  return hemisphereLight(light, glm::mat3(1));
}

class StressGl : public test::GlTest {
 protected:
  // What MAIN makes of each sample.
  std::vector<glm::vec4> run(const Material& material, Lookup lookup, const char* main,
                             const std::vector<Sample>& samples) {
    MaterialSystemOptions options;
    options.lookup = lookup;
    const auto system = makeMaterials(options);
    const MaterialId id = load(*system, material);
    system->demand(id, -4);
    system->finishLoading();
    std::vector<std::string> defines = variantDefines(system->variant(id));
    defines.push_back(std::string("MAIN ") + main);
    if (main == kEnvironmentMain) defines.push_back("ENVIRONMENT 1");
    const auto program = compileProgram({"edges.vert", kVertex}, {"edges.frag", kFragment}, defines, "edges");
    EXPECT_TRUE(program.ok()) << (program.ok() ? "" : program.issue().text);
    const int side = static_cast<int>(std::ceil(std::sqrt(double(samples.size()))));
    const auto texels = static_cast<size_t>(side) * static_cast<size_t>(side);
    std::vector<glm::vec4> data(3 * texels, glm::vec4(0));
    for (size_t k = 0; k < samples.size(); ++k)
      data[k] = samples[k].first, data[texels + k] = samples[k].second,
      data[2 * texels + k] = samples[k].third;
    const GlTexture texture = makeTexture(GL_TEXTURE_2D_ARRAY, "edges");
    glTextureStorage3D(texture.name(), 1, GL_RGBA32F, side, side, 3);
    glTextureSubImage3D(texture.name(), 0, 0, 0, 0, side, side, 3, GL_RGBA, GL_FLOAT, data.data());
    const RenderTarget target = *makeRenderTarget({side, side}, ColorFormat::kLinear32, "edges");
    const GlVertexArray no_vertices = makeVertexArray("none");
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
    glViewport(0, 0, side, side);
    glUseProgram(program->name());
    if (main == kEnvironmentMain) glUniform4fv(0, 9, &kWhiteSky[0].x);
    glBindVertexArray(no_vertices.name());
    system->bind(id);
    glBindTextureUnit(LODEN_MAX_UNITS, texture.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    std::vector<glm::vec4> pixels = readLinear(target);
    pixels.resize(samples.size());
    return pixels;
  }
};

std::vector<Sample> directionSamples(float theta_max, uint32_t shift) {
  const std::vector<EdgeDirection> edges = edgeDirections(theta_max);
  std::vector<Sample> samples;
  const auto step = static_cast<size_t>(amount(13, 1));
  for (size_t i = 0; i < edges.size(); ++i)
    for (size_t k = (i + shift) % step; k < edges.size(); k += step)
      samples.push_back(sampleAt({0.3f, 0.7f}, 0.25f, edges[i].w, edges[k].w));
  return samples;
}

std::vector<Sample> coordinateSamples(const Material& material) {
  const glm::vec3 wi = glm::normalize(glm::vec3(0.3f, -0.2f, 0.8f)),
                  wo = glm::normalize(glm::vec3(-0.4f, 0.1f, 0.7f));
  std::vector<float> borders{0, 1, material.lambda_max};
  for (const Band& band : material.bands)
    borders.insert(borders.end(),
                   {band.window.in_begin, band.window.in_end, band.window.out_begin, band.window.out_end});
  if (material.surface)
    borders.insert(borders.end(), {material.surface->fade_begin, material.surface->fade_end});
  const std::vector<float> xs = edgeCoordinates(material.side), levels = edgeLevels(borders);
  std::vector<Sample> samples;
  for (size_t i = 0; i < xs.size(); ++i)
    for (size_t k = 0; k < levels.size(); ++k)
      // Beyond 1e5 a texture unit may do as it likes with its fixed point.
      if (std::abs(xs[i]) < 2e5f) samples.push_back(sampleAt({xs[i], 0.3f}, levels[k], wi, wo));
  return samples;
}

glm::vec3 valueAt(const Evaluator& evaluator, Lookup lookup, bool environment, const Sample& s) {
  const glm::vec3 wi(s.second), wo(s.third);
  const auto hit = evaluator.findHit(glm::vec2(s.first), s.first.z, wo, lookup);
  return environment ? evaluator.evaluateEnvironment(hit, whiteSky(), wo) : evaluator.evaluate(hit, wi, wo);
}

// The smallest difference to the evaluator's values within a few ulp of the sample: maps have steps where an
// index changes, and rounding may put a sample on the other side.
double differenceNearby(const Evaluator& evaluator, Lookup lookup, bool environment, const Sample& s,
                        const glm::vec3& gpu) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-4e-7f, 4e-7f);
  double smallest = 1e9;
  for (int k = 0; k < 256; ++k) {
    Sample near = s;
    for (int axis = 0; axis < 3; ++axis) {
      near.second[axis] += uniform(random) * std::max(std::abs(s.second[axis]), 1.0f);
      near.third[axis] += uniform(random) * std::max(std::abs(s.third[axis]), 1.0f);
      if (axis < 2) near.first[axis] += uniform(random) * std::max(std::abs(s.first[axis]), 1.0f);
    }
    smallest = std::min(smallest, largestOf(valueAt(evaluator, lookup, environment, near) - gpu));
  }
  return smallest;
}

struct Compared {
  int64_t samples = 0, not_finite_or_negative = 0, beside_steps = 0, different = 0;
  double largest = 0;  // of those not beside steps
};

void compare(const Evaluator& evaluator, Lookup lookup, bool environment, const std::vector<Sample>& samples,
             const std::vector<glm::vec4>& gpu, Compared& compared) {
  constexpr double kMost = 1e-3;  // of white: acos of a GPU is right to 1e-4
  for (size_t k = 0; k < samples.size(); ++k) {
    const glm::vec3 shown(gpu[k]);
    ++compared.samples;
    if (!blackOrLight(shown)) {
      ++compared.not_finite_or_negative;
      continue;
    }
    const glm::vec3 expected = valueAt(evaluator, lookup, environment, samples[k]);
    // Lobes of fixtures are brighter than white.
    const double off = largestOf(expected - shown) / std::max(1.0, largestOf(expected));
    if (off <= kMost) {
      compared.largest = std::max(compared.largest, off);
      continue;
    }
    if (differenceNearby(evaluator, lookup, environment, samples[k], shown) <= kMost) {
      ++compared.beside_steps;
      continue;
    }
    ++compared.different;
    const Sample& s = samples[k];
    ADD_FAILURE() << evaluator.material().name << ", " << lookupName(lookup) << ": x " << s.first.x << ' '
                  << s.first.y << " lambda " << s.first.z << " wi " << s.second.x << ' ' << s.second.y << ' '
                  << s.second.z << " wo " << s.third.x << ' ' << s.third.y << ' ' << s.third.z << ": GPU "
                  << shown.x << ' ' << shown.y << ' ' << shown.z << ", CPU " << expected.x << ' '
                  << expected.y << ' ' << expected.z;
    if (compared.different > 20) return;
  }
}

// The fixtures' geometry is noise, on which no two roundings find the same point: lookups are compared on a
// plane and on bumps.
struct Case {
  Material material;
  std::vector<Lookup> lookups;
};
std::vector<Case> cases() {
  std::vector<Case> all;
  for (Material& material : edgeMaterials()) {
    const bool plane = material.name == "plane";
    all.push_back({std::move(material),
                   plane ? std::vector{Lookup::kFast, Lookup::kDefault} : std::vector{Lookup::kNone}});
  }
  Material bumps = planeMaterial(0.1);
  bumps.name = "bumps";
  bumps.geometry = bumpImage(64, 0.1);
  bumps.side = 64;
  all.push_back({std::move(bumps), {Lookup::kFast, Lookup::kDefault}});
  return all;
}

void note(const std::string& what, const Compared& compared) {
  record(what + ": samples compared", double(compared.samples), "all tried");
  record(what + ": samples not finite or negative on the GPU", double(compared.not_finite_or_negative), "0");
  record(what + ": samples that differ from the evaluator, with no step within 4 ulp",
         double(compared.different), "0");
  record(what + ": largest difference to the evaluator", compared.largest, "<= 1e-3 of white");
  record(what + ": share of samples beside a step", double(compared.beside_steps) / double(compared.samples),
         "<= .01");
  EXPECT_EQ(compared.not_finite_or_negative, 0);
  EXPECT_EQ(compared.different, 0);
  EXPECT_LE(double(compared.beside_steps), 0.01 * double(compared.samples));
}

TEST_F(StressGl, DirectionsAtEdgesAreTheEvaluators) {
  Compared lights, sky;
  uint32_t shift = 0;
  for (const Case& c : cases())
    for (const Lookup lookup : c.lookups) {
      Evaluator evaluator(c.material);
      evaluator.prepareEnvironment();
      const std::vector<Sample> samples = directionSamples(c.material.theta_max, ++shift);
      compare(evaluator, lookup, false, samples, run(c.material, lookup, kEvaluate, samples), lights);
      compare(evaluator, lookup, true, samples, run(c.material, lookup, kEnvironmentMain, samples), sky);
    }
  note("pairs of edge directions, one light", lights);
  note("edge directions of sight, white sky", sky);
}

TEST_F(StressGl, CoordinatesAndLevelsAtEdgesAreTheEvaluators) {
  Compared compared;
  for (const Case& c : cases())
    for (const Lookup lookup : c.lookups) {
      const Evaluator evaluator(c.material);
      const std::vector<Sample> samples = coordinateSamples(c.material);
      compare(evaluator, lookup, false, samples, run(c.material, lookup, kEvaluate, samples), compared);
    }
  note("edge coordinates at edge levels", compared);
}

// The maps of directions as the shaders have them, against double. A GPU's acos is right to 1e-4, and theta
// of a float near the pole to sqrt(2.4e-7).
TEST_F(StressGl, MapsOfDirectionsAreThoseOfDoubles) {
  const Material material = smoothMaterial();
  const double theta_max = double(material.theta_max);
  std::vector<Sample> samples;
  std::vector<glm::dvec3> directions;
  for (const EdgeDirection& edge : edgeDirections(material.theta_max))
    if (edge.valid && edge.unit)
      samples.push_back(sampleAt({}, 0, edge.w, {})), directions.push_back(glm::dvec3(edge.w));
  const auto gpu = run(material, Lookup::kNone,
                       "color = vec4(loden_grid_position(second.xyz, loden_material.theta_max),"
                       "loden_vdim_square_from_view(second.xyz));",
                       samples);
  double theta = 0, phi = 0, square = 0;
  for (size_t k = 0; k < samples.size(); ++k) {
    const glm::dvec3& w = directions[k];
    const double sine = std::hypot(w.x, w.y);
    theta = std::max(
        theta, std::abs(double(gpu[k].y) - std::min(std::atan2(sine, w.z) / theta_max, 1.0)) * theta_max);
    double turn = std::atan2(w.y, w.x) / (2 * kPi);
    turn = double(gpu[k].x) - (turn - std::floor(turn));
    if (sine > 0) phi = std::max(phi, std::abs(turn - std::floor(turn + 0.5)) * 2 * kPi);
    square =
        std::max(square, largestOf(glm::dvec3(glm::dvec2(gpu[k].z, gpu[k].w) - vdimSquareFromView(w), 0)));
    for (int c = 0; c < 4; ++c) EXPECT_TRUE(gpu[k][c] >= 0 && gpu[k][c] <= 1) << k;
  }
  record("shader's theta against double, radians", theta, "<= 6e-4");
  record("shader's phi against double, radians", phi, "<= 1e-5");
  record("shader's square of the lookups against double", square, "<= 1e-4");
  EXPECT_LE(theta, 6e-4);
  EXPECT_LE(phi, 1e-5);
  EXPECT_LE(square, 1e-4);
}

// log2 of the minor axis, or of half the major one if that is longer, in texels; from -20 on.
double lambdaByDefinition(glm::dvec2 dx, glm::dvec2 dy, double side) {
  const double a = std::hypot(dx.x, dx.y), b = std::hypot(dy.x, dy.y);
  return std::log2(std::max(std::max(std::min(a, b), 0.5 * std::max(a, b)) * side, 1e-6));
}

TEST_F(StressGl, FootprintsOfEveryShapeHaveALevel) {
  const Material material = smoothMaterial();
  std::vector<glm::vec2> axes{{0, 0}, {-0.0f, 0}};
  for (const float length :
       {1e-30f, 1e-20f, 1e-10f, 1e-6f, 1e-3f, 0.125f, 0.3f, 1.0f, 1e3f, 1e6f, 1e15f, 1e18f})
    for (const double angle : {0.0, 0.3, kPi / 4, kPi / 2, 3.0, -1.0})
      axes.push_back(length * glm::vec2(std::cos(angle), std::sin(angle)));
  std::vector<Sample> samples;
  for (const glm::vec2& dx : axes)
    for (const glm::vec2& dy : axes) samples.push_back({glm::vec4(dx, dy), {}, {}});
  const size_t finite = samples.size();
  for (const float bad : {NAN, INFINITY, -INFINITY, 1e30f})
    for (const glm::vec2& dy : {glm::vec2(0), glm::vec2(0.1f, 0), glm::vec2(bad)})
      samples.push_back({glm::vec4(bad, 0, dy), {}, {}});
  const auto gpu = run(material, Lookup::kNone,
                       "vec2 step_; int taps = loden_footprint_taps(first.xy, first.zw, step_);"
                       "LodenPoint m = loden_point_default();"
                       "LodenHit h = loden_find_hit(m, vec2(0.3), first.xy, first.zw, vec3(0.0, 0.0, 1.0));"
                       "vec3 c = loden_evaluate(h, vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, 1.0));"
                       "color = vec4(loden_lambda_from_footprint(first.xy, first.zw), float(taps), h.lambda,"
                       "c.x + c.y + c.z);",
                       samples);
  double worst = 0, value = 0;
  int64_t stretched = 0, wrong_taps = 0, unusable = 0;
  for (size_t k = 0; k < samples.size(); ++k) {
    unusable += !std::isfinite(gpu[k].z) || gpu[k].z < 0 || gpu[k].z > material.lambda_max ||
                !std::isfinite(gpu[k].w) || gpu[k].w < 0;
    if (k >= finite) continue;
    const glm::dvec2 dx(samples[k].first.x, samples[k].first.y), dy(samples[k].first.z, samples[k].first.w);
    const double expected = lambdaByDefinition(dx, dy, material.side);
    worst = std::max(worst, std::abs(double(gpu[k].x) - expected));
    const glm::dvec3 shown = smoothValue(material.side, glm::dvec2(0.3f), expected, {0, 0, 1}, {0, 0, 1});
    value = std::max(value, std::abs(shown.x + shown.y + shown.z - double(gpu[k].w)));
    const double a = glm::length(dx), b = glm::length(dy), ratio = std::max(a, b) / std::min(a, b);
    // Squares below 1e-37 are zero for a GPU: no shape is left of such a footprint.
    if (std::max(a, b) < 1e-18 || std::abs(ratio - 1.5) < 1e-3) continue;
    stretched += ratio >= 1000;
    wrong_taps += (ratio > 1.5) != (gpu[k].y == 2);
  }
  record("footprints: lambda against its definition, levels", worst, "<= 1e-4");
  record("footprints: value of the hit that find_hit makes of them, against its definition", value,
         "<= 1e-3");
  record("footprints whose sides are as 1000 : 1 and more", double(stretched), "all tried");
  record("footprints with another number of taps than their shape asks for", double(wrong_taps), "0");
  record("footprints, including those that are not finite, whose level or value is not finite",
         double(unusable), "0");
  EXPECT_LE(worst, 1e-4);
  EXPECT_LE(value, 1e-3);
  EXPECT_EQ(wrong_taps, 0);
  EXPECT_EQ(unusable, 0);
}

}  // namespace
}  // namespace loden::stress
