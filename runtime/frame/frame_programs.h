// Private to the renderer: which program an object is drawn with, by its material and what a frame's settings
// leave out.
#pragma once

#include <cstdint>
#include <string_view>

#include "material/base/result.h"
#include "runtime/frame/frame.h"
#include "runtime/frame/image_light.h"
#include "runtime/frame/scene_gpu.h"

namespace loden::runtime {

// What a pass draws with: set again only where the next object wants another.
struct PassProgram {
  std::string_view row;
  MaterialId material;
  MaterialVariant variant;
  uint32_t program = 0;
  int changes = 0;
  int base_material = -1;  // whose textures are bound
};

// Everything that it refers to must outlive it. Objects are indices into GpuScene::objects.
class FramePrograms {
 public:
  FramePrograms(ShaderLibrary& shaders, MaterialSystem& materials, const GpuScene& scene,
                ImageLight& image_light, const FrameSettings& settings)
      : shaders_(shaders),
        materials_(materials),
        scene_(scene),
        image_light_(image_light),
        settings_(settings) {}

  // None: drawn with its base material.
  MaterialId materialOf(int object) const;
  // A Loden material is opaque whatever its fallback is.
  AlphaMode alphaMode(int object) const;
  // Whether what is drawn of the material lies below its mesh.
  bool movesDepth(MaterialId id) const;

  // A program without a material, by its row.
  Status use(std::string_view row, PassProgram& current) { return use(row, {}, {}, current); }
  // An object's depth, as the camera or the sun sees it.
  Status useForDepth(int object, PassProgram& current);
  // `lambda`: none of the object's pixels shows a finer level.
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
