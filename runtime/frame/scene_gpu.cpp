#include "runtime/frame/scene_gpu.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "material/base/issues.h"
#include "runtime/scene/camera.h"
#include "shaders/scene_shared.h"

namespace loden::runtime {
namespace {

Result<std::vector<Asset>> loadAssets(const Scene& scene, MaterialSystem& materials) {
  std::vector<Asset> assets;
  for (const SceneAsset& asset : scene.assets) {
    const bool embedded = asset.path.empty();
    auto id = embedded ? materials.load(std::shared_ptr(memorySource(asset.embedded, asset.name)), asset.name)
                       : materials.load(asset.path);
    if (!id) return id.issue();
    assets.push_back({OwnedMaterial(materials, *id), embedded ? asset.name : asset.path.stem().string()});
  }
  return assets;
}

SceneMaterial materialOf(const Scene& scene, const Instance& instance) {
  return instance.material >= 0 ? scene.materials[instance.material] : SceneMaterial{};
}

Object makeObject(const Scene& scene, const Instance& instance, const BaseMaterials& base_materials) {
  const SceneMaterial material = materialOf(scene, instance);
  Object object;
  object.base_material = base_materials.indexOf(instance);
  object.mesh = instance.mesh;
  object.bounds = transformed(scene.meshes[instance.mesh].bounds, instance.world_from_local);
  object.mirrored = glm::determinant(glm::mat3(instance.world_from_local)) < 0;
  object.double_sided = material.double_sided;
  if (!object.double_sided)
    object.facing = facingCone(scene.meshes[instance.mesh], instance.world_from_local);
  if (!material.flat_btf) return object;
  object.asset = material.flat_btf->asset;
  const Mesh& mesh = scene.meshes[instance.mesh];
  object.periods_per_metre = uvDensity(mesh, *material.flat_btf, instance.world_from_local);
  object.curved = !isPlain(mesh, *material.flat_btf, instance.world_from_local, object.periods_per_metre);
  return object;
}

// A mesh has one material, so that its vertices can carry tile coordinates.
std::vector<GpuMesh> uploadMeshes(const Scene& scene, const GlBuffer& defaults) {
  std::vector<FlatBtfBinding> bindings(scene.meshes.size());
  for (const Instance& instance : scene.instances)
    bindings[instance.mesh] = materialOf(scene, instance).flat_btf.value_or(FlatBtfBinding{});
  std::vector<GpuMesh> meshes;
  for (size_t i = 0; i < scene.meshes.size(); ++i)
    meshes.push_back(uploadMesh(scene.meshes[i], bindings[i], defaults));
  return meshes;
}

void addLights(const Scene& scene, const Device& device, GpuScene& gpu) {
  for (const Light& light : scene.lights) {
    if (light.kind != LightKind::kSun)
      gpu.lights.push_back(light);
    else if (!gpu.sun)
      gpu.sun = light;
  }
  if (gpu.sun) gpu.sun_view = sunView(gpu.bounds, gpu.sun->direction, ShadowMap::kSide);
  if (gpu.lights.size() <= SCENE_MAX_LIGHTS) return;
  device.log({issue_id::kGltfNode, Severity::kWarning, scene.name,
              "more than " + std::to_string(SCENE_MAX_LIGHTS) + " lights: the rest is left out"});
  gpu.lights.resize(SCENE_MAX_LIGHTS);
}

// The most light that a lamp can send to any point of the box; 0 where it does not reach.
float mostLight(const Light& light, const Bounds& box) {
  const float distance = glm::distance(glm::clamp(light.position, box.min, box.max), light.position);
  if (light.range > 0 && distance >= light.range) return 0;
  const float near = std::max(distance, 0.1f);
  return (light.intensity.x + light.intensity.y + light.intensity.z) / (near * near);
}

// The indices of the lights that can be strongest at an object, at most SCENE_MAX_OBJECT_LIGHTS.
void chooseLights(const std::vector<Light>& lights, const Bounds& box, SceneObject& data) {
  std::vector<std::pair<float, int>> reaching;
  for (size_t i = 0; i < lights.size(); ++i)
    if (const float most = mostLight(lights[i], box); most > 0)
      reaching.emplace_back(-most, static_cast<int>(i));
  std::sort(reaching.begin(), reaching.end());
  data.flags.y = static_cast<int>(std::min<size_t>(reaching.size(), SCENE_MAX_OBJECT_LIGHTS));
  for (int k = 0; k < data.flags.y; ++k) data.lights[k / 4][k % 4] = reaching[k].second;
}

// The inverse transpose but for a positive factor, from cofactors: exists where the transform flattens the
// mesh.
glm::mat3 normalMatrix(const glm::mat3& m) {
  const glm::mat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  float largest = 0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) largest = std::max(largest, std::abs(cofactors[column][row]));
  if (!(largest > 0)) return glm::mat3(1);
  return cofactors * ((glm::determinant(m) < 0 ? -1.0f : 1.0f) / largest);
}

SceneObject objectData(const Object& object, const SceneMaterial& material,
                       const glm::mat4& world_from_local) {
  SceneObject data{};
  data.world_from_local = world_from_local;
  data.normal_from_local = glm::mat4(normalMatrix(glm::mat3(world_from_local)));
  // Of an emissive texture a Loden material shows nothing, and the factor alone would glow all over.
  if (material.texture(TextureRole::kEmissive).image < 0) data.emissive = glm::vec4(material.emissive, 0);
  data.tile = glm::vec4(1 / object.periods_per_metre, 0, 0, 0);
  data.flags = {object.double_sided ? SCENE_DOUBLE_SIDED : 0, 0, object.mirrored ? -1 : 1, 0};
  if (material.flat_btf) data.flags.x |= SCENE_DERIVE_TANGENTS;
  return data;
}

void uploadObjects(const Scene& scene, GpuScene& gpu) {
  GLint alignment = 256;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  gpu.object_stride = (sizeof(SceneObject) + alignment - 1) / alignment * alignment;
  std::vector<std::byte> all(std::max<size_t>(gpu.objects.size(), 1) * gpu.object_stride);
  for (size_t i = 0; i < gpu.objects.size(); ++i) {
    const Instance& instance = scene.instances[i];
    SceneObject data = objectData(gpu.objects[i], materialOf(scene, instance), instance.world_from_local);
    chooseLights(gpu.lights, gpu.objects[i].bounds, data);
    std::memcpy(all.data() + i * gpu.object_stride, &data, sizeof data);
  }
  gpu.object_uniforms = makeBuffer(all.size(), all, 0, "object uniforms");
}

}  // namespace

Result<GpuScene> uploadScene(const Scene& scene, const Device& device, MaterialSystem& materials) {
  GpuScene gpu{BaseMaterials(scene), makeDefaultAttributes(), {}, {}, {}, {}, {}, {}, {}, {}, 0};
  auto assets = loadAssets(scene, materials);
  if (!assets) return assets.issue();
  gpu.assets = std::move(assets.value());
  for (const Instance& instance : scene.instances) {
    gpu.objects.push_back(makeObject(scene, instance, gpu.base_materials));
    const Bounds& box = gpu.objects.back().bounds;
    gpu.bounds = gpu.objects.size() == 1
                     ? box
                     : Bounds{glm::min(gpu.bounds.min, box.min), glm::max(gpu.bounds.max, box.max)};
  }
  gpu.meshes = uploadMeshes(scene, gpu.default_attributes);
  addLights(scene, device, gpu);
  uploadObjects(scene, gpu);
  return gpu;
}

}  // namespace loden::runtime
