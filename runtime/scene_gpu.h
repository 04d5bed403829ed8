// Private to the renderer: a scene as the frame loop sees it. Nothing in it changes from frame to frame.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/device.h"
#include "runtime/frame_shadow.h"
#include "runtime/gl_objects.h"
#include "runtime/material_system.h"
#include "runtime/mesh_gpu.h"
#include "runtime/scene.h"

namespace loden::runtime {

// An instance.
struct Object {
  int mesh = 0;                 // index into GpuScene::meshes
  int asset = -1;               // index into GpuScene::assets; -1: drawn with its base material
  float periods_per_metre = 1;  // of its UVs
  Bounds bounds;                // world
  bool mirrored = false;        // by its transform: front faces are clockwise
  bool double_sided = false;
};

struct Asset {
  MaterialId material;
  std::string name;
};

struct GpuScene {
  std::vector<GpuMesh> meshes;
  std::vector<Object> objects;
  std::vector<Asset> assets;
  std::vector<Light> lights;  // points and spots
  std::optional<Light> sun;
  SunView sun_view;
  Bounds bounds;              // of all objects, world
  GlBuffer object_uniforms;   // a SceneObject every `object_stride` bytes
  size_t object_stride = 0;
};

// Uploads meshes and per-object data, opens the assets. Issues of MaterialSystem::load.
Result<GpuScene> uploadScene(const Scene& scene, const Device& device, MaterialSystem& materials);

}  // namespace loden::runtime
