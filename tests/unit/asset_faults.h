// Assets with one fault each: for every issue that an asset can have, inputs that provoke it and nothing
// else.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "material/asset/asset_chunks.h"
#include "material/asset/asset_format.h"

namespace loden::test {

using Bytes = std::vector<std::byte>;

// A chunk before it is packed.
struct RawChunk {
  uint32_t type = 0;
  Bytes raw;
  uint32_t flags = asset::kFlagCritical;
};

// The chunks of a material as the writer would lay them out, without its checks.
std::vector<RawChunk> rawChunks(const Material& material);

// A file of the chunks. `forge` changes the table before its checksum is computed, and no byte of a chunk;
// `stored_only` compresses nothing.
Bytes assemble(const std::vector<RawChunk>& raw,
               const std::function<void(std::vector<ChunkInfo>&)>& forge = {}, bool stored_only = false);

struct AssetFault {
  int id = 0;        // of the issue
  std::string what;  // for messages: which of the inputs of this issue
  Bytes file;
  std::optional<Material> material;  // where the writer has to refuse it, too
};

// At least one for every issue of an asset, in no order.
std::vector<AssetFault> assetFaults();

}  // namespace loden::test
