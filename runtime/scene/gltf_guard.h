// Checks on an untrusted glTF file before the JSON parser sees it. See also material/base/json_depth.h and
// material/system/confined_path.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "material/base/result.h"

namespace loden::runtime {

inline constexpr uint64_t kMaxGltfBytes = uint64_t(1) << 30;  // the largest file that is read

// The JSON text of a .gltf (all of it) or a .glb (its first chunk), as a view into `bytes`. Issues:
// kGltfParse if the .glb header is damaged.
Result<std::string_view> gltfJson(std::span<const std::byte> bytes, const std::string& name);

// All bytes of a regular file of at most kMaxGltfBytes.
Result<std::vector<std::byte>> readRegularFile(const std::filesystem::path& path);

}  // namespace loden::runtime
