// Any bytes as a glTF scene, for the runtime's loader and for `loden validate`: no crash, no endless loop, no
// runaway allocation; and what the loader accepts holds together, so that a renderer may index without asking
// again.
#include <cmath>
#include <cstdint>

#include "importer/gltf/pack.h"
#include "runtime/scene/animation.h"
#include "runtime/scene/gltf_scene.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using loden::fuzz::require;

bool isFinite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// What belongs to each vertex is there for each, or for none.
void checkStreams(const loden::runtime::Mesh& mesh) {
  const auto whole = [&](const auto& stream) {
    require(stream.empty() || stream.size() == mesh.vertices.size());
  };
  for (const auto& set : mesh.uv_sets) whole(set);
  whole(mesh.colors);
  whole(mesh.influences);
  for (const auto& target : mesh.targets) {
    whole(target.positions);
    whole(target.normals);
    whole(target.tangents);
  }
}

void checkMotion(const loden::runtime::Scene& scene) {
  const auto node = [&](int index) { return index >= 0 && size_t(index) < scene.nodes.size(); };
  for (size_t i = 0; i < scene.nodes.size(); ++i) require(scene.nodes[i].parent < static_cast<int>(i));
  for (const auto& skin : scene.skins) {
    require(skin.joints.size() == skin.joint_from_mesh.size());
    for (const int joint : skin.joints) require(node(joint));
  }
  for (const auto& instance : scene.instances) {
    require(instance.node == -1 || node(instance.node));
    require(instance.skin >= -1 && instance.skin < static_cast<int>(scene.skins.size()));
    if (instance.skin >= 0) require(!scene.meshes[size_t(instance.mesh)].influences.empty());
  }
  for (const auto& animation : scene.animations) {
    for (const auto& channel : animation.channels) require(node(channel.node) && !channel.times.empty());
    for (const double seconds : {0.0, 0.3, 1e9}) {
      const auto pose = loden::runtime::poseAt(scene, &animation, seconds);
      for (const auto& instance : scene.instances)
        if (isDeformed(scene, instance)) (void)deformedMesh(scene, instance, pose);
    }
  }
}

void checkScene(const loden::runtime::Scene& scene) {
  checkMotion(scene);
  for (const auto& image : scene.images)
    require(image.pixels.size() == size_t(image.size.x) * size_t(image.size.y) && !image.pixels.empty());
  for (const auto& mesh : scene.meshes) {
    checkStreams(mesh);
    for (const auto& vertex : mesh.vertices)
      require(isFinite(vertex.position) && std::isfinite(vertex.uv.x) && std::isfinite(vertex.uv.y));
    require(mesh.indices.size() % 3 == 0);
    for (const uint32_t index : mesh.indices) require(index < mesh.vertices.size());
  }
  for (const auto& instance : scene.instances) {
    require(instance.mesh >= 0 && size_t(instance.mesh) < scene.meshes.size());
    require(instance.material >= -1 && instance.material < static_cast<int>(scene.materials.size()));
    for (int c = 0; c < 4; ++c) require(isFinite(instance.world_from_local[c]));
  }
  for (const auto& material : scene.materials)
    for (const auto& use : material.textures)
      require(use.image < static_cast<int>(scene.images.size()) && use.tex_coord >= 0 &&
              use.tex_coord < loden::runtime::kUvSets);
  for (const auto& material : scene.materials)
    require(!material.flat_btf ||
            (material.flat_btf->asset >= 0 && size_t(material.flat_btf->asset) < scene.assets.size()));
  for (const auto& light : scene.lights)
    require(isFinite(light.position) && isFinite(light.direction) && isFinite(light.intensity));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const loden::fuzz::InputFolder folder;
  const auto path = folder.write("input.gltf", loden::fuzz::textOf(data, size));
  if (const auto scene = loden::runtime::loadGltfScene(path)) checkScene(*scene);
  (void)loden::importer::validateGltf(path);
  return 0;
}
