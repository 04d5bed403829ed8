#include "tests/bench/btf_table.h"

#include <epoxy/gl.h>

#include <vector>

#include "material/base/check.h"
#include "material/model/texture.h"
#include "shaders/loden_shared.h"
#include "tests/bench/bench_support.h"

namespace loden::bench {
namespace {

using namespace runtime;

constexpr int kRings = 6;
constexpr int kViewBase[kRings] = {0, 0, 1, 6, 13, 24};  // of a ring among those of its parity
constexpr int kLightBase[kRings] = {0, 0, 1, 3, 7, 12};  // the same, every other sample
constexpr int kViews[2] = {33, 48},
              kLights[2] = {17, 24};  // per class; the pole is in both classes of lights

struct RingSample {
  int ring = 0, index = 0;
};
RingSample ringSample(int sample) {
  RingSample at;
  at.index = sample;
  while (at.index >= bonn81Rings()[size_t(at.ring)].count) at.index -= bonn81Rings()[size_t(at.ring++)].count;
  return at;
}

// 2 x 2 means.
std::vector<glm::vec3> halved(const std::vector<glm::vec3>& fine, int side) {
  const int half = side / 2;
  std::vector<glm::vec3> coarse;
  for (int t = 0; t < half * half; ++t) {
    const glm::vec3* at = &fine[size_t(t / half * 2 * side + t % half * 2)];
    coarse.push_back(0.25f * (at[0] + at[1] + at[side] + at[side + 1]));
  }
  return coarse;
}

void uploadLayer(const GlTexture& texture, int layer, std::vector<glm::vec3> image, int side) {
  for (int mip = 0; side >= 1; ++mip, side /= 2) {
    glTextureSubImage3D(texture.name(), mip, 0, 0, layer, side, side, 1, GL_RGB, GL_FLOAT, image.data());
    if (side > 1) image = halved(image, side);
  }
}

}  // namespace

BtfTable::BtfTable(const importer::BakedOutput& baked) {
  const int side = baked.manifest().size, mips = fullMipCount(side, side), lights = bonn81Directions().size();
  LODEN_CHECK(baked.manifest().directions.kind == DirectionSetKind::kBonn81);
  LODEN_CHECK_EQ(side & (side - 1), 0);
  for (int k = 0; k < kTextures; ++k) {
    const int layers = kViews[k >> 2] * kLights[k >> 1 & 1];
    textures_[size_t(k)] = makeTexture(GL_TEXTURE_2D_ARRAY, "btf table");
    const GLuint name = textures_[size_t(k)].name();
    glTextureStorage3D(name, mips, GL_RGB9_E5, side, side, layers);
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    bytes_ += textureBytes(TexelFormat::kRGBA8Unorm, uint64_t(side), uint64_t(side), uint64_t(layers),
                           mips);  // as many bytes as RGB9E5
  }
  for (int v = 0; v < lights; ++v) {
    const std::vector<glm::vec3> images = require(baked.btfView(v));
    const RingSample view = ringSample(v);
    for (int l = 0; l < lights; ++l) {
      const auto first = images.begin() + ptrdiff_t(l) * side * side;
      const RingSample light = ringSample(l);
      const int view_parity = view.ring & 1, light_parity = light.ring & 1;
      const int layer = (kViewBase[view.ring] + view.index) * kLights[light_parity] + kLightBase[light.ring] +
                        light.index / 2;
      for (int q = 0; q < 2; ++q)
        if (light.ring == 0 || (light.index & 1) == q)
          uploadLayer(textures_[size_t(view_parity << 2 | light_parity << 1 | q)], layer,
                      {first, first + side * side}, side);
    }
  }
}

void BtfTable::bind() const {
  for (int k = 0; k < kTextures; ++k)
    glBindTextureUnit(GLuint(LODEN_MAX_UNITS + k), textures_[size_t(k)].name());
}

const char kBtfTableLibrary[] = R"(
layout(binding = LODEN_MAX_UNITS) uniform sampler2DArray btf_table[8];

const int BTF_COUNT[6] = int[](1, 6, 12, 18, 20, 24);
const int BTF_VIEW_BASE[6] = int[](0, 0, 1, 6, 13, 24);
const int BTF_LIGHT_BASE[6] = int[](0, 0, 1, 3, 7, 12);
const int BTF_LIGHTS[2] = int[](17, 24);

// The ring of that parity next to w, its weight, and the two samples on it on both sides of w.
struct BtfRing {
  int ring, first, second;
  float weight, blend;
};
BtfRing btf_ring(vec3 w, int parity) {
  float at = min(acos(clamp(w.z, -1.0, 1.0)) / radians(15.0), 5.0);
  int low = min(int(at), 4);
  BtfRing r;
  r.ring = (low & 1) == parity ? low : low + 1;
  r.weight = 1.0 - abs(at - float(r.ring));
  float turn = w.x == 0.0 && w.y == 0.0 ? 0.0 : atan(w.y, w.x) / (2.0 * LODEN_PI);
  int count = BTF_COUNT[r.ring];
  float place = (turn - floor(turn)) * float(count);
  r.blend = place - floor(place);
  r.first = int(place) % count;
  r.second = (r.first + 1) % count;
  return r;
}

vec3 btf_table_value(vec2 x, float lambda, vec3 wi, vec3 wo) {
  vec3 sum = vec3(0.0);
  for (int k = 0; k < 8; ++k) {
    int light_parity = k >> 1 & 1;
    BtfRing view = btf_ring(wo, k >> 2), light = btf_ring(wi, light_parity);
    bool is_first = (light.first & 1) == (k & 1);
    int slot = BTF_LIGHT_BASE[light.ring] + (is_first ? light.first : light.second) / 2;
    float weight = view.weight * light.weight * (is_first ? 1.0 - light.blend : light.blend);
    int base = BTF_VIEW_BASE[view.ring], lights = BTF_LIGHTS[light_parity];
    LODEN_COUNT(LODEN_MAX_UNITS + k, 2);
    vec3 first = textureLod(btf_table[k], vec3(x, float((base + view.first) * lights + slot)), lambda).rgb;
    vec3 second = textureLod(btf_table[k], vec3(x, float((base + view.second) * lights + slot)), lambda).rgb;
    sum += weight * mix(first, second, view.blend);
  }
  return sum;
}
)";

}  // namespace loden::bench
