// Animation: the transforms of a scene's nodes at a time, and the vertices of meshes that a skin or morph
// targets deform. No GL.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "runtime/scene/scene.h"

namespace loden::runtime {

// The state of all nodes at one time.
struct ScenePose {
  std::vector<glm::mat4> world_from_node;  // by index into Scene::nodes
  // Per node, the weights of its morph targets; empty if it has none.
  std::vector<std::vector<float>> weights;
};
// The transform from a node's frame to its parent's.
glm::mat4 parentFromNode(const SceneNode& node);
// The pose of the scene at a time of the animation; null: the pose stored in the nodes themselves. Before its
// first key and after its last an animation stands still.
ScenePose poseAt(const Scene& scene, const SceneAnimation* animation, double seconds);

// The world transform of an instance in a pose. For a skinned instance it is the identity, since its joints
// place it.
glm::mat4 worldFromLocal(const Instance& instance, const ScenePose& pose);
// The light or camera moved to where its node is in the pose.
Light lightAt(const Light& light, const ScenePose& pose);
SceneCamera cameraAt(const SceneCamera& camera, const ScenePose& pose);

// Whether the instance's vertices move relative to each other (by a skin or morph targets).
bool isDeformed(const Scene& scene, const Instance& instance);
// The instance's mesh with its vertices morphed and skinned, and the bounds of these: in the local frame, or
// in the world frame if it is skinned. Tangents are transformed so that they stay on the surface. The
// instance must be deformed.
Mesh deformedMesh(const Scene& scene, const Instance& instance, const ScenePose& pose);

// The matrix that maps normals where `linear` maps positions, up to a positive factor: the inverse transpose
// computed from cofactors, which exist even if the transform flattens a mesh.
glm::mat3 normalMatrix(const glm::mat3& linear);

}  // namespace loden::runtime
