#include "importer/tile/file/gltf_materials.h"

#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "importer/tile/mesh_material.h"
#include "material/base/gltf_extensions.h"
#include "material/base/issues.h"
#include "material/model/color.h"

namespace loden::importer {
namespace {

constexpr double kMostTransform = 1e9;  // keeps transformed coordinates finite

// The numbers of an extension's member; nothing if it is no array of `count` finite numbers.
std::optional<glm::dvec2> pairOf(const tinygltf::Value& value) {
  if (!value.IsArray() || value.ArrayLen() != 2 || !value.Get(0).IsNumber() || !value.Get(1).IsNumber())
    return std::nullopt;
  const glm::dvec2 pair(value.Get(0).GetNumberAsDouble(), value.Get(1).GetNumberAsDouble());
  if (!(std::abs(pair.x) <= kMostTransform && std::abs(pair.y) <= kMostTransform)) return std::nullopt;
  return pair;
}

std::optional<TileTexture::Wrap> wrapOf(int mode) {
  switch (mode) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return TileTexture::Wrap::kRepeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return TileTexture::Wrap::kClamp;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return TileTexture::Wrap::kMirror;
    default:
      return std::nullopt;
  }
}

// Linear texels of a picture; none if it was not read, or holds what tinygltf does not decode to.
std::vector<glm::vec3> texelsOf(const tinygltf::Image& image, bool srgb) {
  const size_t bytes = image.bits == 8    ? 1
                       : image.bits == 16 ? 2
                                          : 0,
               channels = size_t(std::max(image.component, 0));
  if (image.width < 1 || image.height < 1 || bytes == 0 || channels < 3) return {};
  const size_t texels = size_t(image.width) * size_t(image.height);
  if (image.image.size() / texels < bytes * channels) return {};
  std::vector<float> linear;  // [code]
  const size_t highest = bytes == 1 ? 255 : 65535;
  for (size_t code = 0; code <= highest; ++code) {
    const double value = double(code) / double(highest);
    linear.push_back(float(srgb ? linearFromSrgb(value) : value));
  }
  std::vector<glm::vec3> result;
  result.reserve(texels);
  for (size_t t = 0; t < texels; ++t) {
    glm::vec3 texel;
    for (size_t c = 0; c < 3; ++c) {
      uint16_t code = 0;
      std::memcpy(&code, &image.image[(t * channels + c) * bytes], bytes);
      texel[int(c)] = linear[code];
    }
    result.push_back(texel);
  }
  return result;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace

Issue GltfMaterials::refuse(const std::string& where, const std::string& text) const {
  return {issue_id::kTileMaterial, Severity::kError, file_ + ": " + where, text};
}

void GltfMaterials::warn(const std::string& place, const std::string& text) {
  warnings.push_back({issue_id::kTileMaterial, Severity::kWarning, file_ + ": " + place, text});
}

Result<const GltfMaterial*> GltfMaterials::at(int material) {
  if (const auto found = read_.find(material); found != read_.end()) return &found->second;
  GltfMaterial result{
      "no material", brdfFromMetallicRoughness(glm::vec3(0.5f), 0, 1), TexturePoint::kNone, {}, {}};
  if (material >= 0) {
    if (size_t(material) >= model_.materials.size())
      return refuse("material " + std::to_string(material), "does not exist");
    auto made = read(size_t(material));
    if (!made) return made.issue();
    result = std::move(*made);
  }
  return &read_.emplace(material, std::move(result)).first->second;
}

Result<GltfMaterial> GltfMaterials::read(size_t index) {
  const tinygltf::Material& material = model_.materials[index];
  const auto& pbr = material.pbrMetallicRoughness;
  GltfMaterial result;
  result.label =
      "material " + std::to_string(index) + (material.name.empty() ? "" : " '" + material.name + "'");
  const auto checked = [&](const char* name, double value) -> Status {
    if (value >= 0 && value <= 1) return {};
    return refuse(result.label,
                  std::string(name) + " is " + number(value) + " and must be 0 to 1; correct the material");
  };
  for (const double value : pbr.baseColorFactor)
    if (const Status status = checked("baseColorFactor", value); !status) return status.issue();
  if (const Status status = checked("metallicFactor", pbr.metallicFactor); !status) return status.issue();
  if (const Status status = checked("roughnessFactor", pbr.roughnessFactor); !status) return status.issue();

  TileMaterial factors;
  factors.name = material.name;
  factors.base_color = {float(pbr.baseColorFactor[0]), float(pbr.baseColorFactor[1]),
                        float(pbr.baseColorFactor[2])};
  factors.metallic = float(pbr.metallicFactor), factors.roughness = float(pbr.roughnessFactor);
  result.brdf = brdfFromMetallicRoughness(factors.base_color, factors.metallic, factors.roughness);
  const auto addTexture = [&](const tinygltf::TextureInfo& info, bool srgb, const char* name,
                              GltfTextureUse& use_of, std::shared_ptr<const TileTexture>& of) -> Status {
    if (info.index < 0) return {};
    auto picture = texture(info.index, srgb, result.label + ", " + name);
    if (!picture) return picture.issue();
    const auto laid = use(info, result.label + ", " + name);
    if (!laid) return laid.issue();
    of = std::move(*picture), use_of = *laid;
    return {};
  };
  if (const Status s = addTexture(pbr.baseColorTexture, true, "baseColorTexture", result.base_color,
                                  factors.base_color_texture);
      !s)
    return s.issue();
  if (const Status s = addTexture(pbr.metallicRoughnessTexture, false, "metallicRoughnessTexture",
                                  result.metallic_roughness, factors.metallic_roughness_texture);
      !s)
    return s.issue();
  if (factors.base_color_texture || factors.metallic_roughness_texture) {
    result.index = uint32_t(textured.size());
    textured.push_back(std::move(factors));
  }
  warnOfUnbaked(index, result.label);
  return result;
}

Result<GltfTextureUse> GltfMaterials::use(const tinygltf::TextureInfo& info, const std::string& where) const {
  GltfTextureUse result{info.texCoord};
  const auto found = info.extensions.find(kTextureTransform);
  if (found == info.extensions.end()) return result;
  const auto bad = [&](const char* member, const char* wanted) {
    return refuse(where + ", " + kTextureTransform,
                  std::string(member) + " is not " + wanted + "; correct the material");
  };
  glm::dvec2 offset(0), scale(1);
  for (auto [member, value] : {std::pair("offset", &offset), std::pair("scale", &scale)}) {
    if (!found->second.Has(member)) continue;
    const auto pair = pairOf(found->second.Get(member));
    if (!pair) return bad(member, "two numbers up to 1e9");
    *value = *pair;
  }
  double rotation = 0;
  if (found->second.Has("rotation")) {
    const tinygltf::Value& value = found->second.Get("rotation");
    rotation = value.IsNumber() ? value.GetNumberAsDouble() : std::nan("");
    if (!std::isfinite(rotation)) return bad("rotation", "a finite number of radians");
  }
  if (found->second.Has("texCoord")) {
    const tinygltf::Value& value = found->second.Get("texCoord");
    if (!value.IsInt() || value.GetNumberAsInt() < 0) return bad("texCoord", "a whole number from 0");
    result.set = value.GetNumberAsInt();
  }
  // Scaled, turned, moved. Counter-clockwise where v points down: the extension's words and Khronos'
  // TextureTransformTest; its GLSL listing turns the other way (KhronosGroup/glTF issue 1563).
  const double c = std::cos(rotation), s = std::sin(rotation);
  result.transform =
      glm::dmat3(c * scale.x, -s * scale.x, 0, s * scale.y, c * scale.y, 0, offset.x, offset.y, 1);
  return result;
}

Result<std::shared_ptr<const TileTexture>> GltfMaterials::texture(int index, bool srgb,
                                                                  const std::string& where) {
  auto& texture = textures_[{index, srgb}];
  if (texture) return texture;
  if (size_t(index) >= model_.textures.size())
    return refuse(where, "texture " + std::to_string(index) + " does not exist");
  const tinygltf::Texture& source = model_.textures[size_t(index)];
  if (source.source < 0 || size_t(source.source) >= model_.images.size())
    return refuse(where, "texture " + std::to_string(index) +
                             " has no image of glTF's own kinds; export it as PNG or JPEG");
  const tinygltf::Image& image = model_.images[size_t(source.source)];
  TileTexture made;
  made.width = image.width, made.height = image.height;
  made.texels = texelsOf(image, srgb);
  if (made.texels.empty())
    return refuse(where, "image " + std::to_string(source.source) +
                             (image.uri.empty() ? "" : " '" + image.uri + "'") +
                             " cannot be read; put it into the file's folder, as PNG or JPEG");
  if (source.sampler >= 0) {
    if (size_t(source.sampler) >= model_.samplers.size())
      return refuse(where, "sampler " + std::to_string(source.sampler) + " does not exist");
    const tinygltf::Sampler& sampler = model_.samplers[size_t(source.sampler)];
    const auto u = wrapOf(sampler.wrapS), v = wrapOf(sampler.wrapT);
    if (!u || !v)
      return refuse(where,
                    "sampler " + std::to_string(source.sampler) + " wraps in a way that glTF does not know");
    made.wrap_u = *u, made.wrap_v = *v;
    made.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
  }
  return texture = std::make_shared<const TileTexture>(std::move(made));
}

// One warning each.
void GltfMaterials::warnOfUnbaked(size_t index, const std::string& label) {
  const tinygltf::Material& material = model_.materials[index];
  if (material.normalTexture.index >= 0)
    warn(label, "normalTexture is not baked: a tile's relief is its geometry; displace the mesh by it");
  if (material.occlusionTexture.index >= 0)
    warn(label, "occlusionTexture is not baked: the bake traces the tile's own shadows");
  bool emits = material.emissiveTexture.index >= 0;
  for (const double value : material.emissiveFactor) emits = emits || value > 0;
  if (emits) warn(label, "emissive light is not baked: a tile only reflects");
  if (material.alphaMode != "OPAQUE")
    warn(label,
         "alphaMode " + material.alphaMode + " is not baked: a tile is opaque; cut its holes into the mesh");
  for (const auto& [name, value] : material.extensions)
    if (!isSupportedGltfExtension(name)) warn(label, name + " is not baked: metallic-roughness alone is");
}

}  // namespace loden::importer
