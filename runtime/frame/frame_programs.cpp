#include "runtime/frame/frame_programs.h"

#include <epoxy/gl.h>

#include <limits>

namespace loden::runtime {

MaterialId FramePrograms::materialOf(int object) const {
  const int asset = scene_.objects[size_t(object)].asset;
  if (settings_.base_materials_only || asset < 0) return {};
  const MaterialId id = scene_.assets[size_t(asset)].material.id();
  return settings_.parallax_occlusion && !marchVariant(materials_.variant(id)) ? MaterialId{} : id;
}

AlphaMode FramePrograms::alphaMode(int object) const {
  return materialOf(object) ? AlphaMode::kOpaque
                            : scene_.base_materials.alphaMode(scene_.objects[size_t(object)].base_material);
}

// The material's, but for what the settings leave out.
MaterialVariant FramePrograms::variantOf(MaterialId id) const {
  MaterialVariant variant = materials_.variant(id);
  if (settings_.lookup == Lookup::kFast && variant.lookup == Lookup::kDefault) variant.lookup = Lookup::kFast;
  if (settings_.visibility == Visibility::kNone)
    variant.visibility = Visibility::kNone, variant.shadow_quads = 0;
  const bool fast = settings_.visibility != Visibility::kDefault || variant.lookup == Lookup::kFast;
  if (fast && byLookup(variant.visibility)) variant.visibility = Visibility::kFast;
  return variant;
}

// The same without what is too fine to be seen on the object. Its lambda has no upper bound, since pixels
// that see a surface edge on ask for any; and it is that of most of the object, a level above which is taken
// to be that of all.
MaterialVariant FramePrograms::farVariantOf(MaterialId id, float lambda) const {
  if (settings_.lambda_rule != LambdaRule::kFootprint && !settings_.lambda) return variantOf(id);
  return narrowed(variantOf(id), materials_.material(id), {lambda - 1, std::numeric_limits<float>::max()});
}

Status FramePrograms::use(std::string_view row, MaterialId id, const MaterialVariant& variant,
                          PassProgram& current) {
  if (current.program != 0 && current.row == row && current.material == id && current.variant == variant)
    return {};
  const Result<uint32_t> program = shaders_.program(row, variant);
  if (!program) return program.issue();
  if (current.program != *program) ++current.changes;
  glUseProgram(*program);
  if (id) materials_.bind(id);
  current = {row, id, variant, *program, current.changes, -1};
  return {};
}

void FramePrograms::bindBaseMaterial(int object, PassProgram& current) const {
  const int material = scene_.objects[size_t(object)].base_material;
  if (current.base_material == material) return;
  scene_.base_materials.bind(material);
  current.base_material = material;
}

bool FramePrograms::movesDepth(MaterialId id) const {
  return settings_.parallax_depth && !settings_.parallax_occlusion && settings_.heat == HeatMap::kNone &&
         id && hasRelief(materials_.variant(id));
}

Status FramePrograms::useForDepth(int object, PassProgram& current) {
  const MaterialId id = materialOf(object);
  if (alphaMode(object) == AlphaMode::kMask) {
    const Status status = use("scene_base_depth", current);
    if (status) bindBaseMaterial(object, current);
    return status;
  }
  if (!movesDepth(id)) return use("scene_depth", current);
  const bool curved = scene_.objects[size_t(object)].curved;
  return use(curved ? "scene_relief_depth_curved" : "scene_relief_depth", id, variantOf(id), current);
}

Status FramePrograms::useForShading(int object, float lambda, PassProgram& current) {
  const MaterialId id = materialOf(object);
  if (!id) {
    const bool follows = current.row == "scene_base";  // else a Loden material may hold the units
    const Status status = use("scene_base", current);
    if (status && !follows) image_light_.bind();
    if (status) bindBaseMaterial(object, current);
    return status;
  }
  const bool heat = settings_.heat != HeatMap::kNone;
  if (settings_.parallax_occlusion)
    return use(heat ? "scene_heat_march" : "scene_forward_march", id, *marchVariant(materials_.variant(id)),
               current);
  const bool curved = scene_.objects[size_t(object)].curved && hasRelief(materials_.variant(id));
  if (heat) return use(curved ? "scene_heat_curved" : "scene_heat", id, variantOf(id), current);
  if (movesDepth(id))
    return use(curved ? "scene_forward_depth_curved" : "scene_forward_depth", id, variantOf(id), current);
  const MaterialVariant variant = farVariantOf(id, lambda);
  return use(curved && hasRelief(variant) ? "scene_forward_curved" : "scene_forward", id, variant, current);
}

}  // namespace loden::runtime
