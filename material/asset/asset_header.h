// Encodes and decodes the HEAD chunk, which holds everything about a material except its texels and its META
// text. Internal.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "material/asset/asset_issues.h"
#include "material/model/material.h"

namespace loden::asset {

std::vector<std::byte> encodeHeader(const Material& material);

// The material that the record describes; its textures have extents but no data. Checks only what is needed
// to read the record, counts above all; checkMaterial checks the rest.
Material decodeHeader(std::span<const std::byte> record, IssueList& issues);

}  // namespace loden::asset
