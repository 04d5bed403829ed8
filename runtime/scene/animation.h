// Scenes in motion: from an animation's time to the transforms of nodes, and on to the vertices of meshes
// that a skin or morph targets deform. No GL here.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "runtime/scene/scene.h"

namespace loden::runtime {

// Where everything is at one time.
struct ScenePose {
  std::vector<glm::mat4> world_from_node;   // by index into Scene::nodes
  std::vector<std::vector<float>> weights;  // of the node's morph targets; empty if it has none
};
glm::mat4 parentFromNode(const SceneNode& node);
// Null: as the nodes stand in the file. Before its first key and behind its last an animation stands still.
ScenePose poseAt(const Scene& scene, const SceneAnimation* animation, double seconds);

// The transform of an instance in a pose; that of a skinned one is the identity, since its joints place it.
glm::mat4 worldFromLocal(const Instance& instance, const ScenePose& pose);
Light lightAt(const Light& light, const ScenePose& pose);
SceneCamera cameraAt(const SceneCamera& camera, const ScenePose& pose);

// Whether the instance's vertices move among each other.
bool isDeformed(const Scene& scene, const Instance& instance);
// The instance's mesh with its vertices morphed and skinned, and their bounds: local frame, or the world's
// for a skinned one. Tangents follow the surface as normals do. The instance must be deformed.
Mesh deformedMesh(const Scene& scene, const Instance& instance, const ScenePose& pose);

// Maps normals where `linear` maps positions, but for a positive factor: the inverse transpose, by cofactors,
// which exist where the transform flattens a mesh.
glm::mat3 normalMatrix(const glm::mat3& linear);

}  // namespace loden::runtime
