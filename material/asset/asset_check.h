// What a material must satisfy to stand in an asset: the same checks for the writer and for the readers.
// Internal.
#pragma once

#include <string>

#include "material/asset/asset_format.h"
#include "material/asset/asset_issues.h"
#include "material/model/material.h"

namespace loden::asset {

// Fields and extents; not the texels.
void checkMaterial(const Material& material, IssueList& issues);

// The texels of one part, whose description is valid: that they are there, finite, and zero where unused.
void checkPartTexels(const Material& material, const Part& part, const std::string& place, IssueList& issues);

// That meta text is UTF-8 and within its limit.
void checkMeta(const std::string& text, IssueList& issues);

}  // namespace loden::asset
