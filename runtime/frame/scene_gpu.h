// Private to the renderer: a scene in GL buffers, as the passes draw it. After uploadScene only poseScene and
// dressScene change it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/frame/base_materials.h"
#include "runtime/frame/mesh_gpu.h"
#include "runtime/frame/owned.h"
#include "runtime/gl/device.h"
#include "runtime/gl/gl_objects.h"
#include "runtime/gl/material/material_system.h"
#include "runtime/scene/animation.h"
#include "runtime/scene/camera.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// An instance of a mesh.
struct Object {
  int mesh = 0;           // index into GpuScene::meshes; a deformed object has a mesh of its own
  bool deformed = false;  // its vertices are moved by a skin or morph targets
  glm::mat4 world_from_local{1};
  int asset = -1;               // index into GpuScene::assets; -1: drawn with its base material
  int base_material = 0;        // index into GpuScene::base_materials
  int needs = 0;                // index into GpuScene::needs
  float periods_per_metre = 1;  // tile periods per metre of its UVs
  bool curved = false;    // the mesh is curved or has stretched UVs, so that look-ups follow the surface
  Bounds bounds;          // world frame
  FacingCone facing;      // directions of its front faces; every direction if double sided
  bool mirrored = false;  // by its transform, so that front faces are clockwise
  bool double_sided = false;
};

struct Asset {
  OwnedMaterial material;
  std::string name;
};

struct GpuScene {
  BaseMaterials base_materials;
  GlBuffer default_attributes;
  std::vector<GpuMesh> meshes;
  std::vector<Object> objects;
  // Per pair of mesh and base material.
  std::vector<std::vector<TextureNeed>> needs;
  std::vector<Asset> assets;
  std::vector<Light> lights;  // point and spot lights
  std::optional<Light> sun;
  Bounds bounds;                    // around all objects, world frame
  std::vector<Light> scene_lights;  // all lights of the scene, in its order
  GlBuffer object_uniforms;         // one SceneObject (shaders/scene_shared.h) every `object_stride` bytes
  size_t object_stride = 0;
};

// A scene on the GPU. Uploads meshes and per-object data, opens the assets and has the images streamed.
// Issues: those of MaterialSystem::load and loadTexture.
Result<GpuScene> uploadScene(const Scene& scene, const Device& device, MaterialSystem& materials);

// Uses the Loden materials that are now bound to the scene's materials, and opens the assets that were
// appended. The scene must be the one that was uploaded, in this pose. Issues: those of MaterialSystem::load.
Status dressScene(const Scene& scene, const ScenePose& pose, MaterialSystem& materials, GpuScene& gpu);

// Moves everything to the pose, and returns whether anything moved. The scene must be the one that was
// uploaded. Tile periods per metre stay those of the uploaded scene.
bool poseScene(const Scene& scene, const ScenePose& pose, GpuScene& gpu);

}  // namespace loden::runtime
