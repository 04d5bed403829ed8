// The glTF extensions that Loden supports: a few in bakes, and more in the runtime, which draws them.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace loden {

// The extensions that a bake supports, or that do not change what it bakes.
inline constexpr std::array<std::string_view, 3> kSupportedGltfExtensions{
    "KHR_lights_punctual", "KHR_mesh_quantization", "LODEN_materials_flat_btf"};
constexpr bool isSupportedGltfExtension(std::string_view name) {
  return std::find(kSupportedGltfExtensions.begin(), kSupportedGltfExtensions.end(), name) !=
         kSupportedGltfExtensions.end();
}

// The extensions that a scene may require: the runtime draws them, or the picture does not depend on them.
// `loden validate` accepts the same extensions.
inline constexpr std::array<std::string_view, 16> kDrawnGltfExtensions{
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression",
    "EXT_texture_webp",        "KHR_lights_punctual",
    "KHR_materials_clearcoat", "KHR_materials_emissive_strength",
    "KHR_materials_ior",       "KHR_materials_sheen",
    "KHR_materials_specular",  "KHR_materials_unlit",
    "KHR_materials_variants",  "KHR_mesh_quantization",
    "KHR_texture_transform",   "KHR_xmp",
    "KHR_xmp_json_ld",         "LODEN_materials_flat_btf"};
constexpr bool isDrawnGltfExtension(std::string_view name) {
  return std::find(kDrawnGltfExtensions.begin(), kDrawnGltfExtensions.end(), name) !=
         kDrawnGltfExtensions.end();
}

}  // namespace loden
