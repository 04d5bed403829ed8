// The sample renderer's uniform blocks.
#include "scene_shared.h"

layout(std140, binding = SCENE_BLOCK_FRAME) uniform SceneFrameBlock {
  SceneFrame scene;
};
layout(std140, binding = SCENE_BLOCK_OBJECT) uniform SceneObjectBlock {
  SceneObject object;
};
#ifdef SCENE_BASE
layout(std140, binding = SCENE_BLOCK_BASE_MATERIAL) uniform SceneBaseMaterialBlock {
  SceneBaseMaterial base_material;
};
#endif
