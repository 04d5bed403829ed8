// Private to the renderer: a scene as the frame loop sees it. Only poseScene changes it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "runtime/frame/base_materials.h"
#include "runtime/frame/mesh_gpu.h"
#include "runtime/gl/device.h"
#include "runtime/gl/gl_objects.h"
#include "runtime/gl/material/material_system.h"
#include "runtime/scene/animation.h"
#include "runtime/scene/camera.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// An instance.
struct Object {
  int mesh = 0;           // index into GpuScene::meshes; a deformed one's is its own
  bool deformed = false;  // by a skin or morph targets
  glm::mat4 world_from_local{1};
  int asset = -1;               // index into GpuScene::assets; -1: drawn with its base material
  int base_material = 0;        // of GpuScene::base_materials
  float periods_per_metre = 1;  // of its UVs
  bool curved = false;          // or with stretched UVs: the lookup follows it
  Bounds bounds;                // world
  FacingCone facing;            // every direction if double sided
  bool mirrored = false;        // by its transform: front faces are clockwise
  bool double_sided = false;
};

// Unloads the material when it goes. The system must outlive it, with its context current.
class OwnedMaterial {
 public:
  OwnedMaterial(MaterialSystem& system, MaterialId id) : system_(&system), id_(id) {}
  OwnedMaterial(OwnedMaterial&& other) noexcept
      : system_(std::exchange(other.system_, nullptr)), id_(other.id_) {}
  OwnedMaterial& operator=(OwnedMaterial&& other) noexcept {
    std::swap(system_, other.system_);
    std::swap(id_, other.id_);
    return *this;
  }
  ~OwnedMaterial() {
    if (system_) system_->unload(id_);
  }
  MaterialId id() const { return id_; }

 private:
  MaterialSystem* system_;
  MaterialId id_;
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
  std::vector<Asset> assets;
  std::vector<Light> lights;  // points and spots
  std::optional<Light> sun;
  Bounds bounds;                    // of all objects, world
  std::vector<Light> scene_lights;  // all, in the scene's order
  GlBuffer object_uniforms;         // a SceneObject every `object_stride` bytes
  size_t object_stride = 0;
};

// Uploads meshes and per-object data, opens the assets. Issues of MaterialSystem::load.
Result<GpuScene> uploadScene(const Scene& scene, const Device& device, MaterialSystem& materials);

// Takes over the Loden materials that the scene's materials have by now, and opens the assets that are new
// behind those that there were; the scene must be the one that was uploaded, in this pose. Issues of
// MaterialSystem::load.
Status dressScene(const Scene& scene, const ScenePose& pose, MaterialSystem& materials, GpuScene& gpu);

// Moves everything to where the pose has it; the scene must be the one that was uploaded. Tile periods per
// metre stay those of the uploaded scene. Whether anything moved.
bool poseScene(const Scene& scene, const ScenePose& pose, GpuScene& gpu);

}  // namespace loden::runtime
