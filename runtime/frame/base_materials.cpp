#include "runtime/frame/base_materials.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <tuple>

#include "material/base/memory_issue.h"
#include "runtime/scene/camera.h"
#include "runtime/scene/image_mips.h"
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

ImageTexture textureOf(const SceneImage& image, std::shared_ptr<const Texture> mips, bool srgb,
                       const TextureSampler& sampler) {
  ImageTexture texture;
  texture.name = image.name;
  texture.mips = std::move(mips);
  texture.srgb = srgb;
  texture.wrap_s = GLuint(wrapOf(sampler.wrap_u));
  texture.wrap_t = GLuint(wrapOf(sampler.wrap_v));
  texture.min_filter = GLuint(minFilterOf(sampler));
  texture.mag_filter = sampler.magnify_linear ? GL_LINEAR : GL_NEAREST;
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

Result<BaseMaterials> BaseMaterials::create(const Scene& scene, MaterialSystem& system) {
  return withMemoryIssue(scene.name, "the textures of this scene", [&]() -> Result<BaseMaterials> {
    std::vector<SceneMaterial> all = scene.materials;
    all.emplace_back();
    BaseMaterials made(system);
    if (Status status = made.loadTextures(scene, all); !status) return status.issue();
    made.uploadUniforms(all);
    return made;
  });
}

Status BaseMaterials::loadTextures(const Scene& scene, const std::vector<SceneMaterial>& materials) {
  std::map<std::pair<int, bool>, std::shared_ptr<const Texture>> mips;
  std::map<std::tuple<int, bool, TextureSampler>, int> indices;
  for (const SceneMaterial& material : materials) {
    Item& item = materials_.emplace_back();
    item.alpha_mode = material.alpha_mode;
    for (size_t role = 0; role < kTextureRoles; ++role) {
      const TextureUse& use = material.textures[role];
      item.textures[role] = -1;
      if (use.image < 0) continue;
      const SceneImage& image = scene.images[size_t(use.image)];
      const bool srgb = isSrgb(TextureRole(role));
      const auto [index, fresh] =
          indices.try_emplace({use.image, srgb, use.sampler}, static_cast<int>(textures_.size()));
      item.textures[role] = index->second;
      if (!fresh) continue;
      std::shared_ptr<const Texture>& texels = mips[{use.image, srgb}];
      if (!texels) texels = std::make_shared<const Texture>(imageMips(image, srgb));
      const Result<TextureId> id = system_->loadTexture(textureOf(image, texels, srgb, use.sampler));
      if (!id) return id.issue();
      textures_.push_back(
          {OwnedTexture(*system_, *id), image.name, image.size, use.sampler.mips != MipFilter::kNone});
    }
  }
  return {};
}

void BaseMaterials::uploadUniforms(const std::vector<SceneMaterial>& materials) {
  GLint alignment = 256;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  stride_ = (sizeof(SceneBaseMaterial) + size_t(alignment) - 1) / size_t(alignment) * size_t(alignment);
  std::vector<std::byte> uniforms(materials.size() * stride_);
  for (size_t i = 0; i < materials.size(); ++i) {
    const SceneBaseMaterial data = materialData(materials[i]);
    std::memcpy(uniforms.data() + i * stride_, &data, sizeof data);
  }
  uniforms_ = makeBuffer(uniforms.size(), uniforms, 0, "base materials");
}

std::vector<TextureNeed> BaseMaterials::needsOf(const Mesh& mesh, const SceneMaterial& source,
                                                int material) const {
  std::vector<TextureNeed> needs;
  std::vector<std::tuple<const TextureUse*, glm::ivec2, float>> known;  // most textures are used alike
  for (size_t role = 0; role < kTextureRoles; ++role) {
    const int texture = materials_[size_t(material)].textures[role];
    if (texture < 0) continue;
    const TextureUse& use = source.textures[role];
    const StreamedTexture& streamed = textures_[size_t(texture)];
    const auto same = std::find_if(known.begin(), known.end(), [&](const auto& entry) {
      const auto& [other, size, density] = entry;
      return other->tex_coord == use.tex_coord && other->image_u == use.image_u &&
             other->image_v == use.image_v && size == streamed.size;
    });
    float density = 0;
    if (same != known.end())
      density = std::get<float>(*same);
    else if (streamed.mipmapped)
      known.emplace_back(&use, streamed.size, density = texelDensity(mesh, use, streamed.size));
    const auto listed = std::find_if(needs.begin(), needs.end(),
                                     [&](const TextureNeed& need) { return need.texture == texture; });
    if (listed == needs.end())
      needs.push_back({texture, density});
    else
      listed->texels_per_metre = std::min(listed->texels_per_metre, density);
  }
  return needs;
}

int BaseMaterials::maskTexture(int material) const {
  const Item& item = materials_[size_t(material)];
  return item.alpha_mode == AlphaMode::kMask ? item.textures[size_t(TextureRole::kBaseColor)] : -1;
}

void BaseMaterials::bind(int material) const {
  glBindBufferRange(GL_UNIFORM_BUFFER, SCENE_BLOCK_BASE_MATERIAL, uniforms_.name(),
                    GLintptr(size_t(material) * stride_), sizeof(SceneBaseMaterial));
  const Item& item = materials_[size_t(material)];
  for (GLuint role = 0; role < GLuint(kTextureRoles); ++role) {
    if (item.textures[role] < 0) continue;
    glBindTextureUnit(role, system_->textureName(textures_[size_t(item.textures[role])].id.id()));
    glBindSampler(role, 0);
  }
}

}  // namespace loden::runtime
