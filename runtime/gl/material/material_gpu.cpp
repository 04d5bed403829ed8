#include "runtime/gl/material/material_gpu.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "material/model/color.h"
#include "runtime/gl/gl_state.h"
#include "runtime/gl/material/gl_texture.h"

namespace loden::runtime {
namespace {

PartTexture oneTexel(int unit, TexelFormat format, TextureShape shape, bool plain_2d,
                     const glm::vec4& value) {
  PartTexture texel{unit, Sampling::kRepeatNearest, plain_2d, "", Texture::make(format, shape, 1, 1, 1)};
  storeTexel(texel.texels, 0, 0, 0, 0, value);
  return texel;
}

void writeWhole(const PartTexture& part, const GlTexture& texture) {
  int64_t unlimited = std::numeric_limits<int64_t>::max();
  TextureUpload().step(part, texture.name(), unlimited);
}

std::string directionsKey(const DirectionSet& set) {
  return std::string(reinterpret_cast<const char*>(set.samples.data()),
                     set.samples.size() * sizeof set.samples[0]);
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
  for (auto& [key, shared] : nearest_)
    if (const auto texture = shared.lock()) texture->release();
  nearest_.clear();
}

std::vector<uint32_t> SharedTextures::emptyUnits(const MaterialVariant& variant) const {
  std::vector<uint32_t> units(size_t(unitsOf(variant)), empty_array_.name());
  for (int b = 0; b < variant.bands; ++b)
    units[size_t(LODEN_UNIT_TABLE(variant.bands) + b)] =
        units[size_t(LODEN_UNIT_ENVIRONMENT(variant.bands) + b)] = empty_volume_.name();
  units[LODEN_UNIT_GEOMETRY] = empty_2d_.name();
  units[LODEN_UNIT_VDIM_VOLUME] = empty_volume_.name();
  if (variant.nearest_tables)
    units[LODEN_UNIT_NEAREST_LIGHT] = units[LODEN_UNIT_NEAREST_VIEW] = empty_index_.name();
  return units;
}

std::shared_ptr<const GlTexture> SharedTextures::nearestImage(const DirectionSet& set) {
  std::erase_if(nearest_, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<GlTexture>& shared = nearest_[directionsKey(set)];
  if (auto texture = shared.lock()) return texture;
  const auto texture =
      std::make_shared<GlTexture>(makeIndexTexture(nearestDirectionLookup(set, kNearestLookupSide),
                                                   kNearestLookupSide, "nearest of " + directionsName(set)));
  shared = texture;
  return texture;
}

MaterialGpu::MaterialGpu(const Material& material, const MaterialVariant& variant, const std::string& label,
                         size_t parts)
    : material_(&material),
      variant_(variant),
      label_(label),
      data_(makeMaterialData(material)),
      parts_(parts) {}

void MaterialGpu::create(SharedTextures& shared) {
  empty_ = shared.emptyUnits(variant_);
  if (variant_.nearest_tables) {
    nearest_light_ = shared.nearestImage(material_->lights);
    nearest_view_ = shared.nearestImage(material_->views);
    empty_[LODEN_UNIT_NEAREST_LIGHT] = nearest_light_->name();
    empty_[LODEN_UNIT_NEAREST_VIEW] = nearest_view_->name();
  }
  if (variant_.near && variant_.bands == 0) createSurfaceStandIns();
  bound_ = empty_;
  block_ = makeBuffer(sizeof data_, {}, GL_DYNAMIC_STORAGE_BIT, label_ + " block");
  written_ = false;
}

void MaterialGpu::createSurfaceStandIns() {
  const PhongMean& mean = material_->mean;
  const float scale = data_.specular_scale;
  const bool ggx = material_->surface->lobe == Lobe::kGgx;
  // A GGX material is dull until its maps are there.
  const float strength = ggx || !(scale > 0) ? 0 : mean.ks / scale;
  const float width = ggx ? 1 : std::log2(std::max(mean.alpha, 1.0f)) / 12;
  stand_ins_.clear();
  const auto add = [this](int unit, TexelFormat format, std::vector<glm::vec4> layers) {
    Texture texels = Texture::make(format, TextureShape::kArray2D, 1, 1, int(layers.size()));
    for (size_t z = 0; z < layers.size(); ++z) storeTexel(texels, 0, 0, 0, int(z), layers[z]);
    StandIn stand_in;
    stand_in.texel.unit = unit;
    stand_in.texel.sampling = Sampling::kRepeatNearest;
    stand_in.texel.texels = std::move(texels);
    stand_in.average = layers;
    stand_in.mean = std::move(layers);
    stand_in.texture = uploadWhole(stand_in.texel, label_ + " stand-in");
    empty_[size_t(unit)] = stand_in.texture.name();
    stand_ins_.push_back(std::move(stand_in));
  };
  add(LODEN_UNIT_NORMAL(0), TexelFormat::kRGBA8Snorm, {{0, 0, 1, width}});
  add(LODEN_UNIT_COLOR(0), TexelFormat::kRGBA8Unorm, {{glm::sqrt(meanAlbedo(mean)), strength}});
  // Of a plane with nothing around it: the integrals of the basis times the cosine, over pi.
  add(LODEN_UNIT_AMBIENT(0), TexelFormat::kRGBA8Snorm, {{1, 2.0f / 3, 0, 0}, {0, 0, 0, 0}});
  // No shadows.
  if (variant_.shadow_quads > 0)
    add(LODEN_UNIT_SHADOW(0), TexelFormat::kRGBA8Snorm, std::vector<glm::vec4>(variant_.shadow_quads));
  if (variant_.indirect) add(LODEN_UNIT_INDIRECT(0), TexelFormat::kRGBA8Snorm, std::vector<glm::vec4>(2));
  stand_ins_shown_ = true;
}

void MaterialGpu::fadeStandIns(float share) {
  const GlPixelStateScope scope;
  for (StandIn& stand_in : stand_ins_) {
    for (size_t z = 0; z < stand_in.mean.size(); ++z)
      storeTexel(stand_in.texel.texels, 0, 0, 0, int(z),
                 glm::mix(stand_in.mean[z], stand_in.average[z], share));
    writeWhole(stand_in.texel, stand_in.texture);
  }
  stand_ins_shown_ = share < 1;
  chooseUnits();
}

void MaterialGpu::contextLost() {
  block_.release();
  nearest_light_.reset(), nearest_view_.reset();
  for (StandIn& stand_in : stand_ins_) stand_in.texture.release();
  stand_ins_.clear();
  for (PartTextures& part : parts_) {
    for (GlTexture& texture : part.textures) texture.release();
    part = {};
  }
}

void MaterialGpu::setPart(size_t part, std::vector<GlTexture> textures, const LoadedPart& loaded) {
  PartTextures& slot = parts_[part];
  slot.units.reserve(loaded.textures.size());  // before anything changes
  slot.textures = std::move(textures);
  slot.units.clear();
  for (const PartTexture& texture : loaded.textures) {
    slot.units.push_back(texture.unit);
    for (StandIn& stand_in : stand_ins_)
      for (size_t z = 0; z < stand_in.average.size() && stand_in.texel.unit == texture.unit; ++z)
        stand_in.average[z] = fetchTexel(texture.texels, texture.texels.mips - 1, 0, 0, int(z));
  }
  chooseUnits();
}

void MaterialGpu::dropPart(size_t part) {
  if (parts_[part].units.empty()) return;
  parts_[part] = {};
  chooseUnits();
}

void MaterialGpu::chooseUnits() {
  bound_ = empty_;
  for (const PartTextures& part : parts_)
    for (size_t i = 0; i < part.units.size(); ++i) bound_[size_t(part.units[i])] = part.textures[i].name();
  if (!stand_ins_shown_) return;
  for (const StandIn& stand_in : stand_ins_) bound_[size_t(stand_in.texel.unit)] = stand_in.texture.name();
}

bool MaterialGpu::publish(const ResidentState& state) {
  if (written_ && state == published_) return false;
  if (!stand_ins_.empty()) fadeStandIns(coarsestShare(*material_, state));
  published_ = state;
  written_ = true;
  applyResidency(data_, *material_, state);
  glNamedBufferSubData(block_.name(), 0, sizeof data_, &data_);
  return true;
}

void MaterialGpu::bind() const {
  glBindTextures(variant_.first_unit, GLsizei(bound_.size()), bound_.data());
  glBindSamplers(variant_.first_unit, GLsizei(bound_.size()), nullptr);
  glBindBufferBase(GL_UNIFORM_BUFFER, LODEN_BLOCK_MATERIAL, block_.name());
}

}  // namespace loden::runtime
