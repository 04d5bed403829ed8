// Valid files that the JSON parser's library refuses, rewritten so that it does not.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace loden::runtime {

// The file without the bytes that EXT_meshopt_compression leaves away: buffers that only say how large views
// are once they are decompressed become small ones. Nothing if the file has none. `json` is its JSON text,
// whose depth has been checked.
std::vector<std::byte> withoutFallbackBuffers(std::span<const std::byte> file, std::string_view json);

}  // namespace loden::runtime
