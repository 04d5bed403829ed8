#include "runtime/frame/base_materials.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <tuple>

#include "runtime/gl/gl_state.h"
#include "shaders/scene_shared.h"

namespace loden::runtime {
namespace {

static_assert(kTextureRoles == SCENE_TEXTURES);
static_assert(int(TextureRole::kSpecular) == SCENE_TEXTURE_SPECULAR);
static_assert(int(TextureRole::kClearcoatNormal) == SCENE_TEXTURE_CLEARCOAT_NORMAL);

GLint wrapOf(Wrap wrap) {
  if (wrap == Wrap::kMirror) return GL_MIRRORED_REPEAT;
  return wrap == Wrap::kClamp ? GL_CLAMP_TO_EDGE : GL_REPEAT;
}

GLint minFilterOf(const TextureSampler& sampler) {
  switch (sampler.mips) {
    case MipFilter::kNone:
      return sampler.minify_linear ? GL_LINEAR : GL_NEAREST;
    case MipFilter::kNearest:
      return sampler.minify_linear ? GL_LINEAR_MIPMAP_NEAREST : GL_NEAREST_MIPMAP_NEAREST;
    case MipFilter::kLinear:
      break;
  }
  return sampler.minify_linear ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_LINEAR;
}

// Each pixel the rounded mean of up to four codes.
SceneImage halved(const SceneImage& image) {
  SceneImage half{image.name, glm::max(image.size / 2, 1), {}};
  half.pixels.reserve(size_t(half.size.x) * size_t(half.size.y));
  for (int y = 0; y < half.size.y; ++y)
    for (int x = 0; x < half.size.x; ++x) {
      glm::ivec4 sum(2);
      for (int k = 0; k < 4; ++k) {
        const glm::ivec2 at = glm::min(2 * glm::ivec2(x, y) + glm::ivec2(k & 1, k >> 1), image.size - 1);
        sum += glm::ivec4(image.pixels[size_t(at.y) * size_t(image.size.x) + size_t(at.x)]);
      }
      half.pixels.emplace_back(sum / 4);
    }
  return half;
}

GlTexture makeImageTexture(const SceneImage& image, bool srgb, const TextureSampler& sampler) {
  GLint most = 1024;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  if (std::max(image.size.x, image.size.y) > most) return makeImageTexture(halved(image), srgb, sampler);
  const int levels = static_cast<int>(std::bit_width(unsigned(std::max(image.size.x, image.size.y))));
  GlTexture texture = makeTexture(GL_TEXTURE_2D, image.name);
  const GLuint name = texture.name();
  const bool mips = sampler.mips != MipFilter::kNone;
  glTextureStorage2D(name, mips ? levels : 1, srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, image.size.x, image.size.y);
  glTextureSubImage2D(name, 0, 0, 0, image.size.x, image.size.y, GL_RGBA, GL_UNSIGNED_BYTE,
                      image.pixels.data());
  glTextureParameteri(name, GL_TEXTURE_WRAP_S, wrapOf(sampler.wrap_u));
  glTextureParameteri(name, GL_TEXTURE_WRAP_T, wrapOf(sampler.wrap_v));
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, sampler.magnify_linear ? GL_LINEAR : GL_NEAREST);
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, minFilterOf(sampler));
  if (mips) glGenerateTextureMipmap(name);
  return texture;
}

// Reflectance of a dielectric seen head-on; an index of 0 reflects everything.
float facingReflectance(float ior) {
  const float ratio = (ior - 1) / (ior + 1);
  return ior == 0 ? 1.0f : ratio * ratio;
}

int bitsOf(const SceneMaterial& material) {
  int bits = material.unlit ? SCENE_UNLIT : 0;
  if (material.sheen_color != glm::vec3(0)) bits |= SCENE_SHEEN;
  if (material.clearcoat > 0) bits |= SCENE_CLEARCOAT;
  if (material.alpha_mode == AlphaMode::kMask) bits |= SCENE_ALPHA_MASK;
  if (material.alpha_mode == AlphaMode::kBlend) bits |= SCENE_ALPHA_BLEND;
  return bits;
}

SceneBaseMaterial materialData(const SceneMaterial& material) {
  SceneBaseMaterial data{};
  data.base_color = material.base_color;
  data.emissive_cutoff = glm::vec4(material.emissive, material.alpha_cutoff);
  data.factors = {material.metallic, material.roughness, material.normal_scale, material.occlusion_strength};
  data.specular = glm::vec4(material.specular_color, material.specular);
  data.sheen = glm::vec4(material.sheen_color, material.sheen_roughness);
  data.clearcoat = {material.clearcoat, material.clearcoat_roughness, material.clearcoat_normal_scale,
                    facingReflectance(material.ior)};
  data.flags.y = bitsOf(material);
  for (size_t role = 0; role < kTextureRoles; ++role) {
    const TextureUse& use = material.textures[role];
    if (use.image >= 0) data.flags.x |= 1 << role;
    data.image_u[role] = glm::vec4(use.image_u, float(use.tex_coord));
    data.image_v[role] = glm::vec4(use.image_v, 0);
  }
  return data;
}

}  // namespace

BaseMaterials::BaseMaterials(const Scene& scene) {
  const GlPixelStateScope pixels;
  GLint alignment = 256;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  stride_ = (sizeof(SceneBaseMaterial) + size_t(alignment) - 1) / size_t(alignment) * size_t(alignment);
  std::vector<SceneMaterial> all = scene.materials;
  all.emplace_back();
  std::vector<std::byte> uniforms(all.size() * stride_);
  std::map<std::tuple<int, bool, TextureSampler>, uint32_t> made;
  for (size_t i = 0; i < all.size(); ++i) {
    Item item{all[i].alpha_mode, {}};
    for (size_t role = 0; role < kTextureRoles; ++role) {
      const TextureUse& use = all[i].textures[role];
      if (use.image < 0) continue;
      const SceneImage& image = scene.images[size_t(use.image)];
      const bool srgb = isSrgb(TextureRole(role));
      const auto [slot, fresh] = made.try_emplace({use.image, srgb, use.sampler}, 0u);
      if (fresh) {
        textures_.push_back(makeImageTexture(image, srgb, use.sampler));
        slot->second = textures_.back().name();
        texture_bytes_ += image.pixels.size() * 4 * (use.sampler.mips == MipFilter::kNone ? 3 : 4) / 3;
      }
      item.textures[role] = slot->second;
    }
    materials_.push_back(item);
    const SceneBaseMaterial data = materialData(all[i]);
    std::memcpy(uniforms.data() + i * stride_, &data, sizeof data);
  }
  uniforms_ = makeBuffer(uniforms.size(), uniforms, 0, "base materials");
}

void BaseMaterials::bind(int material) const {
  glBindBufferRange(GL_UNIFORM_BUFFER, SCENE_BLOCK_BASE_MATERIAL, uniforms_.name(),
                    GLintptr(size_t(material) * stride_), sizeof(SceneBaseMaterial));
  const Item& item = materials_[size_t(material)];
  for (GLuint role = 0; role < GLuint(kTextureRoles); ++role) {
    if (item.textures[role] == 0) continue;
    glBindTextureUnit(role, item.textures[role]);
    glBindSampler(role, 0);
  }
}

}  // namespace loden::runtime
