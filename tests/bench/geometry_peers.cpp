#include "tests/bench/geometry_peers.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "importer/tile/tile.h"

namespace loden::bench {

using namespace runtime;

namespace {

// project(at): where the picture shows a point of tile coordinates, for the periods that an instance covers.
// From straight above the eye is a pinhole and that place is found by one division of matrices; a tilted eye
// is so distant that Newton's method needs three steps.
const std::string kProject = std::string("layout(location = 0) out vec2 uv;") + kPlaneView + R"(
uniform vec2 periods_per_length;
uniform ivec2 first_period;
uniform int periods_across;
uniform float deepest;  // tile lengths, < 0
vec2 period() {
  return vec2(first_period + ivec2(gl_InstanceID % periods_across, gl_InstanceID / periods_across));
}
// What the picture shows at uv, seen past the depth z, less `at`.
vec2 off(vec3 at) {
  vec3 wo = towards_eye();
  return plane_point() + wo.xy / wo.z * at.z * periods_per_length - at.xy;
}
void project(vec3 at) {
  if (tilt == 0.0) {
    mat2 slope = mat2(turn, -turn.y, turn.x) * (at.z / 0.4);
    slope = mat2(slope[0] * periods_per_length, slope[1] * periods_per_length);
    uv = inverse(plane_periods + slope) * (at.xy - plane_corner - plane_periods * vec2(0.5)) + 0.5;
  } else {
    uv = vec2(0.5);
    const float step_ = 1e-2;
    for (int i = 0; i < 3; ++i) {
      vec2 here = off(at);
      uv.x += step_;
      vec2 right = off(at);
      uv += vec2(-step_, step_);
      vec2 up = off(at);
      uv.y -= step_;
      uv -= inverse(mat2(right - here, up - here)) * here * step_;
    }
  }
  gl_Position = vec4(uv * 2.0 - 1.0, at.z / deepest * 1.9 - 0.95, 1.0);
}
)";

// The periods that a view sees any of, between the plane and a depth.
struct Periods {
  glm::ivec2 first{0}, count{0};
  explicit Periods(const PlaneView& view, double deepest, double overhang) {
    glm::dvec2 low(INFINITY), high(-INFINITY);
    for (const double z : {0.0, deepest})
      for (int corner = 0; corner < 4; ++corner) {
        const glm::dvec2 uv(corner & 1, corner >> 1);
        const glm::dvec3 wo = towardsEye(view, uv);
        const glm::dvec2 at = onPlane(view, uv) + glm::dvec2(wo) / wo.z * z * periodsPerLength(view.aspect);
        low = glm::min(low, at), high = glm::max(high, at);
      }
    first = glm::ivec2(glm::floor(low - overhang));
    count = glm::ivec2(glm::floor(high + overhang)) - first + 1;
  }
};

// With the program's uniforms of kProject; depth-tested, over black.
template <class Draw>
void drawPeriods(const PlaneView& view, double deepest, double overhang, bool cull, Draw draw) {
  GLint program = 0, array = 0;
  glGetIntegerv(GL_CURRENT_PROGRAM, &program);
  glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &array);
  const auto name = static_cast<GLuint>(program);
  const auto location = [&](const char* uniform) { return glGetUniformLocation(name, uniform); };
  const Periods periods(view, deepest, overhang);
  const glm::vec2 scale(periodsPerLength(view.aspect));
  glProgramUniform2fv(name, location("periods_per_length"), 1, &scale.x);
  glProgramUniform2iv(name, location("first_period"), 1, &periods.first.x);
  glProgramUniform1i(name, location("periods_across"), periods.count.x);
  glProgramUniform1f(name, location("deepest"), float(deepest));
  const float black[4] = {}, far = 1;
  glEnable(GL_DEPTH_TEST);
  if (cull) glEnable(GL_CULL_FACE);
  glClearBufferfv(GL_COLOR, 0, black);
  glClearBufferfv(GL_DEPTH, 0, &far);
  draw(periods.count.x * periods.count.y);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(static_cast<GLuint>(array));
}

// --- the tile's own surface --------------------------------------------------------------------------------

const std::string kMeshVertex = kProject + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 parameter_of_vertex;
layout(location = 1) out vec2 parameter;
void main() {
  parameter = parameter_of_vertex;
  project(position + vec3(period(), 0.0));
})";

const char kMeshMain[] = R"(
layout(location = 1) in vec2 parameter;
void main() {
  vec3 wo = towards_eye();
  LodenPoint m = loden_point_default();
  vec2 x = plane_point();
  float lambda = max(loden_lambda_from_footprint(dFdx(x), dFdy(x)), 0.0);
  LodenHit h = loden_hit_at_parameter(x, parameter, lambda);
  SUM_LIGHTS(loden_evaluate(h, wi, wo));
})";

class TileMesh {
 public:
  explicit TileMesh(const importer::Tile& tile) : array_(makeVertexArray("tile mesh")) {
    std::vector<float> vertices;
    for (size_t k = 0; k < tile.positions.size(); ++k) {
      const glm::dvec3& p = tile.positions[k];
      for (const double value : {p.x, p.y, p.z, tile.params[k].x, tile.params[k].y})
        vertices.push_back(float(value));
      deepest_ = std::min(deepest_, p.z);
      for (const double reach : {-p.x, -p.y, p.x - 1, p.y - 1}) overhang_ = std::max(overhang_, reach);
    }
    const auto bytes_of = [](const auto& values) { return std::as_bytes(std::span(values)); };
    vertices_ = makeBuffer(bytes_of(vertices).size(), bytes_of(vertices), 0, "tile vertices");
    triangles_ = makeBuffer(bytes_of(tile.triangles).size(), bytes_of(tile.triangles), 0, "tile triangles");
    indices_ = GLsizei(3 * tile.triangles.size());
    bytes_ = bytes_of(vertices).size() + bytes_of(tile.triangles).size();
    const GLuint array = array_.name();
    glVertexArrayVertexBuffer(array, 0, vertices_.name(), 0, 5 * sizeof(float));
    glVertexArrayElementBuffer(array, triangles_.name());
    for (const GLuint attribute : {0u, 1u}) {
      glEnableVertexArrayAttrib(array, attribute);
      glVertexArrayAttribBinding(array, attribute, 0);
      glVertexArrayAttribFormat(array, attribute, attribute ? 2 : 3, GL_FLOAT, GL_FALSE,
                                attribute ? 3 * sizeof(float) : 0);
    }
  }
  void draw(const PlaneView& view) const {
    drawPeriods(view, deepest_, overhang_, false, [this](int count) {
      glBindVertexArray(array_.name());
      glDrawElementsInstanced(GL_TRIANGLES, indices_, GL_UNSIGNED_INT, nullptr, count);
    });
  }
  uint64_t bytes() const { return bytes_; }

 private:
  GlVertexArray array_;
  GlBuffer vertices_, triangles_;
  GLsizei indices_ = 0;
  uint64_t bytes_ = 0;
  double deepest_ = -1e-6, overhang_ = 0;  // by how much the mesh leaves [0,1]^2
};

// By cells per side of a period; of a file one alone.
class TileMeshes {
 public:
  explicit TileMeshes(const std::string& tile) {
    constexpr std::string_view kBuiltin = "builtin:";
    if (!tile.starts_with(kBuiltin)) {
      meshes_.try_emplace(kLeastCells, require(importer::loadTile(tile)));
    } else {
      for (int cells = kLeastCells; cells <= kMostCells; cells *= 2)
        meshes_.try_emplace(cells, require(importer::builtinTile(tile.substr(kBuiltin.size()), cells)));
    }
    for (const auto& [cells, mesh] : meshes_) bytes_ += mesh.bytes();
  }
  // At least as many cells as pixels.
  void draw(const PlaneView& view) const {
    auto finest = meshes_.lower_bound(int(std::ceil(view.texels / std::exp2(view.lambda) - 1e-6)));
    if (finest == meshes_.end()) --finest;
    finest->second.draw(view);
  }
  uint64_t bytes() const { return bytes_; }

 private:
  static constexpr int kLeastCells = 4, kMostCells = 128;
  std::map<int, TileMesh> meshes_;
  uint64_t bytes_ = 0;
};

// --- a shell of prisms -------------------------------------------------------------------------------------

// Top and four sides of a period, two triangles each, counter-clockwise from outside.
const std::string kShellVertex = kProject + R"(
layout(location = 1) flat out vec2 prism;
const vec2 kRing[5] = vec2[](vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 1), vec2(0, 0));
const int kCorner[6] = int[](0, 1, 2, 0, 2, 3);
void main() {
  int face = gl_VertexID / 6, corner = kCorner[gl_VertexID % 6];
  bool bottom = face < 4 && corner < 2;
  vec2 at = face == 4 ? kRing[corner] : kRing[face + (corner == 1 || corner == 2 ? 1 : 0)];
  prism = period();
  project(vec3(prism + at, bottom ? deepest : 0.0));
})";

const char kShellMain[] = R"(
layout(binding = FREE_UNIT) uniform sampler2D height_map;  // depth as a share of depth_range
uniform vec2 depth_range;
layout(location = 1) flat in vec2 prism;
void main() {
  vec3 wo = towards_eye();
  LodenPoint m = loden_point_default();
  vec2 x = plane_point(), shift = -wo.xy / wo.z * depth_range;
  shift += vec2(lessThan(abs(shift), vec2(1e-6))) * 1e-6;
  float lambda = max(loden_lambda_from_footprint(dFdx(x), dFdy(x)), 0.0);
  vec2 a = (prism - x) / shift, b = (prism + 1.0 - x) / shift;
  vec2 near = min(a, b), far = max(a, b);
  float enter = max(max(near.x, near.y), 0.0), leave = min(min(far.x, far.y), 1.0);
  float above = enter, below = enter;
  bool hit = false;
  do {
    LODEN_COUNT(FREE_UNIT, 1);
    hit = textureLod(height_map, x + shift * below, lambda).r <= below;
    if (hit || below >= leave) break;
    above = below;
    below = min(below + 1.0 / float(STEPS), leave);
  } while (true);
  if (!hit) discard;
  for (int i = 0; i < BISECTIONS; ++i) {
    float middle = 0.5 * (above + below);
    LODEN_COUNT(FREE_UNIT, 1);
    if (textureLod(height_map, x + shift * middle, lambda).r <= middle) below = middle; else above = middle;
  }
  LodenHit h = loden_hit_at_parameter(x, x + shift * below, lambda);
  SUM_LIGHTS(loden_evaluate(h, wi, wo));
})";

}  // namespace

TileRenderer meshRenderer(const Device& device, const std::string& tile, const Material& material) {
  TileRenderer renderer = loadRenderer(device, "displaced mesh", "a cell a pixel", material, Lookup::kNone);
  const auto meshes = std::make_shared<const TileMeshes>(tile);
  renderer.main = kMeshMain;
  renderer.vertex = kMeshVertex;
  renderer.extra_bytes = meshes->bytes();
  renderer.draw = [meshes](const PlaneView& view) { meshes->draw(view); };
  return renderer;
}

TileRenderer shellRenderer(const Device& device, int steps, int bisections, const Material& material,
                           std::shared_ptr<const HeightMap> heights) {
  TileRenderer renderer = marchRenderer(device, "parallax occlusion mapping in a shell", steps, bisections,
                                        material, std::move(heights));
  renderer.main = kShellMain;
  renderer.vertex = kShellVertex;
  const double deepest = -double(material.geometry.range.z);
  renderer.draw = [deepest](const PlaneView& view) {
    drawPeriods(view, deepest, 0, true, [](int count) { glDrawArraysInstanced(GL_TRIANGLES, 0, 30, count); });
  };
  return renderer;
}

}  // namespace loden::bench
