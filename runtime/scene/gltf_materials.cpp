// Materials: glTF's metallic-roughness model, and the extensions of it that are drawn.
#include <cmath>

#include "runtime/scene/gltf_reader.h"

namespace loden::runtime::gltf {
namespace {

glm::vec3 colorOf(const std::vector<double>& values, const glm::vec3& fallback) {
  if (values.size() < 3) return fallback;
  const glm::vec3 color(values[0], values[1], values[2]);
  return std::isfinite(color.x + color.y + color.z) ? glm::clamp(color, 0.0f, 1e6f) : fallback;
}

float unitFactor(double value, float fallback) {
  return std::isfinite(value) ? glm::clamp(static_cast<float>(value), 0.0f, 1.0f) : fallback;
}

float factorMember(const tinygltf::Value& object, const char* key, float fallback) {
  return unitFactor(numberMember(object, key).value_or(fallback), fallback);
}

glm::vec3 colorMember(const tinygltf::Value& object, const char* key, const glm::vec3& fallback) {
  if (!object.Has(key) || !object.Get(key).IsArray()) return fallback;
  const tinygltf::Value& array = object.Get(key);
  std::vector<double> values;
  for (size_t i = 0; i < array.ArrayLen(); ++i)
    if (array.Get(int(i)).IsNumber()) values.push_back(array.Get(int(i)).GetNumberAsDouble());
  return colorOf(values, fallback);
}

// What the readers of one material share.
struct MaterialReader {
  Reader& reader;
  const tinygltf::Material& source;
  std::string place;
  SceneMaterial& material;

  template <class Info>  // tinygltf has three kinds
  void texture(TextureRole role, const Info& info) {
    material.texture(role) =
        readTexture(reader, {info.index, info.texCoord, 1, transformOf(info.extensions)}, place);
  }
  void texture(TextureRole role, const tinygltf::Value& object, const char* key) {
    material.texture(role) = readTexture(reader, textureMember(object, key), place);
  }
  const tinygltf::Value* extension(const char* name) const {
    const auto found = source.extensions.find(name);
    return found != source.extensions.end() && found->second.IsObject() ? &found->second : nullptr;
  }
};

void readCore(MaterialReader& in) {
  const tinygltf::PbrMetallicRoughness& pbr = in.source.pbrMetallicRoughness;
  SceneMaterial& material = in.material;
  const float alpha = pbr.baseColorFactor.size() == 4 ? unitFactor(pbr.baseColorFactor[3], 1) : 1;
  material.base_color = glm::vec4(colorOf(pbr.baseColorFactor, glm::vec3(1)), alpha);
  material.metallic = unitFactor(pbr.metallicFactor, 1);
  material.roughness = unitFactor(pbr.roughnessFactor, 1);
  material.emissive = colorOf(in.source.emissiveFactor, glm::vec3(0));
  material.double_sided = in.source.doubleSided;
  if (const float scale = float(in.source.normalTexture.scale); std::isfinite(scale))
    material.normal_scale = scale;
  material.occlusion_strength = unitFactor(in.source.occlusionTexture.strength, 1);
  if (in.source.alphaMode == "MASK") material.alpha_mode = AlphaMode::kMask;
  if (in.source.alphaMode == "BLEND") material.alpha_mode = AlphaMode::kBlend;
  if (std::isfinite(in.source.alphaCutoff)) material.alpha_cutoff = float(in.source.alphaCutoff);
  in.texture(TextureRole::kBaseColor, pbr.baseColorTexture);
  in.texture(TextureRole::kMetallicRoughness, pbr.metallicRoughnessTexture);
  in.texture(TextureRole::kNormal, in.source.normalTexture);
  in.texture(TextureRole::kOcclusion, in.source.occlusionTexture);
  in.texture(TextureRole::kEmissive, in.source.emissiveTexture);
}

void readSpecular(MaterialReader& in) {
  if (const tinygltf::Value* object = in.extension("KHR_materials_ior")) {
    const double ior = numberMember(*object, "ior").value_or(1.5);
    if (ior == 0 || (ior >= 1 && ior < 1e6)) in.material.ior = static_cast<float>(ior);
  }
  const tinygltf::Value* object = in.extension("KHR_materials_specular");
  if (!object) return;
  in.material.specular = factorMember(*object, "specularFactor", 1);
  in.material.specular_color = colorMember(*object, "specularColorFactor", glm::vec3(1));
  in.texture(TextureRole::kSpecular, *object, "specularTexture");
  in.texture(TextureRole::kSpecularColor, *object, "specularColorTexture");
}

void readSheen(MaterialReader& in) {
  const tinygltf::Value* object = in.extension("KHR_materials_sheen");
  if (!object) return;
  in.material.sheen_color = colorMember(*object, "sheenColorFactor", glm::vec3(0));
  in.material.sheen_roughness = factorMember(*object, "sheenRoughnessFactor", 0);
  in.texture(TextureRole::kSheenColor, *object, "sheenColorTexture");
  in.texture(TextureRole::kSheenRoughness, *object, "sheenRoughnessTexture");
}

void readClearcoat(MaterialReader& in) {
  const tinygltf::Value* object = in.extension("KHR_materials_clearcoat");
  if (!object) return;
  in.material.clearcoat = factorMember(*object, "clearcoatFactor", 0);
  in.material.clearcoat_roughness = factorMember(*object, "clearcoatRoughnessFactor", 0);
  in.material.clearcoat_normal_scale = textureMember(*object, "clearcoatNormalTexture").scale;
  in.texture(TextureRole::kClearcoat, *object, "clearcoatTexture");
  in.texture(TextureRole::kClearcoatRoughness, *object, "clearcoatRoughnessTexture");
  in.texture(TextureRole::kClearcoatNormal, *object, "clearcoatNormalTexture");
}

void readEmissiveStrength(MaterialReader& in) {
  const tinygltf::Value* object = in.extension("KHR_materials_emissive_strength");
  if (!object) return;
  const double strength = numberMember(*object, "emissiveStrength").value_or(1);
  if (strength >= 0 && strength < 1e6) in.material.emissive *= static_cast<float>(strength);
}

Result<SceneMaterial> readMaterial(Reader& reader, size_t index) {
  SceneMaterial material;
  MaterialReader in{reader, reader.model.materials[index], at("materials", index), material};
  material.name = in.source.name;
  for (auto* read : {&readCore, &readSpecular, &readSheen, &readClearcoat, &readEmissiveStrength}) read(in);
  material.unlit = in.source.extensions.contains("KHR_materials_unlit");
  if (Status status = readFlatBtf(reader, in.source, in.place, material.flat_btf); !status)
    return status.issue();
  return material;
}

}  // namespace

std::optional<double> numberMember(const tinygltf::Value& object, const char* key) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return {};
  return object.Get(key).GetNumberAsDouble();
}

std::optional<int> indexMember(const tinygltf::Value& object, const char* key) {
  const std::optional<double> number = numberMember(object, key);
  if (!number || !(*number >= 0 && *number < 1e9) || *number != std::floor(*number)) return {};
  return static_cast<int>(*number);
}

std::string stringMember(const tinygltf::Value& object, const char* key) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsString()) return {};
  return object.Get(key).Get<std::string>();
}

Status readMaterials(Reader& reader) {
  for (size_t i = 0; i < reader.model.materials.size(); ++i) {
    auto material = readMaterial(reader, i);
    if (!material) return material.issue();
    reader.scene.materials.push_back(*std::move(material));
  }
  return {};
}

}  // namespace loden::runtime::gltf
