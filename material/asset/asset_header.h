// The HEAD chunk: everything about a material except its texels and its meta text. Internal.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "material/asset/asset_issues.h"
#include "material/model/material.h"

namespace loden::asset {

std::vector<std::byte> encodeHeader(const Material& material);

// The material that the record describes, textures with extents and no data. Checks only what it takes to
// read the record, counts above all; checkMaterial checks the rest.
Material decodeHeader(std::span<const std::byte> record, IssueList& issues);

}  // namespace loden::asset
