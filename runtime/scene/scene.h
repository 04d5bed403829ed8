// A scene in memory, as the renderer takes it. No file format and no GL. Units are metres and radians,
// colours are linear RGB, and y is up, as in glTF, unless a caller says otherwise.
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
  // Texture coordinates, unitless and of any range: the set that the Loden material uses, or else the set of
  // the normal texture, or else the first set.
  glm::vec2 uv{0};
};

struct Bounds {
  glm::vec3 min{0}, max{0};
  glm::vec3 centre() const { return 0.5f * (min + max); }
  float radius() const { return 0.5f * glm::length(max - min); }
};

// The number of sets of texture coordinates that textures may choose from: TEXCOORD_0 and up.
inline constexpr int kUvSets = 4;

// What a morph target adds to each vertex at weight 1. Each list has one entry per vertex, or is empty.
struct MorphTarget {
  std::vector<glm::vec3> positions, normals, tangents;
};

// The joints that move a vertex, as indices into Skin::joints of its skin, and their weights, which sum to 1.
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
  // Each of the lists below has one entry per vertex, or is empty where the mesh has none.
  std::array<std::vector<glm::vec2>, kUvSets> uv_sets;
  std::vector<glm::vec4> colors;  // linear RGBA, multiplied with the base colour
  std::vector<Influences> influences;
  std::vector<MorphTarget> targets;
};
// Appends a copy of each of the vertices `sources`, with everything that belongs to it.
void appendCopies(Mesh& mesh, std::span<const uint32_t> sources);
// Gives each corner of each triangle a vertex of its own.
void separateTriangles(Mesh& mesh);

// A .loden file that the scene refers to, or contains.
struct SceneAsset {
  std::filesystem::path path;  // empty if embedded
  std::vector<std::byte> embedded;
  std::string name;  // for messages
};

// The extension LODEN_materials_flat_btf on a material: tile coordinates x = rotation(scale * uv), in tile
// periods.
struct FlatBtfBinding {
  int asset = 0;          // index into Scene::assets
  int tex_coord = 0;      // glTF TEXCOORD set
  glm::vec2 scale{1, 1};  // tile periods per unit of uv
  float rotation = 0;     // radians, from u towards v
};

// A decoded picture; its first row is at v = 0.
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

// The uses of a material's textures, in the order of SCENE_TEXTURE_* (shaders/scene_shared.h).
enum class TextureRole {
  kBaseColor,          // sRGB colour, and alpha
  kMetallicRoughness,  // roughness in green, metallic in blue
  kNormal,
  kOcclusion,           // red channel
  kEmissive,            // sRGB
  kSpecular,            // alpha channel
  kSpecularColor,       // sRGB
  kSheenColor,          // sRGB
  kSheenRoughness,      // alpha channel
  kClearcoat,           // red channel
  kClearcoatRoughness,  // green channel
  kClearcoatNormal,
};
inline constexpr int kTextureRoles = 12;
constexpr bool isSrgb(TextureRole role) {
  return role == TextureRole::kBaseColor || role == TextureRole::kEmissive ||
         role == TextureRole::kSpecularColor || role == TextureRole::kSheenColor;
}

struct TextureUse {
  int image = -1;  // index into Scene::images; -1: no texture, and the factor counts alone
  TextureSampler sampler;
  int tex_coord = 0;  // below kUvSets
  // The two rows of the matrix that takes (u, v, 1) to image coordinates (KHR_texture_transform).
  glm::vec3 image_u{1, 0, 0}, image_v{0, 1, 0};
};

enum class AlphaMode { kOpaque, kMask, kBlend };

// glTF's metallic-roughness material with the extensions that are drawn. Members are named as in glTF.
struct SceneMaterial {
  std::string name;
  glm::vec4 base_color{1};
  float metallic = 1, roughness = 1;
  float normal_scale = 1, occlusion_strength = 1;
  glm::vec3 emissive{0};  // may exceed 1 (KHR_materials_emissive_strength)
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
  std::array<TextureUse, kTextureRoles> textures;  // indexed by TextureRole
  std::optional<FlatBtfBinding> flat_btf;

  TextureUse& texture(TextureRole role) { return textures[static_cast<size_t>(role)]; }
  const TextureUse& texture(TextureRole role) const { return textures[static_cast<size_t>(role)]; }
};

// A node of the scene's hierarchy. Its transform is matrix * translation * rotation * scale: scale is applied
// first.
struct SceneNode {
  std::string name;
  int parent = -1;  // index into Scene::nodes, smaller than the node's own; -1: the world
  glm::mat4 matrix{1};
  glm::vec3 translation{0};
  glm::quat rotation{1, 0, 0, 0};
  glm::vec3 scale{1};
  std::vector<float> weights;  // weights of morph targets
};

// The joints that move a mesh's vertices.
struct Skin {
  std::vector<int> joints;                 // indices into Scene::nodes
  std::vector<glm::mat4> joint_from_mesh;  // per joint, in the pose in which the mesh was modelled
};

enum class AnimationTarget { kTranslation, kRotation, kScale, kWeights };
enum class Interpolation { kLinear, kStep, kCubic };
struct AnimationChannel {
  int node = 0;  // index into Scene::nodes
  AnimationTarget target = AnimationTarget::kTranslation;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times;  // seconds, increasing; at least one
  size_t width = 3;          // numbers per value
  // [key][number]; for cubic splines [key][in-tangent, value, out-tangent][number].
  std::vector<float> values;
};
struct SceneAnimation {
  std::string name;
  double duration = 0;  // seconds; time of the last key of all channels
  std::vector<AnimationChannel> channels;
};

// One mesh placed in the world.
struct Instance {
  std::string name;
  int mesh = 0;                   // index into Scene::meshes
  int material = -1;              // index into Scene::materials; -1 is glTF's default material
  glm::mat4 world_from_local{1};  // in the pose stored in the file
  int node = -1;                  // index into Scene::nodes; -1: the instance never moves
  glm::mat4 node_from_local{1};
  int skin = -1;  // index into Scene::skins
};

enum class LightKind { kSun, kPoint, kSpot };
struct Light {
  LightKind kind = LightKind::kPoint;
  glm::vec3 position{0};          // world; unused by a sun
  glm::vec3 direction{0, -1, 0};  // unit, the way the light travels; unused by a point light
  // Colour * intensity: for a sun the irradiance on a surface that faces it, for other lights the radiant
  // intensity. With irradiance pi a white Lambert surface facing the light has radiance 1.
  glm::vec3 intensity{1};
  float range = 0;                     // metres; 0 means no end
  float cos_inner = 1, cos_outer = 0;  // cosines of a spot light's inner and outer cone angle
  int node = -1;                       // index into Scene::nodes, to which it is attached; -1: it never moves
};

struct SceneCamera {
  std::string name;
  glm::mat4 world_from_camera{1};  // looks along -z, y up
  float fov_y = 0.7f;              // radians
  int node = -1;                   // index into Scene::nodes, to which it is attached; -1: it never moves
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
  std::vector<Issue> notes;  // what was unusual in the file but not fatal
};

Bounds boundsOf(const Mesh& mesh);
// The box around the eight corners of a transformed box.
Bounds transformed(const Bounds& bounds, const glm::mat4& transform);

// Sets vertex normals to the area-weighted mean of the triangles' normals.
void computeNormals(Mesh& mesh);
// Sets vertex tangents from positions and UVs. Vertices on a mirror seam are split so that each has one sign;
// vertices whose UVs are degenerate get w = 0.
void computeTangents(Mesh& mesh);

}  // namespace loden::runtime
