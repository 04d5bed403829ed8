// Private to the renderer: glTF's own materials on the GPU.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "runtime/gl/gl_objects.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// The base materials (glTF's own metallic-roughness materials): one per material of the scene, then glTF's
// default material as the last.
class BaseMaterials {
 public:
  // Uploads every image that a material uses, with mipmaps, once per pair of colour space and sampler. Images
  // larger than the driver's largest texture are halved until they fit.
  explicit BaseMaterials(const Scene& scene);

  // The index, for alphaMode() and bind(), of an instance's material.
  int indexOf(const Instance& instance) const {
    return instance.material >= 0 ? instance.material : static_cast<int>(materials_.size()) - 1;
  }
  AlphaMode alphaMode(int material) const { return materials_[size_t(material)].alpha_mode; }
  // Binds the textures and the uniform block of that material.
  void bind(int material) const;
  // Bytes of all textures on the GPU, mipmaps included.
  uint64_t textureBytes() const { return texture_bytes_; }

 private:
  struct Item {
    AlphaMode alpha_mode = AlphaMode::kOpaque;
    // GL names by TextureRole; 0 where the material has no such texture
    std::array<uint32_t, kTextureRoles> textures{};
  };
  std::vector<GlTexture> textures_;
  std::vector<Item> materials_;
  GlBuffer uniforms_;
  size_t stride_ = 0;
  uint64_t texture_bytes_ = 0;
};

}  // namespace loden::runtime
