// The conditions that a material in an asset must satisfy, checked by the writer and by the readers.
// Internal.
#pragma once

#include <string>

#include "material/asset/asset_format.h"
#include "material/asset/asset_issues.h"
#include "material/model/material.h"

namespace loden::asset {

// Checks fields and extents, but not texels.
void checkMaterial(const Material& material, IssueList& issues);

// Checks the texels of one part, whose description has been found valid: they must be present, finite, and
// zero where unused.
void checkPartTexels(const Material& material, const Part& part, const std::string& place, IssueList& issues);

// Checks that the META text is UTF-8 and within its limit.
void checkMeta(const std::string& text, IssueList& issues);

}  // namespace loden::asset
