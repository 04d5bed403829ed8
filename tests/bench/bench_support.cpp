#include "tests/bench/bench_support.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <random>

#include "material/base/exit_code.h"
#include "runtime/shader/shader_library.h"

namespace loden::bench {
namespace {

using namespace runtime;

constexpr int kSide = 64;

Texture noise(TexelFormat format, TextureShape shape, int width, int height, int depth, int mips,
              uint32_t seed) {
  Texture texture = Texture::make(format, shape, width, height, depth, mips);
  std::mt19937 random(seed);
  const bool floats = format == TexelFormat::kRGBA32Sfloat;
  if (!floats) {
    for (std::byte& byte : texture.data) byte = std::byte(random() & 0x7f);
    return texture;
  }
  float* values = reinterpret_cast<float*>(texture.data.data());
  for (size_t i = 0; i < texture.data.size() / sizeof(float); ++i)
    values[i] = float(random() & 0xffff) / 65536.0f;
  return texture;
}

Material plain(Mode mode, const char* name) {
  Material material;
  material.mode = mode;
  material.name = name;
  material.side = kSide;
  material.mean = {0.01f, 0.5f, 0.2f, 12, 0.01f, -0.02f, MeanChroma::kRatio};
  material.meta_json = "{}";
  return material;
}

Band gridBand(Domain domain, uint32_t seed) {
  const bool flat = domain == Domain::kFlat;
  Band band;
  band.domain = domain;
  band.y_quads = 4;
  band.chroma_quads = flat ? 0 : 1;
  band.ratio = flat;
  band.lambda_first = flat ? 0.0f : 1.0f;
  band.window = flat ? Window{-2, -1, 1, 2} : Window{1, 2, 1e4f, 2e4f};
  band.quad_scale.assign(size_t(band.quads()), glm::vec4(0.05f));
  band.quad_levels.assign(size_t(band.quads()), {});
  const int side = flat ? kSide : kSide / 2;
  band.weights = noise(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, side, side, band.layers(),
                       flat ? 1 : fullMipCount(side, side), seed);
  const DirectionGrid grid;
  band.table = noise(TexelFormat::kRGBA8Snorm, TextureShape::kVolume, grid.phis, grid.thetas * grid.thetas,
                     band.quads() * grid.phis, 1, seed + 1);
  return band;
}

const ShaderText kVertex{"full_screen.vert", R"(
layout(location = 0) out vec2 uv;
void main() {
  uv = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
  gl_Position = vec4(uv * 2.0 - 1.0, 0.0, 1.0);
})"};

}  // namespace

Material lodMaterial(uint32_t seed) {
  Material material = plain(Mode::kLod, "lod");
  material.lambda_max = 4;
  material.lights = material.views = bonn81Directions();
  for (int level = 0; level < 5; ++level) {
    Band band;
    band.filter = WeightFilter::kNearest;
    band.layout = TableLayout::kNearest;
    band.window = {-2, -1, float(level), float(level + 1)};
    band.lambda_first = float(level);
    band.y_quads = 2;
    band.chroma_quads = 1;
    band.quad_scale.assign(3, glm::vec4(0.05f));
    band.quad_levels.resize(3);
    const uint32_t band_seed = seed + 10 * uint32_t(level);
    band.weights = noise(TexelFormat::kRGBA32Sfloat, TextureShape::kArray2D, kSide >> level, kSide >> level,
                         3, 1, band_seed);
    band.table = noise(TexelFormat::kRGBA32Sfloat, TextureShape::kVolume, 81, 81, 3, 1, band_seed + 1);
    material.bands.push_back(std::move(band));
  }
  return material;
}

Material fusedMaterial(uint32_t seed) {
  Material material = plain(Mode::kFused, "fused");
  material.lambda_max = 6;
  material.geometry = wavyGeometry(2 * kSide);
  material.bands.push_back(gridBand(Domain::kFlat, seed));
  material.bands.push_back(gridBand(Domain::kReference, seed + 5));
  return material;
}

Material surfaceMaterial(uint32_t seed) {
  Material material = plain(Mode::kSurface, "surface");
  material.lambda_max = 6;
  material.geometry = wavyGeometry(2 * kSide);
  const int mips = fullMipCount(2 * kSide, 2 * kSide);
  SurfaceMaps maps;
  maps.normal = noise(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, 2 * kSide, 2 * kSide, 1, mips, seed);
  maps.color =
      noise(TexelFormat::kRGBA8Unorm, TextureShape::kArray2D, 2 * kSide, 2 * kSide, 1, mips, seed + 1);
  maps.ambient =
      noise(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, 2 * kSide, 2 * kSide, 2, mips, seed + 2);
  material.surface = std::move(maps);
  return material;
}

GeometryImage wavyGeometry(int side) {
  std::vector<glm::dvec3> positions;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const glm::dvec2 p = (glm::dvec2(x, y) + 0.5) / double(side);
      const double height = std::cos(4 * kPi * p.x) * std::cos(4 * kPi * p.y);
      positions.emplace_back(p, 0.05 * (height - 1));
    }
  const std::vector<uint16_t> charts(positions.size(), 1);
  return encodeGeometryImage(side, positions, charts, true);
}

void answerHelp(int argc, char** argv, const char* usage) {
  for (int i = 1; i < argc; ++i)
    if (!std::strcmp(argv[i], "--help") || !std::strcmp(argv[i], "-h"))
      std::printf("usage: %s\n", usage), std::exit(0);
  if (argc > 1 && !std::strchr(usage, ' ')) std::fprintf(stderr, "usage: %s\n", usage), std::exit(1);
}

std::unique_ptr<Device> makeDevice() {
  setenv("LP_NUM_THREADS", "0", 0);
  DeviceOptions options;
  options.log = [](const Issue& issue) {
    std::fprintf(stderr, "%s: %s\n", issue.where.c_str(), issue.text.c_str());
  };
  return require(Device::create(options));
}

std::shared_ptr<const ByteSource> assetSource(const Material& material) {
  return memorySource(require(serializeAsset(material)), material.name);
}

FullScreen::FullScreen(glm::ivec2 size)
    : target_(require(makeRenderTarget(size, ColorFormat::kLinear32, "bench"))),
      array_(makeVertexArray("bench")) {
  glBindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer.name());
  glViewport(0, 0, size.x, size.y);
  glBindVertexArray(array_.name());
}

// A program that is deleted while in use would be found, and could not be restored, by whoever draws next.
FullScreen::~FullScreen() {
  glUseProgram(0);
}

GlProgram FullScreen::program(const std::string& fragment, std::span<const std::string> defines,
                              const std::string& vertex) const {
  const ShaderText own{"bench.vert", vertex};
  return require(compileProgram(vertex.empty() ? kVertex : own, {"bench.frag", fragment}, defines, "bench"));
}

void FullScreen::draw(const GlProgram& program) const {
  glUseProgram(program.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

const char kMaterialFragment[] = R"(
#include "loden_material.glsl"
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;
layout(location = 0) uniform vec2 lambda;
void main() {
  vec3 wi = normalize(vec3(0.3, 0.2, 1.0)), wo = normalize(vec3(uv - 0.5, 0.6));
  LodenPoint m = loden_point_default();
#ifdef FULL_PARALLAX
  m.skip_parallax = false;
#endif
  LodenHit h = loden_find_hit_at(m, uv * 5.0, mix(lambda.x, lambda.y, uv.y), wo);
  color = vec4(loden_evaluate(h, wi, wo), 0.0);
#ifdef LODEN_COUNT_FETCHES
  color.w = float(loden_fetches);
#endif
})";

void drawAt(const FullScreen& screen, const GlProgram& program, glm::vec2 lambda) {
  glProgramUniform2f(program.name(), 0, lambda.x, lambda.y);
  screen.draw(program);
}

double meanFetches(const FullScreen& screen, const GlProgram& program, glm::vec2 lambda) {
  drawAt(screen, program, lambda);
  double sum = 0;
  const std::vector<glm::vec4> pixels = screen.read();
  for (const glm::vec4& pixel : pixels) sum += pixel.w;
  return sum / double(pixels.size());
}

namespace {

// Whether the driver draws on the processor, whose time is then the picture's.
bool drawsOnProcessor() {
  const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  return renderer && (std::strstr(renderer, "llvmpipe") || std::strstr(renderer, "softpipe"));
}

double processorMs() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

double msOf(const std::function<void()>& task, bool on_processor) {
  glFinish();
  if (on_processor) {
    const double start = processorMs();
    task();
    glFinish();
    return processorMs() - start;
  }
  GLuint query = 0;
  glGenQueries(1, &query);
  glBeginQuery(GL_TIME_ELAPSED, query);
  task();
  glEndQuery(GL_TIME_ELAPSED);
  GLuint64 nanoseconds = 0;
  glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
  glDeleteQueries(1, &query);
  return double(nanoseconds) * 1e-6;
}

}  // namespace

std::vector<double> interleavedMedians(const std::vector<std::function<void()>>& tasks, int rounds) {
  constexpr int kWarmUp = 2;
  const bool on_processor = drawsOnProcessor();
  std::vector<std::vector<double>> times(tasks.size());
  for (int round = -kWarmUp; round < rounds; ++round)
    for (size_t i = 0; i < tasks.size(); ++i) {
      const double ms = msOf(tasks[i], on_processor);
      if (round >= 0) times[i].push_back(ms);
    }
  std::vector<double> medians;
  for (std::vector<double>& t : times) {
    std::nth_element(t.begin(), t.begin() + ptrdiff_t(t.size() / 2), t.end());
    medians.push_back(t[t.size() / 2]);
  }
  return medians;
}

void fail(const Issue& issue) {
  std::fprintf(stderr, "%s: %s\n", issue.where.c_str(), issue.text.c_str());
  std::exit(exitCodeOf(issue));
}

}  // namespace loden::bench
