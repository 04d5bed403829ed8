#include "runtime/frame/scene_gpu.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "material/base/issues.h"
#include "runtime/scene/camera.h"
#include "shaders/scene_shared.h"

namespace loden::runtime {
namespace {

// Those of the scene's from index `first` on.
Result<std::vector<Asset>> loadAssets(const Scene& scene, size_t first, MaterialSystem& materials) {
  std::vector<Asset> assets;
  for (size_t i = first; i < scene.assets.size(); ++i) {
    const SceneAsset& asset = scene.assets[i];
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

// The instance's mesh as it is drawn: `own` holds it if it is deformed.
const Mesh& meshOf(const Scene& scene, const Instance& instance, const ScenePose& pose, Mesh& own) {
  if (!isDeformed(scene, instance)) return scene.meshes[size_t(instance.mesh)];
  own = deformedMesh(scene, instance, pose);
  return own;
}

// What an object has from its Loden material, or from having none.
void wearMaterial(const SceneMaterial& material, const Instance& instance, const Mesh& mesh, Object& object) {
  object.asset = -1;
  object.periods_per_metre = 1;
  object.curved = false;
  if (!material.flat_btf) return;
  object.asset = material.flat_btf->asset;
  object.periods_per_metre = uvDensity(mesh, *material.flat_btf, instance.world_from_local);
  object.curved = object.deformed ||
                  !isPlain(mesh, *material.flat_btf, instance.world_from_local, object.periods_per_metre);
}

Object makeObject(const Scene& scene, const Instance& instance, const Mesh& mesh,
                  const BaseMaterials& base_materials) {
  const SceneMaterial material = materialOf(scene, instance);
  Object object;
  object.base_material = base_materials.indexOf(instance);
  object.mesh = instance.mesh;
  object.deformed = isDeformed(scene, instance);
  object.world_from_local = instance.world_from_local;
  object.bounds = transformed(mesh.bounds, instance.world_from_local);
  object.mirrored = glm::determinant(glm::mat3(instance.world_from_local)) < 0;
  object.double_sided = material.double_sided;
  // Of many instances, or of meshes that change, it would take longer than it saves.
  if (!object.double_sided && !object.deformed && instance.node_from_local == glm::mat4(1))
    object.facing = facingCone(mesh, instance.world_from_local);
  wearMaterial(material, instance, mesh, object);
  return object;
}

FlatBtfBinding bindingOf(const Scene& scene, const Instance& instance) {
  return materialOf(scene, instance).flat_btf.value_or(FlatBtfBinding{});
}

// A mesh has one material, so that its vertices can carry tile coordinates. Deformed instances have meshes of
// their own, behind the scene's, whose own are left out where nothing else shows them.
void uploadObjects(const Scene& scene, GpuScene& gpu) {
  std::vector<const Instance*> users(scene.meshes.size(), nullptr);
  for (const Instance& instance : scene.instances)
    if (!isDeformed(scene, instance)) users[size_t(instance.mesh)] = &instance;
  for (size_t i = 0; i < scene.meshes.size(); ++i)
    gpu.meshes.push_back(
        users[i] ? uploadMesh(scene.meshes[i], bindingOf(scene, *users[i]), gpu.default_attributes)
                 : GpuMesh{});
  const ScenePose rest = poseAt(scene, nullptr, 0);
  std::map<std::pair<int, int>, int> needs;  // by mesh and material
  for (const Instance& instance : scene.instances) {
    Mesh own;
    const Mesh& mesh = meshOf(scene, instance, rest, own);
    Object object = makeObject(scene, instance, mesh, gpu.base_materials);
    if (object.deformed) {
      object.mesh = static_cast<int>(gpu.meshes.size());
      gpu.meshes.push_back(uploadMesh(mesh, bindingOf(scene, instance), gpu.default_attributes));
    }
    const auto [found, fresh] =
        needs.try_emplace({object.mesh, object.base_material}, static_cast<int>(gpu.needs.size()));
    object.needs = found->second;
    if (fresh)
      gpu.needs.push_back(
          gpu.base_materials.needsOf(mesh, materialOf(scene, instance), object.base_material));
    gpu.objects.push_back(std::move(object));
  }
}

void findBounds(GpuScene& gpu) {
  gpu.bounds = gpu.objects.empty() ? Bounds{} : gpu.objects[0].bounds;
  for (const Object& object : gpu.objects)
    gpu.bounds = {glm::min(gpu.bounds.min, object.bounds.min), glm::max(gpu.bounds.max, object.bounds.max)};
}

void sortLights(GpuScene& gpu) {
  gpu.lights.clear();
  gpu.sun.reset();
  for (const Light& light : gpu.scene_lights) {
    if (light.kind != LightKind::kSun && gpu.lights.size() < SCENE_MAX_LIGHTS)
      gpu.lights.push_back(light);
    else if (light.kind == LightKind::kSun && !gpu.sun)
      gpu.sun = light;
  }
}

void noteLights(const Scene& scene, const Device& device) {
  size_t suns = 0;
  for (const Light& light : scene.lights) suns += light.kind == LightKind::kSun;
  const auto warn = [&](const std::string& text) {
    device.log({issue_id::kGltfNode, Severity::kWarning, scene.name, text});
  };
  if (scene.lights.size() - suns > SCENE_MAX_LIGHTS)
    warn("more than " + std::to_string(SCENE_MAX_LIGHTS) + " lights: the rest is left out");
  if (suns > 1) warn("more than one directional light: the rest is left out");
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

SceneObject objectData(const Object& object, const SceneMaterial& material) {
  SceneObject data{};
  data.world_from_local = object.world_from_local;
  data.normal_from_local = glm::mat4(normalMatrix(glm::mat3(object.world_from_local)));
  // Of an emissive texture a Loden material shows nothing, and the factor alone would glow all over.
  if (material.texture(TextureRole::kEmissive).image < 0) data.emissive = glm::vec4(material.emissive, 0);
  data.tile = glm::vec4(1 / object.periods_per_metre, 0, 0, 0);
  data.flags = {object.double_sided ? SCENE_DOUBLE_SIDED : 0, 0, object.mirrored ? -1 : 1, 0};
  if (material.flat_btf) data.flags.x |= SCENE_DERIVE_TANGENTS;
  return data;
}

void uploadUniforms(const Scene& scene, GpuScene& gpu) {
  GLint alignment = 256;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  gpu.object_stride = (sizeof(SceneObject) + alignment - 1) / alignment * alignment;
  std::vector<std::byte> all(std::max<size_t>(gpu.objects.size(), 1) * gpu.object_stride);
  for (size_t i = 0; i < gpu.objects.size(); ++i) {
    SceneObject data = objectData(gpu.objects[i], materialOf(scene, scene.instances[i]));
    chooseLights(gpu.lights, gpu.objects[i].bounds, data);
    std::memcpy(all.data() + i * gpu.object_stride, &data, sizeof data);
  }
  if (gpu.object_uniforms)
    glNamedBufferSubData(gpu.object_uniforms.name(), 0, GLsizeiptr(all.size()), all.data());
  else
    gpu.object_uniforms = makeBuffer(all.size(), all, GL_DYNAMIC_STORAGE_BIT, "object uniforms");
}

// Whether the object moved.
bool poseObject(const Scene& scene, const Instance& instance, const ScenePose& pose, GpuScene& gpu,
                Object& object) {
  const glm::mat4 world = worldFromLocal(instance, pose);
  if (world == object.world_from_local && !object.deformed) return false;
  Mesh own;
  const Mesh& mesh = meshOf(scene, instance, pose, own);
  if (object.deformed) moveVertices(mesh, bindingOf(scene, instance), gpu.meshes[size_t(object.mesh)]);
  object.world_from_local = world;
  object.bounds = transformed(mesh.bounds, world);
  object.mirrored = glm::determinant(glm::mat3(world)) < 0;
  object.facing = {};
  return true;
}

}  // namespace

Result<GpuScene> uploadScene(const Scene& scene, const Device& device, MaterialSystem& materials) {
  Result<BaseMaterials> base_materials = BaseMaterials::create(scene, materials);
  if (!base_materials) return base_materials.issue();
  GpuScene gpu{
      std::move(*base_materials), makeDefaultAttributes(), {}, {}, {}, {}, {}, {}, {}, scene.lights, {}, 0};
  auto assets = loadAssets(scene, 0, materials);
  if (!assets) return assets.issue();
  gpu.assets = std::move(assets.value());
  noteLights(scene, device);
  uploadObjects(scene, gpu);
  findBounds(gpu);
  sortLights(gpu);
  uploadUniforms(scene, gpu);
  return gpu;
}

Status dressScene(const Scene& scene, const ScenePose& pose, MaterialSystem& materials, GpuScene& gpu) {
  auto assets = loadAssets(scene, gpu.assets.size(), materials);
  if (!assets) return assets.issue();
  for (Asset& asset : *assets) gpu.assets.push_back(std::move(asset));
  for (size_t i = 0; i < gpu.objects.size(); ++i) {
    const Instance& instance = scene.instances[i];
    Object& object = gpu.objects[i];
    Mesh own;
    const Mesh& mesh = meshOf(scene, instance, pose, own);
    moveVertices(mesh, bindingOf(scene, instance), gpu.meshes[size_t(object.mesh)]);
    wearMaterial(materialOf(scene, instance), instance, mesh, object);
  }
  uploadUniforms(scene, gpu);
  return {};
}

bool poseScene(const Scene& scene, const ScenePose& pose, GpuScene& gpu) {
  bool moved = false;
  for (size_t i = 0; i < gpu.objects.size(); ++i)
    moved = poseObject(scene, scene.instances[i], pose, gpu, gpu.objects[i]) || moved;
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Light light = lightAt(scene.lights[i], pose);
    moved = moved || light.position != gpu.scene_lights[i].position ||
            light.direction != gpu.scene_lights[i].direction;
    gpu.scene_lights[i] = light;
  }
  if (!moved) return false;
  findBounds(gpu);
  sortLights(gpu);
  uploadUniforms(scene, gpu);
  return true;
}

}  // namespace loden::runtime
