// Private to the renderer: chooses the program that an object is drawn with, from the object's material and
// the frame's settings.
#pragma once

#include <cstdint>
#include <string_view>

#include "material/base/result.h"
#include "runtime/frame/frame.h"
#include "runtime/frame/image_light.h"
#include "runtime/frame/scene_gpu.h"

namespace loden::runtime {

// The program and material that a pass has set; they are set again only if the next object needs others.
struct PassProgram {
  std::string_view row;
  MaterialId material;
  MaterialVariant variant;
  uint32_t program = 0;
  int changes = 0;
  int base_material = -1;  // the base material whose textures are bound; -1: none
};

// Chooses and binds programs for one frame. All constructor arguments must outlive it. Objects are indices
// into GpuScene::objects.
class FramePrograms {
 public:
  FramePrograms(ShaderLibrary& shaders, MaterialSystem& materials, const GpuScene& scene,
                ImageLight& image_light, const FrameSettings& settings)
      : shaders_(shaders),
        materials_(materials),
        scene_(scene),
        image_light_(image_light),
        settings_(settings) {}

  // The Loden material that the object is drawn with; 0 if it is drawn with its base (glTF) material.
  MaterialId materialOf(int object) const;
  // The alpha mode of the object: opaque for a Loden material, whatever the glTF material's own alpha mode
  // is.
  AlphaMode alphaMode(int object) const;
  // Whether the material's depth is that of its relief below the mesh, and not that of the mesh.
  bool movesDepth(MaterialId id) const;

  // Uses the program of this row without a Loden material.
  Status use(std::string_view row, PassProgram& current) { return use(row, {}, {}, current); }
  // Uses the program that draws an object's depth, as the camera or the sun sees it.
  Status useForDepth(int object, PassProgram& current);
  // Uses the program that shades an object. `lambda` is a lower bound of the level of detail of the object's
  // pixels.
  Status useForShading(int object, float lambda, PassProgram& current);

 private:
  MaterialVariant variantOf(MaterialId id) const;
  MaterialVariant farVariantOf(MaterialId id, float lambda) const;
  void bindBaseMaterial(int object, PassProgram& current) const;
  Status use(std::string_view row, MaterialId id, const MaterialVariant& variant, PassProgram& current);

  ShaderLibrary& shaders_;
  MaterialSystem& materials_;
  const GpuScene& scene_;
  ImageLight& image_light_;
  const FrameSettings& settings_;
};

}  // namespace loden::runtime
