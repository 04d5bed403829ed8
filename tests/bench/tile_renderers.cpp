#include "tests/bench/tile_renderers.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>

#include "runtime/stream/shader_variants.h"

namespace loden::bench {

using namespace runtime;

const char kPlaneView[] = R"(
uniform mat2 plane_periods;  // of periodsOf()
uniform vec2 plane_corner;   // of cornerOf()
uniform float tilt, spread;  // of towardsEye()
uniform vec2 turn;           // cosine and sine
vec2 plane_point() { return plane_corner + plane_periods * uv; }
vec3 towards_eye() {
  float theta = tilt + spread * (uv.x - 0.5);
  vec3 wo = tilt == 0.0 ? vec3(uv - 0.5, 0.4) : vec3(sin(theta), spread * (uv.y - 0.5), cos(theta));
  return normalize(vec3(mat2(turn, -turn.y, turn.x) * wo.xy, wo.z));
}
)";

namespace {

const std::string kFragmentHead = std::string(R"(
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;
)") + kPlaneView + R"(
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
// The mean over the lights of what a renderer makes of each; for tests the parameter that it reads.
#ifdef SHOW_PARAMETER
#define SUM_LIGHTS(value) color = vec4(h.p, 0.0, 1.0)
#else
#define SUM_LIGHTS(value)                         \
  {                                               \
    vec3 sum = vec3(0.0);                         \
    for (int light = 0; light < LIGHTS; ++light) { \
      vec3 wi = normalize(kLights[light]);        \
      sum += value;                               \
    }                                             \
    SHOW(sum * (1.0 / float(LIGHTS)));            \
  }
#endif
)";

const char kLodenMain[] = R"(
void main() {
  vec3 wo = towards_eye();
  LodenPoint m = loden_point_default();
  vec2 x = plane_point();
  LodenHit h = loden_find_hit(m, x, dFdx(x), dFdy(x), wo);
  SUM_LIGHTS(loden_evaluate(h, wi, wo));
})";

}  // namespace

FetchBytes::FetchBytes(const Material& m) {
  for (size_t b = 0; b < m.bands.size(); ++b) {
    const bool nearest = m.bands[b].layout == TableLayout::kNearest;
    set(LODEN_UNIT_WEIGHTS + int(b), m.bands[b].weights, m.bands[b].filter == WeightFilter::kNearest ? 1 : 8);
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

void FetchBytes::set(int unit, const Texture& texture, int texels) {
  bytes_[unit] = float(texelBytes(texture.format) * texels);
}

uint64_t TileRenderer::bytes() const {
  return (uses_material ? materials->stats().resident_bytes : uint64_t{0}) + extra_bytes;
}

TileRenderer loadRenderer(const Device& device, const std::string& name, const std::string& setting,
                          const Material& material, Lookup lookup) {
  TileRenderer renderer{name, setting, nullptr, {}, FetchBytes(material), {}, {}, true, 0, {}, {}, {}};
  MaterialSystemOptions options;
  options.lookup = lookup;
  renderer.materials = require(MaterialSystem::create(device, options));
  renderer.id = require(renderer.materials->load(assetSource(material), name));
  renderer.materials->demand(renderer.id, 0);
  renderer.materials->finishLoading();
  return renderer;
}

TileRenderer lodenRenderer(const Device& device, const std::string& name, const std::string& setting,
                           const Material& material, Lookup lookup) {
  TileRenderer renderer = loadRenderer(device, name, setting, material, lookup);
  renderer.main = kLodenMain;
  return renderer;
}

RendererPrograms compileRenderer(const FullScreen& screen, const TileRenderer& renderer,
                                 std::span<const PlaneView> views, int lights) {
  constexpr double kSlack = 0.01;
  double least = INFINITY, most = -INFINITY;
  for (const PlaneView& view : views) {
    least = std::min(least, askedLambda(view));
    most = std::max(most, askedLambda(view));
  }
  std::vector<std::string> defines = variantDefines(narrowed(renderer.materials->variant(renderer.id),
                                                             renderer.materials->material(renderer.id),
                                                             {float(least - kSlack), float(most + kSlack)}));
  defines.insert(defines.end(), renderer.defines.begin(), renderer.defines.end());
  defines.push_back("UNITS " + std::to_string(kUnits));
  defines.push_back("LIGHTS " + std::to_string(lights));
  const std::string fragment = kFragmentHead + renderer.main;
  GlProgram plain = screen.program(fragment, defines, renderer.vertex);
  defines.push_back("LODEN_COUNT_FETCHES 1");
  return {std::move(plain), screen.program(fragment, defines, renderer.vertex)};
}

void drawRenderer(const FullScreen& screen, const TileRenderer& renderer, const GlProgram& program,
                  const PlaneView& view, Counted counted) {
  renderer.materials->bind(renderer.id);
  // Location -1 of a uniform that the program does not have is ignored.
  const auto location = [&](const char* name) { return glGetUniformLocation(program.name(), name); };
  const glm::mat2 periods(periodsOf(view));
  const glm::vec2 corner(cornerOf(view)), turn(std::cos(view.turn), std::sin(view.turn));
  glProgramUniformMatrix2fv(program.name(), location("plane_periods"), 1, GL_FALSE, &periods[0].x);
  glProgramUniform2fv(program.name(), location("plane_corner"), 1, &corner.x);
  glProgramUniform1f(program.name(), location("tilt"), float(glm::radians(view.degrees)));
  glProgramUniform1f(program.name(), location("spread"), float(kSpread));
  glProgramUniform2fv(program.name(), location("turn"), 1, &turn.x);
  glProgramUniform1fv(program.name(), location("fetch_bytes"), kUnits, renderer.fetch_bytes.data());
  glProgramUniform1i(program.name(), location("count_bytes"), counted == Counted::kBytes);
  if (renderer.prepare) renderer.prepare(program);
  if (renderer.draw) {
    glUseProgram(program.name());
    renderer.draw(view);
  } else {
    screen.draw(program);
  }
}

}  // namespace loden::bench
