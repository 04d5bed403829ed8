// Shared by C++ and GLSL: what the sample renderer's shaders read beside a material. Another engine has its
// own.
#ifndef LODEN_SCENE_SHARED_H
#define LODEN_SCENE_SHARED_H

#define SCENE_BLOCK_FRAME 1  // uniform block bindings, behind the material's
#define SCENE_BLOCK_OBJECT 2
#define SCENE_BLOCK_BASE_MATERIAL 3
#define SCENE_UNIT_SHADOW 29  // texture units, behind those of any material

// Textures of a base material, which no Loden material is drawn together with: bit, unit and index in one.
#define SCENE_TEXTURE_BASE_COLOR 0
#define SCENE_TEXTURE_METALLIC_ROUGHNESS 1
#define SCENE_TEXTURE_NORMAL 2
#define SCENE_TEXTURE_OCCLUSION 3
#define SCENE_TEXTURE_EMISSIVE 4
#define SCENE_TEXTURE_SPECULAR 5
#define SCENE_TEXTURE_SPECULAR_COLOR 6
#define SCENE_TEXTURE_SHEEN_COLOR 7
#define SCENE_TEXTURE_SHEEN_ROUGHNESS 8
#define SCENE_TEXTURE_CLEARCOAT 9
#define SCENE_TEXTURE_CLEARCOAT_ROUGHNESS 10
#define SCENE_TEXTURE_CLEARCOAT_NORMAL 11
#define SCENE_TEXTURES 12
#define SCENE_UNIT_REFLECTIONS 12  // of the environment, by roughness
#define SCENE_UNIT_REFLECTANCE 13  // of a base material under white light, by cosine and roughness

#define SCENE_MAX_SUNS 4           // of the environment
#define SCENE_MAX_LIGHTS 32        // point and spot lights of a frame
#define SCENE_MAX_OBJECT_LIGHTS 8  // of them, those that reach one object

// Bits of SceneFrame.flags.x
#define SCENE_SUN 1
#define SCENE_SHADOWS 2
#define SCENE_FILMIC 4  // tone curve; without it colours are clipped
#define SCENE_LAMBDA_OVERRIDE 8
#define SCENE_SUN_VIEW 16  // the sun's view, for the shadow map
#define SCENE_LAMBDA_DISTANCE 32
#define SCENE_NEUTRAL 64              // the tone curve of glTF's viewers
#define SCENE_ENVIRONMENT_SHADOW 128  // the shadow map is that of the environment's first sun
#define SCENE_SHELL 256               // meshes stand for the lowest points of a relief

// Of SceneFrame.lambda.z: what a heat map shows
#define SCENE_HEAT_LAMBDA 1   // 0 to 8
#define SCENE_HEAT_FETCHES 2  // 0 to 100
#define SCENE_HEAT_TERMS 3    // red the near term, green bands, blue the mean alone

// Bits of SceneObject.flags.x
#define SCENE_DOUBLE_SIDED 1
#define SCENE_DERIVE_TANGENTS 2  // the vertices' tangents belong to a Loden material

// Bits of SceneBaseMaterial.flags.y
#define SCENE_UNLIT 1
#define SCENE_SHEEN 2
#define SCENE_CLEARCOAT 4
#define SCENE_ALPHA_MASK 8
#define SCENE_ALPHA_BLEND 16

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace loden::runtime {
using glm::ivec4;
using glm::mat4;
using glm::vec4;
#endif

// std140: only vec4, ivec4 and mat4, so that both languages agree.
struct SceneLight {
  vec4 position_range;   // world, metres; range 0: no end
  vec4 intensity_kind;   // linear RGB radiant intensity; w 1 for a spot light
  vec4 direction_outer;  // the way its light travels; cosine of the outer cone
  vec4 inner;            // cosine of the inner cone, unused x 3
};

struct SceneFrame {
  mat4 clip_from_world;
  mat4 shadow_from_world;  // texture coordinates and depth of the shadow map
  vec4 camera_exposure;    // world position; factor before the tone curve
  vec4 sun_direction;      // unit, towards the sun; w: side of a shadow texel, metres
  vec4
      sun_irradiance;  // linear RGB on a surface that faces it; w: half width of its shadows' borders, texels
  vec4 environment[9];  // as loden_hemisphere_light takes it
  vec4 environment_suns[2 *
                        SCENE_MAX_SUNS];  // each: unit direction towards it; linear RGB irradiance facing it
  vec4 base_environment[9];  // the same for base materials, with the suns in it where there are reflections
  ivec4 flags;  // bits, number of the environment's suns, 1 if the rest of it gives light, levels of the
                // reflection map or 0
  vec4 lambda;  // override; metres across a pixel at 1 m, for the distance rule; the heat map; level of
                // the reflection map behind the scene
  SceneLight lights[SCENE_MAX_LIGHTS];
};

struct SceneObject {
  mat4 world_from_local;
  mat4 normal_from_local;  // inverse transpose of its upper 3 x 3
  vec4 emissive;           // linear RGB that a Loden material adds; unused
  vec4 tile;        // metres per tile period, where its texture coordinates are not stretched; unused x 3
  ivec4 flags;      // bits, number of lights, 1 or -1 if the transform mirrors, unused
  ivec4 lights[2];  // indices into SceneFrame.lights
};

// glTF's own material: names as in runtime/scene/scene.h.
struct SceneBaseMaterial {
  vec4 base_color;
  vec4 emissive_cutoff;
  vec4 factors;                  // metallic, roughness, normal scale, occlusion strength
  vec4 specular;                 // linear RGB, strength
  vec4 sheen;                    // linear RGB, roughness
  vec4 clearcoat;                // strength, roughness, normal scale; reflectance of the dielectric facing it
  ivec4 flags;                   // bits of the textures there are, other bits, unused x 2
  vec4 image_u[SCENE_TEXTURES];  // (u, v, 1) to the image, and the set of texture coordinates
  vec4 image_v[SCENE_TEXTURES];  // w unused
};

#ifdef __cplusplus
static_assert(sizeof(SceneLight) == 64);
static_assert(sizeof(SceneFrame) ==
              2 * 64 + (23 + 2 * SCENE_MAX_SUNS) * 16 + SCENE_MAX_LIGHTS * sizeof(SceneLight));
static_assert(sizeof(SceneObject) == 2 * 64 + 5 * 16);
static_assert(sizeof(SceneBaseMaterial) == (7 + 2 * SCENE_TEXTURES) * 16);
static_assert(SCENE_MAX_OBJECT_LIGHTS == 8);
}  // namespace loden::runtime
#endif

#endif
