// The node hierarchy, flattened: instances, cameras and lights in world space.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/scene/gltf_reader.h"

namespace loden::runtime::gltf {
namespace {

bool isFinite(const glm::mat4& m) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      if (!std::isfinite(m[c][r])) return false;
  return true;
}

glm::mat4 localTransform(const tinygltf::Node& node) {
  glm::mat4 m(1);
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = static_cast<float>(node.matrix[i]);
    return m;
  }
  if (node.translation.size() == 3)
    m = glm::translate(m, glm::vec3(node.translation[0], node.translation[1], node.translation[2]));
  if (node.rotation.size() == 4) {
    const glm::quat q(static_cast<float>(node.rotation[3]), static_cast<float>(node.rotation[0]),
                      static_cast<float>(node.rotation[1]), static_cast<float>(node.rotation[2]));
    if (glm::length(q) > 0) m *= glm::mat4_cast(glm::normalize(q));
  }
  if (node.scale.size() == 3) m = glm::scale(m, glm::vec3(node.scale[0], node.scale[1], node.scale[2]));
  return m;
}

void addInstances(Reader& reader, const tinygltf::Node& node, const glm::mat4& world) {
  for (const Reader::Part& part : reader.parts[node.mesh])
    reader.scene.instances.push_back({node.name, part.mesh, part.material, world});
}

void addCamera(Reader& reader, const tinygltf::Node& node, const glm::mat4& world) {
  const tinygltf::Camera& source = reader.model.cameras[node.camera];
  const double fov = source.perspective.yfov;
  if (source.type != "perspective" || !(fov > 0.01 && fov < 3.1))
    return reader.note(issue_id::kGltfNode, at("cameras", node.camera), "is no usable perspective camera");
  reader.scene.cameras.push_back({source.name, world, static_cast<float>(fov)});
}

Light lightOf(const tinygltf::Light& source, const glm::mat4& world) {
  Light light;
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
    return reader.issue(issue_id::kGltfNode, place + ".extensions.KHR_lights_punctual",
                        "light does not exist");
  return *index;
}

Status addNode(Reader& reader, size_t index, const glm::mat4& world) {
  const tinygltf::Node& node = reader.model.nodes[index];
  const std::string place = at("nodes", index);
  const auto bad = [&](const char* text) { return reader.issue(issue_id::kGltfNode, place, text); };
  if (!isFinite(world)) return bad("its world transform is not finite");
  if (node.mesh < -1 || node.mesh >= static_cast<int>(reader.model.meshes.size()))
    return bad("mesh does not exist");
  if (node.camera < -1 || node.camera >= static_cast<int>(reader.model.cameras.size()))
    return bad("camera does not exist");
  const Result<int> light = lightIndex(reader, node, place);
  if (!light) return light.issue();
  if (node.mesh >= 0) addInstances(reader, node, world);
  if (node.camera >= 0) addCamera(reader, node, world);
  if (*light >= 0) reader.scene.lights.push_back(lightOf(reader.model.lights[*light], world));
  return {};
}

// Roots of the default scene; without scenes, the nodes that are no one's child.
Result<std::vector<int>> rootNodes(const Reader& reader) {
  const tinygltf::Model& model = reader.model;
  if (!model.scenes.empty()) {
    const int scene = model.defaultScene < 0 ? 0 : model.defaultScene;
    if (size_t(scene) >= model.scenes.size())
      return reader.issue(issue_id::kGltfNode, "scene", "the default scene does not exist");
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
    glm::mat4 parent;
  };
  std::vector<Pending> stack;
  for (auto root = roots->rbegin(); root != roots->rend(); ++root) stack.push_back({*root, glm::mat4(1)});
  std::vector<bool> visited(reader.model.nodes.size(), false);
  while (!stack.empty()) {
    const Pending next = stack.back();
    stack.pop_back();
    if (next.node < 0 || size_t(next.node) >= visited.size())
      return reader.issue(issue_id::kGltfNode, at("nodes", size_t(next.node)), "does not exist");
    if (visited[next.node])
      return reader.issue(issue_id::kGltfNode, at("nodes", next.node),
                          "is part of a loop, or has two parents");
    visited[next.node] = true;
    const tinygltf::Node& node = reader.model.nodes[next.node];
    const glm::mat4 world = next.parent * localTransform(node);
    if (Status status = addNode(reader, next.node, world); !status) return status;
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
      stack.push_back({*child, world});
  }
  return {};
}

}  // namespace loden::runtime::gltf
