#include "importer/gltf/fallback.h"

#include <algorithm>
#include <cmath>

#include "importer/base/image_encode.h"
#include "importer/gltf/json_tree.h"
#include "material/eval/evaluate.h"
#include "material/model/color.h"
#include "material/model/directions.h"

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value) {
  return std::round(value * 1e5) / 1e5;
}

// The light directions that averages are taken over: three heights, eight ways around.
std::vector<glm::vec3> averagedLights() {
  std::vector<glm::vec3> lights;
  for (const double theta : {15.0, 40.0, 62.0})
    for (int k = 0; k < 8; ++k)
      lights.emplace_back(directionFromSpherical({theta * kPi / 180, (k + 0.5) * kPi / 4}));
  return lights;
}

// Estevez and Kulla 2017, with Neubelt and Pettineo's visibility, times pi and the light's cosine.
float sheenValue(const glm::vec3& wi, const glm::vec3& wo, float roughness) {
  const float inverse = 1 / (roughness * roughness), nh = glm::normalize(wi + wo).z;
  const float distribution = (2 + inverse) * std::pow(std::max(1 - nh * nh, 0.0f), inverse / 2) / 2;
  return distribution / (4 * (wi.z + wo.z - wi.z * wo.z)) * wi.z;
}

glm::vec3 seenFrom(const Evaluator& evaluator, const glm::vec3& wo) {
  glm::vec3 sum(0);
  const auto lights = averagedLights();
  const auto coarsest = static_cast<float>(std::log2(std::max(evaluator.material().side, 1)));
  const auto hit = evaluator.findHit(glm::vec2(0.5f), coarsest, wo);
  for (const glm::vec3& wi : lights) sum += evaluator.evaluate(hit, wi, wo);
  return sum / static_cast<float>(lights.size());
}

struct Texel {
  glm::vec3 color{0}, normal{0};
};

// A square of the period from above, each texel the mean of 2 x 2 points.
std::vector<Texel> seenFromAbove(const Evaluator& evaluator, int side) {
  const SurfaceMaps& maps = *evaluator.material().surface;
  const glm::vec3 up(0, 0, 1);
  std::vector<Texel> texels(size_t(side) * size_t(side));
  for (int i = 0; i < 4 * side * side; ++i) {
    const int column = i / 4 % side, row = i / 4 / side;
    const glm::vec2 x = (glm::vec2(column, row) + 0.25f + 0.5f * glm::vec2(i % 2, i / 2 % 2)) / float(side);
    const auto hit = evaluator.findHit(x, maps.lambda_first, up);
    const auto point = nearPoint(maps, hit.p, maps.lambda_first);
    const glm::vec3 base =
        point.diffuse + (maps.lobe == Lobe::kGgx ? glm::max(point.f0 - 0.04f, glm::vec3(0)) : glm::vec3(0));
    texels[size_t(i / 4)].color += 0.25f * base;
    texels[size_t(i / 4)].normal += 0.25f * point.normal;
  }
  return texels;
}

// The light that the texels send up under the averaged lights, if they are a matt surface of their normals.
glm::vec3 shadedMean(const std::vector<Texel>& texels) {
  glm::vec3 sum(0);
  const auto lights = averagedLights();
  for (const Texel& texel : texels)
    for (const glm::vec3& wi : lights)
      sum += texel.color * std::max(glm::dot(glm::normalize(texel.normal), wi), 0.0f);
  return sum / static_cast<float>(texels.size() * lights.size());
}

uint8_t code(float value) {
  return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}
uint8_t srgbCode(float value) {
  const float v = std::clamp(value, 0.0f, 1.0f);
  return code(v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f);
}

Result<std::string> png(int side, const std::vector<glm::u8vec3>& pixels, const char* name) {
  const OIIO::ImageSpec spec(side, side, 3, OIIO::TypeDesc::UINT8);
  const auto bytes = encodeImage(name, spec, OIIO::TypeDesc::UINT8, pixels.data());
  if (!bytes) return bytes.issue();
  return std::string(bytes->begin(), bytes->end());
}

}  // namespace

void fitFactors(Json& look, const Material& material) {
  glm::dvec3 color = glm::max(glm::dvec3(rgbFromYcc(glm::dvec3(material.mean.ka + material.mean.kd,
                                                               material.mean.cb, material.mean.cr))),
                              0.0);
  if (material.mean.chroma == MeanChroma::kRatio) {
    const double y = material.mean.ka + material.mean.kd;
    color = rgbFromYcc(glm::dvec3(y, material.mean.cb * y, material.mean.cr * y));
  }
  if (material.surface) {
    // The average; metals, too, are matt in it, as the tile's own shape is not in the fallback.
    const Texture& map = material.surface->color;
    const glm::vec4 code = fetchTexel(map, map.mips - 1, 0, 0, 0);
    if (map.mipWidth(map.mips - 1) == 1) color = glm::dvec3(code) * glm::dvec3(code);
  }
  color = glm::clamp(color, 0.0, 1.0);
  // GGX alpha^2 = 2 / (n + 2) (Walter et al. 2007), alpha = roughness^2 (glTF); no highlight is fully rough.
  const double n = std::max(0.0f, material.mean.alpha);
  const double roughness = material.mean.ks > 1e-3 ? std::pow(2 / (n + 2), 0.25) : 1;
  setNull(look);
  setNumbers(memberOf(look, "baseColorFactor"), {rounded(color.x), rounded(color.y), rounded(color.z), 1.0});
  memberOf(look, "metallicFactor") = 0.0;
  memberOf(look, "roughnessFactor") = rounded(std::clamp(roughness, 0.05, 1.0));
}

Result<FallbackMaps> bakeFallback(const Material& material) {
  constexpr int kMostSide = 256;
  FallbackMaps maps;
  const Evaluator evaluator(material);
  const glm::vec3 matt = seenFrom(evaluator, {0, 0, 1});
  if (material.surface) {
    const int side = std::clamp(material.surface->color.width, 16, kMostSide);
    const std::vector<Texel> texels = seenFromAbove(evaluator, side);
    const glm::vec3 shaded = shadedMean(texels);
    std::vector<glm::u8vec3> colors, normals;
    for (const Texel& texel : texels) {
      const glm::vec3 n = 0.5f * glm::normalize(texel.normal + glm::vec3(0, 0, 1e-6f)) + 0.5f;
      colors.emplace_back(srgbCode(texel.color.r), srgbCode(texel.color.g), srgbCode(texel.color.b));
      normals.emplace_back(code(n.x), code(1 - n.y), code(n.z));  // glTF's green axis runs against v
    }
    auto color = png(side, colors, "colour.png"), normal = png(side, normals, "normal.png");
    if (!color) return color.issue();
    if (!normal) return normal.issue();
    maps.color_png = std::move(*color);
    maps.normal_png = std::move(*normal);
    for (int c = 0; c < 3; ++c)
      if (shaded[c] > 1e-4f) maps.color_factor[c] = std::clamp(matt[c] / shaded[c], 0.0f, 1.0f);
  }
  // What views along the surface have more than a matt surface of the same brightness from above.
  const glm::vec3 grazing(directionFromSpherical({70 * kPi / 180, 0.3}));
  float lobe = 0;
  for (const glm::vec3& wi : averagedLights()) lobe += sheenValue(wi, grazing, maps.sheen_roughness) / 24;
  const glm::vec3 more = seenFrom(evaluator, grazing) - matt;
  maps.sheen = glm::clamp(more / std::max(lobe, 1e-3f), 0.0f, 0.5f);
  return maps;
}

}  // namespace loden::importer
