// Puts a material into a glTF scene: extension LODEN_materials_flat_btf (importer/gltf/README.md).
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "material/base/result.h"

namespace loden::importer {

struct PackOptions {
  std::filesystem::path scene;   // .gltf or .glb
  std::string material;          // name of the material that gets the extension
  std::filesystem::path asset;   // .loden
  std::filesystem::path output;  // the same kind of file as `scene`
  bool embed = false;            // into a bufferView; otherwise by uri, beside the output
  int tex_coord = 0;             // TEXCOORD_n that gives x
  // Tile periods per unit of texture coordinate; none: so many that a period is as long as the next member
  // says on the material's surfaces.
  std::optional<glm::dvec2> scale;
  double period = 0;    // metres along the tile's x; 0: as the asset says, and scale 1 if it does not
  double rotation = 0;  // radians, as in KHR_texture_transform
  // Replace all that the material looks like, too: pbrMetallicRoughness and sheen fitted to the asset, its
  // colours and normals as textures, nothing of what there was.
  bool fit_fallback = false;
};

struct PackReport {
  int material = 0;             // index in the scene
  std::string asset_reference;  // uri, or "bufferView N"
  bool fallback_fitted = false;
  glm::dvec2 scale{1};  // as written
  // Metres of one tile along its x and y, the median over the material's surfaces; 0: they cannot be
  // measured.
  glm::dvec2 period{0};
  double stretch = 1;  // UvSurvey::Stretch, of the scale as written
  double stretched_share = 0;
  std::vector<std::string> remarks;          // what the caller should be told
  std::vector<std::filesystem::path> files;  // written or copied
};

// Everything else in the scene stays as it is. If the output lies in another folder, buffers and images that
// the scene names by uri are copied beside it. No file of other bytes is overwritten: an asset whose name is
// taken gets its hash into the name, a buffer or image is refused (kExists). The scene itself is written
// last, whole or not at all. Too little memory is kMemory.
Result<PackReport> pack(const PackOptions& options);

// Issues of a scene's use of the extension, of its buffers' sizes, and of the assets that it refers to; no
// result (kCannotOpen, kCannotRead) if the scene itself cannot be read.
Result<std::vector<Issue>> validateGltf(const std::filesystem::path& path);

}  // namespace loden::importer
