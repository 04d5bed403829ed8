#include "runtime/material_gpu.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>

#include "material/color.h"
#include "runtime/gl_texture.h"

namespace loden::runtime {
namespace {

PartTexture oneTexel(int unit, TexelFormat format, TextureShape shape, bool plain_2d, const glm::vec4& value) {
  PartTexture texel{unit, Sampling::kRepeatNearest, plain_2d, "", Texture::make(format, shape, 1, 1, 1)};
  storeTexel(texel.texels, 0, 0, 0, 0, value);
  return texel;
}

GlTexture uploadWhole(const PartTexture& part, const std::string& label) {
  GlTexture texture = allocateTexture(part, label);
  uint64_t unlimited = ~0ull;
  TextureUpload().step(part, texture.name(), unlimited);
  return texture;
}

std::string directionsKey(const DirectionSet& set) {
  return std::string(reinterpret_cast<const char*>(set.samples.data()), set.samples.size() * sizeof set.samples[0]);
}

// The fitted mean as one analytic surface, for surface maps that are not there yet.
glm::vec3 meanAlbedo(const PhongMean& mean) {
  const float y = mean.ka + mean.kd;
  const float chroma = mean.chroma == MeanChroma::kRatio ? y : 1;
  const glm::vec3 rgb = rgbFromYcc(glm::vec3(y, mean.cb * chroma, mean.cr * chroma));
  return y > 0 ? glm::clamp(rgb, 0.0f, 1.0f) : glm::vec3(0.5f);
}

}  // namespace

void SharedTextures::create() {
  using enum TexelFormat;
  empty_2d_ = uploadWhole(oneTexel(0, kRGBA8Unorm, TextureShape::kArray2D, true, {}), "empty 2D");
  empty_array_ = uploadWhole(oneTexel(0, kRGBA8Unorm, TextureShape::kArray2D, false, {}), "empty array");
  empty_volume_ = uploadWhole(oneTexel(0, kRGBA8Unorm, TextureShape::kVolume, false, {}), "empty volume");
  const uint8_t zero = 0;
  empty_index_ = makeIndexTexture({&zero, 1}, 1, "empty index");
}

void SharedTextures::contextLost() {
  for (GlTexture* texture : {&empty_2d_, &empty_array_, &empty_volume_, &empty_index_}) texture->release();
  for (auto& [key, texture] : nearest_) texture.release();
  nearest_.clear();
}

std::array<uint32_t, LODEN_UNIT_FIRST_FREE> SharedTextures::emptyUnits(const MaterialVariant& variant) const {
  std::array<uint32_t, LODEN_UNIT_FIRST_FREE> units;
  units.fill(empty_array_.name());
  for (int b = 0; b < LODEN_MAX_BANDS; ++b) units[size_t(LODEN_UNIT_TABLE + b)] = units[size_t(LODEN_UNIT_ENVIRONMENT + b)] = empty_volume_.name();
  units[LODEN_UNIT_GEOMETRY] = empty_2d_.name();
  units[LODEN_UNIT_VDIM_VOLUME] = empty_volume_.name();
  if (variant.nearest_tables)
    units[LODEN_UNIT_NEAREST_LIGHT] = units[LODEN_UNIT_NEAREST_VIEW] = empty_index_.name();
  return units;
}

uint32_t SharedTextures::nearestImage(const DirectionSet& set) {
  GlTexture& texture = nearest_[directionsKey(set)];
  if (!texture)
    texture = makeIndexTexture(nearestDirectionLookup(set, kNearestLookupSide), kNearestLookupSide,
                               "nearest of " + directionsName(set));
  return texture.name();
}

MaterialGpu::MaterialGpu(const Material& material, const MaterialVariant& variant, const std::string& label,
                         VdimAtlasSize atlas, size_t parts)
    : material_(&material), variant_(variant), label_(label), data_(makeMaterialData(material, atlas)), parts_(parts) {}

void MaterialGpu::create(SharedTextures& shared) {
  empty_ = shared.emptyUnits(variant_);
  if (variant_.nearest_tables) {
    empty_[LODEN_UNIT_NEAREST_LIGHT] = shared.nearestImage(material_->lights);
    empty_[LODEN_UNIT_NEAREST_VIEW] = shared.nearestImage(material_->views);
  }
  if (variant_.kind == MaterialVariant::Kind::kSurface) createSurfaceStandIns();
  bound_ = empty_;
  block_ = makeBuffer(sizeof data_, {}, GL_DYNAMIC_STORAGE_BIT, label_ + " block");
  written_ = false;
}

void MaterialGpu::createSurfaceStandIns() {
  const PhongMean& mean = material_->mean;
  const float scale = data_.surface.x;
  const glm::vec4 specular{scale > 0 ? mean.ks / scale : 0, std::log2(std::max(mean.alpha, 1.0f)) / 12, 0, 1};
  const PartTexture texels[] = {
      oneTexel(LODEN_UNIT_NORMAL, TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, false, {0, 0, 1, 0}),
      oneTexel(LODEN_UNIT_DIFFUSE, TexelFormat::kRGBA16Unorm, TextureShape::kArray2D, false, {meanAlbedo(mean), 1}),
      oneTexel(LODEN_UNIT_SPECULAR, TexelFormat::kRG8Unorm, TextureShape::kArray2D, false, specular)};
  stand_ins_.clear();
  for (const PartTexture& texel : texels) {
    stand_ins_.push_back(uploadWhole(texel, label_ + " stand-in"));
    empty_[size_t(texel.unit)] = stand_ins_.back().name();
  }
}

void MaterialGpu::contextLost() {
  block_.release();
  for (GlTexture& texture : stand_ins_) texture.release();
  stand_ins_.clear();
  for (PartTextures& part : parts_) {
    for (GlTexture& texture : part.textures) texture.release();
    part = {};
  }
}

void MaterialGpu::setPart(size_t part, std::vector<GlTexture> textures, const LoadedPart& loaded) {
  PartTextures& slot = parts_[part];
  slot.textures = std::move(textures);
  slot.units.clear();
  for (size_t i = 0; i < loaded.textures.size(); ++i) {
    slot.units.push_back(loaded.textures[i].unit);
    bound_[size_t(loaded.textures[i].unit)] = slot.textures[i].name();
  }
}

void MaterialGpu::dropPart(size_t part) {
  for (int unit : parts_[part].units) bound_[size_t(unit)] = empty_[size_t(unit)];
  parts_[part] = {};
}

void MaterialGpu::publish(const ResidentState& state) {
  const bool same = state.lambda == published_.lambda && state.geometry == published_.geometry &&
                    state.bands == published_.bands;
  if (written_ && same) return;
  published_ = state;
  written_ = true;
  applyResidency(data_, *material_, state);
  glNamedBufferSubData(block_.name(), 0, sizeof data_, &data_);
}

void MaterialGpu::bind() const {
  glBindTextures(0, GLsizei(bound_.size()), bound_.data());
  glBindSamplers(0, GLsizei(bound_.size()), nullptr);
  glBindBufferBase(GL_UNIFORM_BUFFER, LODEN_BLOCK_MATERIAL, block_.name());
}

}  // namespace loden::runtime
