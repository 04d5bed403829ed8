// The node hierarchy, flattened: instances, cameras and lights in world space.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/scene/animation.h"
#include "runtime/scene/gltf_reader.h"

namespace loden::runtime::gltf {
namespace {

constexpr size_t kMaxInstances = size_t(1) << 17;

bool isFinite(const glm::mat4& m) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      if (!std::isfinite(m[c][r])) return false;
  return true;
}

SceneNode nodeOf(const Reader& reader, const tinygltf::Node& source, int parent) {
  SceneNode node;
  node.name = source.name;
  node.parent = parent;
  if (source.matrix.size() == 16)
    for (int i = 0; i < 16; ++i) node.matrix[i / 4][i % 4] = static_cast<float>(source.matrix[size_t(i)]);
  else {
    if (source.translation.size() == 3)
      node.translation = {source.translation[0], source.translation[1], source.translation[2]};
    if (source.rotation.size() == 4) {
      const glm::quat q(static_cast<float>(source.rotation[3]), static_cast<float>(source.rotation[0]),
                        static_cast<float>(source.rotation[1]), static_cast<float>(source.rotation[2]));
      if (glm::length(q) > 0) node.rotation = glm::normalize(q);
    }
    if (source.scale.size() == 3) node.scale = {source.scale[0], source.scale[1], source.scale[2]};
  }
  const std::vector<double>* weights = &source.weights;
  if (weights->empty() && source.mesh >= 0 && size_t(source.mesh) < reader.model.meshes.size())
    weights = &reader.model.meshes[size_t(source.mesh)].weights;
  for (const double weight : *weights)
    node.weights.push_back(std::isfinite(weight) ? static_cast<float>(weight) : 0.0f);
  return node;
}

// One transform per instance of EXT_mesh_gpu_instancing; the identity for nodes without it.
Result<std::vector<glm::mat4>> instanceTransforms(const Reader& reader, const tinygltf::Node& node,
                                                  const std::string& place) {
  const auto found = node.extensions.find("EXT_mesh_gpu_instancing");
  if (found == node.extensions.end()) return std::vector<glm::mat4>{glm::mat4(1)};
  const std::string where = place + ".extensions.EXT_mesh_gpu_instancing";
  if (!found->second.IsObject() || !found->second.Has("attributes"))
    return reader.issue(issue_id::kGltfExtension, where, "needs attributes");
  const tinygltf::Value& attributes = found->second.Get("attributes");
  std::vector<float> parts[3];
  constexpr const char* kNames[3] = {"TRANSLATION", "ROTATION", "SCALE"};
  constexpr size_t kWidths[3] = {3, 4, 3};
  size_t count = 0;
  for (size_t k = 0; k < 3; ++k) {
    const std::optional<int> accessor = indexMember(attributes, kNames[k]);
    if (!accessor) continue;
    auto values = readFloats(reader, *accessor, int(kWidths[k]), where + "." + kNames[k]);
    if (!values) return values.issue();
    if (count != 0 && values->size() != count * kWidths[k])
      return reader.issue(issue_id::kGltfExtension, where, "its attributes differ in length");
    count = values->size() / kWidths[k];
    parts[k] = *std::move(values);
  }
  if (count > kMaxInstances) return reader.issue(issue_id::kGltfExtension, where, "has too many instances");
  std::vector<glm::mat4> transforms(count, glm::mat4(1));
  for (size_t i = 0; i < count; ++i) {
    const auto part = [&](size_t k) { return parts[k].empty() ? nullptr : parts[k].data() + i * kWidths[k]; };
    glm::mat4& m = transforms[i];
    if (const float* t = part(0)) m = glm::translate(m, glm::vec3(t[0], t[1], t[2]));
    if (const float* r = part(1)) {
      const glm::quat q(r[3], r[0], r[1], r[2]);
      if (glm::length(q) > 0) m *= glm::mat4_cast(glm::normalize(q));
    }
    if (const float* s = part(2)) m = glm::scale(m, glm::vec3(s[0], s[1], s[2]));
  }
  return transforms;
}

Status addInstances(Reader& reader, const tinygltf::Node& node, int scene_node, const glm::mat4& world,
                    const std::string& place) {
  const auto transforms = instanceTransforms(reader, node, place);
  if (!transforms) return transforms.issue();
  for (const Reader::Part& part : reader.parts[size_t(node.mesh)]) {
    if (reader.scene.instances.size() + transforms->size() > kMaxInstances)
      return reader.issue(issue_id::kGltfNode, place, "the scene has too many instances of meshes");
    // Without joints of its own a mesh ignores its node's skin.
    const bool skinned = !reader.scene.meshes[size_t(part.mesh)].influences.empty();
    for (const glm::mat4& transform : *transforms) {
      Instance instance{node.name, part.mesh, part.material, world * transform, scene_node, transform, -1};
      if (skinned) instance.skin = node.skin;
      if (instance.skin >= 0) instance.world_from_local = glm::mat4(1);
      if (!isFinite(instance.world_from_local))
        return reader.issue(issue_id::kGltfNode, place, "an instance's transform is not finite");
      reader.scene.instances.push_back(std::move(instance));
    }
  }
  return {};
}

void addCamera(Reader& reader, const tinygltf::Node& node, int scene_node, const glm::mat4& world) {
  const tinygltf::Camera& source = reader.model.cameras[node.camera];
  const double fov = source.perspective.yfov;
  if (source.type != "perspective" || !(fov > 0.01 && fov < 3.1))
    return reader.note(issue_id::kGltfNode, at("cameras", node.camera), "is no usable perspective camera");
  reader.scene.cameras.push_back({source.name, world, static_cast<float>(fov), scene_node});
}

Light lightOf(const tinygltf::Light& source, int scene_node, const glm::mat4& world) {
  Light light;
  light.node = scene_node;
  light.kind = source.type == "directional" ? LightKind::kSun
               : source.type == "spot"      ? LightKind::kSpot
                                            : LightKind::kPoint;
  light.position = glm::vec3(world[3]);
  const glm::vec3 forward = -glm::vec3(world[2]);
  if (glm::length(forward) > 0) light.direction = glm::normalize(forward);
  glm::vec3 color(1);
  if (source.color.size() == 3) color = glm::vec3(source.color[0], source.color[1], source.color[2]);
  const glm::vec3 intensity = color * static_cast<float>(source.intensity);
  light.intensity = std::isfinite(intensity.x + intensity.y + intensity.z) ? glm::max(intensity, glm::vec3(0))
                                                                           : glm::vec3(0);
  light.range = source.range > 0 && source.range < 1e9 ? static_cast<float>(source.range) : 0.0f;
  light.cos_inner = std::cos(static_cast<float>(source.spot.innerConeAngle));
  light.cos_outer = std::cos(static_cast<float>(source.spot.outerConeAngle));
  return light;
}

// Index of the light that a node carries; -1 if none.
Result<int> lightIndex(const Reader& reader, const tinygltf::Node& node, const std::string& place) {
  const auto found = node.extensions.find("KHR_lights_punctual");
  if (found == node.extensions.end()) return -1;
  const std::optional<int> index = indexMember(found->second, "light");
  if (!index || size_t(*index) >= reader.model.lights.size())
    return reader.issue(issue_id::kNodeLight, place + ".extensions.KHR_lights_punctual",
                        "light does not exist");
  return *index;
}

Status addNode(Reader& reader, size_t index, int scene_node, const glm::mat4& world) {
  const tinygltf::Node& node = reader.model.nodes[index];
  const std::string place = at("nodes", index);
  const auto bad = [&](int id, const char* text) { return reader.issue(id, place, text); };
  if (!isFinite(world)) return bad(issue_id::kNodeNumbers, "its world transform is not finite");
  if (node.mesh < -1 || node.mesh >= static_cast<int>(reader.model.meshes.size()))
    return bad(issue_id::kNodeMesh, "mesh does not exist");
  if (node.camera < -1 || node.camera >= static_cast<int>(reader.model.cameras.size()))
    return bad(issue_id::kNodeCamera, "camera does not exist");
  if (node.skin < -1 || node.skin >= static_cast<int>(reader.model.skins.size()))
    return bad(issue_id::kNodeSkin, "skin does not exist");
  const Result<int> light = lightIndex(reader, node, place);
  if (!light) return light.issue();
  if (node.mesh >= 0)
    if (Status status = addInstances(reader, node, scene_node, world, place); !status) return status;
  if (node.camera >= 0) addCamera(reader, node, scene_node, world);
  if (*light >= 0)
    reader.scene.lights.push_back(lightOf(reader.model.lights[size_t(*light)], scene_node, world));
  return {};
}

// Roots of the default scene; without scenes, the nodes that are no one's child.
Result<std::vector<int>> rootNodes(const Reader& reader) {
  const tinygltf::Model& model = reader.model;
  if (!model.scenes.empty()) {
    const int scene = model.defaultScene < 0 ? 0 : model.defaultScene;
    if (size_t(scene) >= model.scenes.size())
      return reader.issue(issue_id::kSceneDefault, "scene", "the default scene does not exist");
    return model.scenes[scene].nodes;
  }
  std::vector<bool> is_child(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes)
    for (int child : node.children)
      if (child >= 0 && size_t(child) < is_child.size()) is_child[child] = true;
  std::vector<int> roots;
  for (size_t i = 0; i < model.nodes.size(); ++i)
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  return roots;
}

}  // namespace

// Depth first without recursion. glTF's nodes form strict trees: one that is met twice is an error, which
// covers loops.
Status readNodes(Reader& reader) {
  const auto roots = rootNodes(reader);
  if (!roots) return roots.issue();
  struct Pending {
    int node;
    int parent;  // of the scene's nodes
    glm::mat4 world_from_parent;
  };
  std::vector<Pending> stack;
  for (auto root = roots->rbegin(); root != roots->rend(); ++root) stack.push_back({*root, -1, glm::mat4(1)});
  reader.nodes.assign(reader.model.nodes.size(), -1);
  while (!stack.empty()) {
    const Pending next = stack.back();
    stack.pop_back();
    if (next.node < 0 || size_t(next.node) >= reader.nodes.size())
      return reader.issue(next.parent < 0 ? issue_id::kSceneNode : issue_id::kNodeChild,
                          at("nodes", size_t(next.node)), "does not exist");
    if (reader.nodes[size_t(next.node)] >= 0)
      return reader.issue(issue_id::kGltfNode, at("nodes", next.node),
                          "is part of a loop, or has two parents");
    const tinygltf::Node& node = reader.model.nodes[size_t(next.node)];
    const int scene_node = static_cast<int>(reader.scene.nodes.size());
    reader.nodes[size_t(next.node)] = scene_node;
    reader.scene.nodes.push_back(nodeOf(reader, node, next.parent));
    const glm::mat4 world = next.world_from_parent * parentFromNode(reader.scene.nodes.back());
    if (Status status = addNode(reader, size_t(next.node), scene_node, world); !status) return status;
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
      stack.push_back({*child, scene_node, world});
  }
  return {};
}

}  // namespace loden::runtime::gltf
