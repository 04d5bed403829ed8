// A scene in memory, as the renderer takes it: no file format and no GL here. Units are metres and radians,
// colours linear RGB; y is up, as in glTF, unless a caller says otherwise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "material/base/result.h"

namespace loden::runtime {

struct Vertex {
  glm::vec3 position{0};      // local frame
  glm::vec3 normal{0, 0, 1};  // unit
  // xyz: unit, dP/du made orthogonal to the normal. w: sign such that dP/dv runs along w * cross(normal,
  // xyz), -1 where UVs are mirrored; 0 where there is no usable tangent and the shader derives a frame
  // itself. glTF's own sign is the opposite, because its v runs downwards.
  glm::vec4 tangent{1, 0, 0, 0};
  glm::vec2 uv{0};  // unitless, any range; the set that the mesh's material asks for
};

struct Bounds {
  glm::vec3 min{0}, max{0};
  glm::vec3 centre() const { return 0.5f * (min + max); }
  float radius() const { return 0.5f * glm::length(max - min); }
};

// One triangle list with one material.
struct Mesh {
  std::string name;
  std::vector<Vertex> vertices;
  std::vector<uint32_t> indices;  // three per triangle, counter-clockwise seen from outside
  Bounds bounds;                  // local frame
};

// A .loden file that the scene names, or carries.
struct SceneAsset {
  std::filesystem::path path;  // empty if embedded
  std::vector<std::byte> embedded;
  std::string name;  // for messages
};

// LODEN_materials_flat_btf on a material: x = rotation(scale * uv), in tile periods.
struct FlatBtfBinding {
  int asset = 0;          // index into Scene::assets
  int tex_coord = 0;      // glTF TEXCOORD set
  glm::vec2 scale{1, 1};  // tile periods per unit of uv
  float rotation = 0;     // radians, from u towards v
};

struct SceneMaterial {
  std::string name;
  glm::vec4 base_color{1};
  float metallic = 1, roughness = 1;
  glm::vec3 emissive{0};
  bool double_sided = false;
  std::optional<FlatBtfBinding> flat_btf;
};

// One mesh placed in the world.
struct Instance {
  std::string name;
  int mesh = 0;       // index into Scene::meshes
  int material = -1;  // index into Scene::materials; -1 is glTF's default material
  glm::mat4 world_from_local{1};
};

enum class LightKind { kSun, kPoint, kSpot };
struct Light {
  LightKind kind = LightKind::kPoint;
  glm::vec3 position{0};          // world; unused by a sun
  glm::vec3 direction{0, -1, 0};  // unit, the way the light travels; unused by a point light
  // colour * intensity: a sun's irradiance on a surface that faces it, the others' radiant intensity. With
  // irradiance pi a white Lambert surface facing the light is 1.
  glm::vec3 intensity{1};
  float range = 0;                     // metres; 0 means no end
  float cos_inner = 1, cos_outer = 0;  // of a spot light's cone
};

struct SceneCamera {
  std::string name;
  glm::mat4 world_from_camera{1};  // looks along -z, y up
  float fov_y = 0.7f;              // radians
};

struct Scene {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<SceneMaterial> materials;
  std::vector<SceneAsset> assets;
  std::vector<Instance> instances;
  std::vector<Light> lights;
  std::vector<SceneCamera> cameras;
  std::vector<Issue> notes;  // what was odd but not fatal
};

Bounds boundsOf(const Mesh& mesh);
// Of a box after a transform: the box around its eight corners.
Bounds transformed(const Bounds& bounds, const glm::mat4& transform);

// Area-weighted vertex normals from the triangles.
void computeNormals(Mesh& mesh);
// Per-vertex tangents from positions and UVs; vertices on a mirror seam are split so that each has one sign.
// Vertices whose UVs are degenerate keep w = 0.
void computeTangents(Mesh& mesh);

}  // namespace loden::runtime
