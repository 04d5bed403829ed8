#include "tests/bench/peer_renderers.h"

#include <epoxy/gl.h>

#include <cmath>

#include "importer/study/cone_map.h"

namespace loden::bench {

using namespace runtime;

namespace {

const char kMarchMain[] = R"(
// Depth below the plane, as a share of depth_range.
layout(binding = FREE_UNIT) uniform sampler2D height_map;
uniform vec2 depth_range;
void main() {
  vec3 wo = towards_eye();
  LodenPoint m = loden_point_default();
  vec2 x = plane_point(), shift = -wo.xy / wo.z * depth_range;
  float lambda = max(loden_lambda_from_footprint(dFdx(x), dFdy(x)), 0.0);
  float above = 0.0, below = 1.0;
  int taken = 0;
  do {
    below = float(taken + 1) / float(STEPS);
    LODEN_COUNT(FREE_UNIT, 1);
    if (textureLod(height_map, x + shift * below, lambda).r <= below) break;
    above = below;
  } while (++taken < STEPS);
  for (int i = 0; i < BISECTIONS; ++i) {
    float middle = 0.5 * (above + below);
    LODEN_COUNT(FREE_UNIT, 1);
    if (textureLod(height_map, x + shift * middle, lambda).r <= middle) below = middle; else above = middle;
  }
  LodenHit h = loden_hit_at_parameter(x, x + shift * below, lambda);
  SUM_LIGHTS(loden_evaluate(h, wi, wo));
})";

const char kConeMain[] = R"(
// Depth as a share of the map's range, and the root of the width of a cone of height 1, over WIDEST.
layout(binding = FREE_UNIT) uniform sampler2D cone_map;
uniform vec2 depth_range;
uniform float steepness_of_shift;
void main() {
  vec3 wo = towards_eye();
  LodenPoint m = loden_point_default();
  vec2 x = plane_point(), shift = -wo.xy / wo.z * depth_range;
  float lambda = max(loden_lambda_from_footprint(dFdx(x), dFdy(x)), 0.0);
  float steepness = length(shift) * steepness_of_shift, below = 0.0;
  for (int i = 0; i < STEPS; ++i) {
    LODEN_COUNT(FREE_UNIT, 1);
    vec2 texel = textureLod(cone_map, x + shift * below, 0.0).rg;
    float cone = WIDEST * texel.y * texel.y;
    below += max(texel.x - below, 0.0) * cone / (cone + steepness);
  }
  LodenHit h = loden_hit_at_parameter(x, x + shift * below, lambda);
  SUM_LIGHTS(loden_evaluate(h, wi, wo));
})";

const char kTableMain[] = R"(
void main() {
  vec3 wo = towards_eye();
  vec2 x = plane_point();
  float lambda = max(loden_lambda_from_footprint(dFdx(x), dFdy(x)), 0.0);
  SUM_LIGHTS(btf_table_value(x, lambda, wi, wo));
})";

const char kConstantMain[] = R"(
uniform vec3 constant_color;
void main() { SHOW(constant_color); })";

const std::string kFreeUnitDefine = "FREE_UNIT " + std::to_string(kFreeUnit);

}  // namespace

Material seenFromAbove(Material material, const importer::TileTracer& tracer) {
  if (material.geometry.identity_parameterization) return material;
  const SurfaceMaps of_tile = *material.surface;
  for (Texture SurfaceMaps::*map : {&SurfaceMaps::normal, &SurfaceMaps::color}) {
    Texture& seen = (*material.surface).*map;
    // Roots of albedo are averaged as albedo.
    const bool roots = map == &SurfaceMaps::color;
    const auto linear = [&](const Texture& texture, int mip, int x, int y) {
      const glm::vec4 texel = fetchTexel(texture, mip, x, y, 0);
      return roots ? glm::vec4(glm::vec3(texel) * glm::vec3(texel), texel.w) : texel;
    };
    const auto store = [&](int mip, int x, int y, glm::vec4 mean) {
      if (roots) mean = glm::vec4(glm::sqrt(glm::vec3(mean)), mean.w);
      storeTexel(seen, mip, x, y, 0, mean);
    };
    const int side = seen.width;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        glm::vec4 sum(0);
        for (const glm::dvec2 inside : {glm::dvec2(.26, .23), {.76, .27}, {.24, .73}, {.77, .74}})
          if (const auto hit = tracer.intersectView((glm::dvec2(x, y) + inside) / double(side), {0, 0, 1})) {
            const glm::ivec2 p(glm::min(glm::fract(hit->p) * double(side), double(side) - 1));
            sum += linear(of_tile.*map, 0, p.x, p.y) / 4.0f;
          }
        store(0, x, y, sum);
      }
    for (int mip = 1; mip < seen.mips; ++mip)
      for (int y = 0; y < side >> mip; ++y)
        for (int x = 0; x < side >> mip; ++x)
          store(mip, x, y,
                (linear(seen, mip - 1, 2 * x, 2 * y) + linear(seen, mip - 1, 2 * x + 1, 2 * y) +
                 linear(seen, mip - 1, 2 * x, 2 * y + 1) + linear(seen, mip - 1, 2 * x + 1, 2 * y + 1)) /
                    4.0f);
  }
  return material;
}

HeightMap::HeightMap(const GeometryImage& geometry) {
  const int side = geometry.side(), mips = fullMipCount(side, side);
  std::vector<float> depths;
  for (int t = 0; t < side * side; ++t)
    depths.push_back(1 - fetchTexel(geometry.texels, 0, t % side, t / side, 0).z);
  texture_ = makeTexture(GL_TEXTURE_2D, "heights");
  glTextureStorage2D(texture_.name(), mips, GL_R16, side, side);
  glTextureSubImage2D(texture_.name(), 0, 0, 0, side, side, GL_RED, GL_FLOAT, depths.data());
  glGenerateTextureMipmap(texture_.name());
  range_ = geometry.range.z * glm::vec2(periodsPerLength(geometry.aspect));
  bytes_ = textureBytes(TexelFormat::kRG8Unorm, uint64_t(side), uint64_t(side), 1, mips);  // as many as R16
}

void HeightMap::bind(const GlProgram& program) const {
  glBindTextureUnit(kFreeUnit, texture_.name());
  glProgramUniform2fv(program.name(), glGetUniformLocation(program.name(), "depth_range"), 1, &range_.x);
}

TileRenderer marchRenderer(const Device& device, const std::string& name, int steps, int bisections,
                           const Material& material, std::shared_ptr<const HeightMap> heights) {
  TileRenderer renderer =
      loadRenderer(device, name, std::to_string(steps) + " + " + std::to_string(bisections) + " steps",
                   material, Lookup::kNone);
  renderer.main = kMarchMain;
  renderer.defines = {"STEPS " + std::to_string(steps), "BISECTIONS " + std::to_string(bisections),
                      kFreeUnitDefine};
  renderer.fetch_bytes.setFree(kFreeUnit, 2, 8);  // R16, trilinear
  renderer.extra_bytes = heights->bytes();
  renderer.prepare = [heights](const GlProgram& program) { heights->bind(program); };
  return renderer;
}

TileRenderer coneRenderer(const Device& device, int steps, const Material& material) {
  const importer::ConeMap map = importer::buildConeMap(material.geometry, 0);
  constexpr float kWidest = 16;  // buildConeMap gives none that is wider
  const float range = material.geometry.range.z;
  std::vector<glm::vec2> texels;
  for (const glm::dvec2& texel : map.texels)
    texels.emplace_back(float(-texel.x) / range, std::sqrt(float(texel.y) / kWidest));
  const auto texture = std::make_shared<GlTexture>(makeTexture(GL_TEXTURE_2D, "cones"));
  glTextureStorage2D(texture->name(), 1, GL_RG16, map.side, map.side);
  glTextureSubImage2D(texture->name(), 0, 0, 0, map.side, map.side, GL_RG, GL_FLOAT, texels.data());
  glTextureParameteri(texture->name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);

  TileRenderer renderer =
      loadRenderer(device, "cone stepping", std::to_string(steps) + " steps", material, Lookup::kNone);
  renderer.main = kConeMain;
  renderer.defines = {"STEPS " + std::to_string(steps), "WIDEST " + std::to_string(kWidest), kFreeUnitDefine};
  renderer.fetch_bytes.setFree(kFreeUnit, 4, 4);  // RG16, bilinear
  renderer.extra_bytes = uint64_t(map.side) * uint64_t(map.side) * 4;
  const glm::vec2 depth_range = range * glm::vec2(periodsPerLength(map.aspect));
  renderer.prepare = [texture, depth_range, range](const GlProgram& program) {
    const auto location = [&](const char* name) { return glGetUniformLocation(program.name(), name); };
    glBindTextureUnit(kFreeUnit, texture->name());
    glProgramUniform2fv(program.name(), location("depth_range"), 1, &depth_range.x);
    glProgramUniform1f(program.name(), location("steepness_of_shift"), 1 / range);
  };
  return renderer;
}

TileRenderer constantRenderer(const Device& device, const Material& material,
                              std::shared_ptr<const glm::vec3> color) {
  TileRenderer renderer =
      loadRenderer(device, "constant colour", "mean of the truth", material, Lookup::kNone);
  renderer.main = kConstantMain;
  renderer.uses_material = false;
  renderer.prepare = [color](const GlProgram& program) {
    glProgramUniform3fv(program.name(), glGetUniformLocation(program.name(), "constant_color"), 1, &color->x);
  };
  return renderer;
}

TileRenderer tableRenderer(const Device& device, const Material& material,
                           const importer::BakedOutput& baked) {
  TileRenderer renderer =
      loadRenderer(device, "full BTF table", "81 x 81 images, 4-D interpolated", material, Lookup::kNone);
  const auto table = std::make_shared<const BtfTable>(baked);
  renderer.main = std::string(kBtfTableLibrary) + kTableMain;
  renderer.uses_material = false;
  for (int k = 0; k < BtfTable::kTextures; ++k)
    renderer.fetch_bytes.setFree(kFreeUnit + k, 4, 8);  // RGB9E5, trilinear
  renderer.extra_bytes = table->bytes();
  renderer.prepare = [table](const GlProgram&) { table->bind(); };
  return renderer;
}

}  // namespace loden::bench
