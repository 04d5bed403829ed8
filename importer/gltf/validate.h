// What `loden validate` says about assets; about scenes, see validateGltf in importer/gltf/pack.h. Not
// installed.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "material/base/result.h"

namespace loden::importer {

// validateAsset, and a warning (kPrefix) if the asset is sound and ends before its last chunk: whoever draws
// it gets a coarser material.
std::vector<Issue> validateAssetBytes(std::span<const std::byte> bytes, const std::string& name);

}  // namespace loden::importer
