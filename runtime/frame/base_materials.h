// Private to the renderer: glTF's own materials on the GPU, whose textures are streamed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "material/base/result.h"
#include "runtime/frame/owned.h"
#include "runtime/gl/gl_objects.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// A texture that a mesh needs, and how finely: see texelDensity().
struct TextureNeed {
  int texture = 0;             // index into BaseMaterials::textures()
  float texels_per_metre = 0;  // in the mesh's own frame; 0: the image itself, however far away
};

// The base materials (glTF's own metallic-roughness materials): one per material of the scene, then glTF's
// default material as the last.
class BaseMaterials {
 public:
  struct StreamedTexture {
    OwnedTexture id;
    std::string name;
    glm::ivec2 size;  // of the image
    bool mipmapped;
  };

  // Has every image that a material uses streamed as a texture, once per pair of colour space and sampler.
  // Issues: those of MaterialSystem::loadTexture.
  static Result<BaseMaterials> create(const Scene& scene, MaterialSystem& system);

  // The index, for the calls below, of an instance's material.
  int indexOf(const Instance& instance) const {
    return instance.material >= 0 ? instance.material : static_cast<int>(materials_.size()) - 1;
  }
  AlphaMode alphaMode(int material) const { return materials_[size_t(material)].alpha_mode; }
  const std::vector<StreamedTexture>& textures() const { return textures_; }
  // The textures that the mesh needs if it wears this material of the scene; each once.
  std::vector<TextureNeed> needsOf(const Mesh& mesh, const SceneMaterial& source, int material) const;
  // The texture by which an alpha mask cuts out; -1: there is no mask, or no texture.
  int maskTexture(int material) const;
  // Binds the textures and the uniform block of that material.
  void bind(int material) const;

 private:
  struct Item {
    AlphaMode alpha_mode = AlphaMode::kOpaque;
    std::array<int, kTextureRoles> textures{};  // indices into textures_ by TextureRole; -1: none
  };
  explicit BaseMaterials(MaterialSystem& system) : system_(&system) {}
  Status loadTextures(const Scene& scene, const std::vector<SceneMaterial>& materials);
  void uploadUniforms(const std::vector<SceneMaterial>& materials);

  MaterialSystem* system_;
  std::vector<StreamedTexture> textures_;
  std::vector<Item> materials_;
  GlBuffer uniforms_;
  size_t stride_ = 0;
};

}  // namespace loden::runtime
