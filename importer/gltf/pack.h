// Puts a material into a glTF scene, by the extension LODEN_materials_flat_btf (importer/gltf/README.md).
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
  std::filesystem::path output;  // a file of the same kind (.gltf or .glb) as `scene`
  // Puts the asset into a bufferView; otherwise it is referenced by URI, beside the output.
  bool embed = false;
  int tex_coord = 0;  // TEXCOORD_n that gives x
  // Tile periods per unit of texture coordinate; empty: computed so that a period has the length `period` on
  // the material's surfaces.
  std::optional<glm::dvec2> scale;
  // Length of a period along the tile's x, metres; 0: as the asset says, or scale 1 if it does not.
  double period = 0;
  double rotation = 0;  // radians, as in KHR_texture_transform
  // Replaces the whole look of the material for other viewers: pbrMetallicRoughness and sheen are fitted to
  // the asset, with its colours and normals as textures, and nothing of the old look is kept.
  bool fit_fallback = false;
};

struct PackReport {
  int material = 0;             // index in the scene
  std::string asset_reference;  // the URI, or "bufferView N"
  bool fallback_fitted = false;
  glm::dvec2 scale{1};  // the scale written to the file
  // The metres of one tile along its x and y, as the median over the material's surfaces; 0: they cannot be
  // measured.
  glm::dvec2 period{0};
  double stretch = 1;  // UvSurvey::Stretch::most for the scale as written
  double stretched_share = 0;
  std::vector<std::string> remarks;          // messages for the caller to show
  std::vector<std::filesystem::path> files;  // written or copied
};

// Packs the asset. Everything else in the scene stays as it is. If the output is in another folder, buffers
// and images that the scene names by URI are copied beside it. No file is overwritten by different bytes: if
// the asset's name is taken, its hash is added to the name; a buffer or image in the same situation is
// refused (kExists). The scene itself is written last, whole or not at all. Too little memory is kMemory.
Result<PackReport> pack(const PackOptions& options);

// The issues of a scene's use of the extension, of its buffers' sizes, and of the assets that it refers to.
// No result (kCannotOpen, kCannotRead) if the scene itself cannot be read.
Result<std::vector<Issue>> validateGltf(const std::filesystem::path& path);

}  // namespace loden::importer
