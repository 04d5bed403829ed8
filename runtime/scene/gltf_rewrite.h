// Rewrites valid glTF files that tinygltf would refuse.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace loden::runtime {

// A copy of the file in which EXT_meshopt_compression's fallback buffers, which have no bytes and only state
// how large the decompressed views are, are replaced by small buffers; empty if the file has none. `json` is
// the file's JSON text, whose depth has been checked.
std::vector<std::byte> withoutFallbackBuffers(std::span<const std::byte> file, std::string_view json);

}  // namespace loden::runtime
