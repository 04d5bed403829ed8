#include "importer/bake/light_sum.h"

#include <algorithm>
#include <array>

// Compiled for AVX2 too and chosen at load: the same operations in the same order, so the same bits. Not
// under sanitizers, which do not bear what chooses, nor by Clang, where it is untried.
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LODEN_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define LODEN_WIDE
#endif

namespace loden::importer {
namespace {

constexpr size_t kGroup = 8;

// The bits of a byte as floats, 0 or 1.
struct ByteAsFloats {
  std::array<std::array<float, kGroup>, 256> of{};
  constexpr ByteAsFloats() {
    for (size_t byte = 0; byte < 256; ++byte)
      for (size_t bit = 0; bit < kGroup; ++bit) of[byte][bit] = float(byte >> bit & 1);
  }
};
constexpr ByteAsFloats kFloats;

struct Lights {
  const float *x, *y, *z, *half_scale;
  float *red, *green, *blue;
};

// sum += lit * (diffuse + specular (N.H)^exponent) * max(N.L, 0), light by light; groups without light are
// skipped. Samples without a GGX lobe only.
LODEN_WIDE void addSample(const Lights& lights, size_t groups, const uint64_t* lit, const glm::vec3& normal,
                          float view_cosine, const LocalBrdf& brdf) {
  const float nx = normal.x, ny = normal.y, nz = normal.z;
  const float red = brdf.diffuse.x, green = brdf.diffuse.y, blue = brdf.diffuse.z;
  const float specular = brdf.specular, exponent = brdf.exponent;
  for (size_t group = 0; group < groups; ++group) {
    const uint8_t bits = uint8_t(lit[group / 8] >> (group % 8 * 8));
    if (bits == 0) continue;
    const float* const on = kFloats.of[bits].data();
    const size_t at = group * kGroup;
    float sum_red[kGroup], sum_green[kGroup], sum_blue[kGroup];
    for (size_t k = 0; k < kGroup; ++k) {
      const float c = nx * lights.x[at + k] + ny * lights.y[at + k] + nz * lights.z[at + k];
      const float h = std::min(std::max(0.0f, (c + view_cosine) * lights.half_scale[at + k]), 1.0f);
      const float cosine = on[k] * std::max(c, 0.0f);
      const float lobe = specular * fastPower(h, exponent);
      sum_red[k] = cosine * (red + lobe);
      sum_green[k] = cosine * (green + lobe);
      sum_blue[k] = cosine * (blue + lobe);
    }
    for (size_t k = 0; k < kGroup; ++k) lights.red[at + k] += sum_red[k];
    for (size_t k = 0; k < kGroup; ++k) lights.green[at + k] += sum_green[k];
    for (size_t k = 0; k < kGroup; ++k) lights.blue[at + k] += sum_blue[k];
  }
}

}  // namespace

LightSum::LightSum(const LightTable& lights)
    : lights_(lights),
      groups_((lights.size() + kGroup - 1) / kGroup),
      x_(lights.x),
      y_(lights.y),
      z_(lights.z),
      half_scale_(lights.half_scale) {
  for (auto* values : {&x_, &y_, &z_, &half_scale_}) values->resize(groups_ * kGroup);
  for (auto& channel : sum_) channel.resize(groups_ * kGroup);
}

void LightSum::clear() {
  for (auto& channel : sum_) std::fill(channel.begin(), channel.end(), 0.0f);
}

void LightSum::add(const glm::vec3& normal, const glm::vec3& wo, const LocalBrdf& brdf, const uint64_t* lit) {
  if (brdf.alpha > 0) return addGgx(normal, wo, brdf, lit);
  const Lights lights{x_.data(),      y_.data(),      z_.data(),     half_scale_.data(),
                      sum_[0].data(), sum_[1].data(), sum_[2].data()};
  addSample(lights, groups_, lit, normal, glm::dot(normal, wo), brdf);
}

void LightSum::addGgx(const glm::vec3& normal, const glm::vec3& wo, const LocalBrdf& brdf,
                      const uint64_t* lit) {
  for (auto* values : {&cosine_, &lobe_, &tinted_}) values->resize(lights_.size());
  lobesOfAllLights(lights_, normal, wo, brdf, cosine_.data(), lobe_.data(), tinted_.data());
  for (size_t l = 0; l < lights_.size(); ++l) {
    if (!(lit[l / 64] >> (l % 64) & 1)) continue;
    for (int c = 0; c < 3; ++c)
      sum_[c][l] += brdf.diffuse[c] * cosine_[l] + lobe_[l] + brdf.f0[c] * tinted_[l];
  }
}

void LightSum::add(std::span<const glm::vec3> values) {
  for (size_t l = 0; l < values.size(); ++l)
    for (int c = 0; c < 3; ++c) sum_[c][l] += values[l][c];
}

}  // namespace loden::importer
