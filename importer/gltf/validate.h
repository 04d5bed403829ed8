// Parts of `loden validate`; validateGltf in importer/gltf/pack.h validates a whole scene. Not installed.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "importer/gltf/gltf_accessor.h"
#include "material/base/result.h"

namespace loden::importer {

// The issues of validateAsset, and a warning (kPrefix) if the asset is valid but ends before its last chunk,
// so that it is drawn coarser.
std::vector<Issue> validateAssetBytes(std::span<const std::byte> bytes, const std::string& name);

// The issues of meshes, nodes and scenes of a document whose lists contain only objects.
std::vector<Issue> checkSceneGraph(const nlohmann::ordered_json& scene, GltfBuffers& buffers,
                                   const std::string& file);

}  // namespace loden::importer
