// The glTF extensions that are understood: by bakes, and by the runtime, which draws more of them.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace loden {

// Those that a bake heeds, or that change nothing in what it bakes.
inline constexpr std::array<std::string_view, 3> kSupportedGltfExtensions{
    "KHR_lights_punctual", "KHR_mesh_quantization", "LODEN_materials_flat_btf"};
constexpr bool isSupportedGltfExtension(std::string_view name) {
  return std::find(kSupportedGltfExtensions.begin(), kSupportedGltfExtensions.end(), name) !=
         kSupportedGltfExtensions.end();
}

// Those that a scene may require: the runtime draws them, or what is drawn does not depend on them. `loden
// validate` accepts the same.
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
