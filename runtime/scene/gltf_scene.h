// Reads scenes from glTF 2.0 files (.gltf, .glb), which are untrusted input.
#pragma once

#include <filesystem>
#include <string>

#include "material/base/result.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// The file's default scene: every triangle mesh with its world transform, materials with their textures and
// the extensions of kDrawnGltfExtensions (material/base/gltf_extensions.h), lights and cameras. What is not
// drawn, and images that cannot be read, are listed in Scene::notes. A mesh with the extras
//   "loden_subdivision": {"levels": 1..6, "quads": true}
// is a cage: every two consecutive triangles form one quad (a b c, a c d), and the mesh becomes a grid of
// points on the cage's Catmull-Clark limit surface. Other files are read from the glTF's own folder only.
// Meshes without normals or tangents get them. Issues: 1xxx and 5xxx, with the place in the file, and
// kMemory.
struct SceneOptions {
  // The variant to show, by name (KHR_materials_variants); empty: the meshes' own materials.
  std::string variant;
};
Result<Scene> loadGltfScene(const std::filesystem::path& path, const SceneOptions& options = {});

}  // namespace loden::runtime
