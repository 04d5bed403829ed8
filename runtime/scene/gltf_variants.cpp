// KHR_materials_variants: other materials for the same meshes, chosen by name.
#include "runtime/scene/gltf_reader.h"

namespace loden::runtime::gltf {
namespace {

constexpr const char* kExtension = "KHR_materials_variants";

bool contains(const tinygltf::Value& array, int number) {
  for (int i = 0; array.IsArray() && i < int(array.ArrayLen()); ++i)
    if (array.Get(i).IsNumber() && array.Get(i).GetNumberAsDouble() == number) return true;
  return false;
}

// An array that an extension object holds; null if there is none.
const tinygltf::Value* arrayOf(const tinygltf::ExtensionMap& extensions, const char* key) {
  const auto found = extensions.find(kExtension);
  if (found == extensions.end() || !found->second.IsObject() || !found->second.Has(key)) return nullptr;
  const tinygltf::Value& array = found->second.Get(key);
  return array.IsArray() ? &array : nullptr;
}

}  // namespace

Status readVariants(Reader& reader, const std::string& shown) {
  if (const tinygltf::Value* variants = arrayOf(reader.model.extensions, "variants"))
    for (int i = 0; i < int(variants->ArrayLen()); ++i) {
      reader.scene.variants.push_back(stringMember(variants->Get(i), "name"));
      if (!shown.empty() && reader.scene.variants.back() == shown) reader.variant = i;
    }
  if (shown.empty() || reader.variant) return {};
  std::string names;
  for (const std::string& name : reader.scene.variants) names += (names.empty() ? "" : ", ") + name;
  return Issue{issue_id::kOption, Severity::kError, reader.file,
               "has no variant " + shown + "; there are: " + (names.empty() ? "none" : names)};
}

int materialIndex(const Reader& reader, const tinygltf::Primitive& primitive) {
  const tinygltf::Value* mappings = reader.variant ? arrayOf(primitive.extensions, "mappings") : nullptr;
  for (int i = 0; mappings && i < int(mappings->ArrayLen()); ++i) {
    const tinygltf::Value& mapping = mappings->Get(i);
    if (mapping.IsObject() && mapping.Has("variants") && contains(mapping.Get("variants"), *reader.variant))
      return indexMember(mapping, "material").value_or(primitive.material);
  }
  return primitive.material;
}

}  // namespace loden::runtime::gltf
