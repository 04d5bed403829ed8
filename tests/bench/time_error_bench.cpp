// Run time against error: every way to draw a tile, in one interleaved run, on the same pixels, against the
// traced tile. A plane fills the picture; at lambda 0 a pixel covers a texel, at 2 it covers 4 a side. Peers
// that need a height field are drawn on tiles that are one. They have no cast shadows, as such shaders
// usually have not.
//
// `loden study time-error` runs it with the options of a study.
//
// Time is processor time of this process with the picture drawn by the calling thread (LP_NUM_THREADS=0,
// unless the environment says otherwise), which other programs on the machine disturb least.
//
// fetches_per_pixel counts texture instructions, fetches_slowest those of the pixel that issues most in each
// block of 8 x 4, as a GPU's wave waits for it; bytes_per_pixel the bytes of the texels that their filters
// read: 1 texel for a fetch, 4 for a gather or a bilinear filter, 8 with mip levels or in a volume. No cache
// is assumed: a texel that neighbouring pixels share counts for each of them.
#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>

#include "importer/base/flip.h"
#include "importer/base/metrics.h"
#include "importer/base/parallel.h"
#include "importer/cook/cook.h"
#include "importer/cook/goal.h"
#include "importer/cook/modes.h"
#include "importer/study/study.h"
#include "importer/tile/tile_tracer.h"
#include "material/asset/asset.h"
#include "material/system/asset_io.h"
#include "material/system/atomic_file.h"
#include "runtime/stream/shader_variants.h"
#include "shaders/loden_shared.h"
#include "tests/bench/bench_support.h"
#include "tests/bench/btf_table.h"

namespace {

using namespace loden;
using namespace loden::bench;
using namespace loden::runtime;
using importer::BakedOutput;

constexpr int kPixels = 192, kRounds = 11, kTruthSamples = 8;  // samples per pixel side
constexpr int kBlockWidth = 8, kBlockHeight = 4;               // pixels that a wave of 32 draws

// The first is drawn with one light, all with four.
const glm::dvec3 kLights[] = {
    glm::normalize(glm::dvec3(0.5, 0.3, 0.8)), glm::normalize(glm::dvec3(-0.3, 0.5, 0.8)),
    glm::normalize(glm::dvec3(-0.5, -0.3, 0.6)), glm::normalize(glm::dvec3(0.3, -0.5, 1.0))};
constexpr int kMostLights = 4;

// How the plane is seen: the level of detail that its pixels ask for, and degrees off the normal.
struct View {
  double lambda = 0, degrees = 0;
};

// Pixels grow by the reciprocal cosine along x.
glm::dvec2 onPlane(const View& view, int side, glm::dvec2 uv) {
  const double periods = kPixels * std::exp2(view.lambda) / side;
  return uv * periods * glm::dvec2(1 / std::cos(glm::radians(view.degrees)), 1);
}
// Through a lens of a hundred degrees if seen from straight above, of a distant eye if not.
glm::dvec3 towardsEye(const View& view, glm::dvec2 uv) {
  if (view.degrees == 0) return glm::normalize(glm::dvec3(uv - 0.5, 0.4));
  const double spread = 0.1;
  const double theta = glm::radians(view.degrees) + spread * (uv.x - 0.5);
  return glm::normalize(glm::dvec3(std::sin(theta), spread * (uv.y - 0.5), std::cos(theta)));
}

constexpr int kUnits = LODEN_MAX_UNITS + BtfTable::kTextures;

// SHOW(rgb) ends every main. In counting variants alpha is the number of texture instructions, or of the
// bytes they read.
const char kCommon[] = R"(
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;
uniform vec2 periods;
uniform float tilt, spread;  // of towardsEye()
#ifdef LODEN_COUNT_FETCHES
uniform float fetch_bytes[UNITS];  // that one instruction on the unit reads
uniform bool count_bytes;
float counted = 0.0;
#define LODEN_COUNT(unit, n) (counted += float(n) * (count_bytes ? fetch_bytes[unit] : 1.0))
#define SHOW(rgb) color = vec4(rgb, counted)
#else
#define SHOW(rgb) color = vec4(rgb, 0.0)
#endif
#include "loden_material.glsl"
const vec3 kLights[4] = vec3[](vec3(0.5, 0.3, 0.8), vec3(-0.3, 0.5, 0.8), vec3(-0.5, -0.3, 0.6),
                               vec3(0.3, -0.5, 1.0));
vec3 towards_eye() {
  float theta = tilt + spread * (uv.x - 0.5);
  return normalize(tilt == 0.0 ? vec3(uv - 0.5, 0.4) : vec3(sin(theta), spread * (uv.y - 0.5), cos(theta)));
}
// The mean over the lights of what a renderer makes of each.
#define SUM_LIGHTS(value)                         \
  {                                               \
    vec3 sum = vec3(0.0);                         \
    for (int light = 0; light < LIGHTS; ++light) { \
      vec3 wi = normalize(kLights[light]);        \
      sum += value;                               \
    }                                             \
    SHOW(sum * (1.0 / float(LIGHTS)));            \
  }
)";

const char kLodenMain[] = R"(
void main() {
  vec3 wo = towards_eye();
  LodenMaterial m = loden_material_default();
  vec2 x = uv * periods;
  LodenHit h = loden_find_hit(m, x, dFdx(x), dFdy(x), wo);
  SUM_LIGHTS(loden_evaluate(m, h, wi, wo));
})";

// Linear steps down the view ray until it is below the height map, then bisections between the last two.
const char kMarchMain[] = R"(
// Depth below the plane, as a share of depth_range.
layout(binding = LODEN_MAX_UNITS) uniform sampler2D height_map;
uniform float depth_range;
void main() {
  vec3 wo = towards_eye();
  LodenMaterial m = loden_material_default();
  vec2 x = uv * periods, shift = -wo.xy / wo.z * depth_range;
  float lambda = max(loden_lambda_from_footprint(dFdx(x), dFdy(x)), 0.0);
  float above = 0.0, below = 1.0;
  int taken = 0;
  do {
    below = float(taken + 1) / float(STEPS);
    LODEN_COUNT(LODEN_MAX_UNITS, 1);
    if (textureLod(height_map, x + shift * below, lambda).r <= below) break;
    above = below;
  } while (++taken < STEPS);
  for (int i = 0; i < BISECTIONS; ++i) {
    float middle = 0.5 * (above + below);
    LODEN_COUNT(LODEN_MAX_UNITS, 1);
    if (textureLod(height_map, x + shift * middle, lambda).r <= middle) below = middle; else above = middle;
  }
  LodenHit h = loden_hit_at_parameter(x, x + shift * below, lambda);
  SUM_LIGHTS(loden_evaluate(m, h, wi, wo));
})";

const char kTableMain[] = R"(
void main() {
  vec3 wo = towards_eye();
  vec2 x = uv * periods;
  float lambda = max(loden_lambda_from_footprint(dFdx(x), dFdy(x)), 0.0);
  SUM_LIGHTS(btf_table_value(x, lambda, wi, wo));
})";

const char kConstantMain[] = R"(
uniform vec3 constant_color;
void main() { SHOW(constant_color); })";

// By unit: bytes of the texels that one texture instruction reads there.
class FetchBytes {
 public:
  explicit FetchBytes(const Material& m) {
    for (size_t b = 0; b < m.bands.size(); ++b) {
      const bool nearest = m.bands[b].layout == TableLayout::kNearest;
      set(LODEN_UNIT_WEIGHTS + int(b), m.bands[b].weights,
          m.bands[b].filter == WeightFilter::kNearest ? 1 : 8);
      set(LODEN_UNIT_TABLE(int(m.bands.size())) + int(b), m.bands[b].table, nearest ? 1 : 8);
      if (nearest) bytes_[LODEN_UNIT_NEAREST_LIGHT] = bytes_[LODEN_UNIT_NEAREST_VIEW] = 1;  // R8
    }
    if (m.surface) {
      int unit = LODEN_UNIT_NORMAL(int(m.bands.size()));
      for (const SurfaceMapRow& row : kSurfaceMapRows)
        set(unit++, (*m.surface).*row.texture, row.first ? 8 : 4);
    }
    if (m.stored_vdim) {
      set(LODEN_UNIT_PAPER_REFERENCE, m.stored_vdim->reference, 1);
      set(LODEN_UNIT_PAPER_PACKED, m.stored_vdim->packed, 4);
    }
    bytes_[LODEN_UNIT_GEOMETRY] = 4 * 4;    // R32
    bytes_[LODEN_UNIT_VDIM_DEPTH] = 4 * 1;  // R8
    bytes_[LODEN_UNIT_VDIM_VOLUME] = 4;     // RG16
  }
  // Of textures outside the material.
  void setFree(int texel_bytes, int texels) {
    std::fill(bytes_ + LODEN_MAX_UNITS, bytes_ + kUnits, float(texel_bytes * texels));
  }
  const float* data() const { return bytes_; }

 private:
  void set(int unit, const Texture& texture, int texels) {
    bytes_[unit] = float(texelBytes(texture.format) * texels);
  }
  float bytes_[kUnits] = {};
};

// One way to draw, with a material system of its own so that its bytes can be read off.
struct Subject {
  std::string renderer, setting;
  std::unique_ptr<MaterialSystem> materials;
  MaterialId id;
  FetchBytes fetch_bytes;
  std::string main;               // of the fragment shader
  std::vector<std::string> more;  // defines beside the variant's
  bool uses_material = true;      // its bytes count
  uint64_t extra_bytes = 0;       // of textures outside the system
};

// Without and with counted fetches.
struct Programs {
  GlProgram plain, counting;
};

class Scene {
 public:
  Scene(const Device& device, const FullScreen& screen, const BakedOutput& baked, int lights)
      : device_(device), screen_(screen), baked_(baked), lights_(lights) {}

  void add(const std::string& renderer, const std::string& setting, const Material& material, Lookup lookup) {
    Subject subject = load(renderer, setting, material, lookup);
    subject.main = kLodenMain;
    subjects_.push_back(std::move(subject));
  }
  // The surface maps of `material`, read where a march over its heights ends.
  void addMarch(const std::string& renderer, int steps, int bisections, const Material& material) {
    Subject subject = load(renderer, std::to_string(steps) + " + " + std::to_string(bisections) + " steps",
                           material, Lookup::kNone);
    makeHeights(material.geometry);
    subject.main = kMarchMain;
    subject.more = {"STEPS " + std::to_string(steps), "BISECTIONS " + std::to_string(bisections)};
    subject.fetch_bytes.setFree(2, 8);  // R16, trilinear
    subject.extra_bytes = height_bytes_;
    subjects_.push_back(std::move(subject));
  }
  void addConstant(const Material& material) {
    Subject subject = load("constant colour", "mean of the truth", material, Lookup::kNone);
    subject.main = kConstantMain;
    subject.uses_material = false;
    subjects_.push_back(std::move(subject));
  }
  void addTable(const Material& material) {
    Subject subject = load("full BTF table", "81 x 81 images, 4-D interpolated", material, Lookup::kNone);
    table_.emplace(baked_);
    subject.main = std::string(kBtfTableLibrary) + kTableMain;
    subject.uses_material = false;
    subject.fetch_bytes.setFree(4, 8);  // RGB9E5, trilinear
    subject.extra_bytes = table_->bytes();
    subjects_.push_back(std::move(subject));
  }

  // The renderer named `base` gives the ratio's denominator.
  void measure(const std::string& tile, const View& view, const std::string& base,
               importer::StudyRows& rows) const;

 private:
  Subject load(const std::string& renderer, const std::string& setting, const Material& material,
               Lookup lookup) {
    Subject subject{renderer, setting, nullptr, {}, FetchBytes(material), {}, {}, true, 0};
    MaterialSystemOptions options;
    options.lookup = lookup;
    subject.materials = require(MaterialSystem::create(device_, options));
    subject.id = require(subject.materials->load(assetSource(material), renderer));
    subject.materials->demand(subject.id, 0);
    subject.materials->finishLoading();
    return subject;
  }
  // The picture's lambda is the same everywhere, as it nearly is over one object of a scene; a renderer then
  // draws with a program that leaves out what is not seen there.
  Programs compile(const Subject& subject, const View& view) const {
    const float lambda = float(view.lambda), slack = 0.01f;
    std::vector<std::string> defines =
        variantDefines(narrowed(subject.materials->variant(subject.id),
                                subject.materials->material(subject.id), {lambda - slack, lambda + slack}));
    defines.insert(defines.end(), subject.more.begin(), subject.more.end());
    defines.push_back("UNITS " + std::to_string(kUnits));
    defines.push_back("LIGHTS " + std::to_string(lights_));
    GlProgram plain = screen_.program(kCommon + subject.main, defines);
    defines.push_back("LODEN_COUNT_FETCHES 1");
    return {std::move(plain), screen_.program(kCommon + subject.main, defines)};
  }
  void makeHeights(const GeometryImage& geometry) {
    if (heights_.name()) return;
    const int side = geometry.side(), mips = fullMipCount(side, side);
    std::vector<float> depths;
    for (int t = 0; t < side * side; ++t)
      depths.push_back(1 - fetchTexel(geometry.texels, 0, t % side, t / side, 0).z);
    heights_ = makeTexture(GL_TEXTURE_2D, "heights");
    glTextureStorage2D(heights_.name(), mips, GL_R16, side, side);
    glTextureSubImage2D(heights_.name(), 0, 0, 0, side, side, GL_RED, GL_FLOAT, depths.data());
    glGenerateTextureMipmap(heights_.name());
    range_ = geometry.range.z;
    height_bytes_ = textureBytes(TexelFormat::kRG8Unorm, uint64_t(side), uint64_t(side), 1,
                                 mips);  // as many bytes as R16
  }
  void draw(const Subject& subject, const GlProgram& program, const View& view, const glm::vec3& mean,
            bool count_bytes = false) const {
    subject.materials->bind(subject.id);
    if (subject.renderer == "full BTF table")
      table_->bind();
    else if (heights_.name())
      glBindTextureUnit(LODEN_MAX_UNITS, heights_.name());
    // Location -1 of a uniform that the program does not have is ignored.
    const auto location = [&](const char* name) { return glGetUniformLocation(program.name(), name); };
    const glm::vec2 periods(onPlane(view, baked_.manifest().size, glm::dvec2(1)));
    glProgramUniform2fv(program.name(), location("periods"), 1, &periods.x);
    glProgramUniform1f(program.name(), location("tilt"), float(glm::radians(view.degrees)));
    glProgramUniform1f(program.name(), location("spread"), 0.1f);
    glProgramUniform1f(program.name(), location("depth_range"), range_);
    glProgramUniform3fv(program.name(), location("constant_color"), 1, &mean.x);
    glProgramUniform1fv(program.name(), location("fetch_bytes"), kUnits, subject.fetch_bytes.data());
    glProgramUniform1i(program.name(), location("count_bytes"), count_bytes);
    screen_.draw(program);
  }
  std::vector<glm::vec3> truth(const std::string& tile, const View& view) const;

  const Device& device_;
  const FullScreen& screen_;
  const BakedOutput& baked_;
  int lights_;
  std::vector<Subject> subjects_;
  std::optional<BtfTable> table_;
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
      const glm::dvec3 wo = towardsEye(view, (glm::dvec2(i, double(j)) + 0.5) / double(kPixels));
      glm::dvec3 sum(0);
      for (int s = 0; s < kTruthSamples * kTruthSamples; ++s) {
        const glm::dvec2 inside =
            (glm::dvec2(s % kTruthSamples, s / kTruthSamples) + 0.4871) / double(kTruthSamples);
        const auto hit = tracer.intersectView(
            onPlane(view, baked_.manifest().size, (glm::dvec2(i, double(j)) + inside) / double(kPixels)), wo);
        for (int light = 0; hit && light < lights_; ++light)
          sum += importer::shadeHit(tracer, *hit, kLights[light], wo, 0, 0);
      }
      pixels[j * kPixels + size_t(i)] = glm::vec3(sum / double(kTruthSamples * kTruthSamples * lights_));
    }
  });
  return pixels;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

struct Fetches {
  double mean = 0;     // per pixel
  double slowest = 0;  // of the pixel that issues most in each block, mean over the blocks
};
Fetches countFetches(const std::vector<glm::vec4>& pixels) {
  static_assert(kPixels % kBlockWidth == 0 && kPixels % kBlockHeight == 0);
  constexpr int kAcross = kPixels / kBlockWidth, kBlocks = kAcross * (kPixels / kBlockHeight);
  std::vector<float> most(kBlocks);
  Fetches fetches;
  for (int j = 0; j < kPixels; ++j)
    for (int i = 0; i < kPixels; ++i) {
      const float count = pixels[size_t(j) * kPixels + size_t(i)].w;
      float& block = most[size_t(j / kBlockHeight * kAcross + i / kBlockWidth)];
      block = std::max(block, count);
      fetches.mean += double(count) / double(pixels.size());
    }
  for (const float count : most) fetches.slowest += double(count) / kBlocks;
  return fetches;
}

void Scene::measure(const std::string& tile, const View& view, const std::string& base,
                    importer::StudyRows& rows) const {
  const std::vector<glm::vec3> expected = truth(tile, view);
  glm::dvec3 mean(0);
  for (const glm::vec3& pixel : expected) mean += glm::dvec3(pixel) / double(expected.size());
  std::vector<Programs> programs;
  for (const Subject& subject : subjects_) programs.push_back(compile(subject, view));
  std::vector<std::function<void()>> tasks;
  for (size_t i = 0; i < subjects_.size(); ++i)
    tasks.push_back([&, mean, i] { draw(subjects_[i], programs[i].plain, view, glm::vec3(mean)); });
  const std::vector<double> ms = interleavedMedians(tasks, kRounds);
  double base_ms = 0;
  for (size_t i = 0; i < subjects_.size(); ++i)
    if (subjects_[i].renderer == base) base_ms = ms[i];
  for (size_t i = 0; i < subjects_.size(); ++i) {
    const Subject& subject = subjects_[i];
    std::vector<glm::vec3> got;
    double bytes = 0;
    draw(subject, programs[i].counting, view, glm::vec3(mean), true);
    for (const glm::vec4& pixel : screen_.read()) bytes += double(pixel.w);
    draw(subject, programs[i].counting, view, glm::vec3(mean));
    const std::vector<glm::vec4> counted = screen_.read();
    for (const glm::vec4& pixel : counted) got.emplace_back(pixel);
    const Fetches fetches = countFetches(counted);
    importer::ErrorSums error;
    error.add(expected, got);
    importer::StudyRow row;
    row.set("scene", tile + " at " + number(view.lambda) + ", " + number(view.degrees) + " degrees");
    row.set("lambda", view.lambda).set("degrees", view.degrees);
    row.set("renderer", subject.renderer).set("setting", subject.setting);
    row.set("ms_median", ms[i])
        .set("ratio_to_normal_map", ms[i] / base_ms)
        .set("fetches_per_pixel", fetches.mean)
        .set("fetches_slowest", fetches.slowest);
    row.set("bytes_per_pixel", bytes / double(expected.size()));
    row.set("gpu_bytes", (subject.uses_material ? subject.materials->stats().resident_bytes : uint64_t{0}) +
                             subject.extra_bytes);
    row.set("flip", importer::flip(expected, got, kPixels, kPixels).mean)
        .set("rmse", error.y().rmse)
        .set("psnr_db", error.psnr());
    rows.push_back(std::move(row));
  }
}

struct Arguments {
  importer::StudyOptions study;
  std::vector<double> lambdas, degrees{0};
  std::vector<std::string> only;  // parts of renderers' names; empty: all
  int lights = 1;
  std::filesystem::path assets;
  std::string json, csv, command = "bench_time_error";
  bool print_json = false;

  bool wants(std::string_view renderer) const {
    return only.empty() || std::any_of(only.begin(), only.end(), [&](const std::string& part) {
             return renderer.find(part) != std::string_view::npos;
           });
  }
};

// What `make` cooks, or what an earlier run with the same folder cooked.
template <class Make>
Material kept(const Arguments& arguments, const std::string& name, Make make) {
  if (arguments.assets.empty()) return make();
  const std::filesystem::path path = arguments.assets / (name + ".loden");
  if (std::filesystem::exists(path)) return require(readAsset(path));
  Material material = make();
  std::filesystem::create_directories(arguments.assets);
  if (const Status status = writeAsset(material, path); !status) fail(status.issue());
  return material;
}

Material cooked(const BakedOutput& baked, Mode mode, importer::Preset preset,
                std::optional<Visibility> visibility = {}) {
  importer::CookOptions options;
  if (visibility) options.visibility = *visibility;
  options.mode = mode;
  options.preset = preset;
  options.quiet = true;
  return require(importer::cook(baked, options));
}

Material smallestFused(const BakedOutput& baked) {
  const auto source = require(importer::bakedSource(baked));
  const auto btf = require(importer::loadYcc(*source, 0));
  const importer::FusedPlan plan = importer::smallestPlan(baked.manifest().geometry_size);
  return importer::fitFused(*source, btf, require(importer::geometryOf(baked, plan.geometry_side)), plan, 0)
      .material;
}

void measureTile(const Device& device, const FullScreen& screen, const Arguments& arguments,
                 const std::string& tile, importer::StudyRows& rows) {
  const BakedOutput baked = require(importer::studyBake(arguments.study, tile));
  using importer::Preset;
  const auto asset = [&](const char* name, auto make) { return kept(arguments, tile + "-" + name, make); };
  const Material surface = asset("surface", [&] { return cooked(baked, Mode::kSurface, Preset::kGame); });
  Material maps = surface;
  maps.surface->tail_mip = 0;  // other renderers hold no leading part beside the whole
  maps.surface->visibility = Visibility::kNone;
  Material without_geometry = maps;
  without_geometry.geometry = {};
  Scene scene(device, screen, baked, arguments.lights);
  const std::string base = "normal map";
  if (arguments.wants("constant colour")) scene.addConstant(without_geometry);
  scene.add(base, "diffuse, normal, specular at x", without_geometry, Lookup::kNone);
  if (baked.manifest().identity_parameterization) {
    if (arguments.wants("parallax occlusion mapping")) {
      scene.addMarch("parallax occlusion mapping", 8, 4, maps);
      scene.addMarch("parallax occlusion mapping", 16, 5, maps);
    }
    if (arguments.wants("relief mapping")) scene.addMarch("relief mapping", 32, 6, maps);
  }
  if (arguments.wants("Flat-BTF, as published")) {
    Material paper = asset("paper", [&] { return cooked(baked, Mode::kSurface, Preset::kSeed); });
    paper.geometry = {};
    paper.surface->tail_mip = 0;
    scene.add("Flat-BTF, as published", "latlong 16x16, blended", paper, Lookup::kPaper);
  }
  const int size = baked.manifest().size;
  if (arguments.wants("full BTF table") && (size & (size - 1)) == 0)
    scene.addTable(without_geometry);  // its mips are 2 x 2 means
  if (arguments.wants("LOD-BTF, as published"))
    scene.add("LOD-BTF, as published", "8,2,2 components, 32 bit",
              asset("published", [&] { return cooked(baked, Mode::kLod, Preset::kSeed); }), Lookup::kNone);
  if (arguments.wants("Loden, lod"))
    scene.add("Loden, lod", "16 components, 8 bit",
              asset("lod", [&] { return cooked(baked, Mode::kLod, Preset::kGame); }), Lookup::kNone);
  if (arguments.wants("Loden, surface")) {
    scene.add("Loden, surface", "fast lookup", maps, Lookup::kFast);
    scene.add("Loden, surface", "default lookup", maps, Lookup::kDefault);
  }
  if (arguments.wants("Loden, fused")) {
    const Material fused = asset("fused", [&] { return cooked(baked, Mode::kFused, Preset::kGame); });
    scene.add("Loden, fused", "fast lookup", fused, Lookup::kFast);
    scene.add("Loden, fused", "default lookup", fused, Lookup::kDefault);
    scene.add("Loden, fused", "fast lookup, shadows by map",
              asset("mapped", [&] { return cooked(baked, Mode::kFused, Preset::kGame, Visibility::kMap); }),
              Lookup::kFast);
  }
  if (arguments.wants("Loden, smallest"))
    scene.add("Loden, smallest", "bands alone, fast lookup",
              asset("smallest", [&] { return smallestFused(baked); }), Lookup::kFast);
  for (const double degrees : arguments.degrees)
    for (const double lambda : arguments.lambdas) scene.measure(tile, {lambda, degrees}, base, rows);
}

constexpr const char* kUsage =
    "bench_time_error [--tile NAME,...] [--lambda L,...] [--degrees D,...] [--lights 1..4] [--only "
    "TEXT,...]\n"
    "       [--size N] [--bakes FOLDER] [--assets FOLDER] [--json FILE] [--csv FILE] [--format text|json]\n"
    "       [--threads N] [--command TEXT] [-q]\n"
    "--only takes renderers whose name contains one of the texts, beside the normal map; --assets keeps "
    "what\n"
    "is cooked there, and takes what is there already; TEXT of --command stands in the JSON as what was "
    "typed";

[[noreturn]] void usage(const std::string& wrong) {
  std::fprintf(stderr, "bench_time_error: %s\nusage: %s\n", wrong.c_str(), kUsage);
  std::exit(1);
}

std::vector<std::string> splitAtCommas(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

std::vector<double> numbers(const std::string& option, const std::string& text, double least, double most) {
  std::vector<double> values;
  for (const std::string& part : splitAtCommas(text)) {
    char* end = nullptr;
    values.push_back(std::strtod(part.c_str(), &end));
    if (part.empty() || *end != '\0' || !(values.back() >= least && values.back() <= most))
      usage(option + ": '" + part + "' is no number of " + std::to_string(least) + " to " +
            std::to_string(most));
  }
  return values;
}

// A whole number in [least, most].
int wholeNumber(const std::string& option, const std::string& text, int least, int most) {
  char* end = nullptr;
  const long value = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end != '\0' || value < least || value > most)
    usage(option + ": '" + text + "' is not " + std::to_string(least) + " to " + std::to_string(most));
  return static_cast<int>(value);
}

Arguments parseArguments(int argc, char** argv) {
  Arguments all;
  all.study.bakes = "out/studies/bakes";
  all.study.tiles.clear();
  std::string command;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    all.command += " " + option;
    if (option == "-q") {
      all.study.quiet = true;
      continue;
    }
    if (++i == argc) usage(option + " is unknown, or needs a value");
    const std::string value = argv[i];
    all.command += " " + value;
    if (option == "--tile")
      all.study.tiles = splitAtCommas(value);
    else if (option == "--lambda")
      all.lambdas = numbers(option, value, -8, 8);
    else if (option == "--degrees")
      all.degrees = numbers(option, value, 0, 80);
    else if (option == "--lights")
      all.lights = wholeNumber(option, value, 1, kMostLights);
    else if (option == "--only")
      all.only = splitAtCommas(value);
    else if (option == "--assets")
      all.assets = value;
    else if (option == "--size")
      all.study.size = wholeNumber(option, value, 4, 256);
    else if (option == "--threads")
      all.study.threads = wholeNumber(option, value, 0, 1024);
    else if (option == "--bakes")
      all.study.bakes = value;
    else if (option == "--json")
      all.json = value;
    else if (option == "--csv")
      all.csv = value;
    else if (option == "--command")
      command = value;
    else if (option == "--format" && (value == "text" || value == "json"))
      all.print_json = value == "json";
    else
      usage(option + " " + value + " is unknown");
  }
  if (all.study.tiles.empty()) all.study.tiles = {"button", "isba", "pulli", "sponge"};
  if (all.lambdas.empty()) all.lambdas = {0, 2, 4};
  if (!command.empty()) all.command = command;
  return all;
}

void write(const std::string& path, const std::string& text) {
  if (path.empty()) return;
  if (const Status status = writeFileAtomically(path, std::as_bytes(std::span(text))); !status) {
    std::fprintf(stderr, "%s: %s\n", status.issue().where.c_str(), status.issue().text.c_str());
    std::exit(2);
  }
}

}  // namespace

int main(int argc, char** argv) {
  answerHelp(argc, argv, kUsage);
  const Arguments arguments = parseArguments(argc, argv);
  const std::unique_ptr<Device> device = makeDevice();
  const FullScreen screen({kPixels, kPixels});
  importer::StudyRows rows;
  for (const std::string& tile : arguments.study.tiles) measureTile(*device, screen, arguments, tile, rows);
  const std::string json =
      importer::studyJson({"time-error", "run time against error", nullptr}, arguments.command, rows);
  write(arguments.json, json);
  write(arguments.csv, importer::studyCsv(rows));
  if (arguments.print_json)
    std::printf("%s", json.c_str());
  else
    std::printf("# bench_time_error: %d x %d pixels, %d light(s), median of %d interleaved frames, %s\n%s",
                kPixels, kPixels, arguments.lights, kRounds, device->capabilities().renderer.c_str(),
                importer::studyTable(rows).c_str());
  return std::fflush(stdout) == 0 ? 0 : 2;
}
