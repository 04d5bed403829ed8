// The sample renderer's uniform blocks.
#include "scene_shared.h"

layout(std140, binding = SCENE_BLOCK_FRAME) uniform SceneFrameBlock {
  SceneFrame scene;
};
layout(std140, binding = SCENE_BLOCK_OBJECT) uniform SceneObjectBlock {
  SceneObject object;
};
