// The glTF extensions that a file may require: what the runtime loads and `loden validate` accepts.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace loden {

// Those that are drawn, or change nothing in what is.
inline constexpr std::array<std::string_view, 3> kSupportedGltfExtensions{
    "KHR_lights_punctual", "KHR_mesh_quantization", "LODEN_materials_flat_btf"};
constexpr bool isSupportedGltfExtension(std::string_view name) {
  return std::find(kSupportedGltfExtensions.begin(), kSupportedGltfExtensions.end(), name) !=
         kSupportedGltfExtensions.end();
}

}  // namespace loden
