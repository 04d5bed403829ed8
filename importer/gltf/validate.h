// The parts of what `loden validate` says; the whole about a scene is validateGltf in importer/gltf/pack.h.
// Not installed.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "importer/gltf/gltf_accessor.h"
#include "material/base/result.h"

namespace loden::importer {

// validateAsset, and a warning (kPrefix) if the asset is sound and ends before its last chunk: whoever draws
// it gets a coarser material.
std::vector<Issue> validateAssetBytes(std::span<const std::byte> bytes, const std::string& name);

// What is wrong with meshes, nodes and scenes of a document whose lists hold objects.
std::vector<Issue> checkSceneGraph(const nlohmann::ordered_json& scene, GltfBuffers& buffers,
                                   const std::string& file);

}  // namespace loden::importer
