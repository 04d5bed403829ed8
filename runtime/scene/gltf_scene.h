// Scenes from glTF 2.0 files (.gltf, .glb), untrusted.
#pragma once

#include <filesystem>
#include <string>

#include "material/base/result.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// The file's default scene: every triangle mesh with its world transform, materials with their textures and
// the extensions of kDrawnGltfExtensions (material/base/gltf_extensions.h), lights and cameras. What is not
// drawn, and images that cannot be read, are among the scene's notes. Meshes whose extras say
//   "loden_subdivision": {"levels": 1..6, "quads": true}
// are cages: each two triangles in a row form one quad (a b c, a c d), and the mesh becomes a grid of points
// on their Catmull-Clark limit surface. Other files are read from the glTF's own folder only. Meshes without
// normals or tangents get them. Failures are issues 1xxx and 5xxx, with the place in the file, and kMemory.
struct SceneOptions {
  std::string variant;  // by its name (KHR_materials_variants); empty: the materials of the meshes themselves
};
Result<Scene> loadGltfScene(const std::filesystem::path& path, const SceneOptions& options = {});

}  // namespace loden::runtime
