// Assets with one fault each: for every issue that an asset can have, inputs that provoke it and no other
// issue.
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

// A chunk before it is compressed.
struct RawChunk {
  uint32_t type = 0;
  Bytes raw;
  uint32_t flags = asset::kFlagCritical;
};

// The chunks of a material in the writer's layout, without the writer's checks.
std::vector<RawChunk> rawChunks(const Material& material);

// A file of these chunks. `forge` may change the table before its checksum is computed; the bytes of the
// chunks stay. With stored_only no chunk is compressed.
Bytes assemble(const std::vector<RawChunk>& raw,
               const std::function<void(std::vector<ChunkInfo>&)>& forge = {}, bool stored_only = false);

struct AssetFault {
  int id = 0;        // of the issue
  std::string what;  // names this input among those of the issue, for messages
  Bytes file;
  std::optional<Material> material;  // with the same fault, if the writer has to refuse that too
};

// Faults in no particular order, at least one for every issue of an asset.
std::vector<AssetFault> assetFaults();

}  // namespace loden::test
