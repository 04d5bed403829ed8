// A scene in memory, as the renderer takes it: no file format and no GL here. Units are metres and radians,
// colours linear RGB; y is up, as in glTF, unless a caller says otherwise.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <span>
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
  // Unitless, any range; the set of the Loden material, else of the normal texture, else the first.
  glm::vec2 uv{0};
};

struct Bounds {
  glm::vec3 min{0}, max{0};
  glm::vec3 centre() const { return 0.5f * (min + max); }
  float radius() const { return 0.5f * glm::length(max - min); }
};

// Sets of texture coordinates that textures may choose from: TEXCOORD_0 and up.
inline constexpr int kUvSets = 4;

// What a morph target adds to each vertex at weight 1; each list parallel to the vertices, or empty.
struct MorphTarget {
  std::vector<glm::vec3> positions, normals, tangents;
};

// The joints that move a vertex, as indices into its skin's; weights sum to 1.
struct Influences {
  std::array<uint16_t, 8> joints{};
  std::array<float, 8> weights{};
};

// One triangle list with one material.
struct Mesh {
  std::string name;
  std::vector<Vertex> vertices;
  std::vector<uint32_t> indices;  // three per triangle, counter-clockwise seen from outside
  Bounds bounds;                  // local frame
  // Each parallel to the vertices, or empty where the mesh has none.
  std::array<std::vector<glm::vec2>, kUvSets> uv_sets;
  std::vector<glm::vec4> colors;  // linear RGBA, multiply the base colour
  std::vector<Influences> influences;
  std::vector<MorphTarget> targets;
};
// Adds a copy of each of the named vertices behind the last, with all that belongs to it.
void appendCopies(Mesh& mesh, std::span<const uint32_t> sources);
// Gives each corner of each triangle a vertex of its own.
void separateTriangles(Mesh& mesh);

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

// A decoded picture; the first row is the one at v = 0.
struct SceneImage {
  std::string name;  // for messages
  glm::ivec2 size{0};
  std::vector<glm::u8vec4> pixels;  // [height][width], codes as stored
};

enum class Wrap { kRepeat, kMirror, kClamp };
enum class MipFilter { kNone, kNearest, kLinear };
struct TextureSampler {
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  bool magnify_linear = true, minify_linear = true;
  MipFilter mips = MipFilter::kLinear;
  friend auto operator<=>(const TextureSampler&, const TextureSampler&) = default;
};

// What a material's textures are for, in the order of SCENE_TEXTURE_* (shaders/scene_shared.h).
enum class TextureRole {
  kBaseColor,          // sRGB and alpha
  kMetallicRoughness,  // roughness in green, metallic in blue
  kNormal,
  kOcclusion,           // red
  kEmissive,            // sRGB
  kSpecular,            // alpha
  kSpecularColor,       // sRGB
  kSheenColor,          // sRGB
  kSheenRoughness,      // alpha
  kClearcoat,           // red
  kClearcoatRoughness,  // green
  kClearcoatNormal,
};
inline constexpr int kTextureRoles = 12;
constexpr bool isSrgb(TextureRole role) {
  return role == TextureRole::kBaseColor || role == TextureRole::kEmissive ||
         role == TextureRole::kSpecularColor || role == TextureRole::kSheenColor;
}

struct TextureUse {
  int image = -1;  // index into Scene::images; -1: none, the factor alone counts
  TextureSampler sampler;
  int tex_coord = 0;  // below kUvSets
  // The two rows that take (u, v, 1) to the image: KHR_texture_transform.
  glm::vec3 image_u{1, 0, 0}, image_v{0, 1, 0};
};

enum class AlphaMode { kOpaque, kMask, kBlend };

// glTF's metallic-roughness material with the extensions that are drawn; names are those of glTF's members.
struct SceneMaterial {
  std::string name;
  glm::vec4 base_color{1};
  float metallic = 1, roughness = 1;
  float normal_scale = 1, occlusion_strength = 1;
  glm::vec3 emissive{0};  // may exceed 1: KHR_materials_emissive_strength
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  bool unlit = false;
  float ior = 1.5f;
  float specular = 1;
  glm::vec3 specular_color{1};
  glm::vec3 sheen_color{0};
  float sheen_roughness = 0;
  float clearcoat = 0, clearcoat_roughness = 0, clearcoat_normal_scale = 1;
  std::array<TextureUse, kTextureRoles> textures;  // by TextureRole
  std::optional<FlatBtfBinding> flat_btf;

  TextureUse& texture(TextureRole role) { return textures[static_cast<size_t>(role)]; }
  const TextureUse& texture(TextureRole role) const { return textures[static_cast<size_t>(role)]; }
};

// A node of the hierarchy that things hang on and animations move: first scaled, then turned, then moved,
// then by its matrix.
struct SceneNode {
  std::string name;
  int parent = -1;  // index into Scene::nodes, below the node's own; -1: the world
  glm::mat4 matrix{1};
  glm::vec3 translation{0};
  glm::quat rotation{1, 0, 0, 0};
  glm::vec3 scale{1};
  std::vector<float> weights;  // of morph targets
};

// Joints that a mesh hangs on.
struct Skin {
  std::vector<int> joints;                 // indices into Scene::nodes
  std::vector<glm::mat4> joint_from_mesh;  // of each joint, in the pose that the mesh was made in
};

enum class AnimationTarget { kTranslation, kRotation, kScale, kWeights };
enum class Interpolation { kLinear, kStep, kCubic };
struct AnimationChannel {
  int node = 0;  // index into Scene::nodes
  AnimationTarget target = AnimationTarget::kTranslation;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times;  // seconds, increasing; at least one
  size_t width = 3;          // numbers per value
  // [key][number]; of cubic splines [key][slope before, value, slope behind][number].
  std::vector<float> values;
};
struct SceneAnimation {
  std::string name;
  double duration = 0;  // seconds: the last key of all
  std::vector<AnimationChannel> channels;
};

// One mesh placed in the world.
struct Instance {
  std::string name;
  int mesh = 0;                   // index into Scene::meshes
  int material = -1;              // index into Scene::materials; -1 is glTF's default material
  glm::mat4 world_from_local{1};  // as the nodes stand in the file
  int node = -1;                  // index into Scene::nodes; -1: never moves
  glm::mat4 node_from_local{1};
  int skin = -1;  // index into Scene::skins
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
  int node = -1;                       // that it hangs on; -1: never moves
};

struct SceneCamera {
  std::string name;
  glm::mat4 world_from_camera{1};  // looks along -z, y up
  float fov_y = 0.7f;              // radians
  int node = -1;                   // that it hangs on; -1: never moves
};

struct Scene {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<SceneMaterial> materials;
  std::vector<SceneImage> images;
  std::vector<SceneAsset> assets;
  std::vector<SceneNode> nodes;
  std::vector<Skin> skins;
  std::vector<SceneAnimation> animations;
  std::vector<std::string> variants;  // names of KHR_materials_variants
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
