// The materials of a tile's glTF file: metallic-roughness with textures and KHR_texture_transform. Other
// parts of a material are not baked, and a warning names them. Not installed.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "importer/tile/tile.h"
#include "material/base/result.h"

namespace tinygltf {
class Model;
struct TextureInfo;
}  // namespace tinygltf

namespace loden::importer {

inline constexpr const char* kTextureTransform = "KHR_texture_transform";

// The mapping of a texture onto a primitive.
struct GltfTextureUse {
  int set = -1;  // n of TEXCOORD_n; -1: there is no texture
  glm::dmat3 transform{
      1};  // texture coordinates of the picture from those of the vertices (KHR_texture_transform)
};

struct GltfMaterial {
  std::string label;                     // "material 3 'Linen'"
  LocalBrdf brdf;                        // from the factors alone
  uint32_t index = TexturePoint::kNone;  // in GltfMaterials::textured, if it has textures
  GltfTextureUse base_color, metallic_roughness;
};

class GltfMaterials {
 public:
  // `file` names the model in messages.
  GltfMaterials(const tinygltf::Model& model, std::string file) : model_(model), file_(std::move(file)) {}

  // The material of this index, or for -1 a grey matt one. It is read once, and valid as long as this object.
  Result<const GltfMaterial*> at(int material);
  // Adds a warning, once for each place.
  void warn(const std::string& place, const std::string& text);

  std::vector<TileMaterial> textured;
  std::vector<Issue> warnings;

 private:
  Result<GltfMaterial> read(size_t material);
  Result<GltfTextureUse> use(const tinygltf::TextureInfo& info, const std::string& where) const;
  Result<std::shared_ptr<const TileTexture>> texture(int index, bool srgb, const std::string& where);
  void warnOfUnbaked(size_t material, const std::string& label);
  Issue refuse(const std::string& where, const std::string& text) const;

  const tinygltf::Model& model_;
  const std::string file_;
  std::map<int, GltfMaterial> read_;
  std::map<std::pair<int, bool>, std::shared_ptr<const TileTexture>> textures_;  // [index, sRGB]
};

}  // namespace loden::importer
