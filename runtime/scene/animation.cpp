#include "runtime/scene/animation.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace loden::runtime {
namespace {

// Where a time lies among a channel's keys: `share` of the way from `before` to `after`.
struct KeyPosition {
  size_t before = 0, after = 0;
  float share = 0, step = 0;  // seconds between both
};
KeyPosition keyPosition(const std::vector<float>& times, double seconds) {
  const auto next = std::upper_bound(times.begin(), times.end(), static_cast<float>(seconds));
  if (next == times.begin()) return {};
  const size_t before = size_t(next - times.begin()) - 1;
  if (next == times.end()) return {before, before, 0, 0};
  const float step = times[before + 1] - times[before];
  return {before, before + 1, (static_cast<float>(seconds) - times[before]) / step, step};
}

glm::quat quaternionOf(const float* v) {
  const glm::quat q(v[3], v[0], v[1], v[2]);
  return glm::length(q) > 1e-10f ? glm::normalize(q) : glm::quat(1, 0, 0, 0);
}

// A cubic spline's key is its value between the slopes on both sides.
std::vector<float> cubicValue(const AnimationChannel& channel, const KeyPosition& at) {
  const size_t n = channel.width;
  const float* first = channel.values.data() + at.before * 3 * n;
  const float* second = channel.values.data() + at.after * 3 * n;
  const float u = at.share, u2 = u * u, u3 = u2 * u;
  std::vector<float> result(n);
  for (size_t i = 0; i < n; ++i)
    result[i] = (2 * u3 - 3 * u2 + 1) * first[n + i] + (u3 - 2 * u2 + u) * at.step * first[2 * n + i] +
                (3 * u2 - 2 * u3) * second[n + i] + (u3 - u2) * at.step * second[i];
  return result;
}

std::vector<float> valueAt(const AnimationChannel& channel, double seconds) {
  KeyPosition at = keyPosition(channel.times, seconds);
  if (channel.interpolation == Interpolation::kCubic) return cubicValue(channel, at);
  if (channel.interpolation == Interpolation::kStep) at.share = 0;
  const size_t n = channel.width;
  const float *first = channel.values.data() + at.before * n, *second = channel.values.data() + at.after * n;
  std::vector<float> result(n);
  if (channel.target == AnimationTarget::kRotation) {
    const glm::quat q = glm::slerp(quaternionOf(first), quaternionOf(second), at.share);
    return {q.x, q.y, q.z, q.w};
  }
  for (size_t i = 0; i < n; ++i) result[i] = first[i] + at.share * (second[i] - first[i]);
  return result;
}

void apply(const AnimationChannel& channel, double seconds, SceneNode& node) {
  const std::vector<float> value = valueAt(channel, seconds);
  switch (channel.target) {
    case AnimationTarget::kTranslation:
      node.translation = {value[0], value[1], value[2]};
      break;
    case AnimationTarget::kRotation:
      node.rotation = quaternionOf(value.data());
      break;
    case AnimationTarget::kScale:
      node.scale = {value[0], value[1], value[2]};
      break;
    case AnimationTarget::kWeights:
      node.weights = value;
      break;
  }
}

void addTargets(const Mesh& mesh, std::span<const float> weights, std::vector<Vertex>& vertices) {
  for (size_t k = 0; k < std::min(mesh.targets.size(), weights.size()); ++k) {
    const MorphTarget& target = mesh.targets[k];
    const float weight = weights[k];
    if (weight == 0) continue;
    for (size_t i = 0; i < target.positions.size(); ++i) vertices[i].position += weight * target.positions[i];
    for (size_t i = 0; i < target.normals.size(); ++i) vertices[i].normal += weight * target.normals[i];
    for (size_t i = 0; i < target.tangents.size(); ++i)
      vertices[i].tangent += glm::vec4(weight * target.tangents[i], 0);
  }
}

std::vector<glm::mat4> jointMatrices(const Skin& skin, const ScenePose& pose) {
  std::vector<glm::mat4> matrices;
  for (size_t i = 0; i < skin.joints.size(); ++i)
    matrices.push_back(pose.world_from_node[size_t(skin.joints[i])] * skin.joint_from_mesh[i]);
  return matrices;
}

void moveBySkin(const Mesh& mesh, const std::vector<glm::mat4>& joints, std::vector<Vertex>& vertices) {
  for (size_t i = 0; i < vertices.size(); ++i) {
    const Influences& influences = mesh.influences[i];
    glm::mat4 blended(0);
    for (size_t k = 0; k < influences.joints.size(); ++k)
      if (influences.weights[k] != 0) blended += influences.weights[k] * joints[influences.joints[k]];
    Vertex& vertex = vertices[i];
    const glm::mat3 linear(blended);
    vertex.position = glm::vec3(blended * glm::vec4(vertex.position, 1));
    vertex.normal = normalMatrix(linear) * vertex.normal;
    const float side = glm::determinant(linear) < 0 ? -1.0f : 1.0f;
    vertex.tangent = glm::vec4(linear * glm::vec3(vertex.tangent), side * vertex.tangent.w);
  }
}

// Unit normals, and tangents orthogonal to them.
void orthonormalize(std::vector<Vertex>& vertices) {
  for (Vertex& vertex : vertices) {
    const float length = glm::length(vertex.normal);
    vertex.normal = length > 1e-20f ? vertex.normal / length : glm::vec3(0, 1, 0);
    const glm::vec3 along =
        glm::vec3(vertex.tangent) - vertex.normal * glm::dot(vertex.normal, glm::vec3(vertex.tangent));
    const float along_length = glm::length(along);
    vertex.tangent = along_length > 1e-20f ? glm::vec4(along / along_length, vertex.tangent.w)
                                           : glm::vec4(1, 0, 0, 0);  // the shader derives a frame
  }
}

}  // namespace

glm::mat4 parentFromNode(const SceneNode& node) {
  return glm::translate(node.matrix, node.translation) * glm::mat4_cast(node.rotation) *
         glm::scale(glm::mat4(1), node.scale);
}

ScenePose poseAt(const Scene& scene, const SceneAnimation* animation, double seconds) {
  std::vector<SceneNode> nodes = scene.nodes;
  if (animation)
    for (const AnimationChannel& channel : animation->channels)
      apply(channel, seconds, nodes[size_t(channel.node)]);
  ScenePose pose;
  for (const SceneNode& node : nodes) {
    const glm::mat4 local = parentFromNode(node);
    pose.world_from_node.push_back(node.parent < 0 ? local
                                                   : pose.world_from_node[size_t(node.parent)] * local);
    pose.weights.push_back(node.weights);
  }
  return pose;
}

glm::mat4 worldFromLocal(const Instance& instance, const ScenePose& pose) {
  if (instance.skin >= 0) return glm::mat4(1);
  if (instance.node < 0) return instance.world_from_local;
  return pose.world_from_node[size_t(instance.node)] * instance.node_from_local;
}

Light lightAt(const Light& light, const ScenePose& pose) {
  if (light.node < 0) return light;
  const glm::mat4& world = pose.world_from_node[size_t(light.node)];
  Light moved = light;
  moved.position = glm::vec3(world[3]);
  const glm::vec3 forward = -glm::vec3(world[2]);
  if (glm::length(forward) > 0) moved.direction = glm::normalize(forward);
  return moved;
}

SceneCamera cameraAt(const SceneCamera& camera, const ScenePose& pose) {
  SceneCamera moved = camera;
  if (camera.node >= 0) moved.world_from_camera = pose.world_from_node[size_t(camera.node)];
  return moved;
}

bool isDeformed(const Scene& scene, const Instance& instance) {
  return instance.node >= 0 && (instance.skin >= 0 || !scene.meshes[size_t(instance.mesh)].targets.empty());
}

Mesh deformedMesh(const Scene& scene, const Instance& instance, const ScenePose& pose) {
  const Mesh& mesh = scene.meshes[size_t(instance.mesh)];
  Mesh result;
  result.name = mesh.name;
  result.vertices = mesh.vertices;
  result.indices = mesh.indices;
  result.uv_sets = mesh.uv_sets;
  result.colors = mesh.colors;
  addTargets(mesh, pose.weights[size_t(instance.node)], result.vertices);
  if (instance.skin >= 0)
    moveBySkin(mesh, jointMatrices(scene.skins[size_t(instance.skin)], pose), result.vertices);
  orthonormalize(result.vertices);
  result.bounds = boundsOf(result);
  return result;
}

glm::mat3 normalMatrix(const glm::mat3& m) {
  const glm::mat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  float largest = 0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) largest = std::max(largest, std::abs(cofactors[column][row]));
  if (!(largest > 0)) return glm::mat3(1);
  return cofactors * ((glm::determinant(m) < 0 ? -1.0f : 1.0f) / largest);
}

}  // namespace loden::runtime
