#include "runtime/scene/reflections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>

#include "material/model/directions.h"

namespace loden::runtime {
namespace {

constexpr float kPiF = static_cast<float>(kPi);

// Point i of n in the unit square, evenly spread (Hammersley).
glm::vec2 hammersley(uint32_t i, uint32_t n) {
  uint32_t bits = i;
  bits = (bits << 16) | (bits >> 16);
  bits = ((bits & 0x00FF00FFu) << 8) | ((bits & 0xFF00FF00u) >> 8);
  bits = ((bits & 0x0F0F0F0Fu) << 4) | ((bits & 0xF0F0F0F0u) >> 4);
  bits = ((bits & 0x33333333u) << 2) | ((bits & 0xCCCCCCCCu) >> 2);
  bits = ((bits & 0x55555555u) << 1) | ((bits & 0xAAAAAAAAu) >> 1);
  return {(float(i) + 0.5f) / float(n), (float(bits) + 0.5f) / 4294967296.0f};
}

// Half vector of the GGX lobe around z, drawn in proportion to its visible area head-on.
glm::vec3 ggxHalf(glm::vec2 u, float alpha) {
  const float cosine = std::sqrt((1 - u.y) / (1 + (alpha * alpha - 1) * u.y));
  const float sine = std::sqrt(std::max(1 - cosine * cosine, 0.0f));
  return {sine * std::cos(2 * kPiF * u.x), sine * std::sin(2 * kPiF * u.x), cosine};
}

float ggxDensity(float nh, float alpha) {
  const float d = nh * nh * (alpha * alpha - 1) + 1;
  return alpha * alpha / (kPiF * d * d);
}

// Smith's masking and shadowing, height correlated, over 4 nl nv.
float ggxVisibility(float nl, float nv, float alpha) {
  const float a2 = alpha * alpha;
  const float sum = nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2);
  return 0.5f / std::max(sum, 1e-6f);
}

struct FacePoint {
  int face = 0;
  glm::vec2 st{0};
};
FacePoint cubePoint(const glm::vec3& d) {
  const glm::vec3 a = glm::abs(d);
  if (a.x >= a.y && a.x >= a.z)
    return d.x > 0 ? FacePoint{0, glm::vec2(-d.z, -d.y) / a.x * 0.5f + 0.5f}
                   : FacePoint{1, glm::vec2(d.z, -d.y) / a.x * 0.5f + 0.5f};
  if (a.y >= a.z)
    return d.y > 0 ? FacePoint{2, glm::vec2(d.x, d.z) / a.y * 0.5f + 0.5f}
                   : FacePoint{3, glm::vec2(d.x, -d.z) / a.y * 0.5f + 0.5f};
  return d.z > 0 ? FacePoint{4, glm::vec2(d.x, -d.y) / a.z * 0.5f + 0.5f}
                 : FacePoint{5, glm::vec2(-d.x, -d.y) / a.z * 0.5f + 0.5f};
}

// A cube map with all its box filtered halves.
class CubePyramid {
 public:
  explicit CubePyramid(std::vector<glm::vec3> finest) {
    levels_.push_back(std::move(finest));
    for (int side = ReflectionMap::kSide; side > 1; side /= 2)
      levels_.push_back(halved(levels_.back(), side));
  }
  const std::vector<glm::vec3>& finest() const { return levels_[0]; }

  glm::vec3 at(const glm::vec3& direction, float level) const {
    const int last = static_cast<int>(levels_.size()) - 1;
    const float clamped = std::clamp(level, 0.0f, float(last));
    const int low = static_cast<int>(clamped);
    const FacePoint point = cubePoint(direction);
    return glm::mix(bilinear(low, point), bilinear(std::min(low + 1, last), point), clamped - float(low));
  }

 private:
  static std::vector<glm::vec3> halved(const std::vector<glm::vec3>& fine, int side) {
    std::vector<glm::vec3> coarse;
    coarse.reserve(fine.size() / 4);
    for (int row = 0; row < 6 * side; row += 2)
      for (int column = 0; column < side; column += 2) {
        const glm::vec3* p = &fine[size_t(row) * size_t(side) + size_t(column)];
        coarse.push_back(0.25f * (p[0] + p[1] + p[side] + p[side + 1]));
      }
    return coarse;
  }

  // Clamped at the border of the face.
  glm::vec3 bilinear(int level, const FacePoint& point) const {
    const int side = ReflectionMap::kSide >> level;
    const glm::vec2 at = glm::clamp(point.st * float(side) - 0.5f, 0.0f, float(side - 1));
    const glm::ivec2 low(at), high = glm::min(low + 1, side - 1);
    const glm::vec2 share = at - glm::vec2(low);
    const glm::vec3* face = &levels_[size_t(level)][size_t(point.face) * size_t(side) * size_t(side)];
    const auto texel = [&](int x, int y) { return face[size_t(y) * size_t(side) + size_t(x)]; };
    return glm::mix(glm::mix(texel(low.x, low.y), texel(high.x, low.y), share.x),
                    glm::mix(texel(low.x, high.y), texel(high.x, high.y), share.x), share.y);
  }

  std::vector<std::vector<glm::vec3>> levels_;
};

glm::vec3 usable(const glm::vec3& radiance) {
  glm::vec3 result(0);
  for (int c = 0; c < 3; ++c)
    if (radiance[c] > 0 && radiance[c] < 65000) result[c] = radiance[c];  // else no half float
  return result;
}

std::vector<glm::vec3> cubeOf(const Panorama& panorama, const glm::mat3& world_from_panorama) {
  constexpr int kSide = ReflectionMap::kSide, kSub = 2;
  const glm::mat3 panorama_from_world = glm::transpose(world_from_panorama);
  std::vector<glm::vec3> cube;
  cube.reserve(size_t(6) * kSide * kSide);
  for (int row = 0; row < 6 * kSide; ++row)
    for (int column = 0; column < kSide; ++column) {
      glm::vec3 sum(0);
      for (int k = 0; k < kSub * kSub; ++k) {
        const glm::vec2 at =
            glm::vec2(column, row % kSide) + (glm::vec2(k % kSub, k / kSub) + 0.5f) / float(kSub);
        const glm::vec3 direction = panorama_from_world * cubeDirection(row / kSide, at / float(kSide));
        sum += usable(panoramaPixel(panorama, glm::dvec3(direction)));
      }
      cube.push_back(sum / float(kSub * kSub));
    }
  return cube;
}

// A light direction of the lobe around z, its weight, and the level of the pyramid that is as wide as its
// share (Krivanek and Colbert 2008).
struct LobeSample {
  glm::vec3 wi;
  float level;
};
std::vector<LobeSample> lobeSamples(float roughness, uint32_t count) {
  const float alpha = roughness * roughness;
  const float texel = 4 * kPiF / (6.0f * ReflectionMap::kSide * ReflectionMap::kSide);
  std::vector<LobeSample> samples;
  for (uint32_t i = 0; i < count; ++i) {
    const glm::vec3 h = ggxHalf(hammersley(i, count), alpha);
    const glm::vec3 wi = 2 * h.z * h - glm::vec3(0, 0, 1);
    if (!(wi.z > 0)) continue;
    const float share = 4 / (float(count) * ggxDensity(h.z, alpha));  // steradians
    samples.push_back({wi, std::max(0.5f * std::log2(share / texel) + 0.5f, 0.0f)});
  }
  return samples;
}

// Directions spread evenly over the hemisphere: whoever sums them weighs them by their cosines.
std::vector<LobeSample> cosineSamples() {
  constexpr uint32_t kSamples = 1024;
  constexpr float kLevel = 4;  // texels of some 5 degrees
  std::vector<LobeSample> samples;
  for (uint32_t i = 0; i < kSamples; ++i) {
    const glm::vec2 u = hammersley(i, kSamples);
    const float z = 1 - u.y, around = std::sqrt(1 - z * z);
    samples.push_back({{around * std::cos(2 * kPiF * u.x), around * std::sin(2 * kPiF * u.x), z}, kLevel});
  }
  return samples;
}

glm::mat3 frameAround(const glm::vec3& z) {
  const glm::vec3 side = std::abs(z.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0);
  const glm::vec3 x = glm::normalize(glm::cross(side, z));
  return {x, glm::cross(z, x), z};
}

std::vector<glm::vec3> blurredFace(const CubePyramid& source, int level, int face) {
  const int side = ReflectionMap::kSide >> level;
  // Lights much brighter than the rest show as rings where samples are few; coarse levels can afford many.
  const uint32_t count = std::min(64u << level, 1024u);
  const float roughness = std::pow(float(level) / (ReflectionMap::kLevels - 1), 1.5f);
  const std::vector<LobeSample> samples =
      level < ReflectionMap::kLevels ? lobeSamples(roughness, count) : cosineSamples();
  std::vector<glm::vec3> result;
  result.reserve(size_t(side) * size_t(side));
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const glm::vec2 st = (glm::vec2(column, row) + 0.5f) / float(side);
      const glm::mat3 frame = frameAround(cubeDirection(face, st));
      glm::vec3 sum(0);
      float weight = 0;
      for (const LobeSample& sample : samples) {
        sum += sample.wi.z * source.at(frame * sample.wi, sample.level);
        weight += sample.wi.z;
      }
      result.push_back(sum / weight);
    }
  return result;
}

// All faces of a level, on as many threads as there are.
std::vector<glm::vec3> blurred(const CubePyramid& source, int level) {
  std::vector<std::future<std::vector<glm::vec3>>> faces;
  for (int face = 0; face < 6; ++face)
    faces.push_back(
        std::async(std::launch::async, [&source, level, face] { return blurredFace(source, level, face); }));
  std::vector<glm::vec3> result;
  for (auto& face : faces) {
    const std::vector<glm::vec3> pixels = face.get();
    result.insert(result.end(), pixels.begin(), pixels.end());
  }
  return result;
}

// f0 and f90's shares of the GGX lobe's reflectance, and the share of the normal in its middle (see
// makeReflectanceTable), by importance sampling of half vectors.
glm::vec3 ggxReflectance(float nv, float roughness) {
  constexpr uint32_t kSamples = 128;
  const float alpha = roughness * roughness;
  const glm::vec3 wo(std::sqrt(std::max(1 - nv * nv, 0.0f)), 0, nv);
  glm::vec2 sum(0);
  glm::vec3 middle(0);
  for (uint32_t i = 0; i < kSamples; ++i) {
    const glm::vec3 h = ggxHalf(hammersley(i, kSamples), alpha);
    const float vh = glm::dot(wo, h);
    const glm::vec3 wi = 2 * vh * h - wo;
    if (!(wi.z > 0) || !(vh > 0)) continue;
    const float value = ggxVisibility(wi.z, nv, alpha) * 4 * wi.z * vh / h.z;
    const float fresnel = std::pow(1 - vh, 5.0f);
    sum += value * glm::vec2(1 - fresnel, fresnel);
    middle += value * wi;
  }
  // middle = along_mirror * (-wo.x, 0, wo.z) + along_normal * (0, 0, 1)
  const float along_mirror = wo.x > 0.05f ? -middle.x / wo.x : middle.z;
  const float along_normal = middle.z - along_mirror * nv;
  const float share = along_normal / (along_normal + along_mirror);
  return {sum / float(kSamples), std::clamp(share, 0.0f, 1.0f)};
}

// As sheenLobe() of shaders/scene_base_lighting.glsl, over the hemisphere.
float sheenReflectance(float nv, float roughness) {
  constexpr uint32_t kSamples = 128;
  const float inverse = 1 / (roughness * roughness);
  const glm::vec3 wo(std::sqrt(std::max(1 - nv * nv, 0.0f)), 0, nv);
  float sum = 0;
  for (uint32_t i = 0; i < kSamples; ++i) {
    const glm::vec2 u = hammersley(i, kSamples);
    const float z = u.y, radius = std::sqrt(1 - z * z);
    const glm::vec3 wi(radius * std::cos(2 * kPiF * u.x), radius * std::sin(2 * kPiF * u.x), z);
    const float nh = glm::normalize(wi + wo).z;
    const float distribution =
        (2 + inverse) * std::pow(std::max(1 - nh * nh, 0.0f), inverse / 2) / (2 * kPiF);
    sum += distribution / (4 * (z + nv - z * nv)) * z;
  }
  return std::min(sum * 2 * kPiF / float(kSamples), 1.0f);
}

// A round light with soft borders: cosines of where it begins to fade and where it ends.
float softLight(const glm::vec3& w, const glm::vec3& towards, float inner, float outer) {
  const float x = std::clamp((glm::dot(w, glm::normalize(towards)) - outer) / (inner - outer), 0.0f, 1.0f);
  return x * x * (3 - 2 * x);
}

}  // namespace

glm::vec3 cubeDirection(int face, glm::vec2 st) {
  const float s = 2 * st.x - 1, t = 2 * st.y - 1;
  const std::array<glm::vec3, 6> through{glm::vec3(1, -t, -s), {-1, -t, s}, {s, 1, t},
                                         {s, -1, -t},          {s, -t, 1},  {-s, -t, -1}};
  return glm::normalize(through[size_t(face)]);
}

ReflectionMap makeReflectionMap(const Panorama& panorama, const glm::mat3& world_from_panorama) {
  const CubePyramid pyramid(cubeOf(panorama, world_from_panorama));
  ReflectionMap map;
  map.levels.push_back(pyramid.finest());
  for (int level = 1; level <= ReflectionMap::kLevels; ++level) map.levels.push_back(blurred(pyramid, level));
  map.light = rotated(projectPanorama(panorama, 0).light, world_from_panorama);
  return map;
}

std::vector<glm::vec4> makeReflectanceTable(int side) {
  std::vector<glm::vec4> table;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const float nv = std::max(float(column) / float(side - 1), 0.01f);
      const float roughness = std::max(float(row) / float(side - 1), 0.03f);
      const glm::vec3 ggx = ggxReflectance(nv, roughness);
      table.emplace_back(ggx.x, ggx.y, sheenReflectance(nv, std::max(roughness, 0.07f)), ggx.z);
    }
  return table;
}

Panorama neutralPanorama() {
  Panorama panorama{256, 128, {}};
  panorama.pixels.reserve(size_t(panorama.width) * size_t(panorama.height));
  for (int row = 0; row < panorama.height; ++row)
    for (int column = 0; column < panorama.width; ++column) {
      const glm::vec3 w(panoramaDirection(panorama, column, row));
      const float walls = 0.42f + 0.2f * w.z + 0.08f * w.z * w.z;
      const float lights = 4.2f * softLight(w, {0.45f, -0.5f, 0.8f}, 0.95f, 0.86f) +
                           2.0f * softLight(w, {-0.9f, -0.35f, 0.35f}, 0.93f, 0.8f) +
                           2.4f * softLight(w, {0.25f, 0.9f, 0.45f}, 0.95f, 0.85f);
      panorama.pixels.emplace_back(0.65f * (walls + lights));
    }
  return panorama;
}

}  // namespace loden::runtime
