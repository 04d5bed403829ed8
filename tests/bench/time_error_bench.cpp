// Run time against error: every way to draw a tile, in one interleaved run, on the same pixels, against the traced tile.
// A plane fills the picture, one light; near (63 pixels a tile) and far (a pixel covers 4 texels a side). Peers that need a
// height field are drawn on tiles that are one. They have no cast shadows, as such shaders usually have not.
//
//   bench_time_error [--tile NAME]... [--json FILE]     tiles: button, pulli by default; bakes are kept in out/studies/bakes
#include <epoxy/gl.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "importer/cook.h"
#include "importer/flip.h"
#include "importer/fit/goal.h"
#include "importer/fit/modes.h"
#include "importer/metrics.h"
#include "importer/parallel.h"
#include "importer/study/study.h"
#include "importer/tile_tracer.h"
#include "material/asset.h"
#include "runtime/shader_variants.h"
#include "shaders/loden_shared.h"
#include "tests/bench/bench_support.h"

namespace {

using namespace loden;
using namespace loden::bench;
using namespace loden::runtime;
using importer::BakedOutput;

constexpr int kPixels = 190, kRounds = 11, kTruthSamples = 8;  // samples per pixel side
const glm::dvec3 kLight = glm::normalize(glm::dvec3(0.5, 0.3, 0.8));

struct View {
  const char* name;
  double periods;  // of the tile, across the picture
};
constexpr View kViews[] = {{"near", 3}, {"far", 190.0 * 4 / 64}};

glm::dvec3 towardsEye(glm::dvec2 uv) { return glm::normalize(glm::dvec3(uv - 0.5, 0.4)); }

const char kCommon[] = R"(
#include "loden_material.glsl"
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;
uniform float periods;
)";

const char kLodenMain[] = R"(
void main() {
  vec3 wi = normalize(vec3(0.5, 0.3, 0.8)), wo = normalize(vec3(uv - 0.5, 0.4));
  LodenMaterial m = loden_material_default();
  vec2 x = uv * periods;
  LodenHit h = loden_find_hit(m, x, dFdx(x), dFdy(x), wo);
  color = vec4(loden_evaluate(m, h, wi, wo), 0.0);
#ifdef LODEN_COUNT_FETCHES
  color.w = float(loden_fetches);
#endif
})";

// Linear steps down the view ray until it is below the height map, then bisections between the last two.
const char kMarchMain[] = R"(
layout(binding = LODEN_UNIT_FIRST_FREE) uniform sampler2D height_map;  // depth below the plane, share of depth_range
uniform float depth_range;
void main() {
  vec3 wi = normalize(vec3(0.5, 0.3, 0.8)), wo = normalize(vec3(uv - 0.5, 0.4));
  LodenMaterial m = loden_material_default();
  vec2 x = uv * periods, shift = -wo.xy / wo.z * depth_range;
  float lambda = max(loden_lambda_from_footprint(dFdx(x), dFdy(x)), 0.0);
  float above = 0.0, below = 1.0;
  int taken = 0;
  do {
    below = float(taken + 1) / float(STEPS);
    if (textureLod(height_map, x + shift * below, lambda).r <= below) break;
    above = below;
  } while (++taken < STEPS);
  for (int i = 0; i < BISECTIONS; ++i) {
    float middle = 0.5 * (above + below);
    if (textureLod(height_map, x + shift * middle, lambda).r <= middle) below = middle; else above = middle;
  }
  LodenHit hit;
  hit.x = x;
  hit.p = x + shift * below;
  hit.lambda = lambda;
  hit.depth = 0.0;
  color = vec4(loden_evaluate(m, hit, wi, wo), float(min(taken + 1, STEPS) + BISECTIONS + 3));
})";

const char kConstantMain[] = R"(
uniform vec3 constant_color;
void main() { color = vec4(constant_color, 0.0); })";

// One way to draw, with a material system of its own so that its bytes can be read off.
struct Subject {
  std::string renderer, setting;
  std::unique_ptr<MaterialSystem> materials;
  MaterialId id;
  GlProgram program, counting;
  uint64_t extra_bytes = 0;  // of textures outside the system
};

class Scene {
 public:
  Scene(const Device& device, const FullScreen& screen, const BakedOutput& baked) : device_(device), screen_(screen), baked_(baked) {}

  void add(const std::string& renderer, const std::string& setting, const Material& material, Lookup lookup) {
    Subject subject = load(renderer, setting, material, lookup);
    const std::string text = std::string(kCommon) + kLodenMain;
    MaterialVariant variant = subject.materials->variant(subject.id);
    subject.program = screen_.program(text, variantDefines(variant));
    variant.count_fetches = true;
    subject.counting = screen_.program(text, variantDefines(variant));
    subjects_.push_back(std::move(subject));
  }
  // The surface maps of `material`, read where a march over its heights ends.
  void addMarch(const std::string& renderer, int steps, int bisections, const Material& material) {
    Subject subject = load(renderer, std::to_string(steps) + " + " + std::to_string(bisections) + " steps", material, Lookup::kNone);
    makeHeights(material.geometry);
    std::vector<std::string> defines = variantDefines(subject.materials->variant(subject.id));
    defines.push_back("STEPS " + std::to_string(steps));
    defines.push_back("BISECTIONS " + std::to_string(bisections));
    subject.program = screen_.program(std::string(kCommon) + kMarchMain, defines);
    subject.counting = screen_.program(std::string(kCommon) + kMarchMain, defines);
    subject.extra_bytes = height_bytes_;
    subjects_.push_back(std::move(subject));
  }
  void addConstant(const Material& material) {
    Subject subject = load("constant colour", "mean of the truth", material, Lookup::kNone);
    subject.program = screen_.program(std::string(kCommon) + kConstantMain, variantDefines(subject.materials->variant(subject.id)));
    subject.counting = screen_.program(std::string(kCommon) + kConstantMain, variantDefines(subject.materials->variant(subject.id)));
    subjects_.push_back(std::move(subject));
  }

  // The renderer named `base` gives the ratio's denominator.
  void measure(const std::string& tile, const View& view, const std::string& base, importer::StudyRows& rows) const;

 private:
  Subject load(const std::string& renderer, const std::string& setting, const Material& material, Lookup lookup) {
    Subject subject{renderer, setting, nullptr, {}, {}, {}, 0};
    MaterialSystemOptions options;
    options.lookup = lookup;
    subject.materials = require(MaterialSystem::create(device_, options));
    subject.id = require(subject.materials->load(assetSource(material), renderer));
    subject.materials->demand(subject.id, 0);
    subject.materials->finishLoading();
    return subject;
  }
  void makeHeights(const GeometryImage& geometry) {
    if (heights_.name()) return;
    const int side = geometry.side(), mips = fullMipCount(side, side);
    std::vector<float> depths;
    for (int t = 0; t < side * side; ++t) depths.push_back(1 - fetchTexel(geometry.texels, 0, t % side, t / side, 0).z);
    heights_ = makeTexture(GL_TEXTURE_2D, "heights");
    glTextureStorage2D(heights_.name(), mips, GL_R16, side, side);
    glTextureSubImage2D(heights_.name(), 0, 0, 0, side, side, GL_RED, GL_FLOAT, depths.data());
    glGenerateTextureMipmap(heights_.name());
    range_ = geometry.range.z;
    height_bytes_ = textureBytes(TexelFormat::kRG8Unorm, uint64_t(side), uint64_t(side), 1, mips);  // as many bytes as R16
  }
  void draw(const Subject& subject, const GlProgram& program, const View& view, const glm::vec3& mean) const {
    subject.materials->bind(subject.id);
    if (heights_.name()) glBindTextureUnit(LODEN_UNIT_FIRST_FREE, heights_.name());
    // Location -1 of a uniform that the program does not have is ignored.
    const auto location = [&](const char* name) { return glGetUniformLocation(program.name(), name); };
    glProgramUniform1f(program.name(), location("periods"), float(view.periods));
    glProgramUniform1f(program.name(), location("depth_range"), range_);
    glProgramUniform3fv(program.name(), location("constant_color"), 1, &mean.x);
    screen_.draw(program);
  }
  std::vector<glm::vec3> truth(const std::string& tile, const View& view) const;

  const Device& device_;
  const FullScreen& screen_;
  const BakedOutput& baked_;
  std::vector<Subject> subjects_;
  GlTexture heights_;
  float range_ = 0;
  uint64_t height_bytes_ = 0;
};

// Rows from v = 0 up, as the target is read.
std::vector<glm::vec3> Scene::truth(const std::string& tile, const View& view) const {
  const auto mesh = require(importer::loadTile(importer::studyTileName(tile)));
  const importer::TileTracer tracer(mesh);
  std::vector<glm::vec3> pixels(size_t(kPixels) * kPixels);
  importer::parallelFor(size_t(kPixels), 0, [&](size_t j) {
    const importer::FlushDenormals flush;
    for (int i = 0; i < kPixels; ++i) {
      const glm::dvec3 wo = towardsEye((glm::dvec2(i, double(j)) + 0.5) / double(kPixels));
      glm::dvec3 sum(0);
      for (int s = 0; s < kTruthSamples * kTruthSamples; ++s) {
        const glm::dvec2 inside = (glm::dvec2(s % kTruthSamples, s / kTruthSamples) + 0.4871) / double(kTruthSamples);
        const auto hit = tracer.intersectView((glm::dvec2(i, double(j)) + inside) / double(kPixels) * view.periods, wo);
        if (hit) sum += importer::shadeHit(tracer, *hit, kLight, wo, 0, 0);
      }
      pixels[j * kPixels + size_t(i)] = glm::vec3(sum / double(kTruthSamples * kTruthSamples));
    }
  });
  return pixels;
}

void Scene::measure(const std::string& tile, const View& view, const std::string& base, importer::StudyRows& rows) const {
  const std::vector<glm::vec3> expected = truth(tile, view);
  glm::dvec3 mean(0);
  for (const glm::vec3& pixel : expected) mean += glm::dvec3(pixel) / double(expected.size());
  std::vector<std::function<void()>> tasks;
  for (const Subject& subject : subjects_) tasks.push_back([&, mean] { draw(subject, subject.program, view, glm::vec3(mean)); });
  const std::vector<double> ms = interleavedMedians(tasks, kRounds);
  double base_ms = 0;
  for (size_t i = 0; i < subjects_.size(); ++i)
    if (subjects_[i].renderer == base) base_ms = ms[i];
  for (size_t i = 0; i < subjects_.size(); ++i) {
    const Subject& subject = subjects_[i];
    draw(subject, subject.counting, view, glm::vec3(mean));
    std::vector<glm::vec3> got;
    double fetches = 0;
    for (const glm::vec4& pixel : screen_.read()) got.emplace_back(pixel), fetches += double(pixel.w) / double(expected.size());
    importer::ErrorSums error;
    error.add(expected, got);
    importer::StudyRow row;
    row.set("scene", tile + " " + view.name).set("renderer", subject.renderer).set("setting", subject.setting);
    row.set("ms_median", ms[i]).set("ratio_to_normal_map", ms[i] / base_ms).set("fetches_per_pixel", fetches);
    row.set("gpu_bytes", subject.renderer == "constant colour" ? uint64_t{0} : subject.materials->stats().resident_bytes + subject.extra_bytes);
    row.set("flip", importer::flip(expected, got, kPixels, kPixels).mean).set("rmse", error.y().rmse).set("psnr_db", error.psnr());
    rows.push_back(std::move(row));
  }
}

Material cooked(const BakedOutput& baked, Mode mode, importer::Preset preset) {
  importer::CookOptions options;
  options.mode = mode;
  options.preset = preset;
  options.quiet = true;
  return require(importer::cook(baked, options));
}

Material smallestFused(const BakedOutput& baked) {
  const auto source = require(importer::bakedSource(baked));
  const auto btf = require(importer::loadYcc(*source, 0));
  const importer::FusedPlan plan = importer::smallestPlan(baked.manifest().geometry_size);
  return importer::fitFused(*source, btf, require(importer::geometryOf(baked, plan.geometry_side)), plan, 0).material;
}

void measureTile(const Device& device, const FullScreen& screen, const std::string& tile, importer::StudyRows& rows) {
  importer::StudyOptions options;
  options.bakes = "out/studies/bakes";
  const BakedOutput baked = require(importer::studyBake(options, tile));
  using importer::Preset;
  const Material surface = cooked(baked, Mode::kSurface, Preset::kGame);
  Material without_geometry = surface;
  without_geometry.geometry = {};
  Material paper = cooked(baked, Mode::kSurface, Preset::kSeed);
  paper.geometry = {};
  Scene scene(device, screen, baked);
  scene.addConstant(without_geometry);
  scene.add("normal map", "diffuse, normal, specular at x", without_geometry, Lookup::kNone);
  if (baked.manifest().identity_parameterization) {
    scene.addMarch("parallax occlusion mapping", 16, 5, surface);
    scene.addMarch("relief mapping", 32, 6, surface);
  }
  scene.add("Flat-BTF, as published", "latlong 16x16, blended", paper, Lookup::kPaper);
  scene.add("LOD-BTF, as published", "8,2,2 components, 32 bit", cooked(baked, Mode::kLod, Preset::kSeed), Lookup::kNone);
  scene.add("Loden, lod", "16 components, 8 bit", cooked(baked, Mode::kLod, Preset::kGame), Lookup::kNone);
  scene.add("Loden, surface", "fast lookup", surface, Lookup::kFast);
  scene.add("Loden, surface", "default lookup", surface, Lookup::kDefault);
  const Material smallest = smallestFused(baked), fused = cooked(baked, Mode::kFused, Preset::kGame);
  scene.add("Loden, fused", "smallest, fast lookup", smallest, Lookup::kFast);
  scene.add("Loden, fused", "fast lookup", fused, Lookup::kFast);
  scene.add("Loden, fused", "default lookup", fused, Lookup::kDefault);
  for (const View& view : kViews) scene.measure(tile, view, "normal map", rows);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> tiles;
  std::string json;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (!std::strcmp(argv[i], "--tile")) tiles.emplace_back(argv[i + 1]);
    if (!std::strcmp(argv[i], "--json")) json = argv[i + 1];
  }
  if (tiles.empty()) tiles = {"button", "pulli"};
  const std::unique_ptr<Device> device = makeDevice();
  const FullScreen screen({kPixels, kPixels});
  importer::StudyRows rows;
  for (const std::string& tile : tiles) measureTile(*device, screen, tile, rows);
  std::printf("# bench_time_error: %d x %d pixels, 1 light, median of %d interleaved frames, %s\n%s", kPixels, kPixels, kRounds,
              device->capabilities().renderer.c_str(), importer::studyTable(rows).c_str());
  if (!json.empty())
    std::ofstream(json) << importer::studyJson({"time-error", "run time against error", nullptr}, "bench_time_error", rows);
  return 0;
}
